"""A directory of recordings as people have them, each with the right numbers beside it (table.toml)."""

from pathlib import Path

import numpy as np
import pytest

from farhand.common.errors import TraceError
from farhand.common.toml import read_toml
from farhand.netem.recordings.trace import load_trace

FOLDER = Path(__file__).parent / "samples" / "conformance"
TABLE = read_toml(FOLDER / "table.toml", "table")


def test_the_table_is_of_every_file():
    assert set(TABLE) == {path.name for path in FOLDER.iterdir()} - {"table.toml"}
    assert len(TABLE) >= 50


@pytest.mark.parametrize("name", TABLE)
def test_it_is_read_right_or_asked_about(name):
    expected = TABLE[name]
    options = expected.get("options", {})
    if "error" in expected:
        with pytest.raises(TraceError) as caught:
            load_trace(FOLDER / name, **options)
        assert expected["error"] in str(caught.value)
        assert "\n" not in str(caught.value)
        return
    trace = load_trace(FOLDER / name, **options)
    reading = trace.reading
    np.testing.assert_allclose(trace.recorded * 1e3, expected["ms"], rtol=1e-9)
    assert reading.how["format"].split()[0] == expected["format"]
    assert reading.how["kind"].split()[0] == trace.kind
    assert trace.kind == expected.get("kind", trace.kind)
    if "times" in expected:
        np.testing.assert_allclose(trace.times, expected["times"], atol=2e-6)
    if "period" in expected:
        assert trace.period == pytest.approx(expected["period"])
    lost = int(np.isnan(trace.recorded).sum())
    assert reading.lost_inferred == expected.get("inferred", lost - expected.get("seen", 0))
    assert reading.lost_seen + reading.lost_inferred == lost
    assert expected.get("note", "") in "; ".join(reading.notes)

import pytest
from hypothesis import given
from hypothesis import strategies as st

from farhand.programs.series import Series


@given(st.integers(2, 20), st.integers(0, 400))
def test_short_runs_are_kept_whole_and_long_ones_evenly(limit, count):
    series = Series(limit)
    for sample in range(count):
        series.add(sample)
    kept = series.samples()
    assert len(kept) <= limit
    if count <= limit:
        assert kept == list(range(count))
        return
    step = kept[1] - kept[0]
    assert kept == list(range(0, count, step))
    assert len(kept) > limit // 2 - 1


def test_one_sample_is_no_curve():
    with pytest.raises(ValueError, match="two"):
        Series(1)

"""A recorded network, again: message by message the same fates and delays, whatever made them."""

import warnings

import msgspec
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from farhand.cli import run as run_cli
from farhand.common.errors import RunFileError, SpecError
from farhand.common.recording.fates import FATE_TOPICS, Fate
from farhand.common.recording.reader import Entry, RunReader
from farhand.laboratory.simulation import simulate
from farhand.netem.impairments.recorded import Course, _read, recorded_fates
from farhand.netem.spec import parse_spec
from farhand.runs.scenario import load_scenario

EVERYTHING = (
    "uniform:20,80 loss:gilbert(10%,30%) duplicate:8% corrupt:3% reorder:drawn outage:every(2s,200ms)"
)


def fates(path):
    """What became of each message, and when it came."""
    found = {}
    for item in RunReader(path).items(lambda topic: topic in FATE_TOPICS.values()):
        assert isinstance(item, Entry)
        fate = msgspec.json.decode(item.data, type=Fate)
        found.setdefault((fate.direction, fate.key, fate.number), []).append(fate)
    return found


@pytest.mark.parametrize("network", [EVERYTHING, "rate:200kbit constant:20", "tcp-like loss:8% constant:40"])
def test_the_very_same_network_gives_the_very_same_run(tmp_path, network):
    first, again = tmp_path / "first.mcap", tmp_path / "again.mcap"
    once = simulate("point-obstacle", network=network, seed=3, time_limit=6.0, record_to=first, digest=True)
    twice = simulate(
        "point-obstacle", network=f"recorded:{first}", time_limit=6.0, seed=3, record_to=again, digest=True
    )
    known = fates(first)
    assert len(known) > 300
    assert fates(again) == known
    assert once.digest == twice.digest
    if network == EVERYTHING:
        rows = [fate for each in known.values() for fate in each]
        assert {"delivered", "loss", "outage"} <= {fate.fate for fate in rows}
        assert any(fate.copy for fate in rows)
        assert any(fate.corrupted >= 0 for fate in rows)


def test_another_robot_s_name_and_another_rate_get_the_same_network(tmp_path):
    path = tmp_path / "run.mcap"
    simulate("point-obstacle", network="constant:70 loss:20%", seed=3, time_limit=4.0, record_to=path)
    course = recorded_fates(str(path)).of("downlink", "farhand/another/state")
    assert course is not None
    assert {fate.assigned_ns for at in range(0, 3000, 7) for fate in course.at(at * 1_000_000)} == {
        70_000_000
    }
    assert recorded_fates(str(path)).of("uplink", "farhand/another/camera") is None


def test_messages_at_another_rate_than_the_recorded_ones_are_told_once(tmp_path):
    path = tmp_path / "run.mcap"
    simulate("point-obstacle", network="constant:70", time_limit=2.0, record_to=path)
    point = load_scenario("point-obstacle")
    slower = msgspec.structs.replace(point, robot=msgspec.structs.replace(point.robot, state_rate_hz=25.0))
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        for _ in range(2):
            simulate("point-obstacle", network=f"recorded:{path}", time_limit=2.0)
        assert not said
        for _ in range(2):
            simulate(slower, network=f"recorded:{path}", time_limit=2.0)
    (line,) = said
    assert str(line.message) == (
        f"recorded:{path}: state messages come 25 times a second, in it 50 times: each gets the fate of the one that "
        "is nearest in time, and it is not that network message by message"
    )


def fate(at_ms, word="delivered"):
    return Fate(
        direction="uplink",
        key="k",
        number=0,
        size=1,
        arrived_ns=at_ms,
        drawn_ns=0,
        assigned_ns=at_ms,
        achieved_ns=0,
        fate=word,
    )


def test_the_nearest_message_counts_and_the_end_is_followed_by_the_beginning():
    course = Course([0, 10, 30], [[fate(0)], [fate(10)], [fate(30)]], 40)
    assert [course.at(at)[0].assigned_ns for at in (-3, 0, 4, 6, 19, 21, 30)] == [0, 0, 0, 10, 10, 30, 30]
    assert [course.at(at)[0].assigned_ns for at in (40, 49, 75)] == [0, 10, 30]


def test_bad_input_is_one_line(tmp_path, capsys):
    with pytest.raises(SpecError, match="'recorded' is a whole network and stands alone"):
        parse_spec("recorded:x loss:1%")
    with pytest.raises(SpecError, match="expected ':'"):
        parse_spec("recorded")
    with pytest.raises(RunFileError, match=r"holds no run\.mcap"):
        parse_spec(f"recorded:{tmp_path}").prepare()
    (tmp_path / "run.mcap").write_bytes(b"nonsense")
    assert run_cli(["simulate", "--network", f"recorded:{tmp_path}", "--time-limit", "1"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1
    assert "not a recording of Farhand" in said[0]


@pytest.fixture(scope="module")
def short(tmp_path_factory):
    path = tmp_path_factory.mktemp("short") / "run.mcap"
    simulate("point-obstacle", network="constant:70 loss:20%", record_to=path, time_limit=1.0)
    return path.read_bytes()


def used(path, content):
    """The fates that a damaged recording gives, and what is said of it; None: refused."""
    path.write_bytes(content)
    _read.cache_clear()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            found = recorded_fates(str(path))._courses
        except RunFileError:
            return None, []
    return {key: course._fates for key, course in found.items()}, said


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.integers(0, 10**9), st.integers(0, 7), st.booleans())
def test_another_network_than_the_recorded_one_is_told_of(short, tmp_path, place, bit, cut):
    path, place = tmp_path / "run.mcap", place % len(short)
    content = bytearray(short)
    content[place] ^= 1 << bit
    whole, nothing = used(path, short)
    found, said = used(path, short[:place] if cut else bytes(content))
    assert whole
    assert not nothing
    assert found is None or found == whole or said


def test_the_command_line_tells_of_it_in_one_line(short, tmp_path, capsys):
    (tmp_path / "run.mcap").write_bytes(short[: len(short) // 2])
    words = ["simulate", "--scenario", "point-obstacle", "--timeline", str(tmp_path / "none")]
    assert run_cli([*words, "--network", f"recorded:{tmp_path}"]) == 2
    said = [line for line in capsys.readouterr().err.splitlines() if "recorded:" in line]
    assert said == [f"farhand: recorded:{tmp_path}: the file ends early; the network until then is repeated"]


def test_a_run_without_a_network_says_how_one_is_recorded(tmp_path):
    from farhand.common.recording.records import RunInfo
    from farhand.common.recording.run_file import RunFile

    info = RunInfo(scenario={"name": "x"}, robot="r", session=3, seed=1, versions={})
    RunFile(tmp_path / "run.mcap", info).close()
    with pytest.raises(RunFileError, match="holds no network"):
        parse_spec(f"recorded:{tmp_path}").prepare()

"""The witness over real Zenoh, with a session of the test in place of the programs."""

import pytest

from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session
from farhand.common.messages.codec import encode
from farhand.testing import Witness, report, scene, state

pytestmark = pytest.mark.realtime


@pytest.fixture
def places():
    return [f"tcp/127.0.0.1:{port}" for port in free_ports(2)]


def test_it_sees_states_scenes_and_reports_and_waits_for_them(places):
    robot, operator = (open_session(listen=[place]) for place in places)
    witness = Witness(places[0], "r1", reports=places[1])
    seq = 0

    def put_states(n):
        nonlocal seq
        for _ in range(n):
            seq += 1
            robot.put("farhand/r1/state", encode(state(seq)))

    try:

        def talk():
            put_states(1)
            robot.put("farhand/r1/scene", encode(scene(5)))
            operator.put("farhand/r1/report", encode(report(6)))
            return witness.states and witness.scene and witness.reports

        for _ in range(3000):  # until the sessions have met
            if talk():
                break
            with pytest.raises(AssertionError, match="did not come within"):
                witness.wait_for(lambda: False, patience=0.01)
        assert (witness.scene.seq, witness.reports[-1].tick) == (5, 6)

        last = witness.states[-1].seq
        put_states(20)
        seen = []

        def tenth_from_now(found):
            seen.append(found.seq)
            put_states(1)
            return found.seq >= last + 10

        assert witness.wait_until(tenth_from_now).seq >= last + 10
        assert seen[0] > last  # nothing from before it waited
        witness.wait_for(lambda: len(witness.states) >= 20)
        with pytest.raises(AssertionError, match="did not come within"):
            witness.wait_until(lambda found: False, patience=0.05)
        witness.forget()
        assert (witness.states, witness.reports) == ([], [])
        robot.put("farhand/r1/state", b"junk")
        with pytest.raises(AssertionError, match="farhand/r1/state: malformed"):
            witness.wait_for(lambda: False)
    finally:
        witness.close()
        robot.close()
        operator.close()

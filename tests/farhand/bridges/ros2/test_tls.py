"""TLS, of which an end takes no one whom its own authority did not sign: to the router, and to the robot's side."""

import queue

import pytest
import zenoh

from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.wire import data_key
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import open_session, zenoh_config
from farhand.common.trust.tls import load_folder
from farhand.site.certificates import issue, make_authority
from farhand.testing import Programs, short_task
from tests.farhand.bridges.ros2.peer import PATIENCE, Peer, router

pytestmark = pytest.mark.realtime
STATUS, MARKERS = "moveit_msgs/msg/ServoStatus", "visualization_msgs/msg/MarkerArray"


@pytest.mark.long
def test_it_talks_to_a_router_by_tls_and_who_is_of_another_authority_does_not(tmp_path):
    certs, foreign = tmp_path / "certs", tmp_path / "foreign"
    make_authority(certs)
    issue(certs, "router", "hub")
    issue(certs, "observer", "rviz", ["ur5"])
    own = issue(certs, "operator", "alice", ["ur5"])
    make_authority(foreign)
    mallory = issue(foreign, "operator", "alice", ["ur5"])
    port, operator = free_ports(2)
    endpoint, types, heard = f"tls/127.0.0.1:{port}", Types("jazzy"), queue.Queue()
    hub = load_folder(certs / "router.hub").encryption()
    node = ("ros2", "--router", endpoint, "--connect", f"tcp/127.0.0.1:{operator}", "--tls")
    with (
        zenoh.open(zenoh_config(listen=[endpoint], mode="router", extra=hub)),
        Programs(tmp_path) as programs,
    ):
        refused = programs.start(*node, mallory)
        with open_session(
            [endpoint], mode="client", extra=load_folder(certs / "observer.rviz").encryption()
        ) as rviz:
            key = data_key(0, "/farhand/ur5/status", STATUS, types.hash_of(STATUS))
            rviz.declare_subscriber(key, lambda sample: heard.put(sample.payload.to_bytes()))
            bridge = programs.start(*node, own)
            said = types.decode(heard.get(timeout=PATIENCE), STATUS)
            assert (said.code, said.message) == (-1, "waiting for the operator's program")
            nodes = [reply.ok for reply in rviz.liveliness().get("@ros2_lv/0/**") if reply.ok is not None]
            assert sum("/NN/" in str(each.key_expr) for each in nodes) == 1
        assert bridge.interrupt(30) == 0
        assert refused.wait() == 2
        assert "no Zenoh router answers there" in refused.said[-1]


def test_on_the_robots_side_it_hears_and_stops_the_robot_by_tls_and_who_is_of_another_authority_does_not(
    tmp_path,
):
    certs, foreign = tmp_path / "certs", tmp_path / "foreign"
    make_authority(certs)
    issue(certs, "robot", "ur5")
    own = issue(certs, "operator", "alice", ["ur5"])
    make_authority(foreign)
    mallory = issue(foreign, "operator", "alice", ["ur5"])
    port, far = free_ports(2)
    endpoint = f"tls/127.0.0.1:{far}"
    node = ("ros2", "--side", "robot", "--router", f"tcp/127.0.0.1:{port}", "--connect", endpoint, "--tls")
    with router(port), Peer(port) as peer, Programs(tmp_path) as programs:
        scenario = short_task(tmp_path)
        programs.start("robot", "--scenario", scenario, "--listen", endpoint, "--tls", certs / "robot.ur5")
        heard = {name: peer.listen(f"/{name}/ur5/markers", MARKERS) for name in ("alice", "mallory")}
        refused = programs.start(*node, mallory, "--namespace", "/mallory")
        refused.wait_for("nobody answers")
        programs.start(*node, own, "--namespace", "/alice")
        assert "targets" in {each.ns for each in heard["alice"].get(timeout=PATIENCE).markers}
        stopped = peer.call("/alice/ur5/estop", "std_srvs/srv/Trigger")
        assert stopped.success, stopped.message
        assert heard["mallory"].empty()
        assert not any("connected" in line for line in refused.said)

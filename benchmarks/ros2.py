"""What the ROS 2 bridge adds: joint states at 500 Hz out, twists at 100 Hz in, through the real program.

`python -m benchmarks.ros2 [--quick] [--stages] [--json FILE]`. The operator's program and the ROS nodes are fakes of
this process, at a real router; instants are those of one clock. What a message takes holds two Zenoh links as
well: beside it stands what one such link takes alone, and what a program uses that passes the same states on by Zenoh
and does nothing else, at the same time. `--stages` runs more such programs beside it, each with one thing more that the
bridge does, so that where its share goes is seen on a busy machine, too; what takes how long is not to be read from
that. Needs the extra `farhand[ros2]`.
"""

import argparse
import json
import os
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
import psutil
import zenoh
from rich.console import Console
from rich.table import Table

from farhand.bridges.ros2.cdr.twists import TWIST
from farhand.bridges.ros2.cdr.types import Types
from farhand.bridges.ros2.graph.node import RosNode
from farhand.bridges.ros2.graph.wire import RELIABLE, data_key
from farhand.common.link.link import Packet
from farhand.common.link.ports import free_ports
from farhand.common.link.zenoh_link import ZenohLink, open_session, zenoh_config
from farhand.common.messages.codec import Decoder, encode
from farhand.common.messages.keys import mirror_key, report_key, steering_key
from farhand.common.messages.steering import Steering
from farhand.common.timing.clock import SystemClock
from farhand.testing import Program, description, report, state

JOINTS = "sensor_msgs/msg/JointState"
STATES_HZ, TWISTS_HZ, REPORTS_HZ = 500, 100, 50
SECONDS, QUICK = 20.0, 1.0
BARE = "farhand/r/mirror/bare"
ALONE = "as Zenoh comes"
STAGES = (ALONE, "one thread", "and its state kept", "and joint states made")
PASSES_ON = """
import sys, zenoh
from farhand.common.link.zenoh_link import open_session
from farhand.common.link.zenoh_threads import one_thread, resident
stage = int(sys.argv[4])
if stage > 0:
    one_thread()
robot = open_session([sys.argv[1]])
router = open_session([sys.argv[2]], mode="client")
onward = router.declare_publisher("0/bare", express=True, congestion_control=zenoh.CongestionControl.DROP)
def take(sample):
    onward.put(sample.payload.to_bytes())
if stage > 2:
    from farhand.bridges.ros2.cdr.joint_states import JointStates
    from farhand.bridges.ros2.cdr.types import Types
    from farhand.bridges.ros2.graph.wire import attachment_bytes
    from farhand.bridges.ros2.outbound.joints import JointReader
    from farhand.common.timing.clock import SystemClock
    from farhand.exports.ros_messages import Ros
    types, clock, reader = Types("jazzy"), SystemClock(), JointReader()
    made = JointStates(types, Ros(types.types), tuple("abcdef"))
    def take(sample):
        state = reader.read(sample.payload.to_bytes())
        now_ns = clock.time_of_day_ns()
        onward.put(made.encode(now_ns, state.joints), attachment=attachment_bytes(state.seq, now_ns, bytes(16)))
robot.declare_subscriber(sys.argv[3], zenoh.handlers.Callback(resident(take) if stage > 1 else take, indirect=False))
print("ready", flush=True)
sys.stdin.read()
"""


class Ends:
    """Operator and ROS node in this process.

    Args:
        router, operator: ports.
        clock: of all instants.
    """

    def __init__(self, router: int, operator: int, clock: SystemClock) -> None:
        self.clock, self.types = clock, Types("jazzy")
        self.out: dict[int, int] = {}
        self.bare: list[int] = []
        self.steered: dict[float, int] = {}
        self._decoder = Decoder(Steering)
        self.link = ZenohLink(open_session(listen=[f"tcp/127.0.0.1:{operator}"]), [steering_key("r")], clock)
        self.link.mirror = self._steering
        self.reader = open_session([f"tcp/127.0.0.1:{operator}"])
        self.reader.declare_subscriber(BARE, self._bare)
        session = open_session([f"tcp/127.0.0.1:{router}"], mode="client")
        self.session = session
        node = RosNode(session, self.types, clock, domain=0, namespace="", name="peer", wake=lambda: None)
        key = data_key(0, "/farhand/joint_states", JOINTS, self.types.hash_of(JOINTS))
        session.declare_subscriber(key, self._joints)
        session.declare_subscriber("0/bare", lambda _: None)
        self.twists = node.publisher("/farhand/r/delta_twist_cmds", TWIST, RELIABLE)

    def twist(self, x: float) -> object:
        """Of that speed ahead (m/s)."""
        make = self.types.make
        still = make("geometry_msgs/msg/Vector3", x=0.0, y=0.0, z=0.0)
        ahead = make("geometry_msgs/msg/Vector3", x=x, y=0.0, z=0.0)
        header = make(
            "std_msgs/msg/Header",
            stamp=make("builtin_interfaces/msg/Time", sec=0, nanosec=0),
            frame_id="base",
        )
        return make(TWIST, header=header, twist=make("geometry_msgs/msg/Twist", linear=ahead, angular=still))

    def close(self) -> None:
        """Both sessions."""
        self.link.close()
        self.reader.close()
        self.session.close()

    def _joints(self, sample: zenoh.Sample) -> None:
        now_ns = self.clock.now_ns()
        message = self.types.decode(sample.payload.to_bytes(), JOINTS)
        self.out.setdefault(round(message.position[0] * 1e6), now_ns)

    def _bare(self, sample: zenoh.Sample) -> None:
        self.bare.append(self.clock.now_ns() - int(sample.payload.to_bytes()))

    def _steering(self, packet: Packet) -> None:
        steering = self._decoder.decode(packet.payload)
        if steering is not None and steering.engaged:
            self.steered.setdefault(steering.linear[0], packet.arrived_ns)


def measure(seconds: float, stages: int = 1) -> dict[str, float]:
    """Medians and p99 (ms), and the shares of a core of the bridge and of the first so many of STAGES."""
    clock, pause = SystemClock(), threading.Event()
    router_port, operator_port = free_ports(2)
    router = zenoh.open(zenoh_config(listen=[f"tcp/127.0.0.1:{router_port}"], mode="router"))
    ends = Ends(router_port, operator_port, clock)
    arm = description(kind="ur5", model="ur5", joint_names=tuple("abcdef"), radius=0.05)
    try:
        with Program("ros2", "--robot", "r", "--router", f"tcp/127.0.0.1:{router_port}",
                     "--connect", f"tcp/127.0.0.1:{operator_port}") as program, \
                _passing_on(operator_port, router_port, stages) as others:  # fmt: skip
            program.wait_for("node /farhand/r")
            seq = 0
            while not ends.out:
                seq += 1
                ends.link.send(Packet(mirror_key("r", "description"), encode(arm)))
                ends.link.send(Packet(mirror_key("r", "state"), encode(state(seq, joints=(1e-6 * seq,) * 6))))
                pause.wait(0.1)
            process = psutil.Process(program.pid)
            used, begun_ns, first = _used(process), clock.now_ns(), seq + 1
            others_used = [_used(each) for each in others]
            sent, asked = _drive(ends, seconds, first)
            spent, others_spent = _used(process), [_used(each) for each in others]
            took = (clock.now_ns() - begun_ns) * 1e-9
            pause.wait(0.5)
    finally:
        ends.close()
        router.close()
    out = [(ends.out[each] - at) * 1e-6 for each, at in sent.items() if each in ends.out]
    driven = [(ends.steered[each] - at) * 1e-6 for each, at in asked.items() if each in ends.steered]
    bare = [each * 1e-6 for each in ends.bare]
    return {
        "joint states, median": float(np.median(out)),
        "joint states, p99": float(np.quantile(out, 0.99)),
        "joint states that came": len(out) / len(sent),
        "twist to steering, median": float(np.median(driven)) if driven else float("nan"),
        "twist to steering, p99": float(np.quantile(driven, 0.99)) if driven else float("nan"),
        "twists that steered": len(driven) / max(1, len(asked)),
        "one link alone, median": float(np.median(bare)),
        "one link alone, p99": float(np.quantile(bare, 0.99)),
        "share of a core": (spent - used) / took,
        **{
            f"passing on alone, {stage}": (now - before) / took
            for stage, before, now in zip(STAGES, others_used, others_spent, strict=False)
        },
        "load average": os.getloadavg()[0],
    }


def _used(process: psutil.Process) -> float:
    """Of a processor, by the process and for it (s)."""
    times = process.cpu_times()
    return float(times.user + times.system)


@contextmanager
def _passing_on(operator: int, router: int, stages: int) -> Iterator[list[psutil.Process]]:
    """Programs of their own that pass each state on, and do no more than their stage."""
    words = [f"tcp/127.0.0.1:{operator}", f"tcp/127.0.0.1:{router}", mirror_key("r", "state")]
    with ExitStack() as running:
        started = []
        for stage in range(stages):
            process = running.enter_context(
                subprocess.Popen(
                    [sys.executable, "-c", PASSES_ON, *words, str(stage)],
                    stdin=subprocess.PIPE,
                    stdout=subprocess.PIPE,
                    text=True,
                )
            )
            running.callback(process.kill)
            assert process.stdout is not None
            process.stdout.readline()
            started.append(psutil.Process(process.pid))
        yield started


def _drive(ends: Ends, seconds: float, seq: int) -> tuple[dict[int, int], dict[float, int]]:
    """States, reports and twists at their rates; when each was sent (ns)."""
    clock, sent, asked = ends.clock, {}, {}
    start_ns, period_ns = clock.now_ns(), 10**9 // STATES_HZ
    for tick in range(round(seconds * STATES_HZ)):
        clock.sleep_until(start_ns + tick * period_ns)
        number = seq + tick
        message = encode(state(number, joints=(1e-6 * number,) * 6))
        sent[number] = clock.now_ns()
        ends.link.send(Packet(mirror_key("r", "state"), message))
        if tick % (STATES_HZ // REPORTS_HZ) == 0:
            ends.link.send(Packet(report_key("r"), encode(report(number, safety="run", states=1))))
            ends.link.send(Packet(BARE, str(clock.now_ns()).encode()))
        if tick % (STATES_HZ // TWISTS_HZ) == 2:
            # A zero now and then: what a busy machine has held up is let go of, and pressed anew.
            x = 0.0 if tick % 500 < 20 else 0.1 + 1e-6 * tick
            if x:
                asked[x] = clock.now_ns()
            ends.twists.put(ends.twist(x))
    return sent, asked


def main() -> None:
    """Measure, print, and write."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ros2", description=__doc__)
    parser.add_argument("--json", type=Path, metavar="FILE")
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--stages", action="store_true")
    options = parser.parse_args()
    found = measure(QUICK if options.quick else SECONDS, len(STAGES) if options.stages else 1)
    table = Table("what", "ms, or a share")
    for name, value in found.items():
        table.add_row(name, f"{value:.3f}")
    Console(markup=False).print(table)
    if options.json:
        options.json.write_text(json.dumps(found), encoding="utf-8")


if __name__ == "__main__":
    main()

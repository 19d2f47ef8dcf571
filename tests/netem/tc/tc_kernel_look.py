"""`farhand netem --backend tc` on hosts of its own, looked at from outside: what packets suffer, what tc shows.

Run on a kernel that has sch_netem; prints its findings as JSON.
"""

import json
import signal
import tempfile
from pathlib import Path

from farhand.common.timing.clock import SystemClock, to_ns
from farhand.netem.tc.host import HANDLE, run_command
from farhand.programs.command_line import NetemWords
from farhand.trials.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT, OPERATOR, ROBOT, Hosts
from farhand.trials.kernel.probe import probe

UPLINK, DOWNLINK = "constant:50 loss:10%", "lognormal:40,10 reorder:in-order"
DEVICES = ("to-robot", "to-operator")


def look(hosts: Hosts, folder: Path) -> dict[str, object]:
    """Start, measure, look, end, look again."""

    def tc(*words: str) -> str:
        code, stdout, stderr = run_command(hosts.command_on("netem", "tc", *words), {})
        assert code == 0, stderr
        return stdout

    def shown() -> dict[str, list[dict[str, object]]]:
        return {d: json.loads(tc("-json", "qdisc", "show", "dev", d)) for d in DEVICES}

    # What an emulation that was killed leaves: parts of it would live on under `tc qdisc replace`.
    tc(
        "qdisc",
        "add",
        "dev",
        DEVICES[0],
        "root",
        "handle",
        HANDLE,
        "netem",
        "delay",
        "300ms",
        "corrupt",
        "50%",
    )
    words = NetemWords(
        backend="tc",
        uplink=UPLINK,
        downlink=DOWNLINK,
        insecure=True,
        listen_operator=f"tcp/{NETEM_FOR_OPERATOR}:7447",
        listen_robot=f"tcp/{NETEM_FOR_ROBOT}:7448",
        ready_file=str(folder / "ready"),
        stats=str(folder / "stats"),
    )
    netem = hosts.start("netem", "farhand", *words.words(), log=folder / "log")
    clock = SystemClock()
    end_ns = clock.now_ns() + to_ns(30.0)
    while not (folder / "ready").exists() and netem.poll() is None and clock.now_ns() < end_ns:
        clock.sleep_until(clock.now_ns() + to_ns(0.05))
    found: dict[str, object] = {"running": shown()}
    near = hosts.namespace("netem")
    for name, host, address in (("uplink", "robot", ROBOT), ("downlink", "operator", OPERATOR)):
        seen = probe(near, hosts.namespace(host), address, 400, 0.005, patience=0.4)
        found[name] = seen.summary() | {"corrupted": seen.corrupted}
    netem.send_signal(signal.SIGTERM)
    found["code"] = netem.wait(15)
    found["ended"] = shown()
    found["said"] = (folder / "log").read_text()
    found["counted"] = json.loads((folder / "stats").read_text())["tc"]
    return found


def main() -> None:
    """Look, print."""
    hosts = Hosts()
    try:
        with tempfile.TemporaryDirectory() as folder:
            print(json.dumps(look(hosts, Path(folder))))
    finally:
        hosts.close()


if __name__ == "__main__":
    main()

"""Attacks on the robot by those who can reach a port: who they are, what they try, what must be said of it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from farhand.common.errors import FarhandError
from farhand.trials.faults.judgement import Outcome
from farhand.trials.faults.rig import ROBOT, Rig
from farhand.trials.hosts import NETEM_FOR_OPERATOR, NETEM_FOR_ROBOT

OPERATOR_SIDE = f"tls/{NETEM_FOR_OPERATOR}:7447"
SECOND_OPERATOR_TIME = 10.0


@dataclass(frozen=True, slots=True)
class Attack:
    """One attack.

    Attributes:
        run: does it; returns what the attacker says of itself.
        said: (program, part of a line) that must be said of it; any of them will do.
        may_connect: whether its link may come about at all.
        may_read: whether it has a right to read the robot's state.
    """

    run: Callable[[Rig], dict[str, Any]]
    said: tuple[tuple[str, str], ...]
    may_connect: bool = False
    may_read: bool = False


@dataclass(frozen=True, slots=True)
class Attacked:
    """One attack, judged: what the attacker managed, the line that was said, and what the robot did."""

    name: str
    found: dict[str, Any]
    line: str
    outcome: Outcome
    unsafe: tuple[str, ...] = field(default=())

    @property
    def safe(self) -> bool:
        """Whether all was as it must be."""
        return not self.unsafe


def attacks() -> dict[str, Attack]:
    """All of them by name, in the order in which they are done."""
    netem = "netem"
    return {
        "no certificate": Attack(
            lambda rig: _commands(rig, authority="ca.pem"), ((netem, "it showed no certificate"),)
        ),
        "no TLS": Attack(
            lambda rig: _commands(rig, endpoint=OPERATOR_SIDE.replace("tls", "tcp")),
            ((netem, "what it sent is not TLS"),),
        ),
        "certificate of a foreign authority": Attack(
            lambda rig: _commands(rig, folder=str(rig.folder / "foreign/operator.alice"), authority="ca.pem"),
            ((netem, "its certificate is of another authority"),),
        ),
        "certificate that has ended": Attack(
            lambda rig: _commands(rig, "operator.ended"), ((netem, "its certificate has ended"),)
        ),
        "right authority, wrong name": Attack(
            lambda rig: _commands(rig, "operator.mallory", authority="ca.pem"),
            ((netem, "'operator.mallory', which is not in"),),
            may_connect=True,
        ),
        "operator of another robot": Attack(
            lambda rig: _commands(rig, "operator.bob"),
            ((netem, f"operator.bob may not write farhand/{ROBOT}/command"),),
            may_connect=True,
        ),
        "operator of another robot, 10,000 commands/s": Attack(
            lambda rig: _commands(rig, "operator.bob", rate=10_000),
            ((netem, f"operator.bob may not write farhand/{ROBOT}/command"),),
            may_connect=True,
        ),
        "a robot's certificate on the operator's side": Attack(
            lambda rig: _commands(rig, "robot.box"),
            ((netem, "'robot.box', which is not in"),),
            may_connect=True,
        ),
        "operator's certificate on the robot's side": Attack(
            lambda rig: _commands(rig, "operator.eve", endpoint=OPERATOR_SIDE.replace("7447", "7448")),
            ((netem, "'operator.eve', which is not in"),),
            may_connect=True,
        ),
        "peer that joins netem's network": Attack(_joining_peer, ((netem, "what it sent is not TLS"),)),
        "recorded commands replayed": Attack(
            _replay, (("robot", "not newer than the last"),), may_connect=True, may_read=True
        ),
        "second operator, valid certificate": Attack(
            _second_operator, (("second", "holds control"),), may_connect=True, may_read=True
        ),
        "flood, valid certificate, 10,000 commands/s": Attack(
            lambda rig: _commands(rig, "operator.eve", rate=10_000),
            (("robot", "another session holds control"), ("robot", "more at once than are looked at")),
            may_connect=True,
            may_read=True,
        ),
        # Last: Zenoh then takes in newcomers slowly for a while, which would hide what an attacker after it does.
        "port scan, garbage on every listening port": Attack(
            _garbage, ((netem, "what it sent is not TLS"),), may_connect=True
        ),
    }


def perform(rig: Rig, name: str, attack: Attack) -> Attacked:
    """Do an attack while the lawful operator drives, and judge it."""
    before = rig.said_so_far()
    outcome, found = rig.measure(lambda: attack.run(rig))
    said = rig.said(before) | {"second": str(found.get("said", "")).splitlines()}
    lines = [line for program, part in attack.said for line in said[program] if part in line]
    unsafe = list(outcome.unsafe)
    if found["connected"] and not attack.may_connect:
        unsafe.append("it was let in")
    if not found["connected"] and attack.may_connect:
        unsafe.append("it was not even connected: this proves nothing")
    if found["read"] and not attack.may_read:
        unsafe.append("it read the robot's state")
    if not lines:
        unsafe.append("nothing was said of it")
    dead = [program for program, process in rig.programs.items() if process.poll() is not None]
    unsafe += [f"{program} ended" for program in dead]
    line = lines[0].replace(str(rig.certificates), "certs") if lines else ""
    return Attacked(name, found, line, outcome, tuple(unsafe))


def _commands(
    rig: Rig,
    name: str = "",
    *,
    folder: str = "",
    authority: str = "",
    endpoint: str = OPERATOR_SIDE,
    rate: int = 100,
) -> dict[str, Any]:
    """Commands from the operator's host, with the certificate of that name, if any."""
    words = [endpoint, ROBOT, "--rate", str(rate)]
    if name or folder:
        words += ["--folder", folder or str(rig.certificates / name)]
    if authority:
        words += ["--authority", str(rig.certificates / authority)]
    words += [] if name else ["--meet", "2"]
    return rig.attack("operator", "commands", *words)


def _joining_peer(rig: Rig) -> dict[str, Any]:
    """A peer in netem's network that looks for others by multicast and gossip, and lets them come to it."""
    endpoint = f"tcp/{NETEM_FOR_ROBOT}:7448"
    words = [endpoint, ROBOT, "--join", "tcp/0.0.0.0:7460", "--meet", "5"]
    return rig.attack("robot", "commands", *words)


def _replay(rig: Rig) -> dict[str, Any]:
    """The first hundred recorded commands of the lawful operator's session again, with a valid certificate."""
    newest = next(r["command"][0] for _, r in reversed(rig.commands.rows) if r.get("mode") == "run")
    old = [r["bytes"] for _, r in rig.commands.rows if r.get("mode") == "run" and r["command"][0] == newest]
    recorded = rig.folder / "recorded"
    recorded.write_text("\n".join(old[:100]))
    words = [
        OPERATOR_SIDE,
        ROBOT,
        "--folder",
        str(rig.certificates / "operator.eve"),
        "--recorded",
        str(recorded),
    ]
    return rig.attack("operator", "commands", *words)


def _second_operator(rig: Rig) -> dict[str, Any]:
    """Another operator's program with a valid certificate for the same robot."""
    log = rig.folder / "second.log"
    words = ["farhand", "operator", "--tls", str(rig.certificates / "operator.eve"), "--robot", ROBOT]
    words += ["--scenario", str(rig.scenario_file), "--connect", OPERATOR_SIDE]
    other = rig.hosts.start("operator", *words, log=log)
    for _ in range(round(SECOND_OPERATOR_TIME / 0.1)):
        rig.pause(0.1)
        if "holds control" in log.read_text(errors="replace"):
            break
    rig.pause(3.0)
    other.kill()
    other.wait()
    said = log.read_text(errors="replace")
    return {"connected": "holds control" in said, "sent": None, "read": None, "said": said}


def _garbage(rig: Rig) -> dict[str, Any]:
    """From each host: a port scan and random bytes to its own listening ports and to netem's next to it."""
    near = {"operator": NETEM_FOR_OPERATOR, "robot": NETEM_FOR_ROBOT, "netem": ""}
    attackers = []
    for host, neighbour in near.items():
        own = [f"127.0.0.1:{end.rsplit(':', 1)[1]}" for end in rig.hosts.listening(host)]
        if not own:
            raise FarhandError(f"nothing listens on {host}'s host")
        targets = own + [f"{neighbour}:{port}" for port in (7447, 7448) if neighbour]
        attackers.append((len(targets), rig.start_attack(host, "garbage", *targets)))
    found = [rig.result(attacker, "garbage") for _, attacker in attackers]
    return {
        "connected": all(each["connected"] for each in found),
        "sent": sum(each["sent"] for each in found),
        "read": 0,
        "ports": sum(count for count, _ in attackers),
    }

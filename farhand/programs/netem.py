"""The program `farhand netem`: what it may listen on, who emulates, the emulator in its loop."""

from farhand.common.errors import InputError
from farhand.common.process.console import page
from farhand.common.process.security import Access, secure
from farhand.common.process.signals import say, stop_event_on_signals
from farhand.common.trust.zenoh_log import tell_refusals
from farhand.netem.main import run_netem
from farhand.netem.settings import NetemSettings

BACKENDS = ("message", "tc")


def netem_program(
    settings: NetemSettings,
    *,
    insecure: bool = False,
    backend: str = "message",
    tc_operator: str = "",
    tc_robot: str = "",
) -> None:
    """Run the emulator until it is told to end, and print what it did.

    Args:
        settings: what to do.
        insecure: whether listening beyond this host without TLS was accepted.
        backend: `message` (this program) or `tc` (the kernel, on packets).
        tc_operator, tc_robot: network devices for `tc`; empty: those of the endpoints.

    Raises:
        InputError: what was asked for does not go together, or cannot be used.
        ConservationError: at the end, a message is not accounted for.
    """
    ends = [*settings.connect_operator, *settings.connect_robot]
    if settings.router and not ends:
        raise InputError("--router: names no router; say it with --connect-operator or --connect-robot")
    listened = [endpoint for endpoint in (settings.listen_operator, settings.listen_robot) if endpoint]
    access = Access(connect=tuple(ends), listen=tuple(listened), tls=settings.certificates, insecure=insecure)
    secure(access, lambda line: say("netem", line), "netem")
    if access.tls:
        tell_refusals(lambda line: say("netem", line))
    if backend == "tc":
        if settings.robot_networks:
            raise InputError("--backend tc: the kernel does not know robots; leave --robot-network out")
        from farhand.netem.tc.backend import kernel_emulation

        stop_event = stop_event_on_signals()
        with kernel_emulation(settings, tc_operator, tc_robot) as forwarding:
            run_netem(forwarding, stop_event, page(), lambda: _say_where(settings))
        return
    if backend not in BACKENDS:
        raise InputError(f"--backend {backend!r}: must be {' or '.join(BACKENDS)}")
    if tc_operator or tc_robot:
        raise InputError("--tc-operator and --tc-robot: only with --backend tc")
    run_netem(settings, stop_event_on_signals(), page(), lambda: _say_where(settings))


def _say_where(settings: NetemSettings) -> None:
    """What is emulated between which endpoints."""
    ways = (settings.uplink, settings.downlink)
    network = ways[0] if ways[0] == ways[1] else f"{ways[0]} up, {ways[1]} down"
    sides = [
        ", ".join(
            [*([f"listens on {listen}"] if listen else []), *(f"connects to {each}" for each in connect)]
        )
        for listen, connect in (
            (settings.listen_operator, settings.connect_operator),
            (settings.listen_robot, settings.connect_robot),
        )
    ]
    say("netem", f"{network}; operator's side {sides[0]}; robot's side {sides[1]}; Ctrl-C ends it")

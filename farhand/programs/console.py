"""The program `farhand console`: the operator's seat in a browser, beside a running operator's program."""

import asyncio
import socket
import threading
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass

import uvicorn

from farhand.common.errors import EndpointError, InputError
from farhand.common.link.endpoints import is_loopback
from farhand.common.link.zenoh_link import ZenohLink, open_session
from farhand.common.messages.keys import check_robot_name, mirror_key
from farhand.common.process.security import local_only
from farhand.common.process.signals import PeerWatch, stop_event_on_signals
from farhand.common.process.teller import Teller
from farhand.common.timing.clock import SystemClock
from farhand.common.trust.tls import load_folder
from farhand.netem.control import control_endpoint
from farhand.operator_side.console.console import Console
from farhand.operator_side.console.picture import Picture
from farhand.operator_side.console.robot_model import RobotModel
from farhand.operator_side.console.server import Door, Server, build_of
from farhand.operator_side.console.web import web_config
from farhand.programs.command_line import ConsoleWords
from farhand.programs.live_network import LiveNetwork
from farhand.programs.sessions import random_session
from farhand.robot_side.arm.catalogue import ARMS, data_folder, urdf_of
from farhand.robot_side.arm.description.finding import installed

LOOK_EVERY, START_EVERY = 0.2, 0.01
LEAST_TOKEN = 8
BACKLOG = 128


@dataclass(frozen=True, slots=True, kw_only=True)
class ConsoleOptions:
    """What `farhand console` is asked for.

    Attributes:
        robot: name of the robot.
        connect: the operator's report endpoint.
        listen: HOST:PORT for browsers.
        token: what a page must know; needed beyond this host.
        tls: folder with cert.pem and key.pem, for browsers; needed beyond this host.
        opens: whether a browser is opened here.
        netem: the emulator's live control, on this host; empty: the network cannot be changed from the page.
    """

    robot: str
    connect: str
    listen: str = "127.0.0.1:8080"
    token: str = ""
    tls: str = ""
    opens: bool = False
    netem: str = ""


def console_program(options: ConsoleOptions) -> int:
    """Serve until it is told to end; raises InputError."""
    robot = check_robot_name(options.robot)
    connect = local_only(options.connect, "--connect")
    host, port = _host_and_port(options.listen)
    _check_reach(options, host)
    if options.netem:
        control_endpoint(options.netem)
    stop_event, clock = stop_event_on_signals(), SystemClock()
    with ExitStack() as closing:
        bound = closing.enter_context(_bound(host, port))
        teller = Teller("console")
        closing.callback(teller.close)
        link = ZenohLink(open_session([connect]), [*Picture(robot).keys, mirror_key(robot, "camera")], clock)
        closing.callback(link.close)
        PeerWatch("console", connect, link.connected, stop_event)
        network = LiveNetwork(options.netem, robot, clock.now_ns) if options.netem else None
        if network is not None:
            closing.callback(network.close)
        console = Console(robot, link, random_session(), _find_model, network)
        names = {host, "localhost", "127.0.0.1"} if is_loopback(f"tcp/{options.listen}") else {host}
        door = Door(
            hosts=frozenset(f"{name}:{port}" for name in names), token=options.token, build=build_of()
        )
        address = f"{'https' if options.tls else 'http'}://{host}:{port}/"

        def answers() -> None:
            page = f"{address}#{options.token}" if options.token else address
            teller.say(f"{ConsoleWords.SAYS} {page}; Ctrl-C ends it")
            if options.opens:
                threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()

        def pages() -> Server:
            return Server(console, door, clock.now_ns, teller.say)

        asyncio.run(_serve(pages, bound, options.tls, stop_event, answers))
    return 0


async def _serve(
    make: Callable[[], Server],
    bound: socket.socket,
    tls: str,
    stop_event: threading.Event,
    answers: Callable[[], None],
) -> None:
    """Serve what `make` makes until it is told to end; `answers` is called once pages are answered."""
    pages = make()
    server = _Unsignalled(web_config(pages.app, tls))
    serving = asyncio.create_task(server.serve(sockets=[bound]))
    told = False
    while not stop_event.is_set() and not serving.done():
        if server.started and not told:
            told = True
            answers()
        await asyncio.wait([serving], timeout=LOOK_EVERY if told else START_EVERY)
    pages.stopping.set()
    server.should_exit = True
    await serving


class _Unsignalled(uvicorn.Server):
    """Signals are the program's own, as everywhere."""

    @contextmanager
    def capture_signals(self) -> Iterator[None]:
        """None of them."""
        yield


def _host_and_port(listen: str) -> tuple[str, int]:
    host, _, port = listen.rpartition(":")
    if not host or not port.isdigit() or not 0 < int(port) < 65536:
        raise InputError(f"--listen {listen!r}: expected HOST:PORT such as 127.0.0.1:8080")
    return host.strip("[]"), int(port)


def _check_reach(options: ConsoleOptions, host: str) -> None:
    """Raise InputError where strangers could drive."""
    if options.tls:
        load_folder(options.tls)
    if is_loopback(f"tcp/{options.listen}"):
        return
    if not (options.token and options.tls):
        raise InputError(
            f"--listen {options.listen}: beyond this host a console needs --token WORD and --tls DIR, "
            "or whoever reaches it can move the robot"
        )
    if len(options.token) < LEAST_TOKEN:
        raise InputError(f"--token: beyond this host a token has {LEAST_TOKEN} characters or more")


@contextmanager
def _bound(host: str, port: int) -> Iterator[socket.socket]:
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family) as bound:
        bound.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            bound.bind((host, port))
            bound.listen(
                BACKLOG
            )  # before the address is told: whoever comes at once waits, and is not refused
        except OSError as error:
            raise EndpointError(f"--listen {host}:{port}: {error.strerror}; choose another port") from None
        yield bound


def _find_model(name: str) -> RobotModel | None:
    """The drawing of an arm that is known by name."""
    arm = ARMS.get(name)
    if arm is None:
        return None
    folder = installed(arm.shapes) if arm.shapes else None
    if folder is None:
        return None if arm.shapes else RobotModel(data_folder(), arm.urdf)
    return RobotModel(folder, urdf_of(arm), f"package://{arm.shapes}/")

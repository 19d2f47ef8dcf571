"""The console's pages over HTTP and one web socket each: who may come in, what comes out."""

import secrets
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

import anyio
import anyio.to_thread
import msgspec
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from farhand.common.messages.scene import Scene
from farhand.operator_side.console.console import Console
from farhand.operator_side.console.files import Files, packed, response
from farhand.operator_side.console.frames import robot_told, scene_told
from farhand.operator_side.console.light_mesh import light_mesh
from farhand.operator_side.console.said import Hello, Pictured, SaidError, read_said

STATIC = Path(__file__).resolve().parent / "static"
FRAME_PERIOD, BEAT_PERIOD = 1.0 / 30.0, 0.02
HELLO_PATIENCE = 5.0
MOST_PAGES = 16
TOO_OLD, REFUSED, UNREADABLE, TOO_MANY, FULL = 4001, 4003, 4007, 4008, 4009
"""Why a page must go; from 4007 on it may come again."""
_HEADERS = {
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
    "connect-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cache-Control": "no-cache",
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Door:
    """Who may come in.

    Attributes:
        hosts: `HOST:PORT`, as browsers call this console; another name, or a page of another one, is refused.
        token: what a page must know; empty: nothing.
        build: what the page that is served was built from; pages of another build are told to reload.
    """

    hosts: frozenset[str]
    token: str = ""
    build: str = ""


def build_of(static: Path = STATIC) -> str:
    """What the page was built from; empty where it was not built."""
    try:
        found: dict[str, str] = msgspec.json.decode((static / "built.json").read_bytes(), type=dict[str, str])
    except (OSError, msgspec.DecodeError):
        return ""
    return found.get("sources", "")


class Server:
    """Args:
    console: what pages see and change.
    door: who may come in.
    now_ns: the clock.
    tell: takes a line for people.
    """

    def __init__(
        self, console: Console, door: Door, now_ns: Callable[[], int], tell: Callable[[str], None]
    ) -> None:
        self._console, self._door, self._now_ns, self._tell = console, door, now_ns, tell
        self._numbers = self._greeting = 0
        self._scene: tuple[Scene | None, bytes] = (None, b"")
        self._files = Files(STATIC)
        self._meshes: dict[Path, tuple[bytes, bytes]] = {}
        self.stopping = anyio.Event()
        routes = [
            Route("/", self._file),
            Route("/{name}", self._file),
            Route("/robot/{name}", self._robot),
            WebSocketRoute("/socket", self._socket),
        ]
        self.app = Starlette(routes=routes, lifespan=self._lifespan)

    @asynccontextmanager
    async def _lifespan(self, _app: Starlette) -> AsyncIterator[None]:
        async with anyio.create_task_group() as group:
            group.start_soon(self._beat)
            yield
            self.stopping.set()

    async def _beat(self) -> None:
        while not await self._stops_within(BEAT_PERIOD):
            self._console.beat(self._now_ns())

    async def _stops_within(self, seconds: float) -> bool:
        with anyio.move_on_after(seconds):
            await self.stopping.wait()
        return self.stopping.is_set()

    async def _file(self, request: Request) -> Response:
        name = request.path_params.get("name", "index.html")
        if request.headers.get("host", "") not in self._door.hosts:
            return Response("this console has another name", 421, _HEADERS)
        found = self._files.response(name, _accepts(request), _HEADERS)
        return found or Response("there is no such page", 404, _HEADERS)

    async def _robot(self, request: Request) -> Response:
        model, name = self._console.model, request.path_params["name"]
        if request.headers.get("host", "") not in self._door.hosts:
            return Response("this console has another name", 421, _HEADERS)
        if model is not None and name == "model.urdf":
            return response(model.urdf, packed(model.urdf), _accepts(request), "text/xml", _HEADERS)
        if model is not None and name in model.meshes:
            whole, compressed = await self._mesh(model.meshes[name])
            return response(whole, compressed, _accepts(request), "model/stl", _HEADERS)
        return Response("the robot has no such drawing", 404, _HEADERS)

    async def _mesh(self, path: Path) -> tuple[bytes, bytes]:
        """A mesh, lightened, and compressed, which is done once, in a thread: pages that drive are not kept waiting."""
        if path not in self._meshes:
            whole = await anyio.to_thread.run_sync(light_mesh, path)
            self._meshes[path] = whole, await anyio.to_thread.run_sync(packed, whole)
        return self._meshes[path]

    async def _socket(self, socket: WebSocket) -> None:
        origin = urlsplit(socket.headers.get("origin", "")).netloc
        host = socket.headers.get("host", "")
        if host not in self._door.hosts or origin != host:
            await socket.close(1008)
            return
        await socket.accept()
        try:
            if self._greeting + len(self._console.seat.pages) >= MOST_PAGES:
                await socket.close(FULL, f"{MOST_PAGES} pages are open at this console already; close one")
            elif await self._greeted(socket):
                await self._serve(socket)
        except WebSocketDisconnect:
            pass

    async def _greeted(self, socket: WebSocket) -> bool:
        self._greeting += 1
        try:
            return await self._greet(socket)
        finally:
            self._greeting -= 1

    async def _greet(self, socket: WebSocket) -> bool:
        """Whether the page may stay; if not, it is told why."""
        try:
            with anyio.fail_after(HELLO_PATIENCE):
                said = read_said(await _received(socket))
        except (SaidError, TimeoutError):
            said = None
        if not isinstance(said, Hello):
            await socket.close(UNREADABLE, "expected a hello")
            return False
        if not secrets.compare_digest(said.token.encode(), self._door.token.encode()):
            self._tell("a page with a wrong token was refused")
            await socket.close(REFUSED, "the token is wrong: open the address that the console printed")
            return False
        if said.page != self._door.build:
            await socket.close(TOO_OLD, "this page is of another version: reload it")
            return False
        return True

    async def _serve(self, socket: WebSocket) -> None:
        self._numbers += 1
        number = self._numbers
        self._console.seat.join(number, f"page {number}", self._now_ns())
        try:
            async with anyio.create_task_group() as group:
                group.start_soon(self._show, socket, number)
                await self._hear(socket, number)
                group.cancel_scope.cancel()
        finally:
            self._console.leave(number, self._now_ns())

    async def _show(self, socket: WebSocket, number: int) -> None:
        """Frames as fast as the page takes them, 30 a second at most; the rest on change."""
        try:
            await self._show_all(socket, number)
        except (WebSocketDisconnect, RuntimeError):
            pass  # it is gone; whoever hears it learns so as well

    async def _show_all(self, socket: WebSocket, number: int) -> None:
        told: list[object] = [None, b""]
        picture = self._console.picture
        while not await self._stops_within(FRAME_PERIOD):
            if picture.description is not None and _is_new(picture.description, told[0]):
                told[0] = picture.description
                await _send(socket, robot_told(picture.description))
            if (scene := self._scene_told()) is not told[1]:
                told[1] = scene
                await socket.send_bytes(scene)
            if (shown := self._console.camera.next(number, self._now_ns())) is not None:
                await _send(socket, shown)
            await _send(socket, self._console.frame(number, self._now_ns()))

    def _scene_told(self) -> bytes:
        """What pages are told of the scene, made once for all of them and only where it is another one; empty: none."""
        known, new = self._scene[0], self._console.picture.scene
        if new is not None and new is not known:
            same = known is not None and (known.obstacles, known.targets) == (new.obstacles, new.targets)
            told = self._scene[1] if same else msgspec.msgpack.encode(scene_told(new))
            self._scene = (new, told)
        return self._scene[1]

    async def _hear(self, socket: WebSocket, number: int) -> None:
        while True:
            try:
                said = read_said(await _received(socket))
            except WebSocketDisconnect:
                return
            except SaidError as error:
                self._tell(f"page {number} is let go: {str(error)[:200]}")
                await socket.close(UNREADABLE, "what this page says is no message")
                return
            if isinstance(said, Hello):
                await socket.close(UNREADABLE, "a second hello")
                return
            if isinstance(said, Pictured):
                stays = self._console.camera.pictured(number)
            else:
                stays = self._console.hear(number, said, self._now_ns())
            if not stays:
                self._tell(f"page {number} is let go: it says too much")
                await socket.close(TOO_MANY, "this page says too much")
                return


def _accepts(request: Request) -> str:
    return request.headers.get("accept-encoding", "")


def _is_new(description: object, told: object) -> bool:
    return told is None or not description.same_robot(told)  # type: ignore[attr-defined]


async def _received(socket: WebSocket) -> bytes:
    """The next message; raises SaidError for text, WebSocketDisconnect at the end."""
    message = await socket.receive()
    if message["type"] == "websocket.disconnect":
        raise WebSocketDisconnect(message.get("code", 1005))
    payload = message.get("bytes")
    if payload is None:
        raise SaidError("text; expected MessagePack")
    return bytes(payload)


async def _send(socket: WebSocket, told: dict[str, object]) -> None:
    await socket.send_bytes(msgspec.msgpack.encode(told))

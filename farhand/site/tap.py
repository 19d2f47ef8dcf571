"""A wire inspector that knows nothing of Farhand's messages: it decodes any MessagePack with another library."""

import queue
import sys

import msgpack
import zenoh

from farhand.common.errors import InputError
from farhand.common.link.zenoh_link import open_session
from farhand.common.process.security import Access, secure, tool_place
from farhand.common.process.signals import PeerWatch, say, stop_event_on_signals
from farhand.common.trust.access import readable

EVERYTHING = "**"
_SHOWN = 32


def describe(payload: bytes) -> str:
    """A payload as text: MessagePack if it is some, else its length and first bytes; so too what it holds of bytes."""
    try:
        found = msgpack.unpackb(payload, strict_map_key=False)
        if isinstance(found, dict):
            found = {k: _shortened(v) if isinstance(v, bytes) else v for k, v in found.items()}
        return repr(found)
    except (ValueError, msgpack.UnpackException, RecursionError):
        return f"{len(payload)} bytes, not MessagePack: {_shortened(payload)}"


def _shortened(content: bytes) -> str:
    """The first bytes."""
    return f"{content[:_SHOWN].hex(' ')}{' …' * (len(content) > _SHOWN)}"


def run_tap(endpoint: str, key: str, count: int | None, router: bool = False, tls: str = "") -> int:
    """Print what travels under `key` at `endpoint` until Ctrl-C or `count` messages.

    With a certificate folder, "**" is everything that the certificate lets its owner read.
    """
    folder = secure(Access(connect=(endpoint,), tls=tls), lambda line: say("tap", line))
    try:
        zenoh.KeyExpr(key)
    except zenoh.ZError as error:
        what = str(error).splitlines()[0].partition(" at /")[0]
        raise InputError(f"--key {key!r}: not a Zenoh key expression: {what}") from None
    stop_event = stop_event_on_signals()
    waiting: queue.SimpleQueue[zenoh.Sample] = queue.SimpleQueue()
    extra = folder.settings(tool_place(folder)) if folder else ()
    session = open_session([endpoint], mode="client" if router else "peer", extra=extra)
    keys = readable(folder.own) if folder and key == EVERYTHING else (key,)

    def connected() -> bool:
        return bool(session.info.peers_zid() or session.info.routers_zid())

    PeerWatch("tap", endpoint, connected, stop_event)
    printed = 0
    try:
        for each in keys:
            session.declare_subscriber(each, waiting.put)
        while not stop_event.is_set() and (count is None or printed < count):
            try:
                sample = waiting.get(timeout=0.1)
            except queue.Empty:
                continue
            payload = sample.payload.to_bytes()
            print(f"{sample.key_expr}  {len(payload)} B  {describe(payload)}", flush=True)
            printed += 1
    except BrokenPipeError:
        sys.stderr.close()
    finally:
        session.close()  # type: ignore[no-untyped-call]
    return 0

"""How the console is served: limits that keep whoever may not come in from costing anything."""

import asyncio
import logging

import uvicorn
from starlette.applications import Starlette
from uvicorn.protocols.http.h11_impl import H11Protocol

from farhand.operator_side.console.said import MAX_BYTES

ASKS_WITHIN = 5.0
"""Who is connected and has not asked for anything for so long is not waited for (s)."""
ANSWERS_WITHIN = 10.0
"""A page that does not answer a ping for so long is gone; one is sent as often (s)."""
CLOSING_TIME = 1


class ImpatientHttp(H11Protocol):
    """Ends a connection that asks for nothing, or too slowly."""

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Wait for a question, but not for long."""
        super().connection_made(transport)
        self.loop.call_later(ASKS_WITHIN, self._look)

    def _look(self) -> None:
        asked = bool(self.headers) or self.transport.get_protocol() is not self
        if not asked:
            self.transport.abort()


def web_config(app: Starlette, tls: str = "") -> uvicorn.Config:
    """The settings of its server.

    Args:
        app: what is served.
        tls: folder with cert.pem and key.pem; empty: without.
    """
    return uvicorn.Config(
        app,
        http=ImpatientHttp,
        log_config=None,
        log_level=logging.CRITICAL,
        access_log=False,
        server_header=False,
        ws="websockets-sansio",
        ws_max_size=MAX_BYTES,
        ws_ping_interval=ANSWERS_WITHIN,
        ws_ping_timeout=ANSWERS_WITHIN,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=CLOSING_TIME,
        ssl_certfile=f"{tls}/cert.pem" if tls else None,
        ssl_keyfile=f"{tls}/key.pem" if tls else None,
    )

"""Files as pages get them: compressed once, for whoever takes them so."""

import gzip
from collections.abc import Mapping
from pathlib import Path

from starlette.responses import Response

TYPES = {".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml"}


class Files:
    """The built page, as it was when the console began: what is changed on the disk afterwards is another page.

    Args:
        folder: whose files of TYPES are given.
    """

    def __init__(self, folder: Path) -> None:
        paths = [path for path in sorted(folder.iterdir()) if path.suffix in TYPES] if folder.is_dir() else []
        self._whole = {path.name: path.read_bytes() for path in paths}
        self._packed = {name: packed(content) for name, content in self._whole.items()}

    def response(self, name: str, accepts: str, headers: Mapping[str, str]) -> Response | None:
        """The file of that name; None: there is none.

        Args:
            name: of the file.
            accepts: the request's Accept-Encoding.
            headers: that all responses have.
        """
        if name not in self._whole:
            return None
        return response(self._whole[name], self._packed[name], accepts, TYPES[Path(name).suffix], headers)


def packed(content: bytes) -> bytes:
    """Compressed; the same content gives the same bytes."""
    return gzip.compress(content, 9, mtime=0)


def response(
    content: bytes, compressed: bytes, accepts: str, media_type: str, headers: Mapping[str, str]
) -> Response:
    """What is sent: compressed, where that is accepted and shorter."""
    headers = {**headers, "Vary": "Accept-Encoding"}
    if _takes_gzip(accepts) and len(compressed) < len(content):
        return Response(compressed, media_type=media_type, headers=headers | {"Content-Encoding": "gzip"})
    return Response(content, media_type=media_type, headers=headers)


def _takes_gzip(accepts: str) -> bool:
    """Whether a request's Accept-Encoding has gzip, and not with a weight of 0."""
    for word in accepts.split(","):
        coding, _, weight = word.partition(";")
        if coding.strip().lower() == "gzip":
            return weight.replace(" ", "") not in ("q=0", "q=0.0", "q=0.00", "q=0.000")
    return False

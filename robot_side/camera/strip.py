"""The instant of capture, drawn into the picture: a strip of grey blocks that survives JPEG.

A block is 8 x 8 pixels on the grid on which JPEG works, so that it is one constant to it and costs next to nothing
at any quality; light is 1, dark is 0. The strip's 80 bits, the most significant first, go from left to right and
row after row over the picture's last rows of whole blocks: 64 of the stamp (ns), 16 of a CRC over its eight bytes.
Whoever holds a picture alone, such as a screenshot pixel by pixel, can tell from it when it was taken.
"""

import binascii

import numpy as np
import numpy.typing as npt

from farhand.common.errors import FarhandError

BLOCK = 8
DARK, LIGHT = 16, 240
LEAST_WIDTH, LEAST_HEIGHT = 160, 120
_STAMP, _CHECK = 8, 2  # bytes
_BITS = 8 * (_STAMP + _CHECK)

Picture = npt.NDArray[np.uint8]
"""(height, width, channels): the first three are red, green and blue."""


class StripError(FarhandError):
    """A picture holds no strip, or one that cannot be read."""


def strip_height(width: int) -> int:
    """Pixels of a picture of this width that the strip takes at its foot, without what is below its last block."""
    return -(-_BITS // (width // BLOCK)) * BLOCK


def draw_strip(picture: Picture, stamp_ns: int) -> None:
    """Draw a stamp (ns, 0 to 2**63 - 1) into a picture of at least 160 x 120 pixels, in place."""
    stamp = stamp_ns.to_bytes(_STAMP, "big")
    check = binascii.crc_hqx(stamp, 0).to_bytes(_CHECK, "big")
    bits = np.unpackbits(np.frombuffer(stamp + check, np.uint8))
    rows, columns, top = _grid(picture)
    cells = np.full(rows * columns, DARK, np.uint8)
    cells[:_BITS] += bits * np.uint8(LIGHT - DARK)
    blocks = np.kron(cells.reshape(rows, columns), np.ones((BLOCK, BLOCK), np.uint8))
    picture[top : top + rows * BLOCK, : columns * BLOCK, :3] = blocks[:, :, None]


def read_strip(picture: Picture) -> int:
    """The stamp (ns) in a picture; raises StripError where there is none, or its check does not fit."""
    if picture.shape[0] < LEAST_HEIGHT or picture.shape[1] < LEAST_WIDTH:
        raise StripError(f"a picture of less than {LEAST_WIDTH} x {LEAST_HEIGHT} pixels holds no strip")
    rows, columns, top = _grid(picture)
    area = picture[top : top + rows * BLOCK, : columns * BLOCK, :3].astype(np.float32)
    means = area.reshape(rows, BLOCK, columns, BLOCK, 3).mean(axis=(1, 3, 4)).ravel()[:_BITS]
    found = np.packbits(means > (DARK + LIGHT) / 2).tobytes()
    stamp, check = found[:_STAMP], found[_STAMP:]
    if binascii.crc_hqx(stamp, 0).to_bytes(_CHECK, "big") != check:
        raise StripError("the picture holds no strip, or one that was spoilt")
    return int.from_bytes(stamp, "big")


def _grid(picture: Picture) -> tuple[int, int, int]:
    """Rows and columns of the strip's blocks, and its first row of pixels."""
    height, width = picture.shape[:2]
    columns = width // BLOCK
    rows = -(-_BITS // columns)
    return rows, columns, (height // BLOCK - rows) * BLOCK

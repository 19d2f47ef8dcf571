"""A terminal that knows few letters gets plain ones, never an exception."""

import codecs

import pytest

from farhand.common.process.terminal import HANDLER, plain


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_every_letter_is_written(encoding):
    codecs.register_error(HANDLER, plain)
    text = "62 – 73 mm … ━━ ┏ σ ≥ ✓"
    written = text.encode(encoding, HANDLER).decode(encoding)
    assert written == "62 - 73 mm ... -- ? sigma >= +"
    assert "±".encode("ascii", HANDLER) == b"+-"


def test_only_encoding_is_its_business():
    with pytest.raises(UnicodeDecodeError):
        plain(UnicodeDecodeError("ascii", b"\xff", 0, 1, "bad"))

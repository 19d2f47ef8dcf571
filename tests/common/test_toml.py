"""Reading TOML: a byte-order mark is accepted, and what is wrong is one line with the file and the line."""

import pytest

from farhand.common.errors import InputError, TraceError
from farhand.common.toml import parse_toml, read_toml


def test_a_byte_order_mark_is_accepted(tmp_path):
    path = tmp_path / "x.toml"
    path.write_bytes(b"\xef\xbb\xbfv = 1\r\n")
    assert read_toml(path, "thing") == {"v": 1}
    assert parse_toml("\ufeffv = 1", "thing") == {"v": 1}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a = 1\nb = = 2", "thing x: line 2, column 5: not valid TOML: Invalid value"),
        ("a = 1\na = 2\n", "thing x: line 2, column 6: not valid TOML: Cannot overwrite a value"),
        ("a = 1\n[[at", "thing x: line 2"),
        ("a = " + "9" * 5000, "thing x: not valid TOML: "),
        ("a = " + "[" * 50_000, "thing x: not valid TOML: nested too deeply"),
    ],
)
def test_what_is_wrong_is_one_line(text, words):
    with pytest.raises(InputError) as found:
        parse_toml(text, "thing x")
    assert words in str(found.value)
    assert "\n" not in str(found.value)


def test_a_file_that_cannot_be_read(tmp_path):
    with pytest.raises(InputError, match=r"thing .*none.toml: cannot be read: No such file"):
        read_toml(tmp_path / "none.toml", "thing")
    with pytest.raises(InputError, match="cannot be read: embedded null byte"):
        read_toml("a\0b", "thing")
    path = tmp_path / "latin.toml"
    path.write_bytes(b'a = 1\nb = "\xe4"\n')
    with pytest.raises(TraceError, match=r"model .*latin.toml, line 2: cannot be read: is not UTF-8 text"):
        read_toml(path, "model", TraceError)

import os

import pytest

from farhand.common.errors import InputError
from farhand.common.process.outputs import check_writable


def test_what_can_be_written_passes(tmp_path):
    check_writable(None, "--stats")
    check_writable("", "--stats")
    check_writable(tmp_path / "new.json", "--stats")
    check_writable(str(tmp_path / "new.json"), "--stats")
    assert not (tmp_path / "new.json").exists()


def test_what_cannot_is_one_line(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"--stats .*there is no folder"):
        check_writable(tmp_path / "none" / "x.json", "--stats")
    with pytest.raises(InputError, match=r"--stats .*is a folder"):
        check_writable(tmp_path, "--stats")
    monkeypatch.setattr(os, "access", lambda path, mode: False)
    with pytest.raises(InputError, match=r"--stats .*permission denied"):
        check_writable(tmp_path / "x.json", "--stats")

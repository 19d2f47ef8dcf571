import errno
import fcntl
import os
from pathlib import Path

import pytest

from farhand.common.errors import InputError
from farhand.common.process.outputs import check_writable, hold_folder, make_folder, survive


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


def test_a_disk_that_takes_nothing_is_told_before_and_leaves_nothing(tmp_path, monkeypatch):
    def full(self, data):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InputError, match=r"--log .*No space left"):
        check_writable(tmp_path / "x.csv", "--log")
    with pytest.raises(InputError, match=r"--out .*No space left"):
        make_folder(tmp_path / "new", "--out")
    assert [each.name for each in tmp_path.iterdir()] == ["new"]


def test_a_folder_is_one_process_s(tmp_path):
    opened = os.open(tmp_path, os.O_RDONLY)
    try:
        fcntl.flock(opened, fcntl.LOCK_EX)  # as another process would have it: a lock is an open file's
        with pytest.raises(InputError, match=r"--out .*another run is writing there"):
            hold_folder(tmp_path, "--out")
    finally:
        os.close(opened)
    hold_folder(tmp_path, "--out")
    hold_folder(tmp_path, "--out")  # one run after the other in one process


def test_what_fails_on_the_way_is_told_once_and_survived():
    def fail():
        raise OSError(errno.ENOSPC, "No space left on device")

    told = []
    assert survive("--stats s.json", fail, told.append) is None
    assert told == ["--stats s.json: cannot be written: No space left on device"]
    assert survive("x", lambda: 3, told.append) == 3

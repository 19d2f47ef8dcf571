"""`netem --log` where the disk fails: the emulator goes on, and says what is missing."""

import errno

import pytest

from farhand.common.errors import InputError
from farhand.common.recording.fates import Fate
from farhand.netem.measure import message_log
from farhand.netem.measure.message_log import CsvLog, read_log


def record(log, rows):
    for number in rows:
        log.record(
            Fate(
                direction="uplink",
                key="farhand/r/state",
                number=number,
                size=1,
                arrived_ns=5 * number,
                drawn_ns=0,
                assigned_ns=0,
                achieved_ns=2,
            )
        )


def test_every_row_is_there_after_a_close(tmp_path, monkeypatch):
    monkeypatch.setattr(message_log, "_BUFFER", 1000)
    log = CsvLog(tmp_path / "log.csv")
    record(log, range(500))
    log.close()
    rows = read_log(tmp_path / "log.csv")
    assert rows["ordinal"].tolist() == list(range(500))
    assert set(rows["achieved_ns"]) == {2}
    assert (log.missing, log.trouble, log.troubles()) == (0, "", {})


def test_a_disk_that_is_full_from_the_start_costs_the_log_alone():
    log = CsvLog("/dev/full")
    record(log, range(100))
    log.close()
    assert log.missing == 100
    assert log.troubles() == {
        "log": "--log: 100 rows are missing: it cannot be written: No space left on device"
    }


def test_a_disk_that_fills_up_leaves_whole_rows_and_a_count(tmp_path, monkeypatch):
    monkeypatch.setattr(message_log, "_BUFFER", 1000)
    log = CsvLog(tmp_path / "log.csv")
    write, written = log._file.write, []

    def full_later(text):
        if len(written) == 3:
            raise OSError(errno.ENOSPC, "No space left on device")
        written.append(text)
        return write(text)

    monkeypatch.setattr(log, "_file", type("File", (), {"write": staticmethod(full_later), "flush": log._file.flush,
                                                        "close": log._file.close})())  # fmt: skip
    record(log, range(500))
    log.close()
    rows = read_log(tmp_path / "log.csv")
    assert 0 < len(rows) < 500
    assert rows["ordinal"].tolist() == list(range(len(rows)))
    assert log.missing == 500 - len(rows)


def test_a_place_that_cannot_be_written_is_one_line(tmp_path):
    with pytest.raises(InputError, match="cannot be written: No such file or directory"):
        CsvLog(tmp_path / "nowhere" / "log.csv")

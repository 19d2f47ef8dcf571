"""The folder of a run: a used one is refused, two runs of one second have one each."""

import pytest

from farhand.common.errors import InputError
from farhand.runs import run_folder
from farhand.runs.files import RUN_FILES
from farhand.runs.run_folder import make_run_folder


@pytest.mark.parametrize("name", RUN_FILES)
def test_a_used_folder_is_refused_and_replaced_by_force(name, tmp_path):
    for each in (name, "notes.txt"):
        (tmp_path / each).write_text("old")
    with pytest.raises(InputError, match=rf"--out .*holds a run already \({name}\).*--force"):
        make_run_folder(tmp_path, "x")
    assert (tmp_path / name).read_text() == "old"
    make_run_folder(tmp_path, "x", force=True)
    assert [each.name for each in tmp_path.iterdir()] == ["notes.txt"]


def test_two_runs_of_one_second_have_a_folder_each(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(run_folder, "local_timestamp", lambda: "20260101-000000")
    folders = [make_run_folder(None, "ur5") for _ in range(3)]
    assert [each.name for each in folders] == [f"20260101-000000-ur5{end}" for end in ("", "-2", "-3")]

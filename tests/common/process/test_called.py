"""Lines that are meant to be copied name the program as it can be started."""

import sys

from farhand.common.process.called import called


def test_it_is_called_by_its_name_where_that_is_found_and_else_as_it_was_started(tmp_path, monkeypatch):
    folder = tmp_path / ".venv" / "bin"
    folder.mkdir(parents=True)
    script = folder / "farhand"
    script.write_text("")
    script.chmod(0o755)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", str(tmp_path))
    assert called(str(script)) == ".venv/bin/farhand"
    assert called("/usr/lib/python3/farhand/__main__.py") == f"{sys.executable} -m farhand"
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    assert called(str(script)) == str(script)
    monkeypatch.setenv("PATH", str(folder))
    assert called(str(script)) == "farhand"

"""Where compiled code is kept between runs: beside the source, else in the user's cache, else in /tmp.

Importing this decides, before numba is asked to compile anything. USABLE is False where nothing can be
written; NOTICE then says so in one line.
"""

import os
import tempfile
from pathlib import Path


def _writable(directory: Path, private: bool) -> bool:
    """Whether files can be made in `directory` (made if missing), and nobody else owns it where private."""
    try:
        directory.mkdir(parents=True, exist_ok=True, mode=0o700 if private else 0o777)
        if private:  # compiled code is loaded from here: nobody else may have put it there
            facts = directory.lstat()
            if facts.st_uid != os.getuid() or facts.st_mode & 0o022:
                return False
        with tempfile.TemporaryFile(dir=directory):
            return True
    except OSError:
        return False


def _choose() -> bool:
    if os.environ.get("NUMBA_CACHE_DIR"):
        return _writable(Path(os.environ["NUMBA_CACHE_DIR"]), False)
    if _writable(Path(__file__).parent / "__pycache__", False):
        return True
    home = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))
    for directory in (home / "farhand", Path(tempfile.gettempdir()) / f"farhand-{os.getuid()}"):
        if directory.is_absolute() and _writable(directory, True):
            os.environ["NUMBA_CACHE_DIR"] = str(directory)
            import numba.core.config

            vars(numba.core.config)["CACHE_DIR"] = str(directory)  # numba may have been imported already
            return True
    return False


USABLE = _choose()
NOTICE = (
    ""
    if USABLE
    else "no writable place for compiled code (set NUMBA_CACHE_DIR): it is compiled anew at each start"
)

"""Replace the sources of packages by their compiled files: `sourceless.py FOLDER...`.

The root is read-only, so that Python could not keep what it compiles; and either of the two is enough to run.
"""

import compileall
import shutil
import sys
from pathlib import Path


def main(folder: Path) -> None:
    """Compile every source below a folder into its place; what cannot be compiled stays."""
    compileall.compile_dir(folder, quiet=2, legacy=True, workers=0)
    for source in folder.rglob("*.py"):
        if source.with_suffix(".pyc").exists():
            source.unlink()
    for cache in list(folder.rglob("__pycache__")):
        shutil.rmtree(cache)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        main(Path(name))

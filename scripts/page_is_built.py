"""Says whether the console's page that is checked in is the one that its source builds; exit code 1 if not.

`make page` builds it, which needs Node; to see whether it was built, hashes do.
"""

import hashlib
import json
import sys
from pathlib import Path

CONSOLE = Path(__file__).resolve().parent.parent / "operator_side" / "console"
FILES = ("build.mjs", "index.html", "package-lock.json", "package.json", "page.css", "tsconfig.json")
MOST_BYTES = 1_000_000


def sources_digest(page: Path) -> str:
    """SHA-256 of all that the page is built from, as page/build.mjs says it."""
    names = sorted([*FILES, *(f"src/{path.name}" for path in (page / "src").iterdir())])
    digest = hashlib.sha256()
    for name in names:
        digest.update(f"{name}\0".encode() + (page / name).read_bytes() + b"\0")
    return digest.hexdigest()


def troubles(console: Path = CONSOLE) -> list[str]:
    """What is wrong with the built page, a line each."""
    static = console / "static"
    built = json.loads((static / "built.json").read_text())
    found = []
    if built.pop("sources") != sources_digest(console / "page"):
        found.append("operator_side/console/page was changed after the page was built: run `make page`")
    found += [
        f"operator_side/console/static/{name} is not what was built: run `make page`"
        for name, digest in built.items()
        if hashlib.sha256((static / name).read_bytes()).hexdigest() != digest
    ]
    weight = sum((static / name).stat().st_size for name in built)
    if weight > MOST_BYTES:
        found.append(f"the page weighs {weight} bytes; at most {MOST_BYTES}")
    return found


if __name__ == "__main__":
    lines = troubles()
    print("\n".join(lines) or "the console's page is the one that its source builds")
    sys.exit(bool(lines))

"""Some inputs of a campaign's corpora as files for the tests: `python -m farhand.trials.fuzz.keep CAMPAIGN FOLDER`.

A line an input, in base64. Of each target the inputs between the shortest and the longest that are not long, evenly.
"""

import base64
import sys
from pathlib import Path

from farhand.trials.fuzz.registry import NAMES

KEPT, LONGEST = 25, 1200


def chosen(corpus: Path) -> list[bytes]:
    """At most KEPT inputs of a target's corpus, by length."""
    inputs = sorted({path.read_bytes() for path in corpus.iterdir()}, key=lambda data: (len(data), data))
    short = [data for data in inputs if 0 < len(data) <= LONGEST]
    step = max(1.0, len(short) / KEPT)
    return [short[int(place * step)] for place in range(min(KEPT, len(short)))]


def main() -> None:
    """Write them."""
    campaign, folder = map(Path, sys.argv[1:])
    folder.mkdir(parents=True, exist_ok=True)
    for name in NAMES:
        lines = [base64.b64encode(data).decode() for data in chosen(campaign / "corpus" / name)]
        (folder / f"{name}.txt").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

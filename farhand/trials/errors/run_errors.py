"""`farhand trial errors` from beginning to end; it goes on where it was stopped."""

from pathlib import Path

from farhand.common.errors import InputError
from farhand.common.process.console import page
from farhand.common.result_file import write_whole
from farhand.laboratory.campaigns.campaign import Work
from farhand.laboratory.campaigns.pools import Pool
from farhand.laboratory.campaigns.run_table1 import run_with_progress
from farhand.laboratory.campaigns.store import SELECTION, Store, source_digest
from farhand.trials.errors.errors import ERRORS
from farhand.trials.errors.running import Row, lost, run_all, specs
from farhand.trials.errors.tables import broken, to_markdown

MARKDOWN = "errors.md"
CHUNK = 10


def run_errors(names: tuple[str, ...], runs: int, seed: int, pool: Pool, out: Path) -> int:
    """Run what is missing, print the table; returns 0, or 1 where something moved that must not. Raises InputError."""
    for name in names:
        if name not in ERRORS:
            raise InputError(f"--errors {name!r}: must be some of {','.join(ERRORS)}")
    console = page()
    about = {
        "seed": seed,
        "source": source_digest(),
        SELECTION: {"errors": names, "runs": runs},
    }
    store = Store(out, about, Row)
    rows, _ = run_with_progress(specs(names, runs, seed), store, pool, console, Work(run_all, lost), CHUNK)
    store.close()
    text = to_markdown(rows)
    write_whole(out / MARKDOWN, text)
    console.print(text, markup=False, highlight=False, soft_wrap=True)
    return 1 if broken(rows) else 0

"""The published leaderboard says what its rows say."""

import re

import pytest

from tests.farhand.trials.leaderboard.published.tables import MARK, PAGE, TABLES, renewed, rows_of

TEXT = PAGE.read_text(encoding="utf-8")


def test_every_table_is_what_the_rows_say():
    assert {found[2] for found in MARK.finditer(TEXT)} == set(TABLES)
    assert renewed(TEXT) == TEXT


@pytest.mark.parametrize("name", ["all", "both"])
def test_no_run_is_missing_or_crashed(name):
    rows = rows_of(name)
    assert not [row.key for row in rows if row.error]
    said = re.search(rf"`docs/leaderboard/{name}.parquet`[^.]*?([\d,]+) runs", TEXT, re.DOTALL)
    assert said is not None
    assert int(said.group(1).replace(",", "")) == len(rows) == len({row.key for row in rows})


def test_a_number_that_is_not_the_rows_is_noticed():
    one = re.search(r"<!-- table: both -->.*?(\d+ of \d+)", TEXT, re.DOTALL)
    wrong = TEXT[: one.start(1)] + "1041 of 1040" + TEXT[one.end(1) :]
    assert renewed(wrong) == TEXT

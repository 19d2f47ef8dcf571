import pytest

from farhand.laboratory.campaigns.jobs import Row
from farhand.laboratory.campaigns.statistics import clopper_pearson, summarise_cell


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [
        # Closed forms: all successes give (alpha/2)^(1/n), and none 1 - (alpha/2)^(1/n).
        (10, 10, 0.025 ** (1 / 10), 1.0),
        (0, 10, 0.0, 1.0 - 0.025 ** (1 / 10)),
        (200, 200, 0.025 ** (1 / 200), 1.0),
        # Published in many tables: 9 of 10 and 5 of 10.
        (9, 10, 0.5550, 0.9975),
        (5, 10, 0.1871, 0.8129),
        (0, 0, 0.0, 1.0),
    ],
)
def test_interval(successes, trials, low, high):
    assert clopper_pearson(successes, trials) == pytest.approx((low, high), abs=5e-5)


@pytest.mark.parametrize("p", [0.03, 0.5, 0.9])
def test_interval_holds_the_truth_with_at_least_its_level(p):
    from scipy.stats import binom

    n = 40
    covered = sum(
        binom.pmf(k, n, p) for k in range(n + 1) if clopper_pearson(k, n)[0] <= p <= clopper_pearson(k, n)[1]
    )
    assert covered >= 0.95


def test_more_successes_than_trials_are_refused():
    with pytest.raises(ValueError, match="3 of 2"):
        clopper_pearson(3, 2)


def row(task: int, **values) -> Row:
    given = {"success": True, "finished": True, "safe": True, "duration": 10.0, "min_clearance": 0.02}
    return Row(key=str(task), labels={"task": task}, seed=task, **(given | values))


def test_a_cell_counts_pairs_durations_and_leaves_crashes_out():
    rows = [
        row(0, duration=12.0),
        row(1, duration=30.0),
        row(2, success=False, safe=False, min_clearance=-0.1),
        row(3, success=False, finished=False, duration=300.0),
        row(4, success=False, error="ValueError: x", finished=False, duration=None, min_clearance=None),
    ]
    reference = [row(0), row(1, duration=20.0), row(2, finished=False), row(3)]
    cell = summarise_cell(rows, reference)
    assert (cell.tasks, cell.successes, cell.finished, cell.safe, cell.crashed) == (4, 2, 3, 3, 1)
    assert cell.rate == 0.5
    assert cell.min_clearance == -0.1
    assert cell.relative_duration == pytest.approx((1.2 + 1.5) / 2)  # only tasks finished in both


def test_an_empty_cell_claims_nothing():
    cell = summarise_cell([])
    assert (cell.rate, cell.low, cell.high, cell.min_clearance) == (None, 0.0, 1.0, None)

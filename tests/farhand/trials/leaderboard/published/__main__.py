"""Write the tables of docs/leaderboard.md anew: `python -m tests.farhand.trials.leaderboard.published`."""

from tests.farhand.trials.leaderboard.published.tables import PAGE, renewed

if __name__ == "__main__":
    PAGE.write_text(renewed(PAGE.read_text(encoding="utf-8")), encoding="utf-8")

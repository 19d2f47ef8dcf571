"""`farhand` and `python -m farhand`."""

import sys


def main() -> None:
    """Run the command line; exit code 2 and one clear line for bad input."""
    if not (3, 10) <= sys.version_info[:2] <= (3, 11):
        found = ".".join(map(str, sys.version_info[:2]))
        print(
            f"farhand: needs Python 3.10 or 3.11 (pybullet has wheels for these only), this is {found}; "
            "get one with: apt install python3.11, uv python install 3.11 or pyenv install 3.11",
            file=sys.stderr,
        )
        raise SystemExit(2)
    from farhand.cli import run

    raise SystemExit(run())


if __name__ == "__main__":
    main()

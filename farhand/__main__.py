"""`farhand` and `python -m farhand`."""

import signal
import sys


def main() -> None:
    """Run the command line; exit code 2 and one clear line for bad input."""
    if signal.getsignal(signal.SIGINT) == signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # while modules load, Ctrl-C ends without a traceback
    if not (3, 10) <= sys.version_info[:2] <= (3, 14):
        found = ".".join(map(str, sys.version_info[:2]))
        print(
            f"farhand: needs Python 3.10 to 3.14, this is {found}; "
            "get one with: apt install python3.11, uv python install 3.11 or pyenv install 3.11",
            file=sys.stderr,
        )
        raise SystemExit(2)
    from farhand.cli import run_program

    raise SystemExit(run_program())


if __name__ == "__main__":
    main()

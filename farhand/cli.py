"""The command line: what is mounted where, and how errors end: one line and exit code 2 for bad input."""

import errno
import os
import sys
import warnings
from functools import cache
from typing import Any, TextIO

import typer

from farhand.commands.arm import arm_app
from farhand.commands.benchmark import benchmark_app
from farhand.commands.certs import certs_app
from farhand.commands.emulation.netem import netem_app
from farhand.commands.emulation.traces import trace_app
from farhand.commands.help_words import in_plain_words
from farhand.commands.laboratory import register as register_experiments
from farhand.commands.margin import margin_app
from farhand.commands.programs import register as register_programs
from farhand.commands.recordings import register as register_recordings
from farhand.commands.ros2 import register as register_ros2
from farhand.commands.runs import register as register_runs
from farhand.commands.scene import scene_app
from farhand.commands.trials import trial_app
from farhand.commands.ur import ur_app
from farhand.common.errors import FarhandError, InputError, RecordingWarning
from farhand.common.process.signals import die_with_parent, interrupt_on_signals, say
from farhand.common.process.terminal import spare_the_terminal

INTERRUPTED, BROKEN_PIPE = 130, 141
DISK_ERRORS = {errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.EIO, errno.EACCES, errno.EPERM, errno.ENOENT}
"""What is wrong with files and disks, not with Farhand: said in one line."""

app = typer.Typer(
    name="farhand",
    help="Move a robot that is far away, over a bad network, without it hitting anything.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

# Typer carries a Click of its own and exports only some of its exceptions; all of them share this base.
UsageError: type[Exception] = next(c for c in typer.BadParameter.__mro__ if c.__name__ == "ClickException")

register_runs(app)
register_recordings(app)
register_programs(app)
register_ros2(app)
register_experiments(app)
app.add_typer(netem_app, name="netem")
app.add_typer(trace_app, name="trace")
app.add_typer(margin_app, name="margin")
app.add_typer(trial_app, name="trial")
app.add_typer(benchmark_app, name="benchmark")
app.add_typer(certs_app, name="certs")
app.add_typer(arm_app, name="arm")
app.add_typer(ur_app, name="ur")
app.add_typer(scene_app, name="scene")


def run_program() -> int:
    """Run the command line as a process of its own: with its signals and its terminal; returns the exit code.

    Whatever the terminal cannot show, and a pipe that nobody reads any more, does not end in a traceback.
    """
    spare_the_terminal()
    try:
        interrupt_on_signals()
        code = run()
        sys.stdout.flush()
        return code
    except KeyboardInterrupt:
        return INTERRUPTED
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # or the flush at the end fails again
        return BROKEN_PIPE
    except OSError as error:
        if error.errno not in DISK_ERRORS:
            raise
        say("farhand", f"{error.filename or 'output'}: {error.strerror}")
        return 1


def run(arguments: list[str] | None = None) -> int:
    """Run the command line; returns the exit code."""
    die_with_parent()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("always", RecordingWarning)
            warnings.showwarning = _say_warning
            result = _command()(arguments, prog_name="farhand", standalone_mode=False)
    except typer.Exit as end:
        return int(end.exit_code)
    except typer.Abort:
        return INTERRUPTED
    except UsageError as error:
        if type(error).__name__ == "NoArgsIsHelpError":
            error.show()  # type: ignore[attr-defined]
            return 2
        return _refuse(_usage(error))
    except InputError as error:
        return _refuse(f"farhand: {error}")
    except FarhandError as error:
        print(f"farhand: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return INTERRUPTED
    return result if isinstance(result, int) else 0


@cache
def _command() -> Any:
    """What is mounted, as Click has it; made once, as it takes longer than most of what it says."""
    return in_plain_words(typer.main.get_command(app))


def _say_warning(
    message: Warning | str,
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,
    line: str | None = None,
) -> None:
    """One of ours is for people; others are for who writes programs."""
    if issubclass(category, RecordingWarning):
        say("farhand", " ".join(str(message).split()))
    else:
        sys.stderr.write(warnings.formatwarning(message, category, filename, lineno))


def _usage(error: Exception) -> str:
    """One line for an error in the use of a command: where, what, and where to read on."""
    text = getattr(error, "format_message", lambda: str(error))()
    context = getattr(error, "ctx", None)
    command = getattr(context, "command_path", "farhand")
    return f"{command}: {text} (see `{command} --help`)"


def _refuse(line: str) -> int:
    print(" ".join(line.split()), file=sys.stderr)
    return 2

"""One root for every error that Farhand raises on purpose."""

import traceback
from pathlib import Path


def in_one_line(error: BaseException) -> str:
    """What was raised, and in which line of whose file: `ValueError: broken (mine.py, line 7)`."""
    text = " ".join(f"{type(error).__name__}: {error}".split())
    frames = traceback.extract_tb(error.__traceback__)
    return f"{text} ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else text


class FarhandError(Exception):
    """Root of all errors raised on purpose."""


class InputError(FarhandError):
    """The user gave something that cannot work; the text is one line: what, where, what would be right.

    The command line prints it and ends with exit code 2.
    """


class ScenarioError(InputError):
    """A scenario is invalid; the message names the key."""


class SpecError(InputError):
    """A network SPEC is invalid; the message points at the character."""


class TraceError(InputError):
    """A delay trace is unreadable; the message names the file and the line."""


class EndpointError(InputError):
    """A Zenoh endpoint cannot be used: malformed, or its port is taken."""


class RunFileError(InputError):
    """A recorded run cannot be read."""


class RecordingWarning(UserWarning):
    """A recording is used that lacks something; says what."""


class CertificateError(InputError):
    """A certificate folder cannot be used: incomplete, expired, or not for this."""


class ResultError(InputError):
    """What a program left at its end cannot be read: broken, or of another version."""

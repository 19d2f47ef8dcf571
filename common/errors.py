"""One root for every error that Farhand raises on purpose."""


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


class CertificateError(InputError):
    """A certificate folder cannot be used: incomplete, expired, or not for this."""


class ResultError(InputError):
    """What a program left at its end cannot be read: broken, or of another version."""

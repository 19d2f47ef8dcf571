"""What an operator is called by all others: the certificate's name, its own choice, or USER@HOST."""

import getpass
import os
import socket

import msgspec

from farhand.common.errors import InputError
from farhand.common.messages.base import Name
from farhand.common.trust.tls import TlsFolder


def operator_name(chosen: str, folder: TlsFolder | None) -> str:
    """The name of this program's operator.

    Args:
        chosen: by `--name`; empty: none.
        folder: its certificate folder, with TLS.

    Raises:
        InputError: the name is none, or is chosen beside that of a certificate.
    """
    if folder is not None:
        if chosen and chosen != folder.own.name:
            raise InputError(
                f"--name {chosen!r}: with --tls the operator has the certificate's name, {folder.own.name}"
            )
        return folder.own.name
    if chosen:
        return check_name(chosen)
    text = "".join(c if c.isprintable() else "?" for c in f"{_user()}@{socket.gethostname()}")
    return text[:64]


def check_name(name: str, option: str = "--name") -> str:
    """The name itself if it is one; raises InputError otherwise."""
    try:
        msgspec.convert(name, Name)
    except msgspec.ValidationError:
        name_is_one = False
    else:
        name_is_one = name.isprintable()
    if not name_is_one:
        raise InputError(f"{option} {name!r}: an operator's name is 1 to 64 printable characters")
    return name


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a container's user need not have a name
        return str(os.getuid())

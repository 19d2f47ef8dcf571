"""What --help says: its text as it is written, and behind an option a word for what is wanted, not a Python type."""

import inspect
from typing import Any

from rich.markup import escape

_BY_NAME = {
    "scenario": "NAME or FILE",
    "network": "SPEC",
    "uplink": "SPEC",
    "downlink": "SPEC",
    "robot_network": "NAME=SPEC",
    "set": "KEY=VALUE",
    "settings": "KEY=VALUE",
    "connect": "ENDPOINT",
    "listen": "ENDPOINT",
    "report": "ENDPOINT",
    "control": "PORT",
    "metrics": "PORT",
    "netem": "ENDPOINT",
    "timeline": "FILE",
    "stats": "FILE",
    "log": "FILE",
    "record": "FILE",
    "result": "FILE",
    "ready_file": "FILE",
    "tc_operator": "DEVICE",
    "tc_robot": "DEVICE",
    "robot": "NAME",
    "name": "NAME",
}
_BY_TYPE = {"str": "TEXT", "int": "NUMBER", "float": "NUMBER", "Path": "PATH"}


def in_plain_words(command: Any) -> Any:
    """The same Click command, and all below it, whose options say what they want; returns it."""
    command.help = _as_written(command.help)
    for below in getattr(command, "commands", {}).values():
        in_plain_words(below)
    for param in command.params:
        limits = _limits(param)
        if getattr(param, "help", None):
            if "(default: " in param.help:
                param.show_default = False  # said already, and of what stands for it in the program
            param.help = _as_written(param.help)
        if param.param_type_name == "argument":
            param.display_type_rich = lambda ctx: None  # its name and its help say enough
        elif param.metavar is None:
            param.metavar = limits or _word(param)
        if limits:
            param._get_number_range_help_str = lambda: None  # it is in the word already, and shorter
    its_own = command.get_help_option
    command.get_help_option = lambda context: _as_flag(its_own(context))
    return command


def _as_written(text: str | None) -> str | None:
    """A help text that comes out whole: what is in brackets is no markup, and each paragraph is wrapped once."""
    if text is None:
        return None
    paragraphs = inspect.cleandoc(text).split("\n\n")
    return escape("\n\n".join(" ".join(paragraph.split()) for paragraph in paragraphs))


def _as_flag(option: Any) -> Any:
    if option is not None:
        option.metavar = ""
    return option


def _word(param: Any) -> str:
    if getattr(param, "is_flag", False):
        return ""
    if param.name in _BY_NAME or param.name.startswith(("connect_", "listen_")):
        return _BY_NAME.get(param.name, "ENDPOINT")
    kind = str(param.bare_type()) if hasattr(param, "bare_type") else "str"
    return _BY_TYPE.get(kind.removeprefix("list[").removesuffix("]"), "TEXT")


def _limits(param: Any) -> str:
    least, most = getattr(param, "min", None), getattr(param, "max", None)
    if getattr(param, "is_flag", False) or (least is None and most is None):
        return ""
    if most is None:
        return f"{_plain(least)} or more"
    return f"up to {_plain(most)}" if least is None else f"{_plain(least)} to {_plain(most)}"


def _plain(number: Any) -> str:
    """Without an exponent."""
    return f"{number:.15g}"

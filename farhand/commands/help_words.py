"""What stands behind an option in --help: a word for what is wanted, instead of a Python type."""

from typing import Any

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
    for below in getattr(command, "commands", {}).values():
        in_plain_words(below)
    for param in command.params:
        limits = _limits(param)
        if param.param_type_name == "argument":
            param.display_type_rich = lambda ctx: None  # its name and its help say enough
        elif param.metavar is None:
            param.metavar = limits or _word(param)
        if limits:
            param._get_number_range_help_str = lambda: None  # it is in the word already, and shorter
    its_own = command.get_help_option
    command.get_help_option = lambda context: _as_flag(its_own(context))
    return command


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
        return f"{least:g} or more"
    return f"up to {most:g}" if least is None else f"{least:g} to {most:g}"

"""Programs for the emulated controller, translated and not run."""

from collections.abc import Callable

from farhand.robot_side.ur.program import program_text
from farhand.robot_side.ur.settings import UrSettings
from farhand.trials.fuzz.target import Target, one_line
from farhand.trials.fuzz.ur_bench import controller
from farhand.ur_emulator.functions import WAITS, Functions
from farhand.ur_emulator.script_words import ScriptError
from farhand.ur_emulator.sockets import ProgramSockets
from farhand.ur_emulator.urscript import translate
from farhand.ur_emulator.wire import Wire


def seeds() -> list[bytes]:
    """Farhand's own, and the language's words."""
    own = program_text(UrSettings(), 11, 0.002, 10.0)
    more = (
        "def f(a, b=2):\n  global c = [1, 2.5e3, p[0,0,0,0,0,0]]\n  if a > b and not c[0] == 1:\n    return -a\n"
        "  elif a xor b:\n    while True:\n      break\n    end\n  else:\n    textmsg('x', \"y\")\n  end\n"
        "  thread t():\n    sync()\n  end\n"
        "  h = run t()\n  join h\n  kill h\n  enter_critical\n  halt\n  exit_critical\nend\n"
    )
    return [own.encode(), more.encode(), b"sec s():\n  set_tcp(p[0,0,0,0,0,0])\nend\n"]


def start() -> Callable[[bytes], None]:
    """See Target."""
    functions = Functions(controller(), ProgramSockets(Wire())).table()

    def take(data: bytes) -> None:
        try:
            translate(data.decode("utf-8", "replace"), WAITS, functions)
        except ScriptError as error:
            one_line(error)

    return take


TARGET = Target(
    edge="URScript at the emulated controller: the translator",
    promise="a refusal is one line",
    seeds=seeds,
    start=start,
    shape="text",
)

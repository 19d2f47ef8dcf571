"""The program that Farhand runs on the controller, and the messages that it obeys.

A message is a set of RTDE input registers: its number, its deadline, whose it is, and six joint speeds. The program
obeys messages of its own run only, takes a new number for a new message, and brakes by an ordinary stop once none came
for longer than the last one's deadline. So what was sent before a cable was cut, and comes after, moves nothing.
"""

from collections.abc import Sequence

from farhand.robot_side.ur.settings import UrSettings

INPUTS = (
    "input_int_register_24", "input_int_register_25", "input_int_register_26",
    *(f"input_double_register_{i}" for i in range(24, 30)),
)  # fmt: skip
"""Number, deadline (ms; 0: end), run, and joint speeds (rad/s)."""
LIMITS = "output_int_register_27"
"""What a secondary program found of the controller's own limits."""
HEARD, RUN, ENDED = "output_int_register_24", "output_int_register_25", "output_int_register_26"
"""Number of the newest message obeyed; the run, while it runs; why it ended."""
BY_DEADLINE, AS_TOLD = 1, 2
FIRST_WITHIN = 1.0
"""s, from the program's start until the first message."""
STANDS_WITHIN = 0.2
"""s, from the last message until the arm stands, whatever its speed."""
CYCLES = 3
"""Of the controller's, that a message may lie, and a stop may take to begin."""
SPARE = 0.85
"""Of the time that is left for braking, what it takes."""
WATCHDOG_HZ = 10.0
"""The controller's watchdog fires after one or two periods of this."""
LEAST_BRAKING = 2.0
"""rad/s^2."""

_TEXT = """\
def farhand():
  write_output_integer_register(26, 0)
{setup}  told = [0, 0, 0, 0, 0, 0]
  last = 0
  silent = 0.0
  deadline = {first}
  ending = 0
  write_output_integer_register(25, {run})
  while ending == 0:
    number = read_input_integer_register(24)
    if number != last and read_input_integer_register(26) == {run}:
      last = number
      silent = 0.0
      deadline = read_input_integer_register(25) / 1000.0
      told = [read_input_float_register(24), read_input_float_register(25), read_input_float_register(26), read_input_float_register(27), read_input_float_register(28), read_input_float_register(29)]
    else:
      silent = silent + {step}
    end
    if deadline <= 0.0:
      ending = 2
    elif {silence}:
      ending = 1
    else:
      write_output_integer_register(24, last)
      speedj(told, {acceleration}, {step})
    end
  end
  write_output_integer_register(26, ending)
  speeds = get_target_joint_speeds()
  fastest = 0.0
  i = 0
  while i < 6:
    if speeds[i] > fastest:
      fastest = speeds[i]
    end
    if 0 - speeds[i] > fastest:
      fastest = 0 - speeds[i]
    end
    i = i + 1
  end
  braking = fastest / {brake_time}
  if braking < {least}:
    braking = {least}
  end
  stopj(braking)
  write_output_integer_register(25, 0)
end
"""  # noqa: E501 (a list stands on one line, as the controller reads it)


def brake_time(settings: UrSettings, step: float) -> float:
    """What braking takes (s) of what is left of `STANDS_WITHIN`, at a controller's cycle of `step` s."""
    return SPARE * (STANDS_WITHIN - settings.deadline_time - CYCLES * step)


def fastest_joint(settings: UrSettings, step: float, acceleration: float) -> float:
    """The joint speed (rad/s) from which `acceleration` (rad/s^2) just brings a joint to a stand in that time."""
    return brake_time(settings, step) * acceleration


def program_text(settings: UrSettings, run: int, step: float, acceleration: float) -> str:
    """The program as URScript.

    Args:
        settings: payload, tool, deadline.
        run: number of this run, 1 to 2^31 - 1: messages of another one are not obeyed.
        step: the controller's cycle (s).
        acceleration: with which it follows speeds (rad/s^2); what it is told keeps to less by itself.
    """
    setup = ""
    if settings.payload is not None:
        cog = _numbers(settings.payload_cog or (0.0, 0.0, 0.0))
        setup += f"  set_payload({settings.payload!r}, [{cog}])\n"
    if settings.tcp is not None:
        setup += f"  set_tcp(p[{_numbers(settings.tcp)}])\n"
    watched = settings.deadline == "watchdog"
    if watched:
        setup += f'  rtde_set_watchdog("input_int_register_24", {WATCHDOG_HZ}, "stop")\n'
    return _TEXT.format(
        setup=setup,
        run=run,
        step=repr(step),
        first=repr(FIRST_WITHIN),
        silence="False" if watched else "silent > deadline",
        acceleration=repr(acceleration),
        brake_time=f"{brake_time(settings, step):.4f}",
        least=repr(LEAST_BRAKING),
    )


def message(number: int, deadline: float, run: int, qd: Sequence[float]) -> list[float]:
    """Values of `INPUTS`: the next message has to come within `deadline` s; 0: end the program."""
    return [number, round(deadline * 1000.0), run, *qd]


def _numbers(values: Sequence[float]) -> str:
    return ", ".join(repr(float(value)) for value in values)

"""URScript in Python: it means the same, and reaches nothing but what it is offered."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from farhand.ur_emulator.program import Program
from farhand.ur_emulator.script_words import ScriptError
from farhand.ur_emulator.urscript import translate


def ran(text, cycles=50, **functions):
    """What a program passed to `tell`, as it ran."""
    told = []

    def wait():
        yield

    table = {"tell": told.append, "sync": wait, **functions}
    program = Program(translate(text, {"sync"}, table), table)
    for _ in range(cycles):
        if program.running:
            program.cycle()
    return told, program


NUMBERS = st.integers(0, 50).map(str) | st.floats(0, 50).map(lambda value: f"{value:.3f}")
EXPRESSIONS = st.recursive(
    NUMBERS,
    lambda inner: (
        st.tuples(inner, st.sampled_from(["+", "-", "*", "<", "<=", ">", ">=", "==", "!="]), inner).map(
            lambda each: f"({each[0]} {each[1]} {each[2]})"
        )
        | inner.map(lambda each: f"(-{each})")
        | st.tuples(inner, st.sampled_from(["and", "or"]), inner).map(lambda each: f"({' '.join(each)})")
    ),
    max_leaves=8,
)


@settings(max_examples=60)
@given(EXPRESSIONS)
def test_an_expression_means_what_it_means_in_python(expression):
    told, program = ran(f"def main():\n tell({expression})\nend\n")
    assert program.error == ""
    assert told == [eval(expression)]


def test_control_flow_functions_and_scopes():
    text = """
def main():
  global total = 0   # a comment
  def add(x, y):
    total = total + x * y
    local mine = 5
    return mine
  end
  i = 0
  while True:
    i = i + 1
    if i == 2:
      continue
    elif i > 4:
      break
    else:
      tell(add(i, y=10))
    end
  end
  values = [1, 2, 3]
  other = values
  other[0] = 9
  tell(values[0])
  tell(total)
end
"""
    told, program = ran(text)
    assert (told, program.error, program.running) == ([5, 5, 5, 1, 80], "", False)


def test_threads_take_turns_and_are_killed_and_critical_sections_keep_the_others_out():
    text = """
def main():
  global n = 0
  global inside = False
  thread count():
    while True:
      n = n + 1
      sync()
    end
  end
  t = run count()
  sync()
  sync()
  sync()
  enter_critical
  before = n
  sync()
  sync()
  tell(n - before)
  exit_critical
  sync()
  kill t
  after = n
  sync()
  sync()
  tell(n - after)
end
"""
    told, program = ran(text)
    assert (told, program.error) == ([0, 0], "")


def test_a_loop_that_waits_for_nothing_does_not_hold_the_controller_up():
    _, program = ran("def main():\n while True:\n  x = 1\n end\nend\n", cycles=3)
    assert program.running


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("def main():\n x = \nend\n", "line 3"),
        ("def main():\n x = 1 @ 2\nend\n", "line 2"),
        ("def main():\n if True:\n  x = 1\n", "an end is missing"),
        ("x = 1\n", "begins with def or sec"),
        ("def main():\n x = run nothing()\nend\n", "no thread 'nothing'"),
        ("def main():\n x = " + "(" * 200 + "1" + ")" * 200 + "\nend\n", "too deeply"),
    ],
)
def test_what_is_no_program_is_refused_with_its_line(text, said):
    with pytest.raises(ScriptError, match=said):
        translate(text, (), ())


@pytest.mark.parametrize(
    "line",
    [
        "x = __import__('os')", "x = ().__class__", "open('/etc/passwd')", "exec('1')", "f_main()", "b_kill(1)",
        "x = self", "import os", "x = [i for i in 3]", "x = lambda: 1", "tell(1); tell(2)",
    ],
)  # fmt: skip
def test_nothing_of_python_is_within_reach(line):
    try:
        translated = translate(f"def main():\n {line}\nend\n", (), {"tell": print})
    except ScriptError:
        return
    told, program = ran(f"def main():\n {line}\nend\n")
    assert told == []
    assert program.error
    assert not any(name.startswith("__") for name in translated.code.co_names)


@given(st.text(max_size=60))
def test_any_text_is_a_program_or_refused(text):
    try:
        translate(f"def main():\n{text}\nend\n", {"sync"}, {"tell", "sync"})
    except ScriptError:
        pass

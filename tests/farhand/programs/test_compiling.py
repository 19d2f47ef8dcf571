"""A controller that takes long to prepare is announced, one that does not is not."""

import threading

from farhand.programs.compiling import LINE, ROBOT_LINE, prepare_aloud, said_aloud


class Preparing:
    """Prepares until it is told on."""

    def __init__(self, told: threading.Event | None) -> None:
        self.told = told

    def prepare(self):
        assert self.told is None or self.told.wait(10.0)


def test_only_what_takes_long_is_said():
    said, told = [], threading.Event()

    def tell(line):
        said.append(line)
        told.set()

    prepare_aloud(Preparing(None), tell, 60.0)
    assert said == []
    prepare_aloud(Preparing(told), tell, 0.0)
    assert said == [LINE]


def test_a_robot_that_takes_long_is_announced_as_such():
    said, told = [], threading.Event()

    def tell(line):
        said.append(line)
        told.set()

    with said_aloud(ROBOT_LINE, tell, 0.0):
        assert told.wait(10.0)
    assert said == [ROBOT_LINE]

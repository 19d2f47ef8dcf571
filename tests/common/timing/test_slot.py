"""A change from another thread: done once in the loop's thread, or never."""

import threading

import pytest

from farhand.common.errors import InputError
from farhand.common.timing.slot import NotServedError, Slot


class Loop:
    """Serves a slot in a thread of its own."""

    def __init__(self, slot):
        self.slot, self.over = slot, threading.Event()
        self.thread = threading.Thread(target=self.run, name="loop")
        self.thread.start()

    def run(self):
        while not self.over.is_set():
            self.slot.serve(7)
            self.over.wait(0.0005)

    def close(self):
        self.over.set()
        self.thread.join()


@pytest.fixture
def slot():
    found = Slot()
    loop = Loop(found)
    yield found
    loop.close()


def test_it_is_done_in_the_loops_thread_at_its_time(slot):
    assert slot.do(lambda now_ns: (now_ns, threading.current_thread().name)) == (7, "loop")


def test_an_error_goes_to_who_asked_and_the_loop_goes_on(slot):
    def refuse(now_ns):
        raise InputError("no")

    with pytest.raises(InputError, match="no"):
        slot.do(refuse)
    assert slot.do(lambda now_ns: 1) == 1


def test_many_at_once_are_all_done(slot):
    done = []
    threads = [threading.Thread(target=lambda n=n: slot.do(lambda _: done.append(n))) for n in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(done) == list(range(20))


def test_what_nobody_serves_is_taken_back():
    slot, done = Slot(), []
    with pytest.raises(NotServedError, match="nothing was changed"):
        slot.do(done.append, patience=0.01)
    slot.serve(1)
    assert done == []


def test_who_asks_wakes_the_loop():
    slot = Slot(lambda: slot.serve(3))
    assert slot.do(lambda now_ns: now_ns) == 3

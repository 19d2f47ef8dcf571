"""How many threads Zenoh works with in this process; of itself it takes several, a few for each of five purposes."""

import os

_ONE = "(app: (handover: tx), acc: (handover: tx), net: (handover: tx), rx: (handover: tx))"


def one_thread() -> None:
    """Let one thread do all of Zenoh's work: for who passes small messages on, each of which wakes nobody else then.

    Call it before the first session. What is called at an arrival must not put with congestion control BLOCK: it
    would wait for itself. Who has set ZENOH_RUNTIME keeps it.
    """
    os.environ.setdefault("ZENOH_RUNTIME", _ONE)

"""How soon a press leaves the operator, and a key is answered by the ghost."""

from contextlib import ExitStack
from typing import Any

from benchmarks.seat.lines import BEYOND, TICK, summary
from benchmarks.seat.system import system_of
from benchmarks.seat.threads import load
from farhand.common.timing.clock import utc_seconds
from tests.operator_side.console.browser import Browser


def press(count: int) -> dict[str, Any]:
    """From a press that is handed to the console's socket to the first command with a velocity that leaves."""
    with system_of(console=True) as system:
        found, missed = [], 0
        for k in range(count):
            system.rest(0.35 + 0.013 * (k % 9))  # at every phase of the tick
            began_ns = system.press()
            try:
                found.append((system.moves(began_ns) - began_ns) * 1e-9)
            except AssertionError:
                missed += 1
            system.let_go()
        return summary(found) | {
            "load": load(),
            "missed": missed,
            "over": sum(each > TICK + BEYOND for each in found),
        }


def browser(count: int) -> dict[str, Any]:
    """The same from the instant of the key's event in a real page, and to the frame that shows the ghost's answer.

    The page's ghost is drawn in the animation frame after the key's event; without a mark of its own (`ghost`), the
    end of that frame counts.
    """
    with system_of(console=False) as system, ExitStack() as closing:
        page = Browser()
        closing.callback(page.close)
        page.open(f"http://{system.host}/")
        for _ in range(400):
            if page.text("driver") == "you drive":
                break
            system.rest(0.05)
        page.run(
            """window.keys = []; window.ghosts = [];
            addEventListener('keydown', (event) => {
              keys.push(performance.timeOrigin + event.timeStamp);
              requestAnimationFrame(() => setTimeout(() => ghosts.push(performance.now() - event.timeStamp), 0));
            }, true);"""
        )
        commands, missed = [], 0
        for k in range(count):
            system.rest(0.6 + 0.013 * (k % 9))
            began_ns = system.clock.now_ns()
            page.key("KeyD" if k % 2 else "KeyA")
            wall, now_ns = utc_seconds(), system.clock.now_ns()
            try:
                moved_ns = system.moves(began_ns, 1.0)
            except AssertionError:
                missed += 1
            else:
                pressed = page.run("return keys.at(-1)") * 1e-3
                commands.append((moved_ns - now_ns) * 1e-9 + wall - pressed)
            page.key("KeyD" if k % 2 else "KeyA", down=False)
        ghosts = [
            each * 1e-3
            for each in page.run(
                "const own = performance.getEntriesByName('ghost').map(m => m.detail); return own.length ? own : ghosts"
            )
        ]
        return {"command": summary(commands), "missed": missed, "ghost": summary(ghosts), "load": load()}

"""The build's proof that slim.py took out nothing that is needed; compiles the solver for the image."""

from collections.abc import Iterator

import msgspec

import farhand.figure
import farhand.live_status
import netem.check
import netem.fit
import netem.main
from common.scenario import ControllerSettings, load_scenario
from farhand.cli import run
from operator_side.control.registry import make_controller
from robot_side.registry import make_robot

MODULES = (farhand.figure, farhand.live_status, netem.check, netem.fit, netem.main)


def failures() -> Iterator[str]:
    """What does not work, in words."""
    for solver in ("newton", "sqp", "ipopt"):
        controller = make_controller(msgspec.structs.replace(ControllerSettings(), solver=solver))
        controller.prepare()
        notice = getattr(controller, "solver_notice", "")
        if notice:
            yield f"solver {solver}: {notice}"
    for name in ("box-obstacle", "point-obstacle"):
        make_robot(load_scenario(name)).close()
    for solver in ("sqp", "ipopt"):
        options = ["--scenario", "point-obstacle", "--network", "none", "--margin", "none"]
        if run(["simulate", *options, "--solver", solver, "--out", f"/tmp/{solver}"]):
            yield f"the point's task was not driven safely to its end with {solver}"
    if run(["simulate", "--scenario", "ur5-obstacle", "--network", "5g-urban", "--out", "/tmp/ur5"]):
        yield "the UR5's task was not driven safely to its end"


if __name__ == "__main__":
    raise SystemExit("\n".join(failures()) or 0)

"""The build's proof that nothing needed was taken out of the image; compiles the solver for it."""

import pkgutil
from collections.abc import Iterator
from importlib import import_module

import msgspec

from farhand.cli import run
from farhand.operator_side.control.registry import make_controller
from farhand.operator_side.control.settings import ControllerSettings
from farhand.robot_side.robots.registry import make_robot
from farhand.runs.scenario import load_scenario

PACKAGES = ("farhand",)
NOT_FOR_CONTAINERS = ("farhand.__main__", "farhand.pytest_plugin")
ON_DEMAND = ("scipy.stats", "scipy.optimize", "pygments.lexers.python")
"""What is imported only when it is used."""


def import_everything() -> None:
    """Import every module of Farhand; raises ImportError where what it needs is gone."""
    for package in PACKAGES:
        for module in pkgutil.walk_packages(import_module(package).__path__, f"{package}."):
            if module.name not in NOT_FOR_CONTAINERS:
                import_module(module.name)
    for name in ON_DEMAND:
        import_module(name)


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
    import_everything()
    raise SystemExit("\n".join(failures()) or 0)

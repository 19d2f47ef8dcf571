"""Everything of the operator's side that is compiled, before anything is connected."""

from farhand.common.kinds import made
from farhand.operator_side.control.checks import body
from farhand.operator_side.control.controller import Controller


def prepare(controller: Controller) -> None:
    """Compile and warm up a controller and the check behind it; raises InputError where it cannot."""
    made(f"controller {type(controller).__name__}", controller.prepare)
    body.prepare()

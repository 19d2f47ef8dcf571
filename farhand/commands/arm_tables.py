"""What `farhand arm` prints."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table

from farhand.common.process.console import page, whole

if TYPE_CHECKING:
    from farhand.robot_side.arm.fitting.arm import FittedArm
    from farhand.robot_side.arm.model import ArmModel

MM = 1000.0


def print_arms(arms: Sequence["ArmModel"]) -> None:
    """One row an arm."""
    table = Table("model", "joints", "tool frame", "rad/s", "rad/s²", "N m", "capsules", "pairs", box=None)
    for arm in arms:
        table.add_row(
            arm.name,
            str(arm.n),
            arm.tool_frame,
            *(_range(each) for each in (arm.max_velocity, arm.max_acceleration, arm.max_torque)),
            str(len(arm.capsules)),
            str(len(arm.self_pairs)),
        )
    console = page()
    console.print(whole(table, console))


def print_fit(fitted: "FittedArm") -> None:
    """One row a capsule (mm), what was checked, and a line for each pair that is not kept apart."""
    table = Table("link", "radius", "length", "vertices", "excess median", "max", "", box=None)
    table.columns[6].no_wrap = True
    for column in table.columns[1:6]:
        column.justify = "right"
    for each in fitted.links:
        capsule = each.capsule
        length = float(np.linalg.norm(capsule.b - capsule.a))
        table.add_row(
            each.link,
            f"{MM * capsule.radius:.1f}",
            f"{MM * length:.1f}",
            str(each.vertices),
            f"{MM * each.excess_median:.1f}",
            f"{MM * each.excess_max:.1f}",
            f"within that of {each.covered_by}" if each.covered_by else "",
        )
    console = page()
    console.print(whole(table, console))
    count = sum(not each.covered_by for each in fitted.links)
    console.print(
        f"{count} capsules (mm); every vertex lies inside, {-MM * fitted.outside:.3f} mm deep at least"
    )
    for pair in fitted.overlaps:
        one, other = pair.links
        where = f"overlap by {-MM * pair.at_home:.0f} mm at home" if pair.at_home < 0.0 else "overlap"
        console.print(
            f"warning: {one} and {other} {where}, in {pair.share:.0%} of random configurations: "
            "they are not kept apart from each other"
        )


def _range(values: "np.ndarray[tuple[int, ...], np.dtype[np.float64]]") -> str:
    low, high = float(values.min()), float(values.max())
    return f"{low:g}" if low == high else f"{low:g} to {high:g}"

"""What the programs left behind at the end of a run, read from its folder."""

from pathlib import Path

import msgspec

from farhand.common.result_file import read_result
from farhand.netem.measure.result import NetemCounts, NetemResult
from farhand.operator_side.accounts.result import OperatorCounts, OperatorResult
from farhand.robot_side.result import RobotCounts, RobotResult
from farhand.runs.files import NETEM, OPERATOR, ROBOT


class Counts(msgspec.Struct, frozen=True, kw_only=True):
    """All that the three counted and measured; None where one left no result."""

    operator: OperatorCounts | None = None
    netem: NetemCounts | None = None
    robot: RobotCounts | None = None


class RunResults(msgspec.Struct, frozen=True, kw_only=True):
    """The results of the three; None where one died before it could leave any."""

    operator: OperatorResult | None = None
    netem: NetemResult | None = None
    robot: RobotResult | None = None

    def counts(self) -> Counts:
        """Their counts alone, without paths and series: what stands in a summary."""
        return msgspec.convert(self, Counts, from_attributes=True)


def read_results(folder: Path) -> RunResults:
    """The results in a run's folder; raises ResultError where one is broken or of another version."""
    return RunResults(
        operator=read_result(folder / OPERATOR, OperatorResult),
        netem=read_result(folder / NETEM, NetemResult),
        robot=read_result(folder / ROBOT, RobotResult),
    )

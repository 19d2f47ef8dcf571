"""The settings of what steers."""

from farhand.common.scenario.section import KindSection


class SteeringSettings(KindSection, frozen=True, kw_only=True):
    """What steers; what a device alone needs is in the table named after it.

    Attributes:
        kind: which device.
    """

    kind: str = "tester"

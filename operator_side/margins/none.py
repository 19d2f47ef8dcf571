"""d_min and nothing more."""

from farhand.operator_side.margins.law import Margin, MarginInput, MarginLaw


class NoMargin(MarginLaw):
    """d_min and nothing more."""

    def evaluate(self, given: MarginInput) -> Margin:
        """See MarginLaw."""
        return Margin()

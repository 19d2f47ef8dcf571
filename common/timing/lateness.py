"""How late a loop is, in bounded memory."""


class Lateness:
    """How late wake-ups were: count, mean, maximum, and a histogram with power-of-two bins in us."""

    def __init__(self) -> None:
        self.count = 0
        self.total_ns = 0
        self.max_ns = 0
        self.bins = [0] * 24

    def add(self, late_ns: int) -> None:
        """Record one wake-up that came `late_ns` after its deadline."""
        late_ns = max(0, late_ns)
        self.count += 1
        self.total_ns += late_ns
        self.max_ns = max(self.max_ns, late_ns)
        self.bins[min(len(self.bins) - 1, (late_ns // 1000).bit_length())] += 1

    def quantile(self, fraction: float) -> float:
        """Upper edge (s) of the bin that holds the given fraction of all wake-ups; 0 if there were none."""
        below, wanted = 0, fraction * self.count
        for exponent, n in enumerate(self.bins):
            below += n
            if n and below >= wanted:
                return float(1 << exponent) * 1e-6
        return 0.0

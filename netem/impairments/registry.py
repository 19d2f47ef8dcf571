"""The words of a SPEC. A new impairment is one file and one line here."""

from farhand.netem.impairments.base import Word
from farhand.netem.impairments.constant import Constant
from farhand.netem.impairments.corrupt import Corrupt
from farhand.netem.impairments.duplicate import Duplicate
from farhand.netem.impairments.gaussian import Gaussian
from farhand.netem.impairments.lognormal import LogNormal
from farhand.netem.impairments.loss import LossWord
from farhand.netem.impairments.outage import Outage
from farhand.netem.impairments.pareto import Pareto
from farhand.netem.impairments.paretonormal import ParetoNormal
from farhand.netem.impairments.rate import Rate
from farhand.netem.impairments.reorder import Reorder
from farhand.netem.impairments.replay import Empirical, Replay
from farhand.netem.impairments.slot import Slot
from farhand.netem.impairments.tcp_like import TcpLike
from farhand.netem.impairments.uniform import Uniform

WORDS: dict[str, type[Word]] = {
    "constant": Constant,
    "uniform": Uniform,
    "gaussian": Gaussian,
    "normal": Gaussian,
    "pareto": Pareto,
    "paretonormal": ParetoNormal,
    "lognormal": LogNormal,
    "empirical": Empirical,
    "trace": Replay,
    "loss": LossWord,
    "duplicate": Duplicate,
    "corrupt": Corrupt,
    "rate": Rate,
    "slot": Slot,
    "reorder": Reorder,
    "outage": Outage,
    "tcp-like": TcpLike,
}
KINDS = (
    "outage",
    "loss",
    "tcp-like",
    "duplicate",
    "corrupt",
    "rate",
    "delay",
    "reorder",
    "slot",
)

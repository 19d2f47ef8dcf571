"""The words of a SPEC. A new impairment is one file and one line here."""

from netem.impairments.base import Word
from netem.impairments.constant import Constant
from netem.impairments.corrupt import Corrupt
from netem.impairments.duplicate import Duplicate
from netem.impairments.gaussian import Gaussian
from netem.impairments.lognormal import LogNormal
from netem.impairments.loss import LossWord
from netem.impairments.outage import Outage
from netem.impairments.pareto import Pareto
from netem.impairments.paretonormal import ParetoNormal
from netem.impairments.rate import Rate
from netem.impairments.reorder import Reorder
from netem.impairments.replay import Empirical, Replay
from netem.impairments.slot import Slot
from netem.impairments.tcp_like import TcpLike
from netem.impairments.uniform import Uniform

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

"""Loss models with memory, as tc-netem's: Gilbert-Elliott and the four-state Markov chain.

Both are a chain of states, each with a probability of loss; a message takes one step and is then lost
with the probability of the state that it finds. Parameters are named as in `man tc-netem`.
"""

from collections.abc import Sequence

import numpy as np

from farhand.common.geometry import Array
from farhand.netem.impairments.base import ImpairmentContext, LossModel, Transit


class MarkovLoss(LossModel):
    """Losses from a Markov chain that steps once a message.

    Args:
        context: gives the stream.
        transitions: (n, n) probabilities, rows sum to one.
        losses: (n,) probability of loss in each state.
    """

    def __init__(
        self, context: ImpairmentContext, transitions: Sequence[Sequence[float]], losses: Sequence[float]
    ) -> None:
        self._random = context.rng("loss").random
        self._cumulative = [np.cumsum(row).tolist() for row in transitions]
        self._losses = list(losses)
        self._state = self._pick(np.cumsum(stationary(np.array(transitions))).tolist())

    def loses(self, transit: Transit, instant_ns: int) -> bool:
        """Step the chain and draw."""
        self._state = self._pick(self._cumulative[self._state])
        return float(self._random()) < self._losses[self._state]

    def _pick(self, cumulative: list[float]) -> int:
        drawn = float(self._random())
        for state, bound in enumerate(cumulative):
            if drawn < bound:
                return state
        return cumulative.index(cumulative[-1])  # rounding: the last state that can be reached


def stationary(transitions: Array) -> Array:
    """(n,) long-run share of each state, for a chain started in state 0."""
    n = len(transitions)
    # The mean of many powers converges for periodic and reducible chains too, unlike the eigenvector.
    lazy = 0.5 * (np.eye(n) + transitions)
    share = np.zeros(n)
    share[0] = 1.0
    power = lazy
    for _ in range(60):
        power = power @ power
        power /= power.sum(axis=1, keepdims=True)
    result: Array = share @ power
    return result

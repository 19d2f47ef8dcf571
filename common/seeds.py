"""One seed for a run, one independent stream for each use of it."""

import hashlib

import numpy as np


def stream(seed: int, *names: str) -> np.random.Generator:
    """A generator that depends on the seed and the names alone, not on the order of creation.

    Args:
        seed: the run's seed, >= 0.
        names: what the stream is for, e.g. "netem", "uplink", "delay".
    """
    digest = hashlib.sha256("/".join(names).encode()).digest()
    return np.random.Generator(np.random.PCG64(np.random.SeedSequence([seed, *digest[:8]])))


def derived(rng: np.random.Generator) -> np.random.Generator:
    """A generator of its own, seeded by the next draw of another."""
    return np.random.Generator(np.random.PCG64(int(rng.integers(1 << 62))))

"""Which links of an arm can meet, what its SRDF says of them, and what the guard keeps apart: by their meshes.

`python -m farhand.trials.safety.pairs [--configurations 2000] [MODEL ...]`: a table of all pairs of links that come
nearer than 10 mm in random configurations.
"""

import argparse

import numpy as np

from farhand.common.geometry import Array
from farhand.common.seeds import stream
from farhand.robot_side.arm.model import ArmModel, model
from farhand.robot_side.safety.guard.arm_guard import body_of, self_gaps
from farhand.trials.safety.truth import Meshes

NEAR = 0.01  # m
EXACT = 0.02
"""m: hulls that are farther apart than this say enough."""
HEADING = (
    "| arm | links | SRDF | kept apart | meshes meet, % | nearer than 10 mm, % | guard refuses, % | "
    "least where the guard is content, mm |\n|---|---|---|---|---|---|---|---|"
)


def rows(arm: ArmModel, configurations: int) -> list[str]:
    """A line of the table for each pair that comes nearer than NEAR."""
    body, meshes = body_of(arm, NEAR), Meshes(arm)
    pairs = meshes.pairs(arm.home, NEAR)
    rng = stream(1, "pairs", arm.name)
    true: Array = np.empty((configurations, len(pairs)))
    gaps: Array = np.empty((configurations, len(body.pairs)))
    for k in range(configurations):
        q = rng.uniform(arm.lower, arm.upper)
        meshes.place(q)
        true[k] = [meshes.between(pair.one, pair.other, EXACT) for pair in pairs]
        gaps[k] = self_gaps(body, q)
    content = gaps.min(axis=1) >= NEAR
    watched = [frozenset(body.parts[i] for i in pair) for pair in body.pairs]
    found = []
    for column, pair in enumerate(pairs):
        distances, links = true[:, column], frozenset((pair.one, pair.other))
        if distances.min() >= NEAR:
            continue
        own = [i for i, each in enumerate(watched) if each == links]
        refused = (gaps[:, own].min(axis=1) < NEAR).mean() if own else 0.0
        by_stand_ins = bool(own) and own[0] >= len(arm.self_pairs)
        cells = [
            arm.name,
            f"{pair.one}, {pair.other}",
            "excluded" if links in arm.never_colliding else "",
            _how(bool(own), by_stand_ins, links <= set(body.parts)),
            f"{100 * (distances <= 0.0).mean():.1f}",
            f"{100 * (distances < NEAR).mean():.1f}",
            f"{100 * refused:.1f}",
            f"{1e3 * distances[content].min():.1f}",
        ]
        found.append("| " + " | ".join(cells) + " |")
    return found


def _how(kept: bool, by_stand_ins: bool, own_capsules: bool) -> str:
    if kept:
        return "by stand-ins" if by_stand_ins else "by capsules"
    return "no" if own_capsules else "by the capsule that holds it"


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="*", default=["ur3", "ur5", "ur10", "panda"])
    parser.add_argument("--configurations", type=int, default=2000)
    arguments = parser.parse_args()
    print(HEADING)
    for name in arguments.models:
        print("\n".join(rows(model(name), arguments.configurations)), flush=True)


if __name__ == "__main__":
    main()

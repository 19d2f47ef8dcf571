"""The least distance of an arm's capsules to what is around it, compiled: a judge asks at every tick."""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types

from pathlib import Path

from farhand.common.compiled import Compiler
from farhand.robot_side.kernel import distance
from farhand.robot_side.kernel.distance import capsule_row, distance_floor

compiled = Compiler(Path(__file__), Path(distance.__file__).parent)


@compiled
def sweep(axes, arm, around, bounds, often, close):
    """(least, capsule, obstacle, count): the least distance (m) and whose it is; 1e6, -1, -1 without any.

    `count` pairs that the meshes are to decide are written to `close`: those nearer than they may be, and, where it is
    that tick (`often`), those that are near.

    Args:
        axes: (A, B), (k, 3) each: where the capsules' axes end in base (m).
        arm: (capsules, moving): (k, 9) of a Body, joint in column 0, radius in column 7; (m,) indices that count.
        around: (rows, vertices, planes): of a Surroundings table; (o,) whether an obstacle is a plane.
        bounds: (2,) what they may not come nearer than, and what is near (m).
        often: bool.
        close: (m o, 2) indices of capsule and obstacle.
    """
    A, B = axes
    capsules, moving = arm
    rows, vertices, planes = around
    best, which, whose, count = 1e6, -1, -1, 0
    for i in moving:
        joint, radius = capsules[i, 0], capsules[i, 7]
        for j in range(rows.shape[0]):
            if planes[j] and joint < 2:
                # the foot cannot leave the table that it stands on: the meshes decide
                if joint == 1 and often:
                    close[count, 0], close[count, 1] = i, j
                    count += 1
                continue
            if distance_floor(A[i], B[i], radius, rows[j]) > max(best, bounds[1]):
                continue
            d = capsule_row(A[i], B[i], radius, rows[j], vertices)[0]
            if d < best:
                best, which, whose = d, i, j
            if d < bounds[0] or (d < bounds[1] and often):
                close[count, 0], close[count, 1] = i, j
                count += 1
    return best, which, whose, count

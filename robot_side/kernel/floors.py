"""Which distances have to be measured again, by bounds from below on all of them."""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types

from farhand.robot_side.kernel.jit import compiled


@compiled
def sink(floors, moved, known, limit, order):
    """Sink all floors by what their links have moved, and say which of them are under a limit then.

    Args:
        floors: (obstacles, links) no link is nearer to an obstacle than this (m).
        moved: (links,) by how much at most (m).
        known: the place, obstacle * links + link, of the one that has been measured since, and is left out; -1: none.
        limit: (m).
        order: (obstacles * links,) is filled with the places of what is under the limit, the lowest first.

    Returns how many there are. There are few, but for the first time.
    """
    flat = floors.reshape(floors.size)
    links = moved.shape[0]
    count = 0
    for place in range(flat.shape[0]):
        if place == known:
            continue
        flat[place] -= moved[place % links]
        if flat[place] < limit:
            at = count
            while at > 0 and flat[order[at - 1]] > flat[place]:
                order[at] = order[at - 1]
                at -= 1
            order[at] = place
            count += 1
    return count

"""The compiled MPC-CBF solver.

Newton's method on the velocities with the box kept exactly, in an augmented Lagrangian over the barrier rows
whose weight omega and elastic slack are eliminated in closed form. docs/solver.md derives it; the names of
the functions are the names of its sections. SI units throughout.

Arrays:
    plan: (N+1, 3) velocities u_0..u_N; u_N is free and enters the cost only (m/s).
    path: (N+2, 3) positions x_0..x_{N+1}, x_{i+1} = x_i + dt u_i (m).
    obstacles: (capacity, 12) rows of centre (3), R, velocity (3), sigma, normal (3), whether it is a plane (0 or 1).
    kept: (capacity,) indices of the obstacles that can bind; the first `count` are valid.
    multipliers: (capacity, N), one for each row (j, i): h_j(x_{i+1}) - sigma_j >= omega (1 - gamma) h_j(x_i).
    limit: (3,) u_b for each axis (m/s).
    par: the constants named below.
"""

# mypy: allow-untyped-defs, allow-untyped-calls, allow-untyped-decorators
# numba infers the types from the arrays listed above

import numpy as np

from farhand.operator_side.control.compile_cache import compiled

OPTIMAL, SHORTCUT, ELASTIC, CAPPED, INFEASIBLE, BAD_INPUT = range(6)
# par: period, weights Q R P S P_omega, decay 1 - gamma, penalty rho, least and greatest price of the elastic
# slack, and the curvature of the cost in one velocity, which scales gradients to velocities
DT, Q, R, P, S, P_OMEGA, DECAY, RHO, PRICE, PRICE_MAX, CURVATURE = range(11)
PARAMETERS = 11
FLAT = 11
COLUMNS = 12  # of obstacles
BAND = 7  # x_i meets its neighbours' three axes, and its second neighbour on the same axis only

ROW_TOLERANCE = 1e-5  # m^2, by which a barrier row may be missed
ROW_AIM = 1e-7  # m^2, sought within the iteration cap: where h is near 0 the cost feels every bit of it
GRADIENT_TOLERANCE = 2e-4  # m/s, of the projected gradient
STEP_TOLERANCE = 1e-4  # m/s, of a Newton step, before the multipliers move on
MAGNITUDE = 1e6  # an input beyond this is refused: sums of squares must stay exact enough to mean something


@compiled
def barrier(path, i, obstacles, j, dt):
    """h_j(x_i) = |x_i - p_j - i dt v_j|^2 - R_j^2 (m^2); of a plane n_j . (x_i - p_j - i dt v_j) - R_j (m)."""
    if obstacles[j, FLAT] != 0.0:
        h = -obstacles[j, 3]
        for k in range(3):
            h += obstacles[j, 8 + k] * (path[i, k] - obstacles[j, k] - i * dt * obstacles[j, 4 + k])
        return h
    h = -obstacles[j, 3] * obstacles[j, 3]
    for k in range(3):
        d = path[i, k] - obstacles[j, k] - i * dt * obstacles[j, 4 + k]
        h += d * d
    return h


@compiled
def roll_out(plan, path, dt):
    """Fill path from path[0] and the plan."""
    for i in range(plan.shape[0]):
        for k in range(3):
            path[i + 1, k] = path[i, k] + dt * plan[i, k]


@compiled
def tracking_cost(plan, desired, par):
    """The quadratic part of the cost."""
    last = plan.shape[0] - 1
    cost = 0.0
    for k in range(3):
        for i in range(last):
            cost += par[Q] * (plan[i, k] - desired[k]) ** 2 + par[R] * plan[i, k] ** 2
            cost += par[S] * (plan[i + 1, k] - plan[i, k]) ** 2
        cost += par[P] * (plan[last, k] - desired[k]) ** 2
    return cost


@compiled
def barrier_row(t, b, y, par):
    """Augmented Lagrangian of one row t >= omega b, least over omega >= 0 and the elastic slack.

    Args: t = h(x_{i+1}) - sigma, b = (1 - gamma) h(x_i), y the row's multiplier, par.
    Returns (l, omega, c, k, value): the new multiplier, the weight, the curvature c along dt - (2 omega -
    1) db, the curvature k along db, and the value.
    """
    rho = par[RHO]
    twice = 2.0 * par[P_OMEGA]
    price = min(max(twice / b, par[PRICE]), par[PRICE_MAX]) if b > 0.0 else par[PRICE_MAX]
    c = 1.0 / (b * b / twice + 1.0 / rho)
    l = (b - t + y / rho) * c  # noqa: E741
    omega = 1.0 - l * b / twice
    k = -l * l / twice
    if b > 0.0 and omega < 0.0:  # omega stays at 0: the row has become h(x_{i+1}) >= sigma
        l = max(twice / b, y - rho * t)  # noqa: E741
        omega, c, k = 0.0, rho, 0.0
    if l <= 0.0:
        l, omega, c, k = 0.0, 1.0, 0.0, 0.0  # noqa: E741
    if l >= price:  # cheaper to buy slack
        l, omega, c, k = price, max(0.0, 1.0 - price * b / twice), 0.0, 0.0  # noqa: E741
    value = par[P_OMEGA] * (omega - 1.0) ** 2 + l * (omega * b - t) - (l - y) ** 2 / (2.0 * rho)
    return l, omega, c, k, value


@compiled
def merit(plan, path, desired, obstacles, kept, count, multipliers, par):
    """Tracking cost plus every row's augmented Lagrangian."""
    total = tracking_cost(plan, desired, par)
    for q in range(count):
        j = kept[q]
        h = barrier(path, 0, obstacles, j, par[DT])
        for i in range(plan.shape[0] - 1):
            h_next = barrier(path, i + 1, obstacles, j, par[DT])
            t = h_next - obstacles[j, 7]
            b = par[DECAY] * h
            y = multipliers[j, i]
            if t < b or y > 0.0:
                total += barrier_row(t, b, y, par)[4]
            h = h_next
    return total


@compiled
def merit_derivatives(
    plan, path, desired, obstacles, kept, count, multipliers, par, base, band, gradient, updated, theta
):
    """Gradient and banded Hessian of the merit in x_1..x_{N+1}, and the updated multipliers.

    theta scales the rows' own curvature: 1 is Newton, 0 Gauss-Newton (never indefinite).
    Fills gradient (3(N+1),), band (3(N+1), BAND), updated (count, N).
    """
    dt = par[DT]
    decay = par[DECAY]
    last = plan.shape[0] - 1
    band[:, :] = base
    gradient[:] = 0.0
    for i in range(last + 1):
        for k in range(3):
            u = plan[i, k]
            if i < last:
                slope = 2 * (par[Q] * (u - desired[k]) + par[R] * u) - 2 * par[S] * (plan[i + 1, k] - u)
            else:
                slope = 2 * par[P] * (u - desired[k])
            if i > 0:
                slope += 2 * par[S] * (u - plan[i - 1, k])
                gradient[3 * i + k - 3] -= slope / dt
            gradient[3 * i + k] += slope / dt
    grad_t = np.empty(3)
    grad_b = np.empty(3)
    for q in range(count):
        j = kept[q]
        flat = obstacles[j, FLAT] != 0.0
        own = 0.0 if flat else theta * 2  # curvature of h
        h = barrier(path, 0, obstacles, j, dt)
        for i in range(last):
            h_next = barrier(path, i + 1, obstacles, j, dt)
            t = h_next - obstacles[j, 7]
            b = decay * h
            h = h_next
            y = multipliers[j, i]
            updated[q, i] = 0.0
            if t >= b and y <= 0.0:
                continue
            l, omega, c, kb, _ = barrier_row(t, b, y, par)  # noqa: E741
            updated[q, i] = l
            if l <= 0.0:
                continue
            lean = omega + theta * (omega - 1.0) if omega > 0.0 else 0.0
            if flat:
                for k in range(3):
                    grad_t[k] = obstacles[j, 8 + k]
                    grad_b[k] = decay * obstacles[j, 8 + k]
            else:
                for k in range(3):
                    grad_t[k] = 2 * (path[i + 1, k] - obstacles[j, k] - (i + 1) * dt * obstacles[j, 4 + k])
                    grad_b[k] = 2 * decay * (path[i, k] - obstacles[j, k] - i * dt * obstacles[j, 4 + k])
            for k in range(3):
                r = 3 * i + k  # of x_{i+1}; x_i is at r - 3, and x_0 is given
                gradient[r] -= l * grad_t[k]
                band[r, 0] -= own * l
                for m in range(k + 1):
                    band[r, k - m] += c * grad_t[k] * grad_t[m]
                if i > 0:
                    gradient[r - 3] += l * omega * grad_b[k]
                    band[r - 3, 0] += own * l * omega * decay
                    for m in range(k + 1):
                        band[r - 3, k - m] += (c * lean * lean + theta * kb) * grad_b[k] * grad_b[m]
                    for m in range(3):
                        band[r, 3 + k - m] -= c * lean * grad_t[k] * grad_b[m]


@compiled
def hold_bounds(plan, gradient, band, slope, held, limit, par, reach):
    """Projection: hold the velocities within `reach` of a bound that the gradient pushes against.

    Fills slope, the gradient in u, and held; adds a stiff spring to the band for each held velocity.
    Returns the projected gradient's largest component, as a velocity (m/s).
    """
    spring = 1e7 * par[CURVATURE] / par[DT] ** 2
    residual = 0.0
    for k in range(3):
        total = 0.0
        for i in range(plan.shape[0] - 1, -1, -1):
            r = 3 * i + k
            total += gradient[r] * par[DT]
            slope[i, k] = total
            u = plan[i, k]
            target = min(max(u - total / par[CURVATURE], -limit[k]), limit[k])
            residual = max(residual, abs(u - target))
            held[i, k] = (u >= limit[k] - reach and total < 0.0) or (u <= reach - limit[k] and total > 0.0)
            if held[i, k]:
                band[r, 0] += spring
                if i > 0:
                    band[r - 3, 0] += spring
                    band[r, 3] -= spring
    return residual


@compiled
def banded_solve(band, factor, gradient, step):
    """Banded Cholesky: step = -H^-1 gradient. Returns False when H is not positive definite."""
    size = band.shape[0]
    for r in range(size):
        for k in range(min(r, BAND - 1), -1, -1):
            c = r - k
            s = band[r, k]
            for m in range(max(0, r - BAND + 1), c):
                s -= factor[r, r - m] * factor[c, c - m]
            if k > 0:
                factor[r, k] = s / factor[c, 0]
            elif s > 1e-9:
                factor[r, 0] = np.sqrt(s)
            else:
                return False
    for r in range(size):
        s = -gradient[r]
        for m in range(max(0, r - BAND + 1), r):
            s -= factor[r, r - m] * step[m]
        step[r] = s / factor[r, 0]
    for r in range(size - 1, -1, -1):
        s = step[r]
        for m in range(r + 1, min(size, r + BAND)):
            s -= factor[m, m - r] * step[m]
        step[r] = s / factor[r, 0]
    return True


@compiled
def prune(position, obstacles, n, limit, par, stages, kept):
    """Fill `kept` with the obstacles that can bind within the horizon; returns their number.

    Exact: a row holds for every velocity in the box when gamma D^2 - 2 s D + s^2 - gamma R^2 - sigma >= 0 at
    every distance D that can be reached, with s the longest relative step; a plane's where gamma h - s - sigma >= 0.
    """
    gamma = 1.0 - par[DECAY]
    reach = par[DT] * np.sqrt(limit[0] ** 2 + limit[1] ** 2 + limit[2] ** 2)
    count = 0
    for j in range(n):
        square = 0.0
        speed = 0.0
        for k in range(3):
            square += (position[k] - obstacles[j, k]) ** 2
            speed += obstacles[j, 4 + k] ** 2
        step = reach + par[DT] * np.sqrt(speed)
        if obstacles[j, FLAT] != 0.0:
            h = -obstacles[j, 3]
            for k in range(3):
                h += obstacles[j, 8 + k] * (position[k] - obstacles[j, k])
            if gamma * (h - (stages - 2) * step) < step + obstacles[j, 7]:
                kept[count] = j
                count += 1
            continue
        rest = step * step - gamma * obstacles[j, 3] ** 2 - obstacles[j, 7]
        discriminant = step * step - gamma * rest
        if discriminant < 0.0:
            continue
        if np.sqrt(square) - (stages - 2) * step < (step + np.sqrt(discriminant)) / gamma:
            kept[count] = j
            count += 1
    return count


@compiled
def shortcut(position, desired, obstacles, kept, count, gains, limit, par, plan, path):
    """The optimum without obstacles, u_i = gains_i desired; True where it is also the optimum with them."""
    stages = plan.shape[0]
    for k in range(3):
        path[0, k] = position[k]
        for i in range(stages):
            plan[i, k] = gains[i] * desired[k]
            if abs(plan[i, k]) > limit[k]:
                return False
    roll_out(plan, path, par[DT])
    for q in range(count):
        j = kept[q]
        h = barrier(path, 0, obstacles, j, par[DT])
        for i in range(stages - 1):
            h_next = barrier(path, i + 1, obstacles, j, par[DT])
            if h_next - obstacles[j, 7] < par[DECAY] * h:
                return False
            h = h_next
    return True


@compiled
def true_cost(plan, path, desired, obstacles, kept, count, par):
    """Cost with the best omega for each row, and the largest violation of a row (m^2).

    Where h(x_i) < 0 a larger omega pays for any row, so only rows with b >= 0 can be violated.
    """
    cost = tracking_cost(plan, desired, par)
    violation = 0.0
    for q in range(count):
        j = kept[q]
        h = barrier(path, 0, obstacles, j, par[DT])
        for i in range(plan.shape[0] - 1):
            h_next = barrier(path, i + 1, obstacles, j, par[DT])
            t = h_next - obstacles[j, 7]
            b = par[DECAY] * h
            if b > -1e-9:
                violation = max(violation, -t)
            if b > 1e-9:
                cost += par[P_OMEGA] * (min(1.0, max(0.0, t / b)) - 1.0) ** 2
            elif b < -1e-9 and t < b:
                cost += par[P_OMEGA] * ((t - b) / b) ** 2
            h = h_next
    return cost, violation


@compiled
def descend(position, desired, obstacles, kept, count, plan, multipliers, limit, par, base, cap):
    """Projected Newton inside, multiplier updates outside, from `plan`, which becomes the answer.

    Returns (status, Newton steps, cost, violation).
    """
    stages = plan.shape[0]
    size = 3 * stages
    dt = par[DT]
    path = np.empty((stages + 1, 3))
    trial_path = np.empty((stages + 1, 3))
    trial = np.empty((stages, 3))
    slope = np.empty((stages, 3))
    held = np.empty((stages, 3), np.bool_)
    band = np.empty((size, BAND))
    factor = np.empty((size, BAND))
    gradient = np.empty(size)
    step = np.empty(size)
    updated = np.empty((count, stages - 1))
    for k in range(3):
        path[0, k] = position[k]
        trial_path[0, k] = position[k]
        for i in range(stages):
            plan[i, k] = min(max(plan[i, k], -limit[k]), limit[k])
    roll_out(plan, path, dt)
    status = CAPPED
    steps = 0
    inner = 0.3  # m/s: how small a step must be before the multipliers are updated; tightened each time
    residual = 1.0
    first_theta = 1.0
    while steps < cap:
        value = merit(plan, path, desired, obstacles, kept, count, multipliers, par)
        while steps < cap:
            steps += 1
            theta = first_theta
            while True:  # less of the rows' curvature until the Hessian is positive definite
                merit_derivatives(
                    plan, path, desired, obstacles, kept, count, multipliers, par, base,
                    band, gradient, updated, theta,
                )  # fmt: skip
                residual = hold_bounds(plan, gradient, band, slope, held, limit, par, min(1e-3, residual))
                if banded_solve(band, factor, gradient, step) or theta <= 0.0:
                    break
                theta -= 0.5
            scale = 1.0
            while True:  # Armijo's rule along the projected step
                promised = 0.0
                longest = 0.0
                for i in range(stages):
                    for k in range(3):
                        if held[i, k]:
                            du = (limit[k] if slope[i, k] < 0.0 else -limit[k]) - plan[i, k]
                        else:
                            du = (step[3 * i + k] - (step[3 * i + k - 3] if i > 0 else 0.0)) / dt
                        u = min(max(plan[i, k] + scale * du, -limit[k]), limit[k])
                        trial[i, k] = u
                        promised += slope[i, k] * (u - plan[i, k])
                        longest = max(longest, abs(u - plan[i, k]))
                roll_out(trial, trial_path, dt)
                reached = merit(trial, trial_path, desired, obstacles, kept, count, multipliers, par)
                if reached <= value + 1e-4 * promised + 1e-9 or scale < 0.003:
                    break
                scale *= 0.5
            failed = not reached <= value + 1e-9
            if not failed:
                plan[:, :] = trial
                path[:, :] = trial_path
                value = reached
            elif theta <= 0.0:
                break
            if scale == 1.0:
                first_theta = 1.0
            elif scale < 0.1:
                first_theta = max(0.0, theta - 0.5)
            if scale == 1.0 and longest < max(STEP_TOLERANCE, inner):
                break
        inner *= 0.03
        merit_derivatives(
            plan, path, desired, obstacles, kept, count, multipliers, par, base, band, gradient, updated, 0.0
        )
        residual = hold_bounds(plan, gradient, band, slope, held, limit, par, 0.0)
        mismatch = 0.0
        for q in range(count):
            for i in range(stages - 1):
                mismatch = max(mismatch, abs(updated[q, i] - multipliers[kept[q], i]) / par[RHO])
                multipliers[kept[q], i] = updated[q, i]
        if mismatch < ROW_TOLERANCE and residual < GRADIENT_TOLERANCE:
            status = OPTIMAL
            if mismatch < ROW_AIM:
                break
        else:
            status = CAPPED
    cost, violation = true_cost(plan, path, desired, obstacles, kept, count, par)
    if violation > ROW_TOLERANCE and status == OPTIMAL:
        status = ELASTIC
    return status, steps, cost, violation


@compiled
def input_is_bad(position, desired, obstacles, n):
    """Whether a number is not finite or absurdly large, or a radius negative."""
    for k in range(3):
        if not (abs(position[k]) < MAGNITUDE and abs(desired[k]) < MAGNITUDE):
            return True
    for j in range(n):
        for k in range(COLUMNS if obstacles[j, FLAT] != 0.0 else 8):
            if not abs(obstacles[j, k]) < MAGNITUDE:
                return True
        if obstacles[j, 3] < 0.0:
            return True
    return False


@compiled
def shift(plan, multipliers, n):
    """Warm start: everything moves one step towards now, the last step is repeated."""
    for i in range(plan.shape[0] - 1):
        for k in range(3):
            plan[i, k] = plan[i + 1, k]
    for j in range(n):
        for i in range(multipliers.shape[1] - 1):
            multipliers[j, i] = multipliers[j, i + 1]


@compiled
def nearest_and_proof(position, obstacles, kept, count, limit, par):
    """The nearest obstacle, its distance, and whether one step provably cannot reach h >= sigma.

    Returns (index or -1, |x - p| - R, of a plane n . (x - p) - R, proven).
    """
    dt = par[DT]
    nearest = -1
    gap = 1e300
    proven = False
    for q in range(count):
        j = kept[q]
        now = 0.0
        farthest = 0.0
        if obstacles[j, FLAT] != 0.0:
            now = -obstacles[j, 3]
            farthest = -obstacles[j, 3]
            for k in range(3):
                n_k = obstacles[j, 8 + k]
                d = position[k] - obstacles[j, k]
                now += n_k * d
                farthest += n_k * (d - dt * obstacles[j, 4 + k]) + abs(n_k) * limit[k] * dt
            if now < gap:
                gap = now
                nearest = j
            if par[DECAY] * now >= 0.0 and farthest < obstacles[j, 7] - ROW_TOLERANCE:
                proven = True
            continue
        for k in range(3):
            d = position[k] - obstacles[j, k]
            now += d * d
            farthest += (abs(d - dt * obstacles[j, 4 + k]) + limit[k] * dt) ** 2
        square = obstacles[j, 3] ** 2
        if np.sqrt(now) - obstacles[j, 3] < gap:
            gap = np.sqrt(now) - obstacles[j, 3]
            nearest = j
        if par[DECAY] * (now - square) >= 0.0 and farthest - square < obstacles[j, 7] - ROW_TOLERANCE:
            proven = True
    return nearest, gap, proven


@compiled
def solve(position, desired, obstacles, n, plan, multipliers, warm, limit, par, base, gains, cap):
    """One tick. plan and multipliers are the last tick's when warm, and hold this tick's on return.

    base is the tracking cost's Hessian in x_1..x_{N+1}, lower band, (3(N+1), BAND): base[r, k] couples r and
    r - k. gains: (N+1,), see shortcut. cap: Newton steps for each start.

    Returns (status, Newton steps, cost, violation (m^2), index of the binding obstacle or -1).
    """
    stages = plan.shape[0]
    if input_is_bad(position, desired, obstacles, n):
        plan[:, :] = 0.0
        multipliers[:n, :] = 0.0
        return BAD_INPUT, 0, np.nan, np.nan, -1
    kept = np.empty(n, np.int64)
    count = prune(position, obstacles, n, limit, par, stages, kept)
    path = np.empty((stages + 1, 3))
    candidate = np.empty((stages, 3))
    if shortcut(position, desired, obstacles, kept, count, gains, limit, par, candidate, path):
        plan[:, :] = candidate
        multipliers[:n, :] = 0.0
        return SHORTCUT, 0, tracking_cost(plan, desired, par), 0.0, -1
    if warm:
        shift(plan, multipliers, n)
    else:
        multipliers[:n, :] = 0.0
        for i in range(stages):
            for k in range(3):
                plan[i, k] = gains[i] * desired[k]
    nearest, gap, proven = nearest_and_proof(position, obstacles, kept, count, limit, par)
    start = plan.copy()
    y_start = multipliers[:n].copy()
    y = np.zeros((n, stages - 1))
    multipliers[:n, :] = 0.0
    status, cost, violation, steps = CAPPED, 0.0, 1e300, 0
    # A start along the old plan may tunnel through an obstacle that the robot is inside of: then, and after
    # a start that did not succeed, start straight away from the nearest obstacle.
    for away in range(1 if proven or gap <= 0.0 else 0, 2):
        if away == 0:
            candidate[:, :] = start
            for q in range(count):
                y[kept[q], :] = y_start[kept[q], :]
        else:
            y[:, :] = 0.0
            length = gap + obstacles[nearest, 3]
            flat = obstacles[nearest, FLAT] != 0.0
            for i in range(stages):
                for k in range(3):
                    outward = position[k] - obstacles[nearest, k]
                    toward = outward / length if length > 1e-9 else (1.0 if k == 2 else 0.0)
                    if flat:
                        toward = obstacles[nearest, 8 + k]
                    candidate[i, k] = 0.6 * limit[k] * toward
        s, used, f, v = descend(
            position, desired, obstacles, kept, count, candidate, y, limit, par, base, cap
        )
        steps += used
        if v < violation - 1e-6 or (v < violation + 1e-6 and f < cost):
            status, cost, violation = s, f, v
            plan[:, :] = candidate
            multipliers[:n, :] = y
        if s == OPTIMAL or proven or nearest < 0:
            break
    if proven:
        status = INFEASIBLE
    binding = -1
    heaviest = 0.0
    for j in range(n):
        for i in range(stages - 1):
            if multipliers[j, i] > heaviest:
                heaviest = multipliers[j, i]
                binding = j
    return status, steps, cost, violation, binding

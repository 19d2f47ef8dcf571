"""The compiled kernel's formulas against CasADi's, and its linear algebra against numpy's."""

import casadi
import numpy as np
import pytest
from msgspec import structs

from farhand.common.seeds import stream
from farhand.operator_side.control import barrier as rows
from farhand.operator_side.control import newton_kernel as kernel
from farhand.operator_side.control.controller import ControlProblem
from farhand.operator_side.control.newton import kernel_parameters, tracking_hessian
from farhand.operator_side.control.settings import ControllerSettings
from farhand.operator_side.control.statement import barrier, tracking_cost
from farhand.operator_side.control.tracking import tracking_cost as numpy_tracking_cost
from farhand.operator_side.control.tracking import unconstrained_gains

SETTINGS = ControllerSettings()
N = SETTINGS.horizon
COUNT = 4


def symbolic_row(t, b, y, par):
    """barrier_row's value, branch by branch, for CasADi to differentiate."""
    twice, rho = 2 * par[kernel.P_OMEGA], par[kernel.RHO]
    price = casadi.if_else(
        b > 0,
        casadi.fmin(casadi.fmax(twice / casadi.fmax(b, 1e-12), par[kernel.PRICE]), par[kernel.PRICE_MAX]),
        par[kernel.PRICE_MAX],
    )
    free = (b - t + y / rho) / (b * b / twice + 1 / rho)
    at_zero = casadi.logic_and(b > 0, 1 - free * b / twice < 0)
    multiplier = casadi.if_else(at_zero, casadi.fmax(twice / casadi.fmax(b, 1e-12), y - rho * t), free)
    omega = casadi.if_else(at_zero, 0, 1 - free * b / twice)
    omega = casadi.if_else(multiplier <= 0, 1, omega)
    multiplier = casadi.fmax(multiplier, 0)
    omega = casadi.if_else(multiplier >= price, casadi.fmax(0, 1 - price * b / twice), omega)
    multiplier = casadi.fmin(multiplier, price)
    value = par[kernel.P_OMEGA] * (omega - 1) ** 2 + multiplier * (omega * b - t)
    return value - (multiplier - y) ** 2 / (2 * rho)


@pytest.fixture(scope="module")
def reference():
    """CasADi's merit, gradient and Hessian in x_1..x_{N+1}."""
    par = kernel_parameters(SETTINGS)
    x = casadi.SX.sym("x", 3, N + 1)
    start = casadi.SX.sym("start", 3)
    desired = casadi.SX.sym("desired", 3)
    obstacles = casadi.SX.sym("obstacles", kernel.COLUMNS, COUNT)
    y = casadi.SX.sym("y", N, COUNT)
    path = casadi.horzcat(start, x)
    u = (path[:, 1:] - path[:, :-1]) / SETTINGS.period
    merit = tracking_cost(u, desired, SETTINGS)
    for j in range(COUNT):
        for i in range(N):
            t = barrier(path[:, i + 1], i + 1, obstacles[:, j], SETTINGS.period) - obstacles[7, j]
            b = (1 - SETTINGS.gamma) * barrier(path[:, i], i, obstacles[:, j], SETTINGS.period)
            merit += symbolic_row(t, b, y[i, j], par)
    hessian, gradient = casadi.hessian(merit, casadi.vec(x))
    return casadi.Function(
        "reference", [start, desired, casadi.vec(obstacles), y, x], [merit, gradient, hessian]
    )


def random_case(rng):
    """A plan among obstacles, one of them a plane, some of which it enters, with random multipliers."""
    plan = rng.uniform(-0.3, 0.3, (N + 1, 3))
    position = rng.uniform(-1, 1, 3)
    obstacles = np.zeros((COUNT, kernel.COLUMNS))
    obstacles[:, :3] = position + rng.normal(scale=0.2, size=(COUNT, 3))
    obstacles[:, 3] = rng.uniform(0.05, 0.3, COUNT)
    obstacles[:, 4:7] = rng.uniform(-0.1, 0.1, (COUNT, 3))
    obstacles[:, 7] = rng.uniform(0, 0.02, COUNT)
    normal = rng.normal(size=3)
    obstacles[-1, 8:11], obstacles[-1, kernel.FLAT] = normal / np.linalg.norm(normal), 1.0
    multipliers = np.where(rng.random((COUNT, N)) < 0.5, 0.0, rng.uniform(0, 100, (COUNT, N)))
    path = np.vstack([position, position + SETTINGS.period * np.cumsum(plan, axis=0)])
    return position, rng.uniform(-0.3, 0.3, 3), obstacles, plan, path, multipliers


def planes(rng, n):
    """(n, 3) normals: every second obstacle is a plane that faces the start, more or less."""
    normals = rng.normal(size=(n, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    normals[::2] = 0.0
    return normals


def dense(band):
    size = len(band)
    full = np.zeros((size, size))
    for r in range(size):
        for k in range(min(r, kernel.BAND - 1) + 1):
            full[r, r - k] = full[r - k, r] = band[r, k]
    return full


def test_merit_gradient_and_hessian_are_casadis(reference):
    par = kernel_parameters(SETTINGS)
    base = tracking_hessian(SETTINGS)
    rng = stream(5, "kernel", "derivatives")
    kept = np.arange(COUNT)
    active = 0
    for _ in range(50):
        position, desired, obstacles, plan, path, multipliers = random_case(rng)
        band = np.empty_like(base)
        gradient = np.empty(3 * (N + 1))
        updated = np.empty((COUNT, N))
        kernel.merit_derivatives(
            plan, path, desired, obstacles, kept, COUNT, multipliers, par, base, band, gradient, updated, 1.0
        )
        value = kernel.merit(plan, path, desired, obstacles, kept, COUNT, multipliers, par)
        expected = reference(position, desired, obstacles.ravel(), multipliers.T, path[1:].T)
        merit, slope, curvature = (np.array(e) for e in expected)
        active += int((updated > 0).sum())
        assert value == pytest.approx(merit.item(), rel=1e-9)
        assert np.abs(gradient - slope.ravel()).max() <= 1e-9 * np.abs(slope).max()
        assert np.abs(dense(band) - curvature).max() <= 1e-9 * np.abs(curvature).max()
    assert active > 500  # else the rows were not tested


def test_every_branch_of_a_row_is_least_over_its_weight_and_slack():
    """barrier_row's value is that of a brute-force search over omega and the slack."""
    par = kernel_parameters(SETTINGS)
    rho, p_omega = par[kernel.RHO], par[kernel.P_OMEGA]
    omega = np.linspace(0, 6, 600_001)
    for t, b, y in [
        (0.01, 0.03, 0.0),
        (-0.001, 0.03, 5.0),
        (0.02, 0.01, 3000.0),
        (-0.02, -0.01, 0.0),
        (0.0, 0.0, 4.0),
    ]:
        price = (
            np.clip(2 * p_omega / b, par[kernel.PRICE], par[kernel.PRICE_MAX])
            if b > 0
            else par[kernel.PRICE_MAX]
        )
        # least over the slack in closed form: a quadratic up to the price, a straight line beyond it
        multiplier = np.clip(y + rho * (omega * b - t), 0.0, price)
        values = p_omega * (omega - 1) ** 2 + multiplier * (omega * b - t) - (multiplier - y) ** 2 / (2 * rho)
        best = int(np.argmin(values))
        _, found, _, _, value = kernel.barrier_row(t, b, y, par)
        assert value == pytest.approx(values[best], abs=1e-5)
        assert found == pytest.approx(omega[best], abs=2e-3)


def test_banded_solve_is_numpys_and_refuses_an_indefinite_matrix():
    rng = stream(6, "kernel", "cholesky")
    base = tracking_hessian(SETTINGS)
    size = len(base)
    gradient = rng.normal(size=size)
    step = np.empty(size)
    assert kernel.banded_solve(base, np.empty_like(base), gradient, step)
    assert np.allclose(step, -np.linalg.solve(dense(base), gradient), rtol=1e-9, atol=1e-12)
    base[7, 0] = -1.0
    assert not kernel.banded_solve(base, np.empty_like(base), gradient, step)


def test_tracking_cost_is_one_in_all_three_places():
    rng = stream(7, "kernel", "cost")
    settings = structs.replace(SETTINGS, q=3.0, r=0.5, p=7.0, s=2.0)
    plan = rng.normal(size=(N + 1, 3))
    desired = rng.normal(size=3)
    one = kernel.tracking_cost(plan, desired, kernel_parameters(settings))
    assert one == pytest.approx(numpy_tracking_cost(plan, desired, settings), rel=1e-12)
    assert one == pytest.approx(
        float(tracking_cost(casadi.DM(plan.T), casadi.DM(desired), settings)), rel=1e-12
    )
    assert numpy_tracking_cost(np.outer(unconstrained_gains(settings), desired), desired, settings) < one


def test_pruning_is_exact_and_alike_in_both_places():
    """No plan within the limits can violate a row of a dropped obstacle, and something is dropped."""
    rng = stream(8, "kernel", "prune")
    par = kernel_parameters(SETTINGS)
    limit = np.array(SETTINGS.speed_limit)
    dropped = kept_some = 0
    for _ in range(200):
        n = 6
        problem = ControlProblem(
            np.zeros(3),
            np.zeros(3),
            rng.normal(scale=0.7, size=(n, 3)),
            rng.uniform(0.05, 0.4, n),
            rng.uniform(-0.2, 0.2, (n, 3)),
            rng.uniform(0, 0.05, n),
            planes(rng, n),
        )
        table = np.column_stack(
            [
                problem.centres,
                problem.radii,
                problem.velocities,
                problem.sigmas,
                problem.normals,
                problem.flat,
            ]
        )
        kept = np.empty(n, np.int64)
        count = kernel.prune(problem.position, table, n, limit, par, N + 1, kept)
        mask = rows.can_bind(problem, SETTINGS)
        assert list(np.flatnonzero(mask)) == list(kept[:count])
        dropped += n - count
        kept_some += count
        far = rows.subset(problem, ~mask)
        toward = far.centres / np.linalg.norm(far.centres, axis=1, keepdims=True)
        toward = np.where(far.flat[:, None] != 0.0, -far.normals, toward)
        for j in range(len(far.radii)):
            late = rng.integers(0, N)
            plan = np.where(np.arange(N)[:, None] < late, 0.0, np.sign(toward[j])) * limit
            assert rows.all_hold(far, plan, SETTINGS)
    assert dropped > 100
    assert kept_some > 100

"""Stacks of every kind of wish, drawn at random and made to be difficult: exact, and eq. 7.

How exact depends on what a float can hold. A row is a sum of weights times coordinates, and each
coordinate is rounded: to half of 1.2e-7 of its size in float32, of 2.2e-16 in float64. So a row is
met to 1e-6 m (1e-12 m), or, where its weights and coordinates add up to more than 10 m (1000 m),
to 1e-7 (1e-15) of that sum. Rows that nearly imply each other, at a condition number above 1000,
add to that what the rounding of their own targets makes of them: 1e-15 times the condition number.

Two oracles: the dense formula of eq. 7, and LAPACK's least squares, which never forms the matrix S
and so keeps its digits where rows are nearly dependent and the dense formula loses them.
"""

import warnings

import numpy as np
import torch
from hypothesis import assume, given, settings
from hypothesis import strategies as st

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.projection import NearlyDependentRows
from projflow_lite.skeleton import EDGES, N_JOINTS

FRAMES = 5
D = FRAMES * N_JOINTS * 3
CAMERA = pf.Orthographic(pitch=20, yaw=-30, roll=5, scale=1.1)
L = equations.kinematic_laplacian(EDGES, N_JOINTS)
R = equations.kinematic_metric(FRAMES, L, 10.0, 1.0)


def somewhere(random, size):
    """A motion that ends in the pose and at the height in which it began, `size` metres wide."""
    x = size * random.normal(size=(FRAMES, N_JOINTS, 3))
    x[-1] = x[0] + size * np.array([0.7, 0.0, -0.4])
    return x


def frames_of(random, low=0, high=FRAMES):
    return random.choice(np.arange(low, high), random.integers(1, high - low + 1), replace=False)


def joints_of(random, most=4):
    return random.choice(N_JOINTS, random.integers(1, most + 1), replace=False)


def axes_of(random):
    return str(random.choice(["x", "y", "zx", "xyz", "yzx"]))


def columns(axes):
    return ["xyz".index(axis) for axis in axes]


def a_pin(random, x, size):
    n, j, axes = frames_of(random), joints_of(random), axes_of(random)
    std = float(random.choice([0.0, 0.0, 0.05, 0.4]))
    miss = std * random.normal(size=(len(n), len(j), len(axes)))
    return pf.pin(j, n, x[n][:, j][..., columns(axes)] + miss, axes, std)


def an_offset(random, x, size):
    a, b = random.choice(N_JOINTS, 2, replace=False)
    n = frames_of(random)
    return pf.offset(a, b, x[n, a] - x[n, b], frames=n)


def a_loop(random, x, size):
    if random.random() < 0.5:
        return pf.loop(moving=True)
    return pf.loop(joints_of(random), shift=x[-1, 0] - x[0, 0])


def a_lift(random, x, size):
    far = pf.Perspective((0.3, 1.2, 20 * size), 5, 3, 2, 1.7, (0.1, -0.2))
    camera = CAMERA if random.random() < 0.5 else far
    n, j = frames_of(random), int(random.integers(N_JOINTS))
    return pf.lift(camera, j, n, camera.project(x[n, j]))


def a_kept_part(random, x, size):
    return pf.keep(x, joints_of(random, 10), frames_of(random))


def a_velocity(random, x, size):
    n, j = frames_of(random, 0, FRAMES - 1), joints_of(random)
    return pf.velocity(j, n, 20 * (x[n + 1] - x[n])[:, j])


def an_acceleration(random, x, size):
    n, j = frames_of(random, 1, FRAMES - 1), joints_of(random)
    return pf.acceleration(j, n, 400 * (x[n + 1] - 2 * x[n] + x[n - 1])[:, j])


def a_balance(random, x, size):
    n = frames_of(random)
    return pf.centre_of_mass(n, np.einsum("j,njc->nc", pf.skeleton.MASS, x[n]))


def some_rows(random, x, size):
    """Sums of a few coordinates, some of them alike, with weights of very different sizes."""
    A = np.zeros((random.integers(2, 6), D))
    for row in A:
        places = random.choice(D, random.integers(1, 5), replace=False)
        sign = random.choice([-1.0, 1.0], len(places))
        row[places] = sign * random.uniform(0.5, 2, len(places)) * random.choice([0.1, 1.0, 10.0])
    A[-1] = A[0] + 10.0 ** -random.integers(0, 4) * A[-1]
    return pf.rows(A, A @ x.ravel())


def rows_twice_over(random, x, size):
    """What others imply: multiples and sums of them."""
    A = pf.loop("head").rows(FRAMES).A.toarray()
    A = np.vstack([A, 3 * A[:1], A[1:2] - 2 * A[2:]])
    return pf.rows(A, A @ x.ravel())


KINDS = (
    a_pin, an_offset, a_loop, a_lift, a_kept_part, a_velocity, an_acceleration, a_balance,
    some_rows, rows_twice_over,
)  # fmt: skip


def stack(seed, kinds, size):
    """One wish of the given kinds, which one motion fulfils, and another motion to start from."""
    random = np.random.default_rng(seed)
    x = somewhere(random, size)
    wish = kinds[0](random, x, size)
    for kind in kinds[1:]:
        wish = wish & kind(random, x, size)
    return wish, size * random.normal(size=(FRAMES, N_JOINTS, 3))


def projector(rows, dtype):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NearlyDependentRows)
        return pf.Projector(rows, dtype=dtype)


def allowed(rows, x, dtype, condition):
    """How far each row may be from its target, metres: see the top of this file."""
    least, share = {torch.float32: (1e-6, 1e-7), torch.float64: (1e-12, 1e-15)}[dtype]
    size = abs(rows.A) @ np.abs(x.ravel()) + np.abs(rows.y)
    return np.maximum(least, share * size) + 1e-15 * size * (condition if condition > 1e3 else 0)


def least_squares(rows, x):
    """Eq. 6 as LAPACK solves it: the shortest (C^-1 move, noise / std) that meets every row."""
    C = np.linalg.cholesky(np.linalg.inv(R))
    whole = np.hstack([rows.A.toarray() @ C, np.diag(np.sqrt(rows.variance))])
    length = np.linalg.norm(whole, axis=1)
    missing = (rows.y - rows.A @ x.ravel()) / length
    shortest = np.linalg.lstsq(whole / length[:, None], missing, rcond=1e-13)[0]
    return x + (C @ shortest[:D]).reshape(x.shape)


STACKS = {
    "seed": st.integers(0, 10**6),
    "kinds": st.lists(st.sampled_from(KINDS), min_size=1, max_size=5),
    "size": st.sampled_from([0.01, 1.0, 1.0, 30.0]),
}
PRECISIONS = st.sampled_from([torch.float32, torch.float64])


@settings(max_examples=100)
@given(**STACKS, dtype=PRECISIONS)
def test_every_stack_is_met_and_its_pins_are_bit_exact(seed, kinds, size, dtype):
    wish, x = stack(seed, kinds, size)
    rows = wish.rows(FRAMES)
    projection = projector(rows, dtype)
    y = projection.project(torch.as_tensor(x, dtype=dtype))
    z = y.numpy().astype(np.float64)
    miss, hard = np.abs(rows.A @ z.ravel() - rows.y), rows.variance == 0
    assert (miss <= allowed(rows, z, dtype, projection.condition))[hard].all(), (
        miss[hard].max(), projection.condition,
    )  # fmt: skip
    pins = np.flatnonzero(hard & pf.constraints.is_coordinate(rows.A))
    wanted = torch.as_tensor(rows.y[pins], dtype=dtype)
    found = y.flatten()[rows.A.indices[rows.A.indptr[pins]]]
    assert torch.equal(found, wanted)


@settings(max_examples=50)
@given(**STACKS)
def test_every_stack_is_projected_as_both_oracles_say(seed, kinds, size):
    wish, x = stack(seed, kinds, size)
    rows = wish.rows(FRAMES)
    projection = projector(rows, torch.float64)
    z = projection.project(torch.as_tensor(x)).numpy()
    close = 1e-9 * max(1.0, size)
    np.testing.assert_allclose(z, least_squares(rows, x), atol=close, rtol=0)
    if projection.condition < 300:  # beyond, the dense formula's own rounding passes 1e-9
        Sigma = np.diag(rows.variance)
        dense = equations.project(x.ravel(), rows.A.toarray(), rows.y, R, Sigma)
        np.testing.assert_allclose(z.ravel(), dense, atol=close, rtol=0)


@settings(max_examples=100)
@given(**STACKS, dtype=PRECISIONS, by=st.sampled_from([1e-3, 0.1, -5.0]))
def test_one_wrong_target_is_either_met_or_refused(seed, kinds, size, dtype, by):
    wish, x = stack(seed, kinds, size)
    rows = wish.rows(FRAMES)
    hard = rows.variance == 0
    assume(hard.any())
    rows.y[np.random.default_rng(seed).choice(np.flatnonzero(hard))] += by
    try:
        projection = projector(rows, dtype)
    except ValueError as error:
        refusal = str(error)
    else:
        refusal = None
    if refusal is not None:
        assert "contradict" in refusal
        assert np.linalg.matrix_rank(rows.A[hard].toarray(), 1e-9) < hard.sum()
        return
    z = projection.project(torch.as_tensor(x, dtype=dtype)).numpy().astype(np.float64)
    miss = np.abs(rows.A @ z.ravel() - rows.y)
    assert (miss <= allowed(rows, z, dtype, projection.condition))[hard].all()

"""The fast projection against the dense formula, and against what must hold whatever the formula."""

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.constraints import Rows
from projflow_lite.projection import kinematic_joint_metric
from projflow_lite.skeleton import EDGES

FRAMES = 6
D = FRAMES * 66


def random_wish(seed, std=0.0):
    """A pin on some joints, frames and axes, an offset elsewhere, and sometimes a loop."""
    random = np.random.default_rng(seed)
    joints = random.choice(19, random.integers(1, 4), replace=False).tolist()
    frames = random.choice(FRAMES - 1, random.integers(1, FRAMES), replace=False)
    axes = random.choice(["x", "xz", "xyz"])
    shape = (len(frames), len(joints), len(axes))
    wish = pf.pin(joints, frames, random.normal(size=shape), axes=str(axes), std=std)
    wish = wish & pf.offset("left_wrist", "right_wrist", random.normal(size=3))
    return wish & pf.loop() if random.random() < 0.5 else wish


def dense_projection(x, rows, w_kin=10.0, ridge=1.0):
    L = equations.kinematic_laplacian(EDGES, 22)
    R = equations.kinematic_metric(FRAMES, L, w_kin, ridge)
    return equations.project(x.ravel(), rows.A.toarray(), rows.y, R, np.diag(rows.variance))


@settings(max_examples=25)
@given(seed=st.integers(0, 10_000), std=st.sampled_from([0.0, 0.01, 0.3]))
def test_equal_to_the_dense_formula(seed, std):
    rows = random_wish(seed, std).rows(FRAMES)
    x = np.random.default_rng(seed + 1).normal(size=(FRAMES, 22, 3))
    fast = pf.Projector(rows, dtype=torch.float64).project(torch.as_tensor(x))
    np.testing.assert_allclose(fast.numpy().ravel(), dense_projection(x, rows), atol=1e-9)


@settings(max_examples=25)
@given(
    seed=st.integers(0, 10_000),
    dtype=st.sampled_from([torch.float32, torch.float64]),
    share=st.sampled_from([1, 2, 5, 0.25, 1.0]),
    joints=st.sampled_from([["left_wrist"], ["pelvis", "head", "right_foot"]]),
)
def test_hard_rows_hold_and_pins_are_bit_exact(seed, dtype, share, joints):
    random = np.random.default_rng(seed)
    total = 60
    count = share if isinstance(share, int) else round(share * total)
    frames = random.choice(total, count, replace=False)
    target = random.normal(size=(count, len(joints), 3))
    x = torch.as_tensor(random.normal(size=(2, total, 22, 3)), dtype=dtype)
    wish = pf.pin(joints, frames, target) & pf.offset("left_elbow", "right_elbow", [0.4, 0, 0])
    z = pf.Projector(wish.rows(total), dtype=dtype).project(x)
    assert wish.residual(z.numpy()) <= (1e-12 if dtype == torch.float64 else 1e-6)
    index = [pf.skeleton.joint_index(joint) for joint in joints]
    assert torch.equal(
        z[:, frames][:, :, index], torch.as_tensor(target, dtype=dtype).expand(2, -1, -1, -1)
    )


@pytest.mark.parametrize("metric", ["kinematic", "euclidean", kinematic_joint_metric(3.0, 0.5)])
def test_no_feasible_direction_is_orthogonally_shorter(metric):
    """Optimality without the formula: the correction is R-orthogonal to every allowed direction."""
    rows = random_wish(3).rows(FRAMES)
    x = torch.randn(FRAMES, 22, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    move = (pf.Projector(rows, metric, torch.float64).project(x) - x).numpy()
    known = {"kinematic": kinematic_joint_metric(), "euclidean": np.eye(22)}
    R_J = known[metric] if isinstance(metric, str) else metric
    pull = np.einsum("jk,nkc->njc", R_J, move).ravel()
    free = np.eye(D) - np.linalg.pinv(rows.A.toarray()) @ rows.A.toarray()
    assert np.abs(free @ pull).max() < 1e-10


def test_projecting_twice_changes_nothing_and_a_batch_is_its_members():
    rows = random_wish(5).rows(FRAMES)
    projector = pf.Projector(rows, dtype=torch.float64)
    x = torch.randn(3, FRAMES, 22, 3, dtype=torch.float64)
    once = projector.project(x)
    torch.testing.assert_close(projector.project(once), once, atol=1e-13, rtol=0)
    torch.testing.assert_close(projector.project(x[1]), once[1], atol=1e-13, rtol=0)


def test_pulling_a_wrist_takes_the_arm_along():
    """Known answer at w = 10, ridge = 1: how far the rest follows a wrist moved by one metre."""
    x = torch.zeros(1, 22, 3, dtype=torch.float64)
    moved = pf.Projector(pf.pin("left_wrist", 0, [1, 0, 0]).rows(1), dtype=torch.float64).project(x)
    for joint, share in (("left_elbow", 0.71), ("left_shoulder", 0.49), ("pelvis", 0.05)):
        assert moved[0, pf.skeleton.joint_index(joint), 0].item() == pytest.approx(share, abs=0.005)
    assert moved[..., 1:].abs().max() < 1e-15


def test_repeated_and_implied_rows_are_fine():
    wish = pf.pin("head", [1, 1, 4], [[1, 2, 3], [1, 2, 3], [1, 2, 3]]) & pf.loop()
    ends = pf.pin("pelvis", [0, FRAMES - 1], np.ones((2, 3)))
    z = pf.Projector((wish & ends).rows(FRAMES), dtype=torch.float64).project(
        torch.randn(FRAMES, 22, 3).double()
    )
    assert (wish & ends).residual(z.numpy()) < 1e-12


def test_contradictions_are_named():
    def message(wish):
        with pytest.raises(ValueError, match="contradict") as caught:
            pf.Projector(wish.rows(FRAMES))
        return str(caught.value)

    twice = pf.pin("left_wrist", [3, 3], [[0.10, 1, 2], [0.25, 1, 2]])
    assert (
        message(twice)
        == "rows 0 and 3 contradict each other: left_wrist, frame 3, x = 0.1 and 0.25"
    )
    ends = pf.pin("pelvis", [0, FRAMES - 1], [[0, 1, 0], [0, 1, 2]])
    assert "pelvis, frame 5, z" in message(ends & pf.loop())


def test_gradients_flow_and_agree_with_finite_differences():
    projector = pf.Projector(pf.pin("head", 1, [1, 2, 3], std=0.2).rows(2), dtype=torch.float64)
    x = torch.randn(1, 2, 22, 3, dtype=torch.float64, requires_grad=True)
    assert torch.autograd.gradcheck(projector.project, (x,))


def test_one_factorisation_serves_targets_of_every_motion_of_a_batch():
    wish = pf.pin("head", [1, 3], np.zeros((2, 3))) & pf.offset("neck", "head", [0, -0.1, 0])
    targets = np.random.default_rng(0).normal(size=(4, 6))
    rows = wish.rows(FRAMES)
    y = np.concatenate([targets, np.tile(rows.y[6:], (4, 1))], axis=1)
    x = torch.randn(4, FRAMES, 22, 3, dtype=torch.float64)
    together = pf.Projector(rows, dtype=torch.float64).aimed_at(y).project(x)
    for k in range(4):
        alone = pf.Projector(rows._replace(y=y[k]), dtype=torch.float64).project(x[k])
        torch.testing.assert_close(together[k], alone, atol=1e-13, rtol=0)
    with pytest.raises(ValueError, match=r"expected \(\.\.\., 24\) finite targets"):
        pf.Projector(rows).aimed_at(np.zeros(5))


def test_no_rows_leave_a_motion_alone():
    x = torch.randn(2, 22, 3)
    empty = Rows(sparse.csr_matrix((0, 132)), np.zeros(0), np.zeros(0))
    torch.testing.assert_close(pf.Projector(empty).project(x), x)


def wrong_rows(**change):
    A = sparse.csr_matrix(np.eye(1, 132))
    return Rows(**({"A": A, "y": np.zeros(1), "variance": np.zeros(1)} | change))


WRONG = [
    (lambda: pf.Projector(wrong_rows(y=np.zeros(2))), "Projector: 1 rows, but y (2,) and variance (1,)"),
    (lambda: pf.Projector(wrong_rows(A=sparse.csr_matrix(np.eye(1, 100)))), "Projector: A has 100 columns, not a multiple of 66"),
    (lambda: pf.Projector(wrong_rows(y=np.array([np.nan]))), "Projector: A, y and variance must be finite"),
    (lambda: pf.Projector(wrong_rows(variance=np.array([-1.0]))), "Projector: row 0 has a negative variance"),
    (lambda: pf.Projector(wrong_rows(A=sparse.csr_matrix((1, 132)))), "Projector: row 0 of A is zero"),
    (lambda: pf.Projector(wrong_rows(), "kinetic"), "Projector: metric is one of kinematic, euclidean, not 'kinetic'"),
    (lambda: pf.Projector(wrong_rows(), np.eye(21)), "Projector: a metric is a symmetric (22, 22) matrix"),
    (lambda: pf.Projector(wrong_rows(), -np.eye(22)), "Projector: the metric is not positive definite"),
    (lambda: pf.Projector(wrong_rows()).project(torch.zeros(3, 22, 3)), "Projector: expected shape (..., 2, 22, 3), got (3, 22, 3)"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_rows_are_refused_in_one_line(make, message):
    with pytest.raises(ValueError, match=".") as caught:
        make()
    assert str(caught.value) == message

"""The fast projection against the dense formula, and against what must hold whatever the formula."""

import warnings

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import sparse
from torch.utils._python_dispatch import TorchDispatchMode

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.constraints import Rows
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.projection import NearlyDependentRows
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


SMALL = (
    pf.pin("head", 1, [1, 2, 3], std=0.2) & pf.pin("neck", [0, 1], np.ones((2, 1)), axes="y")
    & pf.offset("left_wrist", "right_wrist", [0.3, 0, 0], frames=[1])
)  # fmt: skip


def test_gradients_agree_with_finite_differences():
    """With respect to the motion, the targets and the variances: of hard and of soft rows."""
    rows = SMALL.rows(2)
    projector = pf.Projector(rows, dtype=torch.float64)
    random = torch.Generator().manual_seed(0)
    x = torch.randn(2, 22, 3, dtype=torch.float64, generator=random)
    y, variance = torch.tensor(rows.y), torch.tensor(rows.variance)
    soft = variance[:3].clone()
    for tensor in (x, y, soft):
        tensor.requires_grad_()

    def of_motion(x):
        return projector.project(x)[:, [15, 12, 20, 0]]

    def of_targets(y):
        return projector.aimed_at(y).project(x.detach())[:, [15, 12, 20]]

    def of_variances(soft):
        return projector.project(x.detach(), torch.cat([soft, variance[3:]]))[:, [15, 12, 20]]

    assert torch.autograd.gradcheck(of_motion, (x,))
    assert torch.autograd.gradcheck(of_targets, (y,))
    assert torch.autograd.gradcheck(of_variances, (soft,))


def test_a_pin_passes_on_its_target_and_nothing_else():
    """Known derivatives: a pinned coordinate is its target, whatever the motion was."""
    projector = pf.Projector(pf.pin("head", 0, [1, 2, 3]).rows(1), dtype=torch.float64)
    x = torch.zeros(1, 22, 3, dtype=torch.float64, requires_grad=True)
    y = torch.ones(3, dtype=torch.float64, requires_grad=True)
    head = projector.aimed_at(y).project(x)[0, 15].sum()
    of_x, of_y = torch.autograd.grad(head, (x, y))
    assert not of_x.any()
    torch.testing.assert_close(of_y, torch.ones_like(y))


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


def test_a_variance_of_infinity_leaves_a_row_out_and_zero_makes_it_hard():
    x = torch.randn(2, 22, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    rows = SMALL.rows(2)
    variance = torch.tensor(rows.variance)
    without = Rows(rows.A[3:], rows.y[3:], rows.variance[3:])
    variance[:3] = torch.inf
    left_out = pf.Projector(rows, dtype=torch.float64).project(x, variance)
    torch.testing.assert_close(left_out, pf.Projector(without, dtype=torch.float64).project(x))
    variance[:3] = 0.0
    hard = pf.Projector(rows, dtype=torch.float64).project(x, variance)
    torch.testing.assert_close(hard[1, 15], torch.tensor([1.0, 2.0, 3.0], dtype=torch.float64))


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_soft_rows_that_became_hard_and_imply_each_other_are_refused(dtype):
    wish = pf.offset("left_wrist", "right_wrist", [0.3, 0, 0], frames=[0]) & pf.pin(
        ["left_wrist", "right_wrist"], 0, np.zeros((2, 3)), std=0.1
    )
    projector = pf.Projector(wish.rows(1), dtype=dtype)
    x = torch.zeros(1, 22, 3, dtype=dtype)
    found = projector.project(x, torch.full((9,), 0.01, dtype=dtype))
    assert wish.residual(found.numpy()) < 1e-6
    with pytest.raises(ValueError, match="with variances this small soft rows imply or contradict"):
        projector.project(x, torch.zeros(9, dtype=dtype))


def test_rows_may_be_written_in_any_way():
    """Entries given in two parts, in another layout or as lists are the same rows."""
    rows = SMALL.rows(2)
    half = sparse.coo_matrix(rows.A / 2)
    twice = (np.tile(half.data, 2), (np.tile(half.row, 2), np.tile(half.col, 2)))
    parts = Rows(sparse.coo_matrix(twice, half.shape), list(rows.y), list(rows.variance))
    x = torch.randn(2, 22, 3, generator=torch.Generator().manual_seed(0))
    assert torch.equal(pf.Projector(parts).project(x), pf.Projector(rows).project(x))


def test_no_rows_leave_a_motion_alone():
    x = torch.randn(2, 22, 3)
    empty = Rows(sparse.csr_matrix((0, 132)), np.zeros(0), np.zeros(0))
    torch.testing.assert_close(pf.Projector(empty).project(x), x)


def test_a_pin_that_a_loop_implies_is_bit_exact_too():
    wish = pf.loop("pelvis", shift=[0, 0, 0.1]) & pf.pin(
        "pelvis", [0, 5], [[0, 0.1, 0.2], [0, 0.1, 0.3]]
    )
    z = pf.Projector(wish.rows(6)).project(torch.randn(6, 22, 3))
    assert torch.equal(z[[0, 5], 0], torch.tensor([[0, 0.1, 0.2], [0, 0.1, 0.3]]))


EVERYTHING = SMALL & pf.loop() & pf.velocity("head", [0, 2], np.zeros((2, 3)), std=0.3)


def test_no_tensor_is_made_on_torchs_default_device():
    """Where the default device holds no data, a forgotten `device=` would show."""
    rows = EVERYTHING.rows(5)
    x, variance = torch.randn(2, 5, 22, 3), torch.as_tensor(rows.variance)
    before = pf.Projector(rows)
    with torch.device("meta"):
        assert torch.zeros(1).is_meta
        inside = pf.Projector(rows)
        assert inside.y.device.type == "cpu"
        assert torch.equal(inside.project(x), before.project(x))
        assert torch.equal(inside.project(x, variance), before.project(x, variance))
        assert inside.residual(inside.project(x)) < 1e-6


class Devices(TorchDispatchMode):
    """Notes the device of every tensor that any operation makes."""

    def __init__(self):
        super().__init__()
        self.seen, self.operations = set(), set()

    def __torch_dispatch__(self, operation, types, arguments=(), options=None):
        result = operation(*arguments, **(options or {}))
        for made in result if isinstance(result, tuple | list) else (result,):
            if isinstance(made, torch.Tensor) and made.ndim > 0:
                self.seen.add(made.device.type)
        self.operations.add(str(operation))
        return result


def test_everything_stays_on_the_device_of_the_motion():
    """The device "meta" stands for one that is not the CPU: it refuses to mix with it."""
    rows = EVERYTHING.rows(5)
    projector = pf.Projector(rows, device="meta")
    x = torch.empty(2, 5, 22, 3, device="meta")
    with pytest.raises(RuntimeError):
        projector.y + torch.zeros(len(rows.y))
    aimed = pf.Projector(SMALL.rows(5), device="meta").aimed_at(torch.zeros(8))
    projector.project(x), aimed.project(x)  # the first call inverts the blocks, in numpy
    with Devices() as devices:
        assert projector.project(x).shape == x.shape
        projector.project(x, torch.empty(len(rows.y), device="meta"))
        aimed.project(x)
    assert devices.seen == {"meta"}
    with Devices() as devices:
        pf.Projector(rows).project(torch.zeros(2, 5, 22, 3))
    assert not any("_local_scalar" in name for name in devices.operations)  # a round trip to numpy


@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_what_comes_back_is_as_precise_as_what_was_given(dtype):
    for wish in (EVERYTHING, EVERYTHING & parallel_later()):
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", NearlyDependentRows)
            projector = pf.Projector(wish.rows(5), dtype=dtype)
        x = torch.randn(2, 5, 22, 3, dtype=dtype)
        assert projector.project(x).dtype is dtype
        variance = torch.as_tensor(wish.rows(5).variance)
        torch.testing.assert_close(projector.project(x, variance), projector.project(x))


def parallel_later():
    """Nearly dependent rows in a motion of five frames."""
    A = np.zeros((2, 330))
    A[:, 9 * 3] = 1
    A[1, 3 * 3] = 1e-4
    return pf.rows(A, [0.0, 0.0])

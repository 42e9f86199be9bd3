"""GMD through the one door, `pf.sample`: wishes, goals, and the shipped prior."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite import equations as eq
from projflow_lite.samplers import (
    Avoid,
    Together,
    ancestral,
    circles,
    flow_times,
    keep_speed,
    on_ground,
    reach,
)
from projflow_lite.samplers.gmd import Metres, look
from projflow_lite.skeleton import JOINTS

FRAMES = 12
MEAN = torch.randn(FRAMES, 22, 3, generator=torch.Generator().manual_seed(1), dtype=torch.float64)


def gaussian_velocity(x_t, t, text=None):
    """Exact velocity for noise N(0, 0.7²) and motions N(MEAN, 0.2²)."""
    gain = t * 0.2**2 / ((1 - t) ** 2 * 0.7**2 + t**2 * 0.2**2)
    mean = MEAN.to(x_t.dtype)
    return (mean + gain * (x_t - t * mean) - x_t) / (1 - t)


gaussian_velocity.noise_std = 0.7
PINS = pf.pin("pelvis", [0, 6], [[0, 0], [0.5, 1]], axes="xz") & pf.pin("head", 3, [0.1, 1.7, 0.4])


def sample(wish=None, **options):
    return pf.sample(gaussian_velocity, wish, frames=FRAMES, **({"method": "gmd"} | options))


@pytest.mark.parametrize("method", ["gmd", "gmd_keyframes"])
@pytest.mark.parametrize("dtype", [torch.float32, torch.float64])
def test_pins_of_any_joint_are_imputed(method, dtype):
    motion = sample(PINS, method=method, dtype=dtype, until=1.0)
    assert motion.residual <= (1e-7 if dtype == torch.float32 else 0)
    assert motion.positions.shape == (FRAMES, 22, 3)
    assert motion.wish is PINS
    soft = sample(PINS, method=method, dtype=dtype, until=0.9, pull=0.0)
    assert soft.residual > 1e-4


def test_a_goal_needs_no_wish():
    wanted = pf.pin("left_wrist", [2, 3], [[1, 1, 1], [1, 1, 1]])
    goal = reach(wanted)
    near, far = (sample(goal=goal, scale=s, batch=4).positions for s in (100.0, 0.0))
    assert goal(torch.as_tensor(near)).max() < 0.5 * goal(torch.as_tensor(far)).min()


def test_a_wish_and_a_goal():
    goal = reach(pf.pin("right_wrist", 5, [0.2, 0.3, 0.1]))
    motion = sample(PINS, goal=goal, scale=100.0, until=1.0, dtype=torch.float64)
    assert motion.residual == 0
    without = sample(PINS, until=1.0, dtype=torch.float64)
    closer, before = (goal(torch.as_tensor(m.positions[None])) for m in (motion, without))
    assert closer < 0.5 * before


def test_without_a_wish_or_a_goal_it_is_ancestral_sampling():
    generator = torch.Generator().manual_seed(4)
    x0 = 0.7 * torch.randn(1, FRAMES, 22, 3, generator=generator)
    noise_std = torch.tensor(0.7)
    plain = ancestral(gaussian_velocity, x0, flow_times(9), generator, noise_std=noise_std)
    np.testing.assert_array_equal(sample(steps=9, seed=4).positions, plain[0])


def test_the_seed_decides_and_batches_are_batches():
    first, again, other = (sample(PINS, seed=s, batch=2).positions for s in (1, 1, 2))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.01
    assert first.shape == (2, FRAMES, 22, 3)


class Projected:
    """A stand-in for an emphasised prior on (batch, frames, 66): the same Gaussian motions."""

    noise_std = 1.0

    def __init__(self):
        A = np.random.default_rng(0).normal(size=(66, 66))
        self.kA = torch.as_tensor(A / np.sqrt(66))
        self.back = torch.linalg.inv(self.kA)

    def project(self, motion):
        return (motion.flatten(-2).double() @ self.kA.T).to(motion.dtype)

    def unproject(self, x_proj):
        return (x_proj.double() @ self.back.T).to(x_proj.dtype).unflatten(-1, (22, 3))

    def __call__(self, x_t, t, text=None):
        C = 0.2**2 * self.kA @ self.kA.T
        gain = t * torch.linalg.solve((1 - t) ** 2 * torch.eye(66) + t**2 * C, C)
        mean = self.project(MEAN)
        x1 = mean + (x_t.double() - t * mean) @ gain
        return ((x1 - x_t) / (1 - t)).to(x_t.dtype)


def test_a_prior_on_projected_motion_is_taken_as_it_is():
    prior = Projected()
    motion = pf.sample(prior, PINS, frames=FRAMES, method="gmd", until=1.0, batch=3)
    assert motion.residual < 1e-7
    for options in ({"method": "gmd"}, {}):
        free = pf.sample(prior, None, frames=FRAMES, batch=60, steps=100, **options)
        error = free.positions - MEAN.numpy()
        assert abs(error.mean()) < 5 * 0.2 / np.sqrt(error.size)
        assert error.std() == pytest.approx(0.2, rel=0.05)


def obstacle(centre, **options):
    return Avoid(circles([centre], [0.3]), **options)


WRONG = [
    (
        lambda: sample(goal=obstacle([0.1, 0])),
        "Avoid: an obstacle covers the start point: frame 0, x = 0.00, z = 0.00 is 0.20 m inside; "
        "move one of the two",
    ),
    (
        lambda: sample(PINS, goal=Together(keep_speed(1), obstacle([0.5, 0.9]))),
        "Avoid: an obstacle covers a keyframe: frame 6, x = 0.50, z = 1.00 is 0.20 m inside; "
        "move one of the two",
    ),
    (
        lambda: sample(pf.pin("pelvis", 0, [2, 1], axes="xz"), goal=obstacle([2, 1.1])),
        "Avoid: an obstacle covers the start point: frame 0, x = 2.00, z = 1.00 is 0.20 m inside; "
        "move one of the two",
    ),
    (
        lambda: sample(pf.offset("head", "pelvis", [0, 0.6, 0])),
        "gmd: imputation takes exact pins, but row 0 (-1 * pelvis, frame 0, x + head, frame 0, x) "
        "is not one; ask for it as a goal instead: goal=reach(wish)",
    ),
    (
        lambda: sample(pf.pin("head", 0, [0, 1, 0], std=0.1)),
        "gmd: imputation takes exact pins, but row 0 (head, frame 0, x) is not one; ask for it as "
        "a goal instead: goal=reach(wish)",
    ),
    (
        lambda: sample(pf.pin("head", [1, 1], [[0, 0, 0], [0, 0, 1]])),
        "gmd: two pins contradict each other: head, frame 1, z = 0 and 1",
    ),
    (lambda: sample(pf.pin("head", 12, [0, 0, 0])), "pin: frame 12 is outside 0..11"),
    (lambda: sample(goal=3), "sample: goal is a function of motions, not a int"),
    (
        lambda: sample(PINS, goal=keep_speed(1), method="projflow"),
        "sample: projflow takes wishes and no goal; for goals take gmd, gmd_keyframes",
    ),
    (
        lambda: sample(PINS, metric="euclidean"),
        "sample: gmd overwrites, it has no metric and no guides; leave them out",
    ),
    (
        lambda: sample(scale=3.0),
        "sample: without a wish there is no scale; leave it out, or add a wish",
    ),
    (
        lambda: pf.sample(Projected(), PINS, frames=FRAMES),
        "sample: projflow needs a prior on motions in metres, and this one is on projected motion; "
        "take gmd, gmd_keyframes",
    ),
    (
        lambda: sample(goal=lambda x: x.sum()),
        "goal '<lambda>' returned shape (); expected shape (1,), one number for each motion",
    ),
    (
        lambda: sample(goal=lambda x: x.detach().sum((1, 2, 3)), wish=PINS),
        "goal '<lambda>' is not differentiable: torch cannot follow its value back to the motion; "
        "leave out .detach(), and do not only count or compare",
    ),
    (
        lambda: sample(goal=lambda x: (x.sum((1, 2, 3)) * 0 - 1).log()),
        "goal '<lambda>' is nan for motion 0 of the batch",
    ),
]


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_arguments_say_what_and_what_to_do(make, message):
    with pytest.raises(ValueError, match=".") as caught:
        make()
    assert str(caught.value) == message


def test_a_pinned_start_elsewhere_and_an_unknown_one():
    """The origin is no start where frame 0 is pinned to another place, or nothing is known."""
    at_origin = obstacle([0, 0])
    pinned = pf.pin("pelvis", 0, [2, 1], axes="xz")
    assert sample(pinned, goal=at_origin).positions.shape == (FRAMES, 22, 3)
    assert sample(goal=obstacle([0, 0], start=None)).positions.shape == (FRAMES, 22, 3)


@pytest.fixture(scope="module")
def prior():
    return pf.load_prior()


def test_the_networks_gradient_makes_a_sparse_goal_dense(prior):
    x_t = prior.noise_std * torch.randn(1, 60, 22, 3, generator=torch.Generator().manual_seed(0))
    goal = reach(pf.pin("pelvis", 30, [1.0, 1.0], axes="xz"))
    _, slope = look(prior, x_t, 0.5, "a person walks forward", Metres(), goal, "network")
    by_frame = slope[0].norm(dim=(1, 2))
    assert (by_frame > 0).all()
    far = by_frame[[10, 50]].sum() / by_frame.sum()
    assert far > 1e-3
    assert slope[0, :, JOINTS.index("head")].norm() > 0.05 * slope[0, :, 0].norm()


def test_the_networks_gradient_is_right(prior):
    """Against finite differences, in the direction of the slope itself."""
    x_t = prior.noise_std * torch.randn(1, 20, 22, 3, generator=torch.Generator().manual_seed(0))
    goal = keep_speed(1.0)
    _, slope = look(prior, x_t, 0.6, None, Metres(), goal, "network")
    step = 1e-2 * slope / slope.norm()

    def value(x):
        return goal(x + 0.4 * prior(x, 0.6, None)).item()

    rise = (value(x_t + step) - value(x_t - step)) / 2e-2
    assert rise == pytest.approx(slope.norm().item(), rel=0.02)


def test_walking_around_a_post(prior):
    """The straight way to the keyframe leads through it; guidance bends the walk."""
    goal = Avoid(circles([[0.15, 1.5]], [0.3]), 0.1)
    through, around = (
        goal.depth(
            pf.sample(
                prior, pf.pin("pelvis", 59, [0, 3], axes="xz"), "a person walks forward", batch=6,
                steps=20, method="gmd", goal=goal, scale=scale,
            ).positions
        ).amax(1)
        for scale in (0.0, 40.0)
    )  # fmt: skip
    assert (through > 0.02).all()
    assert (around == 0).sum() >= 5
    assert around.max() < 0.5 * through.max()


def test_imputation_alone_tears_the_body_and_a_pull_mends_it(prior):
    """Motion incoherence: the pelvis goes where it was put, the body stays behind."""
    wish = pf.pin("pelvis", [30, 59], [[0.4, 1.0], [0.8, 2.2]], axes="xz")
    torn, mended = (
        pf.sample(
            prior, wish, "a person walks forward", batch=4, steps=20, method="gmd", pull=pull,
            until=1.0,
        )
        for pull in (0.0, 20.0)
    )  # fmt: skip
    assert torn.residual < 1e-6
    assert mended.residual < 1e-6

    def stretch(motion):
        lengths = motion.bone_lengths()
        return np.abs(lengths[:, [30, 59]] / np.median(lengths, 1, keepdims=True) - 1).max()

    assert stretch(torn) > 1
    assert stretch(mended) < 0.7 * stretch(torn)


def test_levels_of_a_diffusion_may_be_given_as_times():
    """A cosine schedule of noise, as flow times."""
    levels = np.sin(np.linspace(0, np.pi / 2, 12)) ** 2
    times = eq.time_at(levels)
    motion = sample(PINS, steps=[0.0, *times[1:-1], 1.0], until=1.0)
    assert motion.residual < 1e-7
    assert on_ground(torch.as_tensor(motion.positions))[6].tolist() == [0.5, 1.0]

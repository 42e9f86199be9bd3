"""Goals: their values by hand, their slopes by finite differences, and what wrong ones are told."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite import equations as eq
from projflow_lite.samplers import Avoid, Together, box, circles, keep_speed, reach, union
from projflow_lite.samplers.goals import on_ground, slope_of, value_of

FRAMES = 8
RANDOM = torch.Generator().manual_seed(4)
MOTIONS = torch.randn(3, FRAMES, 22, 3, generator=RANDOM, dtype=torch.float64)
KEYS = pf.pin("pelvis", [1, 5], [[0.3, -0.2], [1.0, 0.4]], axes="xz")
ROUND = circles([[0.5, 0.2], [-0.4, -0.8]], [0.9, 0.6])


def walk(speed=1.0):
    """A pelvis that walks straight ahead, `speed` metres a second."""
    x = torch.zeros(1, FRAMES, 22, 3, dtype=torch.float64)
    x[0, :, 0, 2] = speed / 20 * torch.arange(FRAMES, dtype=x.dtype)
    return x


@pytest.mark.parametrize("p", [1, 1.5, 2, 4])
def test_reaching_keyframes_is_equation_12(p):
    y, mask = np.zeros((2, FRAMES)), np.zeros((2, FRAMES), bool)
    y[:, [1, 5]], mask[:, [1, 5]] = [[0.3, 1.0], [-0.2, 0.4]], True
    features = MOTIONS.flatten(2).mT.numpy()  # (batch, 66, frames), as GMD writes a motion
    wanted = [eq.keyframe_goal_of_motion(x, y, mask, [0, 2], p) for x in features]
    np.testing.assert_allclose(reach(KEYS, p)(MOTIONS), wanted, rtol=1e-12)


def test_reaching_other_rows_by_hand():
    x = walk()
    x[0, 0, 20], x[0, 0, 21] = torch.tensor([[1.0, 2.0, 2.0], [0.0, 0.0, 0.0]]).double()
    hands = pf.offset("left_wrist", "right_wrist", [0.5, 0, 0], frames=[0])
    assert reach(hands)(x).item() == pytest.approx(0.5 + 2 + 2)
    assert reach(hands, 2)(x).item() == pytest.approx(0.5 + 2 + 2)  # three rows, three groups
    pinned = pf.pin("left_wrist", 0, [0, 0, 0])
    assert reach(pinned, 2)(x).item() == pytest.approx(3)
    assert reach(pinned & hands, 2)(x).item() == pytest.approx(7.5)


def test_speed_by_hand():
    assert keep_speed(1.2)(walk(1.2)).item() == pytest.approx(0, abs=1e-12)
    assert keep_speed(1.2)(walk(2.0)).item() == pytest.approx((FRAMES - 1) * 0.8 / 20)
    assert keep_speed(1.2)(walk(0.0)).item() == pytest.approx((FRAMES - 1) * 1.2 / 20)


@pytest.mark.parametrize("margin", [0, 0.3])
def test_avoiding_circles_is_the_equation(margin):
    centres, radii = [[0.5, 0.2], [-0.4, -0.8]], [0.9, 0.6]
    goal = Avoid(circles(centres, radii), margin, start=None)
    z = on_ground(MOTIONS).mT.numpy()
    wanted = [eq.obstacle_goal(one, centres, radii, margin) for one in z]
    assert min(wanted) > 0
    np.testing.assert_allclose(goal(MOTIONS), wanted, rtol=1e-12)
    depth = [np.maximum(-eq.signed_distance(one, centres, radii), 0) for one in z]
    np.testing.assert_allclose(goal.depth(MOTIONS), depth, atol=1e-12)


def test_distance_to_a_box_is_that_to_its_nearest_edge():
    """Walk along the rim in small steps and take the nearest point."""
    centre, size = np.array([0.2, -0.1]), np.array([1.0, 0.6])
    s = np.linspace(-1, 1, 4001)
    rim = [np.stack([s, np.full_like(s, e)], 1) for e in (-1, 1)]
    rim = centre + size / 2 * np.concatenate([*rim, *(r[:, ::-1] for r in rim)])
    points = np.random.default_rng(0).normal(size=(40, 2))
    nearest = np.linalg.norm(points[:, None] - rim, axis=-1).min(1)
    inside = (np.abs(points - centre) < size / 2).all(1)
    assert 0 < inside.sum() < 40
    found = box(centre, size)(torch.tensor(points))
    np.testing.assert_allclose(found, np.where(inside, -nearest, nearest), atol=1e-3)
    np.testing.assert_array_equal(
        union(box(centre, size), ROUND)(torch.tensor(points)),
        torch.minimum(found, ROUND(torch.tensor(points))),
    )


def hands_apart(x):
    """A goal as a student would write it."""
    return (x[:, :, 20] - x[:, :, 21]).norm(dim=-1).sum(1)


GOALS = {
    "keyframes": reach(KEYS),
    "keyframes, p = 2": reach(KEYS, 2),
    "rows": reach(pf.loop(["pelvis"]) & pf.offset("head", "pelvis", [0, 0.6, 0])),
    "circles": Avoid(ROUND, 0.2, start=None),
    "box": Avoid(box([0.1, 0.1], [1.5, 2]), 0.2, "left_foot", start=None),
    "any distance": Avoid(lambda z: z.pow(2).sum(-1) - 1, start=None),
    "speed": keep_speed(1.0),
    "a student's": hands_apart,
    "together": Together(reach(KEYS), hands_apart, weights=[2.0, 0.5]),
}


@pytest.mark.parametrize("name", GOALS)
def test_slopes_are_finite_differences(name):
    goal, x = GOALS[name], MOTIONS.clone().requires_grad_()
    slope = slope_of(goal, x, x)
    assert slope.abs().max() > 0
    direction = torch.randn(x.shape, generator=torch.Generator().manual_seed(1)).double()
    step = 1e-6 * direction
    rise = (goal(MOTIONS + step) - goal(MOTIONS - step)).sum() / 2e-6
    assert rise.item() == pytest.approx((slope * direction).sum().item(), rel=1e-5)


@pytest.mark.parametrize("p", [1, 2, 3])
def test_a_goal_that_is_reached_is_level_and_no_accident(p):
    x = torch.zeros(1, FRAMES, 22, 3, dtype=torch.float64)
    x[0, [1, 5], 0] = torch.tensor([[0.3, 9, -0.2], [1.0, 9, 0.4]], dtype=x.dtype)
    x.requires_grad_()
    assert reach(KEYS, p)(x).item() == 0
    assert not slope_of(reach(KEYS, p), x, x).any()


def test_standing_still_has_a_slope_of_zero_and_not_of_nan():
    x = walk(0.0).requires_grad_()
    assert not slope_of(keep_speed(1.0), x, x).any()


def test_together_is_the_weighted_sum():
    both = Together(reach(KEYS), hands_apart, weights=[2.0, 0.5])(MOTIONS)
    torch.testing.assert_close(both, 2 * reach(KEYS)(MOTIONS) + 0.5 * hands_apart(MOTIONS))


def of_motions(goal):
    return lambda: slope_of(goal, MOTIONS.clone().requires_grad_(), MOTIONS)


def total(x):
    return x.sum()


def as_number(x):
    return 3.0


def detached(x):
    return x.detach().sum((1, 2, 3))


def counted(x):
    return (x > 0).sum((1, 2, 3)).float()


def by_numpy(x):
    return torch.as_tensor(x.numpy().sum((1, 2, 3)))


def divided(x):
    return x.sum((1, 2, 3)) / 0


def rooted(x):
    return (x - x).square().sum((1, 2, 3)).sqrt()


LOST = "torch cannot follow its value back to the motion; leave out .detach(), and do not only count or compare"
WRONG_GOALS = {
    total: "goal 'total' returned shape (); expected shape (3,), one number for each motion",
    as_number: "goal 'as_number' returned 3.0; expected shape (3,), one number for each motion",
    detached: f"goal 'detached' is not differentiable: {LOST}",
    counted: f"goal 'counted' is not differentiable: {LOST}",
    by_numpy: "goal 'by_numpy' leaves torch: use torch's functions only",
    divided: "goal 'divided' is inf for motion 0 of the batch",
    rooted: "goal 'rooted' has a gradient that is not a number; a square root of 0 does that",
}


@pytest.mark.parametrize("goal", WRONG_GOALS, ids=lambda g: g.__name__)
def test_goals_that_cannot_be_used_say_why(goal):
    x = MOTIONS.abs().requires_grad_()
    with pytest.raises(ValueError, match=".") as caught:
        slope_of(goal, x, x)
    assert str(caught.value) == WRONG_GOALS[goal]


def test_a_wrong_goal_is_found_among_others():
    x = MOTIONS.clone().requires_grad_()
    with pytest.raises(ValueError, match="goal 'detached' is not differentiable"):
        slope_of(Together(reach(KEYS), detached), x, x)


def test_a_goals_own_mistake_is_not_hidden():
    with pytest.raises(IndexError):
        value_of(lambda x: x[:, :, 30].sum((1, 2)), MOTIONS)


WRONG = [
    (lambda: reach(KEYS, 0.5), "reach: p is a finite number of at least 1, not 0.5"),
    (lambda: keep_speed(-1), "keep_speed: speed is 0 or more metres a second, not -1"),
    (
        lambda: keep_speed(1, "pelvs"),
        "keep_speed: 'pelvs' is not a joint; did you mean 'pelvis'?",
    ),
    (
        lambda: circles([0, 1], 1),
        "circles: centres are (K, 2) and radii (K,), not (2,) and ()",
    ),
    (
        lambda: circles([[0, 1]], [0]),
        "circles: centres must be finite and radii finite and above 0",
    ),
    (
        lambda: circles([[0, np.nan]], [1]),
        "circles: centres must be finite and radii finite and above 0",
    ),
    (lambda: box([0, 0], [1, 0]), "box: centre must be finite and sides finite and above 0"),
    (lambda: box([0, 0, 0], [1, 1]), "box: centre and size are (2,), not (3,), (2,)"),
    (lambda: union(), "union: there is no obstacle"),
    (
        lambda: Avoid([[0, 1]]),
        "Avoid: distance is a function of points, such as circles(...)",
    ),
    (lambda: Avoid(ROUND, -0.1), "Avoid: margin is 0 or more metres, not -0.1"),
    (lambda: Together(total, weights=[1, 2]), "Together: 2 weights for 1 goals"),
]


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_arguments_say_what_and_what_to_do(make, message):
    with pytest.raises(ValueError, match=".") as caught:
        make()
    assert str(caught.value) == message

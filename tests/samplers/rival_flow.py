"""A flow whose answers are known, wishes on it, and what the tests of rivals count with."""

import numpy as np
import torch

import projflow_lite as pf

FRAMES, STEPS, STD = 6, 8, 0.7
SHAPE = (1, FRAMES, 22, 3)
SIZE = FRAMES * 66
RANDOM = np.random.default_rng(3)
MEAN = torch.as_tensor(RANDOM.normal(size=SHAPE[1:]))
MIX = torch.as_tensor(RANDOM.normal(size=(22, 22)) / 22)
"""Joints of the data hang together: C = 0.2² I + MIX MIXᵀ, for every frame and axis."""


def velocity(x_t, t, text=None):
    """Exact velocity for noise N(0, 0.7²) and Gaussian motions around MEAN."""
    C = (0.2**2 * torch.eye(22, dtype=torch.float64) + MIX @ MIX.T).to(x_t.dtype)
    S = (1 - t) ** 2 * STD**2 * torch.eye(22, dtype=x_t.dtype) + t**2 * C
    gain = t * torch.linalg.solve(S, C)
    mean = MEAN.to(x_t.dtype)
    centred = (x_t - t * mean).mT @ gain
    return (mean + centred.mT - x_t) / (1 - t)


velocity.noise_std = STD


def bent(x_t, t, text=None):
    """A velocity that is not linear, to take slopes of."""
    return torch.tanh(velocity(x_t, t)) + 0.1 * x_t.roll(1, dims=2) ** 2


PINS = pf.pin("pelvis", [0, 4], [[0, 0.5], [0.5, 1]], axes="xz") & pf.pin(
    "head", 3, [0.1, 1.7, 0.4]
)
ROWS = pf.offset("left_wrist", "head", [0.1, 0, 0.2], frames=[1, 2]) & pf.centre_of_mass(
    3, [0.2, 0.4, 0.1]
)
SOFT = ROWS & pf.pin("right_wrist", 2, [0.3, 0.2, 0.1], std=0.5)
DOWNHILL = ["flowdps", "pnp_flow", "flowchef", "dps", "dno"]
RIVALS = ["ddnm", "replacement", "imputation", *DOWNHILL]


REACHABLE = pf.pin(["left_wrist", "head"], [1, 4], MEAN[[1, 4]][:, [20, 15]].numpy() + 0.3)


def sample(wish=PINS, prior=velocity, **options):
    settings = {"frames": FRAMES, "steps": STEPS, "dtype": torch.float64, "seed": 5} | options
    if settings.get("method") == "dno":
        settings = {"iterations": 4} | settings
    return pf.sample(prior, wish, **settings)


def replayed(**options):
    """The steps that a callback saw, and the states that they led to."""
    steps = []
    end = sample(callback=steps.append, **options).positions[None]
    return steps, [*(step.x_t.numpy() for step in steps[1:]), end]


def fresh_noise(seed=5):
    """What a sampler draws, the noise of the start first."""
    random = torch.Generator().manual_seed(seed)
    while True:
        yield STD * torch.randn(SHAPE, generator=random, dtype=torch.float64).numpy()


def dense(wish):
    A, y, variance = wish.rows(FRAMES)
    return A.toarray(), y, variance


def miss_of(wish, x):
    """The misfit written out: half the weighted sum of squares."""
    A, y, variance = dense(wish)
    return 0.5 * np.sum((A @ x.ravel() - y) ** 2 / (1 + variance))


def differences(function, x, places, h=1e-5):
    """Central differences of a function of a motion at some of its coordinates."""
    found = []
    for k in places:
        push = np.zeros(SIZE)
        push[k] = h
        push = push.reshape(SHAPE)
        found.append((function(x + push) - function(x - push)) / (2 * h))
    return np.array(found)

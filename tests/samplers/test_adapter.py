"""A model of another layout and normalisation samples what it would sample by itself."""

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite.samplers import Adapter
from projflow_lite.samplers.adapter import read_layout

MEAN = np.random.default_rng(0).normal(size=(22, 3))
STD = np.random.default_rng(1).uniform(0.3, 2.0, size=(22, 3))
SPREAD = 0.4


def normalised_velocity(u_t, t):
    """Exact velocity from N(0, 1) to N(0, SPREAD²), whatever the shape."""
    gain = t * SPREAD**2 / ((1 - t) ** 2 + t**2 * SPREAD**2)
    return (gain * u_t - u_t) / (1 - t)


class Stand_in:  # noqa: N801
    """Shaped as a motion diffusion transformer: axes, joints, frames; refuses anything else."""

    def __init__(self, frames=196):
        self.frames, self.seen = frames, []

    def __call__(self, u_t, t, text):
        assert u_t.shape[1:] == (3, 22, self.frames)
        self.seen.append(text)
        return normalised_velocity(u_t, t)


def test_a_stand_in_of_22_joints_and_196_frames_obeys_exactly():
    model = Stand_in()
    prior = Adapter(model, MEAN, STD, layout="batch axes joints frames")
    wish = pf.pin("left_wrist", [0, 90, 195], np.eye(3)) & pf.loop("pelvis")
    motion = pf.sample(prior, wish, "a person walks", frames=196, steps=8)
    assert motion.residual < 1e-6
    assert model.seen == ["a person walks"] * 8


@pytest.mark.parametrize("layout", ["batch frames joints axes", "batch (joints axes) frames", "batch frames (axes joints)"])  # fmt: skip
def test_samples_have_the_mean_and_spread_of_the_data(layout):
    prior = Adapter(lambda u, t, text: normalised_velocity(u, t), MEAN, STD, layout)
    x = pf.sample(prior, frames=30, steps=60, batch=300, dtype=torch.float64).positions
    error = (x - MEAN) / STD
    assert abs(error.mean()) < 5 * SPREAD / np.sqrt(error.size)
    np.testing.assert_allclose(error.std((0, 1)), SPREAD, rtol=0.06)


def test_the_layouts_carry_every_coordinate_to_its_place():
    x = torch.arange(2 * 5 * 22 * 3.0).reshape(2, 5, 22, 3)
    merged = Adapter(None, layout="batch (joints axes) frames").to_model(x)
    assert merged.shape == (2, 66, 5)
    assert merged[1, 7 * 3 + 2, 4] == x[1, 4, 7, 2]
    for layout in ("axes frames batch joints", "(batch frames) (joints axes)"):
        adapter = Adapter(None, layout=layout)
        torch.testing.assert_close(adapter.from_model(adapter.to_model(x), x.shape), x)


def test_time_may_run_the_other_way():
    there = Adapter(lambda u, t, text: normalised_velocity(u, t), MEAN, STD)
    back = Adapter(lambda u, t, text: -normalised_velocity(u, 1 - t), MEAN, STD, noise_at_one=True)
    x = torch.randn(1, 4, 22, 3, dtype=torch.float64)
    torch.testing.assert_close(there(x, 0.3), back(x, 0.3))


def test_a_conditioned_gaussian_is_what_conditioning_says():
    """Pin one joint, without fresh noise: the others keep mean and spread of their own."""
    prior = Adapter(lambda u, t, text: normalised_velocity(u, t), MEAN, STD)
    wish = pf.pin("head", 2, [5.0, 5.0, 5.0])
    motion = pf.sample(prior, wish, frames=6, steps=80, batch=400, eta=0.0, guides=False, dtype=torch.float64)  # fmt: skip
    error = ((motion.positions - MEAN) / STD)[:, 4]
    assert abs(error.mean()) < 5 * SPREAD / np.sqrt(error.size)
    assert error.std() == pytest.approx(SPREAD, rel=0.05)


WRONG = [
    (lambda: read_layout("batch frames joints"), "Adapter: layout names batch, frames, joints, axes once each, not 'batch frames joints'"),
    (lambda: Adapter(None, layout="batch batch joints axes"), "Adapter: layout names batch, frames, joints, axes once each, not 'batch batch joints axes'"),
    (lambda: Adapter(None, std=[1.0, 0.0, 1.0]), "Adapter: std is above 0 everywhere"),
    (lambda: Adapter(None, mean=np.nan), "Adapter: mean has a value that is not finite"),
    (lambda: Adapter(lambda u, t, text: u[0])(torch.zeros(2, 4, 22, 3), 0.0), "Adapter: the model returned (4, 22, 3) for (2, 4, 22, 3); does it predict a velocity?"),
]  # fmt: skip


@pytest.mark.parametrize(("make", "message"), WRONG, ids=[m for _, m in WRONG])
def test_wrong_models_are_refused(make, message):
    with pytest.raises(ValueError, match=".") as caught:
        make()
    assert str(caught.value) == message

"""The checkpoint in the package: what a student gets must know its prompts and keep its bones."""

import json
from dataclasses import asdict
from importlib.resources import files

import numpy as np
import pytest

import projflow_lite as pf
from data_synth import make_clips
from projflow_lite import scores
from projflow_lite.prior.training import RECIPES
from projflow_lite.skeleton import JOINTS

CLIPS = 32


@pytest.fixture(scope="module")
def prior():
    return pf.load_prior()


@pytest.fixture(scope="module")
def generated(prior):
    """Motions for held-out captions, and the held-out motions themselves."""
    held_out = make_clips(CLIPS, frames=60, seed=424_242)
    return pf.sample(prior, prompt=held_out.captions, batch=CLIPS, seed=0), held_out


def test_it_is_a_few_megabytes_and_says_how_it_was_made(prior):
    path = files("projflow_lite.prior") / "shipped.safetensors"
    assert len(path.read_bytes()) < 12e6
    assert prior.recipe == json.loads(json.dumps(asdict(RECIPES["shipped"])))


@pytest.mark.parametrize(
    ("prompt", "axis", "low", "high"),
    [
        ("a person walks forward", "z", 2.0, 5.0),
        ("a person runs forward", "z", 6.0, 11.0),
        ("a person walks backward", "z", -3.5, -1.0),
        ("a person sidesteps to the left", "x", 0.6, 2.2),
        ("a person sidesteps to the right", "x", -2.2, -0.6),
        ("a person stands still", "z", -0.3, 0.3),
        ("a person jumps forward", "z", 0.1, 1.4),
    ],
)
def test_the_prompt_decides_where_the_body_goes(prior, prompt, axis, low, high):
    motion = pf.sample(prior, prompt=prompt, batch=4, seed=1)
    end = motion.positions[:, -1, 0, "xyz".index(axis)]
    assert low < np.median(end) < high


def test_the_prompt_decides_which_hand_waves(prior):
    for hand, other in (("left", "right"), ("right", "left")):
        motion = pf.sample(prior, prompt=f"a person waves with the {hand} hand", batch=4, seed=2)
        height = motion.positions[..., 1].max(1)
        above = height[:, JOINTS.index(f"{hand}_wrist")] - height[:, JOINTS.index(f"{other}_wrist")]
        assert np.median(above) > 0.3


def test_bones_feet_and_smoothness_are_near_those_of_the_data(generated):
    ours, data = generated[0].positions, generated[1].positions
    # Measured when it was shipped: 0.01 %; see the prior card for skating and jerk over many clips.
    assert scores.bone_length_error(ours).mean() < 5e-4
    assert scores.foot_skating(ours).mean() < scores.foot_skating(data).mean() + 0.04
    assert scores.mean_jerk(ours).mean() < 1.3 * scores.mean_jerk(data).mean()


def test_an_exact_wrist_keeps_a_plausible_body(prior):
    """A circle within reach: exact, and bones stretch by a few per cent at most."""
    angle = np.linspace(0, 2 * np.pi, 60)
    circle = np.stack([-0.4 + 0.15 * np.cos(angle), 1.3 + 0.15 * np.sin(angle)], axis=1)
    wish = pf.pin("right_wrist", None, circle, axes="xy")
    motion = pf.sample(prior, wish, "a person waves with the right hand", seed=0)
    assert motion.residual < 1e-6
    assert scores.bone_length_error(motion.positions) < 0.04

"""The shipped priors that see keyframes: made as they say, and nearer to keyframes than the prior."""

import json
from dataclasses import asdict
from importlib.resources import files

import numpy as np
import pytest
import torch

from data_synth import held_out
from projflow_lite.prior import load_prior
from projflow_lite.prior.checkpoint import fingerprint
from projflow_lite.prior.conditioned_files import load_control_branch, load_masked_prior
from projflow_lite.prior.small_training import RECIPES
from projflow_lite.samplers import METHODS, euler, flow_times
from projflow_lite.samplers.gmd_imputation import Imputation
from projflow_lite.scores import bone_length_error
from projflow_lite.skeleton import JOINTS

LOADERS = {"control_branch": load_control_branch, "masked": load_masked_prior}
CLIPS, STEPS = 32, 15


@pytest.fixture(scope="module", params=list(LOADERS))
def name(request):
    file = f"{request.param}.safetensors"
    if not (files("projflow_lite.prior") / file).is_file():
        command = f"projflow-lite train --recipe {request.param}"
        pytest.skip(f"{file} is not in the package; made by {command}, as prior.safetensors")
    return request.param


@pytest.fixture(scope="module")
def model(name):
    return LOADERS[name]()


@pytest.fixture(scope="module")
def clips():
    return held_out(CLIPS, 60, 17)


def noise(prior, clips):
    random = torch.Generator().manual_seed(0)
    return prior.noise_std * torch.randn(clips.positions.shape, generator=random)


def test_it_is_small_and_made_by_its_recipe_from_the_shipped_prior(model, name):
    assert (files("projflow_lite.prior") / f"{name}.safetensors").stat().st_size < 12e6
    assert model.recipe == json.loads(json.dumps(asdict(RECIPES[name])))
    assert model.start == fingerprint(load_prior())


@pytest.mark.parametrize("keys", [2, 15])
@pytest.mark.parametrize("joint", ["pelvis", "left_wrist"])
def test_it_comes_nearer_to_keyframes_than_the_prior_and_bodies_stay_whole(
    model, clips, joint, keys
):
    x = torch.as_tensor(clips.positions, dtype=torch.float32)
    frames = np.random.default_rng(keys).choice(60, keys, replace=False)
    mask = torch.zeros(60, 22, 3, dtype=torch.bool)
    mask[frames, JOINTS.index(joint)] = True
    sampler, x0, times = METHODS[model.trained_for].sampler, noise(model, clips), flow_times(STEPS)
    with torch.no_grad():
        free = euler(load_prior(), x0, times, clips.captions)
        told = sampler(model, Imputation(mask, x), x0, times, None, clips.captions)
    plain, ours = ((m - x)[:, mask].abs().mean() for m in (free, told))
    assert ours < 0.75 * plain
    assert float(bone_length_error(told.numpy()).mean()) < 0.03


def test_told_nothing_it_still_follows_the_prompt(model, clips):
    x0, times = noise(model, clips), flow_times(STEPS)
    with torch.no_grad():
        x = euler(model, x0, times, ["a person walks forward"] * CLIPS).numpy()
    assert np.median(x[:, -1, 0, 2]) > 1.0
    assert float(bone_length_error(x).mean()) < 0.03

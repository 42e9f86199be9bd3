"""The planner of trajectories: the paper's projections, and training as for the prior."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
import torch

import projflow_lite as pf
from projflow_lite.equations.gmd_goals import fill_trajectory, take_trajectory
from projflow_lite.prior import load_prior
from projflow_lite.prior.small_training import TrajectoryRecipe, TrajectoryTrainer
from projflow_lite.prior.training import train
from projflow_lite.prior.trajectory import load_trajectory_model, save_trajectory_model
from projflow_lite.samplers import sample

SMOKE = TrajectoryRecipe(steps=6, batch=4, widths=(16, 24), lengths=(20, 32))


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    return train(SMOKE, folder, progress=False), folder


def rows_of(motion):
    """A motion as GMD writes it: 66 features by frames."""
    return motion.flatten(1).T.numpy()


def test_projections_are_those_of_the_paper(trained):
    model, motion = trained[0], torch.randn(30, 22, 3)
    pelvis = (0, 2)
    z = model.project(motion)
    assert z.shape == (30, 1, 2)
    np.testing.assert_array_equal(z[:, 0].T, take_trajectory(rows_of(motion), pelvis))
    filled = fill_trajectory(z[:, 0].T, pelvis, 66)
    np.testing.assert_allclose(rows_of(model.unproject(z)), filled)


@pytest.mark.parametrize("frames", [20, 21, 23, 32])
def test_velocity_points_from_where_we_are_to_the_endpoint(trained, frames):
    model = trained[0]
    z = model.noise_std * torch.randn(2, frames, 1, 2)
    v = model(z, 0.75, ["a person walks", None])
    end = model.endpoint(z, 0.75, ["a person walks", None])
    torch.testing.assert_close(z + 0.25 * v, end)


def test_its_scale_is_that_of_trajectories():
    trainer = TrajectoryTrainer(replace(SMOKE, lengths=(60,), batch=64))
    u1, _ = trainer.batch()
    assert u1.shape == (64, 60, 1, 2)
    assert float(u1.square().mean()) == pytest.approx(1, abs=0.3)


def test_a_perfect_network_has_no_loss():
    trainer = TrajectoryTrainer(SMOKE)
    u1, ids = trainer.batch()
    trainer.network.forward = lambda z, t, ids: u1
    assert trainer.loss(u1, ids, torch.Generator().manual_seed(0)) == 0


def test_training_lowers_the_loss():
    trainer = TrajectoryTrainer(replace(SMOKE, steps=60, batch=16, learning_rate=0.01))
    u1, ids = trainer.batch()

    def loss_now():
        with torch.no_grad():
            return float(trainer.loss(u1, ids, torch.Generator().manual_seed(0)))

    before = loss_now()
    while trainer.step < 60:
        trainer.advance()
    assert loss_now() < 0.95 * before


def test_a_run_that_was_interrupted_ends_as_one_that_was_not(trained, tmp_path):
    half = TrajectoryTrainer(SMOKE)
    while half.step < 3:
        half.advance()
    half.save(tmp_path / "run.safetensors")
    resumed = train(SMOKE, tmp_path, progress=False)
    for ours, theirs in zip(resumed.parameters(), trained[0].parameters(), strict=True):
        assert torch.equal(ours, theirs)


def test_a_checkpoint_comes_back_as_it_was(trained, tmp_path):
    model, folder = trained
    save_trajectory_model(model, tmp_path / "again.safetensors")
    again = load_trajectory_model(tmp_path / "again.safetensors")
    z = torch.randn(1, 20, 1, 2)
    assert torch.equal(again(z, 0.5, "a person walks"), model(z, 0.5, "a person walks"))
    assert (again.noise_std, again.lengths) == (model.noise_std, (20, 32))
    assert again.recipe == json.loads(json.dumps(asdict(SMOKE)))
    whole = (folder / "prior.safetensors").read_bytes()
    assert (tmp_path / "again.safetensors").read_bytes() == whole


def test_the_two_stages_of_gmd_meet_their_keyframes(trained):
    """With a planner, lines and both; the second stage imputes what the first has planned."""
    wish = pf.pin("pelvis", [3, 15], [[0.1, 0.2], [0.0, 1.0]], axes="xz")
    body = untaught_prior()
    for switch in (0.0, 0.5):
        motion = sample(
            body, wish, "a person walks", 20, 3, method="gmd_keyframes", until=1.0,
            trajectory_model=trained[0], switch=switch,
        )  # fmt: skip
        at = motion.positions[[3, 15], 0][:, [0, 2]]
        np.testing.assert_allclose(at, [[0.1, 0.2], [0.0, 1.0]], atol=1e-6)


def untaught_prior():
    from projflow_lite.prior.training import Recipe, Trainer

    return Trainer(Recipe(steps=1, batch=4, widths=(16, 24), lengths=(20, 32))).result()


def test_damaged_and_foreign_checkpoints_are_named(trained, tmp_path):
    whole = (trained[1] / "prior.safetensors").read_bytes()
    cut = tmp_path / "cut.safetensors"
    for keep in (0, 1000, -1):
        cut.write_bytes(whole[:keep])
        with pytest.raises(ValueError, match=r"cut\.safetensors is damaged or is not a checkp"):
            load_trajectory_model(cut)
    with pytest.raises(FileNotFoundError, match="there is no checkpoint at"):
        load_trajectory_model(tmp_path / "nothing.safetensors")
    with pytest.raises(ValueError, match=r"prior\.safetensors is not a projflow_lite prior"):
        load_prior(trained[1] / "prior.safetensors")


def test_wrong_shapes_and_lengths_are_refused(trained):
    model = trained[0]
    with pytest.raises(ValueError, match=r"expected shape \(batch, frames, 1, 2\), got \(30, 2\)"):
        model(torch.zeros(30, 2), 0.5)
    with pytest.raises(ValueError, match="500 frames; it was trained on motions of 20 to 32"):
        model(torch.zeros(1, 500, 1, 2), 0.5)
    with pytest.raises(ValueError, match=r"expected shape \(..., 22, 3\), got \(30, 21, 3\)"):
        model.project(torch.zeros(30, 21, 3))
    with pytest.raises(ValueError, match=r"unproject: expected shape \(..., 1, 2\), got \(30, 3\)"):
        model.unproject(torch.zeros(30, 3))

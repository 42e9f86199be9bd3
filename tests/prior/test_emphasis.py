"""The prior on emphasised motion: the projection, what it means, what is stored and refused."""

import itertools
import json
from dataclasses import asdict, replace

import numpy as np
import pytest
import torch

import projflow_lite as pf
from data_synth import make_clips
from data_synth.captions import phrases
from projflow_lite.equations.gmd_emphasis import emphasise, unemphasise
from projflow_lite.equations.gmd_metric import emphasis_metric
from projflow_lite.prior import Prior, load_prior, save_prior
from projflow_lite.prior.emphasis import EmphasisedPrior, load_emphasised, save_emphasised
from projflow_lite.prior.features import (
    EMPHASISED,
    emphasis_in_metres,
    mixing_matrix,
    spreads_of,
)
from projflow_lite.prior.small_training import EmphasisRecipe, EmphasisTrainer
from projflow_lite.prior.text import Vocabulary
from projflow_lite.prior.training import begin, train
from projflow_lite.samplers import sample

SMOKE = EmphasisRecipe(steps=6, batch=4, widths=(16, 24), lengths=(20, 32))


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    return train(SMOKE, folder, progress=False), folder


@pytest.fixture(scope="module")
def motions():
    return torch.as_tensor(make_clips(512, 60, seed=5).positions)


def fresh_prior(motions):
    """A prior before its first step."""
    torch.manual_seed(0)
    mean = motions.mean((0, 1))
    std = float((motions - mean).square().mean().sqrt())
    prior = Prior(Vocabulary.of(phrases()), mean, std, (20, 196), {"widths": [16, 24]})
    return prior.eval().requires_grad_(False)


def untrained(motions, c):
    A, k = mixing_matrix(c)
    spreads = spreads_of(motions - motions.mean((0, 1)))
    return EmphasisedPrior(fresh_prior(motions), torch.as_tensor(A), k, c, spreads)


def seen_from_pelvis(x):
    """Pelvis, then every other joint as seen from it, ``(..., 66)``; worked out here."""
    each = [x[..., 0, :]] + [x[..., j, :] - x[..., 0, :] for j in range(1, 22)]
    return torch.cat(each, -1).double()


def spread_of(motions):
    """The two spreads, as a number for each feature."""
    variance = seen_from_pelvis(motions).var((0, 1))
    ground = [0, 2]
    body = [i for i in range(66) if i not in ground]
    spread = torch.zeros(66).double()
    spread[ground], spread[body] = variance[ground].mean().sqrt(), variance[body].mean().sqrt()
    return spread


def standardised(motions):
    """A function to features around the mean, measured here on all motions."""
    mean, spread = seen_from_pelvis(motions).mean((0, 1)), spread_of(motions)
    return lambda x: (seen_from_pelvis(x) - mean) / spread


@pytest.mark.parametrize("c", [1, 10])
def test_the_projection_is_the_papers(motions, c):
    prior, x = untrained(motions, c), motions[0].double()
    A, features = prior.A.double().numpy(), standardised(motions)
    ours = prior.project(x).T
    np.testing.assert_allclose(ours, emphasise(features(x).T, A, prior.scale), atol=2e-4)
    x_proj = torch.randn(60, 66, generator=torch.Generator().manual_seed(0)).double()
    back = unemphasise(x_proj.T.numpy(), A, prior.scale)
    np.testing.assert_allclose(features(prior.unproject(x_proj)).T, back, atol=2e-4 * back.max())


@pytest.mark.parametrize("c", [0.3, 1, 10, 100])
def test_projected_motion_has_unit_variance(motions, c):
    """On average over the 66 numbers, whatever A' was drawn: measured on motions."""
    projected = untrained(motions, c).project(motions)
    assert float(projected.flatten(0, 1).var(0).mean()) == pytest.approx(1, abs=0.01)


@pytest.mark.parametrize("c", [1, 10])
def test_a_motion_survives_the_way_there_and_back(motions, c):
    prior, x = untrained(motions, c), motions[:8]
    there = prior.project(x.double())
    torch.testing.assert_close(prior.unproject(there), x.double(), atol=1e-9, rtol=0)
    torch.testing.assert_close(prior.unproject(prior.project(x)), x, atol=2e-5, rtol=0)
    assert prior.project(x).dtype == x.dtype


def test_white_noise_in_projected_space_is_coloured_noise_on_motion(motions):
    """Monte Carlo against the metric's inverse: independent from feature to feature."""
    prior = untrained(motions, 10)
    noise = torch.randn(100_000, 66, generator=torch.Generator().manual_seed(0))
    drawn = seen_from_pelvis(prior.coloured(noise))
    R = emphasis_metric(prior.A.double().numpy(), prior.scale)
    spread = spread_of(motions).numpy()
    expected = np.linalg.inv(R) * np.outer(spread, spread)
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    assert np.abs((torch.cov(drawn.T).numpy() - expected) / size).max() < 0.02
    assert np.abs(expected / size - np.eye(66)).max() < 1e-4
    torch.testing.assert_close(prior.noise.flatten(), drawn.std(0), rtol=0.01, atol=0)


@pytest.mark.parametrize("t", [0.0, 0.3, 0.8])
def test_the_plain_network_sees_a_noise_on_the_body_that_it_knows(motions, t):
    """Monte Carlo: at its own time t' it gets t' of the motion, and 1 - t' of unit noise."""
    prior = untrained(motions, 3)
    x1 = motions[:1, :1].expand(400, 100, 22, 3).double()
    white = torch.randn(400, 100, 66, generator=torch.Generator().manual_seed(0)).double()
    seen = []

    def spy(x, time, ids):
        seen.append((x, float(time[0])))
        return x

    prior.plain.network.forward = spy
    prior.endpoint((1 - t) * white + t * prior.project(x1), t)
    x, time = seen[0]
    assert (time == 0) == (t == 0)
    noise = x - time * (x1 - prior.plain.mean) / prior.plain.noise_std
    assert float(noise.mean((0, 1)).abs().max()) < 0.05
    from_pelvis = (noise[:, :, 1:] - noise[:, :, :1]).std((0, 1))
    expected = torch.full_like(from_pelvis, 1 - time)
    torch.testing.assert_close(from_pelvis, expected, rtol=0.03, atol=0)


def test_emphasis_is_a_weight_and_nothing_else(motions):
    """Against its spread a place at c = 10 has a tenth of the noise: by hand, 2 and 0.2."""
    ratio = untrained(motions, 10).noise.flatten() / spread_of(motions)
    others = [i for i in range(66) if i not in EMPHASISED]
    size = (264 / 66) ** 0.5  # N - 2 + 2 c^2 = 264
    torch.testing.assert_close(ratio[others], torch.full((64,), size).double(), rtol=1e-3, atol=0)
    both = torch.full((2,), size / 10).double()
    torch.testing.assert_close(ratio[list(EMPHASISED)], both, rtol=1e-3, atol=0)


def test_noise_that_is_white_in_metres_has_an_emphasis_too(motions):
    """At that c the place has 1 / sqrt(2) of the noise of a joint as seen from the pelvis."""
    spreads = spreads_of(motions - motions.mean((0, 1)))
    noise = untrained(motions, emphasis_in_metres(spreads)).noise
    assert float(noise[0, 0] / noise[5, 0]) == pytest.approx(0.5**0.5, rel=1e-4)


def test_every_step_of_a_run_is_the_same_in_both_spaces(trained):
    """Euler on motions, from noise of that covariance, is Euler in projected space."""
    prior, times = trained[0], [0.0, 0.3, 0.6, 0.9]
    x_proj = torch.randn(2, 32, 66, generator=torch.Generator().manual_seed(2)).double()
    x_t = prior.unproject(x_proj)
    for t, t_next in itertools.pairwise(times):
        x_proj = x_proj + (t_next - t) * prior(x_proj, t, "walks")
        x1_hat = prior.unproject(prior.endpoint(prior.project(x_t), t, "walks"))
        x_t = x_t + (t_next - t) / (1 - t) * (x1_hat - x_t)
    torch.testing.assert_close(prior.unproject(x_proj), x_t, atol=1e-4, rtol=1e-4)


def test_the_loss_is_that_of_noise_and_answers_in_projected_space():
    """A perfect network has none; white noise is drawn as ever, and then coloured.

    An error of a metre of the place counts as much as it does in projected space beside one of the
    body: measured as the white noise that would make it.
    """
    trainer = EmphasisTrainer(SMOKE)
    u1, ids = trainer.batch()
    trainer.network.forward = lambda x, t, ids: u1
    assert trainer.loss(u1, ids, torch.Generator().manual_seed(0)) == 0
    white = torch.randn(1000, 20, 22, 3, generator=torch.Generator().manual_seed(0))
    drawn = seen_from_pelvis(trainer.colour(white)).flatten(0, 1).std(0)
    place = 0.1 * trainer.model.spreads[0] / trainer.model.spreads[1]
    expected = torch.ones(66).double()
    expected[list(EMPHASISED)] = place  # a tenth, by their spreads
    torch.testing.assert_close(drawn, expected, rtol=0.03, atol=0)
    still = torch.zeros(1, 2, 22, 3)
    aside = still.clone()
    aside[..., 0] = 1.0  # all joints, so no bone and no velocity is wrong
    assert float(trainer.size(aside)) == pytest.approx(1 / 3 / place**2, rel=1e-3)
    raised = still.clone()
    raised[..., 1] = 1.0
    assert float(trainer.size(raised)) == pytest.approx(1 / 3, rel=1e-3)


def test_training_lowers_the_loss():
    recipe = replace(SMOKE, steps=60, batch=16, learning_rate=0.01, lengths=(32,))
    trainer = EmphasisTrainer(recipe)
    motions, ids = trainer.batch()

    def loss_now():
        with torch.no_grad():
            return float(trainer.loss(motions, ids, torch.Generator().manual_seed(0)))

    before = loss_now()
    while trainer.step < 60:
        trainer.advance()
    assert loss_now() < 0.98 * before


def weights(prior):
    return torch.cat([w.flatten() for w in prior.plain.network.parameters()])


def test_a_run_that_was_interrupted_ends_as_one_that_was_not(trained, tmp_path):
    half = begin(SMOKE, tmp_path)
    assert isinstance(half, EmphasisTrainer)
    while half.step < 3:
        half.advance()
    half.save(tmp_path / "run.safetensors")
    resumed = train(SMOKE, tmp_path, progress=False)
    assert torch.equal(weights(resumed), weights(trained[0]))
    assert torch.equal(resumed.A, trained[0].A)


def test_a_run_may_begin_with_the_weights_of_a_prior(motions, tmp_path):
    start = tmp_path / "start.safetensors"
    save_prior(fresh_prior(motions), start)
    trainer = EmphasisTrainer(replace(SMOKE, start=str(start)))
    assert trainer.prior.lengths == (20, 196)  # those of the prior, not of the recipe
    theirs = dict(load_prior(start).network.named_parameters())
    for name, ours in trainer.network.named_parameters():
        assert ours.requires_grad
        assert torch.equal(ours, theirs[name])
    trainer.advance()
    trainer.write(tmp_path / "prior.safetensors")
    again = trainer.read(tmp_path / "prior.safetensors")
    assert again.plain.recipe["start"] == str(start)


def test_a_checkpoint_comes_back_with_its_random_matrix(trained, tmp_path):
    prior, folder = trained
    save_emphasised(prior, tmp_path / "again.safetensors")
    again = load_emphasised(tmp_path / "again.safetensors")
    assert torch.equal(again.A, prior.A)
    assert (again.c, again.scale, again.lengths) == (10, prior.scale, (20, 32))
    assert again.plain.recipe == json.loads(json.dumps(asdict(SMOKE)))
    x = torch.randn(1, 20, 66, generator=torch.Generator().manual_seed(0))
    assert torch.equal(again(x, 0.5, "a person walks"), prior(x, 0.5, "a person walks"))
    files = [tmp_path / "again.safetensors", folder / "prior.safetensors"]
    assert files[0].read_bytes() == files[1].read_bytes()


@pytest.mark.parametrize("method", ["gmd", "gmd_keyframes"])
def test_gmd_samples_through_it(trained, method):
    prior = trained[0]
    wish = pf.pin("pelvis", [10], [[0.3, 0.5]], axes="xz")
    motion = sample(prior, wish, "a person walks", 32, 3, method=method, batch=2, until=1.0)
    assert motion.positions.shape == (2, 32, 22, 3)
    np.testing.assert_allclose(motion.positions[:, 10, 0, [0, 2]], [[0.3, 0.5]] * 2, atol=1e-6)
    free = sample(prior, None, "a person walks", 32, 3)
    assert np.isfinite(free.positions).all()


def test_damaged_and_foreign_checkpoints_are_named(trained, motions, tmp_path):
    whole = (trained[1] / "prior.safetensors").read_bytes()
    cut = tmp_path / "cut.safetensors"
    for keep in (0, 1000, -1):
        cut.write_bytes(whole[:keep])
        with pytest.raises(ValueError, match=r"cut\.safetensors is damaged or is not a checkp"):
            load_emphasised(cut)
    with pytest.raises(FileNotFoundError, match="there is no checkpoint at"):
        load_emphasised(tmp_path / "nothing.safetensors")
    save_prior(fresh_prior(motions), tmp_path / "plain.safetensors")
    with pytest.raises(ValueError, match=r"plain\.safetensors is not a projflow_lite emphasised"):
        load_emphasised(tmp_path / "plain.safetensors")
    with pytest.raises(ValueError, match="is not a projflow_lite prior"):
        load_prior(trained[1] / "prior.safetensors")


def test_a_checkpoint_that_contradicts_itself_is_named(trained, tmp_path):
    prior = load_emphasised(trained[1] / "prior.safetensors")
    prior.plain.sizes = {"widths": [24, 24]}
    save_emphasised(prior, tmp_path / "odd.safetensors")
    with pytest.raises(ValueError, match=r"odd\.safetensors does not fit its own description"):
        load_emphasised(tmp_path / "odd.safetensors")
    prior = load_emphasised(trained[1] / "prior.safetensors")
    prior.A = prior.A[:3]
    save_emphasised(prior, tmp_path / "odd.safetensors")
    with pytest.raises(ValueError, match="does not fit its own description: no matrix A"):
        load_emphasised(tmp_path / "odd.safetensors")


def test_wrong_shapes_and_lengths_are_refused(trained):
    prior = trained[0]
    with pytest.raises(ValueError, match=r"expected a projected motion \(batch, frames, 66\)"):
        prior(torch.zeros(2, 20, 22, 3), 0.5)
    with pytest.raises(ValueError, match=r"project: expected shape \(..., 22, 3\), got \(20, 66\)"):
        prior.project(torch.zeros(20, 66))
    with pytest.raises(ValueError, match=r"unproject: expected shape \(..., 66\), got"):
        prior.unproject(torch.zeros(20, 22, 3))
    with pytest.raises(ValueError, match="500 frames; it was trained on motions of 20 to 32"):
        sample(prior, None, frames=500)
    with pytest.raises(ValueError, match="take gmd"):
        sample(prior, pf.pin("pelvis", [0], np.zeros((1, 3))), frames=20)

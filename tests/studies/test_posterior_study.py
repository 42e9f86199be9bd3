"""The posterior study: its sampler against its exact law, its distances against other ways."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import integrate, stats

from projflow_lite import equations as eq
from projflow_lite.studies import (
    posterior,
    posterior_exact,
    posterior_explorer,
    posterior_modes,
    posterior_words,
)
from projflow_lite.studies import posterior_worlds as worlds
from projflow_lite.studies.posterior_explorer import PosteriorExplorer

STORED = Path(__file__).parents[2] / "book" / "results" / "posterior.json"


@pytest.fixture(scope="module")
def rows():
    """Everything the study has rows for, as small as it runs."""
    steps = (5, 20)
    exact = posterior_exact.gaussian_rows(steps, False) + posterior_exact.path_rows(steps, False)
    return exact + posterior_modes.mixture_rows(6, 60, 2, False)


@pytest.mark.parametrize("metric", worlds.METRICS)
@pytest.mark.parametrize(
    ("noise", "eta"), [("original", "0"), ("implied", "paper"), ("guided", "2/steps")]
)
@pytest.mark.parametrize("variance", [0.0, 0.0625])
def test_the_loop_has_the_law_of_the_exact_rows(metric, noise, eta, variance):
    world = worlds.plane(variance)
    x = worlds.sample_ends(world, metric, noise, eta, 8, 20_000, seed=0)
    mean, covariance = eq.sampler_moments(
        world.means[0], world.covariances[0], eq.time_grid(8),
        posterior_exact.projection_of(world, metric), noise, lambda t: worlds.ETAS[eta](t, 8),
    )  # fmt: skip
    variances = np.diag(covariance)
    assert (np.abs(x.mean(0) - mean) < 5 * np.sqrt(variances / len(x)) + 1e-9).all()
    error = np.sqrt((np.outer(variances, variances) + covariance**2) / len(x))
    assert (np.abs(np.cov(x.T) - covariance) < 5 * error + 1e-9).all()


def test_projecting_many_at_once_is_projecting_each():
    rng = np.random.default_rng(0)
    world = worlds.three_modes(variance=0.1)
    x = rng.normal(size=(4, 2))
    moving = worlds.inverse_metric(world, "moving", x, 0.4)
    assert moving.shape == (4, 2, 2)
    together = worlds.project_all(x, world, moving)
    for one, metric, ours in zip(x, moving, together, strict=True):
        right = eq.project(one, world.A, world.y, np.linalg.inv(metric), world.Sigma)
        np.testing.assert_allclose(ours, right, rtol=0, atol=1e-12)


def test_the_first_noise_depends_on_the_seed_only():
    world = worlds.three_modes()
    one = worlds.sample(world, "euclid", "implied", "paper", 3, 5, seed=1)
    other = worlds.sample(world, "moving", "guided", "0", 7, 5, seed=1)
    np.testing.assert_array_equal(one.x_t[0], other.x_t[0])
    np.testing.assert_array_equal(one.x_t[1:], one.x_next[:-1])
    np.testing.assert_allclose(one.x_next[-1][:, 0], world.y[0], rtol=0, atol=1e-12)


def test_exact_samples_have_the_moments_and_modes_of_the_posterior():
    world = worlds.three_modes()
    weights, means, covariances = world.posterior
    x = worlds.exact_samples(world, 40_000, seed=3)
    mean = weights @ means
    off = means - mean
    covariance = np.einsum("k,kij->ij", weights, covariances + off[:, :, None] * off[:, None])
    np.testing.assert_allclose(x.mean(0), mean, rtol=0, atol=5 * covariance[1, 1] ** 0.5 / 200)
    np.testing.assert_allclose(np.cov(x.T), covariance, rtol=0, atol=0.02)
    np.testing.assert_allclose(worlds.shares_of_modes(world, x), weights, rtol=0, atol=0.012)


def test_the_exact_flow_finds_the_modes():
    world = worlds.three_modes()
    x = worlds.exact_flow(world, 100, 20_000, seed=0)
    np.testing.assert_array_equal(x[:, 0], world.y[0])
    np.testing.assert_allclose(
        worlds.shares_of_modes(world, x), world.posterior[0], rtol=0, atol=0.02
    )


def test_moments_of_the_mixture_by_sampling():
    world = worlds.three_modes()
    rng = np.random.default_rng(0)
    mode = rng.choice(3, size=100_000, p=world.weights)
    x = np.stack(
        [rng.multivariate_normal(m, C, 100_000) for m, C in zip(*world.data[1:], strict=True)]
    )
    x = x[mode, np.arange(100_000)]
    mean, covariance = world.moments
    np.testing.assert_allclose(x.mean(0), mean, rtol=0, atol=0.015)
    np.testing.assert_allclose(np.cov(x.T), covariance, rtol=0, atol=0.015)


def test_distances_of_the_posterior_itself_are_none():
    for world in (worlds.line(), worlds.plane(), worlds.plane(0.0625), worlds.path()):
        _, means, covariances = world.posterior
        found = posterior_exact.distances(world, means[0], covariances[0])
        assert found["spread"] == pytest.approx(1)
        assert found["mean error"] == pytest.approx(0, abs=1e-12)
        assert found["KL"] == pytest.approx(0, abs=1e-7)
        assert found["W2"] == pytest.approx(0, abs=1e-6)


def test_distances_along_a_line_by_quadrature():
    world = worlds.line()
    ours, true = stats.norm(0.1, 0.3), stats.norm(0, 0.2)
    found = posterior_exact.distances(world, np.array([0.1]), np.array([[0.09]]))
    kl = integrate.quad(lambda x: ours.pdf(x) * (ours.logpdf(x) - true.logpdf(x)), -3, 3)[0]
    assert found["KL"] == pytest.approx(kl, abs=1e-6)
    quantile = np.linspace(0, 1, 200_001)[1:-1]
    w2 = np.sqrt(np.mean((ours.ppf(quantile) - true.ppf(quantile)) ** 2))
    assert found["W2"] == pytest.approx(w2, abs=1e-4)
    assert found["mean error"] == pytest.approx(0.5)
    assert found["spread"] == pytest.approx(1.5)


def test_energy_distance_is_scipys():
    rng = np.random.default_rng(0)
    a, b = rng.normal(size=(50, 1)), rng.normal(0.5, 2, size=(70, 1))
    theirs = stats.energy_distance(a[:, 0], b[:, 0])
    assert posterior_modes.energy_distance(a, b) == pytest.approx(theirs)


def test_guides_lie_on_the_line_between_keyframes_and_fade():
    world = worlds.path()
    start = posterior_exact.with_guides(world, np.eye(16), 0.0)
    A, y, Sigma = start
    assert A.shape == (16, 16), "at the start every frame but the keyframes has a guide"
    np.testing.assert_array_equal(A[:2], world.A)
    values = dict(zip(A.argmax(axis=1).tolist(), y, strict=True))
    np.testing.assert_allclose(
        [values[n] for n in (0, 6, 9, 15)], [0.5, 0.5 - 0.8 / 3, 0.5 - 1.6 / 3, -0.3]
    )
    np.testing.assert_allclose(np.diag(Sigma)[2:], 1 / 0.99 - 1)
    assert (np.diag(Sigma)[:2] == 0).all()
    A, _, Sigma = posterior_exact.with_guides(world, np.eye(16), 1.0)
    assert sorted(A[2:].argmax(axis=1)) == [1, 2, 4, 5, 10, 11, 13, 14], "radius 3 at the end"
    assert np.diag(Sigma)[2:].min() > 5, "trust 1.5 times a tenth: variance 1 / 0.15 - 1"


def test_every_choice_has_its_row(rows):
    worlds_seen = [row["world"] for row in rows]
    assert worlds_seen.count("line") == len(worlds.CHOICES) == 10
    assert worlds_seen.count("plane") == 2 * 4 * 10
    assert worlds_seen.count("path") == 2 * 3 * 3
    assert worlds_seen.count("three modes") == 2 + 3 * 10
    text = posterior.table(rows)
    assert len(text.splitlines()) == len(rows) + 6 + len(posterior.sentences(rows))
    json.dumps(rows, allow_nan=False)


def test_the_sentences_say_the_numbers(rows):
    changed = json.loads(json.dumps(rows))
    row = posterior_words.pick(changed, world="line", noise="implied", eta="0")
    row["scores"]["spread"][-1] = 0.4321
    assert "0.432 of the true one at 20 steps" in posterior.sentences(changed)[0]
    assert "0.432 " not in posterior.sentences(rows)[0]


def test_a_choice_that_is_not_named_in_full_is_refused(rows):
    with pytest.raises(ValueError, match="rows have"):
        posterior_words.pick(rows, world="plane", noise="implied")


def test_the_picture_is_drawn(rows, tmp_path):
    path = posterior.figure(rows, tmp_path / "posterior.png")
    assert path.stat().st_size > 50_000


@pytest.mark.parametrize("place", [0, 20, 58, 99])
def test_stored_numbers_are_those_of_this_code(place):
    stored = json.loads(STORED.read_text())["rows"][place]
    world = {
        "none": worlds.line(),
        "hard": worlds.path() if stored["world"] == "path" else worlds.plane(),
        "soft": worlds.plane(0.0625),
        "hard and guides": worlds.path(),
    }[stored["wish"]]
    metric = "euclid" if stored["metric"] == "none" else stored["metric"]
    projection = posterior_exact.projection_of(world, metric, "guides" in stored["wish"])
    scores = posterior_exact.exact_row(world, projection, stored["noise"], stored["eta"], (5, 50))
    for name in ("mean error", "spread", "W2", "KL"):
        expected = [stored["scores"][name][i] for i in (0, 3)]
        np.testing.assert_allclose(scores[name], expected, rtol=1e-3, atol=1e-6)


def test_the_explorer_follows_its_controls():
    explorer = PosteriorExplorer(count=60)
    assert explorer.trace.x_t.shape == (20, 60, 2)
    explorer._moved("y", (0.4, 0.0))
    np.testing.assert_allclose(explorer.trace.x_next[-1][:, 0], 0.4, rtol=0, atol=1e-12)
    explorer.noise.value, explorer.eta.value, explorer.metric.value = "guided", "0", "moving"
    right = worlds.sample(worlds.three_modes(0.4), "moving", "guided", "0", 20, 60, seed=0)
    np.testing.assert_array_equal(explorer.trace.x_next, right.x_next)
    explorer.step.value = 19
    assert explorer.time.value == "20 of 20: t = 0.95 → 1.00"
    explorer.steps.value = 5
    assert len(explorer.trace.x_t) == 5
    assert explorer.time.value == "5 of 5: t = 0.80 → 1.00"
    shares = " / ".join(f"{100 * share:.0f}" for share in explorer.scores["shares"])
    assert shares in explorer.said.value


def test_the_outline_of_a_histogram_encloses_all_samples():
    z = np.random.default_rng(0).uniform(-2, 2, size=20_000)
    outline = posterior_explorer.histogram(z)
    area = np.abs(np.sum(outline[:-1, 0] * np.diff(outline[:, 1])))
    assert area == pytest.approx(1)
    assert outline[:, 0].max() < 0.3, "a uniform density of a quarter"

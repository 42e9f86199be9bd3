"""The table that judges a prior, on priors whose place in it is known beforehand."""

import json
from collections import Counter
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pytest
import torch

from data_synth import held_out
from projflow_lite.prior.training import RECIPES, train
from projflow_lite.studies import score_prior, score_prior_words
from projflow_lite.studies.score_prior import COLUMNS, SAMPLES
from projflow_lite.studies.score_prior_words import BARS

SMOKE = replace(RECIPES["smoke"], steps=2, lengths=(40,))
BOOK = Path(__file__).parents[2] / "book"


@pytest.fixture(autouse=True, scope="module")
def few_prompts():
    """To find twelve captions that occur ten times takes longer than all the rest."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(score_prior, "PROMPTS", 3)
        yield


class Copyist:
    """A prior that knows the held-out data by heart, or nothing but noise."""

    noise_std, lengths = 1.0, (40, 40)

    def __init__(self, spoil=0.0):
        self.spoil = spoil
        self.known = held_out(2048, 40, seed=77_777)
        self.places = {}
        for k, text in enumerate(self.known.captions):
            self.places.setdefault(text, []).append(k)

    def __call__(self, x_t, t, text=None):
        random = np.random.default_rng(int(1e6 * abs(float(x_t[0, 0, 0, 0]))) % 2**32)
        # A caption that it never met gets any clip it knows.
        anything = range(len(self.known.captions))
        chosen = [random.choice(self.places.get(caption, anything)) for caption in text]
        x1 = self.known.positions[chosen]
        x1 = x1 + self.spoil * random.normal(size=x1.shape)
        return (torch.as_tensor(x1, dtype=x_t.dtype) - x_t) / (1 - t)


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    folder = tmp_path_factory.mktemp("run")
    prior = train(SMOKE, folder, progress=False)
    return score_prior.run(prior, clips=64, repetitions=2, steps=(1, 2), progress=False)


def test_a_row_for_the_data_and_one_for_every_number_of_steps(rows):
    assert [row["row"] for row in rows] == [
        "held-out data",
        "data as splines",
        "1 steps",
        "2 steps",
    ]
    for row in rows:
        assert tuple(row["scores"]) == COLUMNS
        for cell in row["scores"].values():
            assert np.isfinite([cell["mean"], cell["half width"]]).all()


def test_held_out_data_is_the_floor_and_noise_is_far_above_it(rows):
    data, noise = rows[0]["scores"], rows[2]["scores"]
    assert all(cell["ratio"] == 1 for name, cell in data.items() if name != "bone error %")
    assert data["bone error %"]["mean"] < 0.01
    assert data["R top 3"]["mean"] > 0.5
    for name in ("FID", "kinetic distance", "matching", "jerk", "bone error %"):
        assert noise[name]["mean"] > 2 * data[name]["mean"]
    assert noise["R top 3"]["mean"] < 0.5 * data["R top 3"]["mean"]


def test_curves_of_the_network_are_near_the_data_and_smoother(rows):
    data, curves = rows[0]["scores"], rows[1]["scores"]
    assert curves["FID"]["mean"] < 2 * data["FID"]["mean"]
    assert 0.5 < curves["jerk"]["ratio"] < 1
    assert curves["bone error %"]["mean"] > data["bone error %"]["mean"]


@pytest.mark.parametrize("frames", [24, 30, 33])
def test_the_nearest_curves_are_curves_and_nearer_than_others(frames):
    clip = held_out(1, frames, 5).positions[0]
    best = score_prior.nearest_splines(clip)
    assert best.shape == clip.shape
    assert np.allclose(score_prior.nearest_splines(best), best)  # they are curves already
    random = np.random.default_rng(0).normal(size=(7, *clip.shape))
    for other in random:
        near = best + 1e-3 * score_prior.nearest_splines(other)
        assert np.square(near - clip).sum() > np.square(best - clip).sum()


def test_an_interrupted_run_goes_on(rows, tmp_path, monkeypatch):
    prior = train(SMOKE, tmp_path / "run", progress=False)
    made, generate = [], score_prior.generate

    def counting(*given):
        if len(made) == 2:
            raise KeyboardInterrupt
        made.append(given[0])
        return generate(*given)

    def run():
        return score_prior.run(prior, 64, 2, (1, 2), progress=False, folder=tmp_path / "cells")

    monkeypatch.setattr(score_prior, "generate", counting)
    with pytest.raises(KeyboardInterrupt):
        run()
    made.clear()
    monkeypatch.setattr(
        score_prior, "generate", lambda *given: made.append(given) or generate(*given)
    )
    resumed = run()
    assert len(made) == 2 * (2 * 2 - 1), "one row of one repetition was there"
    assert resumed == rows


def test_two_priors_are_asked_for_lengths_that_both_know(tmp_path):
    prior = train(SMOKE, tmp_path / "run", progress=False)
    other = train(replace(SMOKE, seed=1, lengths=(20, 40)), tmp_path / "other", progress=False)
    data, one, two = score_prior.beside(prior, other, 64, 2, 1, progress=False)
    assert [row["row"] for row in (data, one, two)] == ["held-out data", "shipped", "classroom"]
    assert data["lengths"] == [40]
    assert one["scores"]["jerk"]["mean"] != two["scores"]["jerk"]["mean"]


def test_every_row_and_bar_has_a_verdict_in_the_table(rows):
    text, sentences = score_prior_words.table(rows), score_prior_words.verdicts(rows)
    assert len(sentences) == 2 * len(BARS)
    for part in (*COLUMNS, *sentences, "2 repetitions of 64 clips", "held-out data", "1 steps"):
        assert part in text
    assert any("MISSED" in line and "FID" in line for line in sentences)


def test_the_card_holds_every_number_of_the_table(rows):
    card = score_prior_words.card(rows, [], {"steps": 2, "batch": 8})
    assert "trained for 2 steps of 8 clips" in card
    assert "ten minutes" not in card
    for row in rows:
        for name in COLUMNS:
            assert score_prior_words.shown(row["scores"][name]) in card
    for line in score_prior_words.verdicts(rows):
        assert f"- {line}\n" in card


def test_the_card_compares_the_recipes(rows):
    two = [rows[0], rows[2] | {"row": "shipped"}, rows[3] | {"row": "classroom"}]
    card = score_prior_words.card(rows, two, {"steps": 2, "batch": 8})
    for line in score_prior_words.verdicts(two):
        assert (f"- {line}\n" in card) == line.startswith("classroom")


def test_the_card_in_the_book_is_written_from_its_numbers():
    found = json.loads((BOOK / "results" / "prior-card.json").read_text())
    recipe = json.loads(json.dumps(asdict(RECIPES["shipped"])))
    assert (BOOK / "prior-card.md").read_text() == score_prior_words.card(
        found["shipped"], found["classroom"], recipe
    )


def test_a_prior_that_copies_data_of_its_kind_meets_the_bars_of_physics():
    rows = score_prior.run(Copyist(), 64, 2, (1,), progress=False)
    cells = rows[2]["scores"]
    assert cells["bone error %"]["mean"] < 0.01
    assert cells["jerk"]["ratio"] == pytest.approx(1, abs=0.25)
    assert cells["multimodality"]["ratio"] == pytest.approx(1, abs=0.5)
    spoiled = score_prior.run(Copyist(spoil=0.05), 64, 1, (1,), progress=False)[2]["scores"]
    assert spoiled["jerk"]["mean"] > 3 * cells["jerk"]["mean"]
    assert spoiled["kinetic distance"]["mean"] > 3 * cells["kinetic distance"]["mean"]


def cell(mean, half, ratio, ratio_half):
    return {"mean": mean, "half width": half, "ratio": ratio, "ratio half width": ratio_half}


@pytest.mark.parametrize(
    ("score", "values", "expected"),
    [
        ("FID", (1.0, 0.1, 1.9, 0.05), "1.90 ± 0.05 times held-out data, bar at most 2: met."),
        ("FID", (1.0, 0.1, 2.1, 0.05), "at most 2: MISSED."),
        ("FID", (1.0, 0.1, 2.1, 0.2), "MISSED, but the interval holds the bar."),
        ("R top 3", (0.9, 0.01, 0.94, 0.005), "bar at least 0.95: MISSED."),
        ("diversity", (5.0, 0.1, 1.06, 0.005), "bar 0.95 to 1.05: MISSED."),
        ("bone error %", (0.9, 0.05, 4e4, 1e3), "is 0.90 ± 0.05, bar at most 1: met."),
        ("jerk", (5.0, 0.1, 1.2, float("nan")), "met."),
    ],
)
def test_verdicts_say_what_the_numbers_say(score, values, expected):
    bar = next(bar for bar in BARS if bar.score == score)
    row = {"row": "25 steps", "steps": 25, "scores": {score: cell(*values)}}
    assert score_prior_words.sentence(row, bar).endswith(expected)


def test_a_ratio_has_the_error_of_both_its_parts():
    made = [dict.fromkeys(COLUMNS, value) for value in (2.0, 2.2)]
    floor = [dict.fromkeys(COLUMNS, value) for value in (1.0, 1.2)]
    got = score_prior.summary(made, floor)["FID"]
    half = 12.7062 * 0.1  # Student's t with one degree of freedom, times the standard error
    assert got["mean"] == pytest.approx(2.1)
    assert got["half width"] == pytest.approx(half, rel=1e-4)
    assert got["ratio"] == pytest.approx(2.1 / 1.1)
    expected = 2.1 / 1.1 * np.hypot(half / 2.1, half / 1.1)
    assert got["ratio half width"] == pytest.approx(expected, rel=1e-4)


def test_repeated_clips_share_their_caption_and_prompts_are_of_different_actions():
    many = score_prior.repeated(30, prompts=3, seed=0, pool=2048)
    assert Counter(Counter(many.captions).values()) == {SAMPLES: 3}
    for k in range(3):
        assert len(set(many.captions[k * SAMPLES : (k + 1) * SAMPLES])) == 1
    assert len({clip.tobytes() for clip in many.positions}) == 3 * SAMPLES


def test_samples_differ_by_seed_and_mix_lengths():
    one, two = (score_prior.data_sample([20, 30], 128, seed) for seed in (1, 2))
    assert [len(clip) for clip in one.positions] == [20] * 64 + [30] * 64
    assert not np.array_equal(one.positions[0], two.positions[0])


def test_lengths_are_those_the_prior_was_trained_on():
    assert score_prior.lengths_of(Copyist()) == [40]
    prior = type("P", (), {"lengths": (40, 80)})()
    other = type("P", (), {"lengths": (20, 60)})()
    assert score_prior.lengths_of(prior) == [40, 60, 80]
    assert score_prior.lengths_of(prior, other) == [40, 50, 60]
    assert score_prior.lengths_of(lambda x_t, t, text=None: x_t) == [40, 60, 80]


@pytest.mark.parametrize(
    ("numbers", "words"),
    [
        ((100, 2, (25,)), "multiple of 64"),
        ((64, 0, (25,)), "one repetition"),
        ((64, 2, ()), "step"),
    ],
)
def test_numbers_that_make_no_sense_are_refused(numbers, words):
    with pytest.raises(ValueError, match=words):
        score_prior.run(Copyist(), *numbers)

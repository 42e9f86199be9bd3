"""Scores of sets of embeddings, against sets whose answer is known beforehand."""

import numpy as np
import pytest
from scipy import stats

from projflow_lite import scores


def pairs(n=3200, features=16, noise=0.1, seed=0):
    """Points of texts, and of motions near them."""
    random = np.random.default_rng(seed)
    text = random.normal(size=(n, features))
    return text, text + noise * random.normal(size=text.shape)


def test_texts_in_place_are_found_and_shuffled_ones_are_at_chance():
    text, motion = pairs()
    assert scores.r_precision(text, motion) == (1.0, 1.0, 1.0, 3200)
    shuffled = np.random.default_rng(1).permutation(text)
    found = scores.r_precision(shuffled, motion)
    for top, share in enumerate(found[:3], start=1):
        low, high = stats.binom.interval(0.999, 3200, top / 32)
        assert low <= share * 3200 <= high


def test_ranks_worked_out_by_hand():
    """Four texts on a line; motions whose own text is nearest, second, third and last."""
    text = np.array([[0.0], [10.0], [20.0], [30.0]])
    motion = np.array([[1.0], [16.0], [2.0], [-5.0]])
    assert scores.r_precision(text, motion, batch=4) == (0.25, 0.5, 0.75, 4)


def test_what_does_not_fill_a_batch_of_32_is_dropped():
    text, motion = pairs(70)
    motion[64:] += 100.0  # the six that are left over would be far off
    assert scores.r_precision(text, motion) == (1.0, 1.0, 1.0, 64)
    with pytest.raises(ValueError, match="31 motions do not fill one batch of 32"):
        scores.r_precision(text[:31], motion[:31])


def test_a_caption_that_occurs_twice_is_found_half_of_the_time():
    text, motion = pairs(32, noise=0.0)
    text[1], motion[1] = text[0], motion[0]
    assert scores.r_precision(text, motion) == (31 / 32, 1.0, 1.0, 32)
    same = np.zeros((32, 4))
    assert scores.r_precision(same, same)[:3] == pytest.approx((1 / 32, 2 / 32, 3 / 32))


def test_matching_score_is_the_mean_distance():
    text = np.zeros((2, 2))
    assert scores.matching_score(text, [[3.0, 4.0], [0.0, 1.0]]) == 3.0
    with pytest.raises(ValueError, match="matching_score"):
        scores.matching_score(text, np.zeros((3, 2)))
    with pytest.raises(ValueError, match="not finite"):
        scores.matching_score(text, np.full((2, 2), np.nan))


@pytest.mark.parametrize(("features", "std"), [(1, 0.5), (64, 2.0)])
def test_diversity_of_a_gaussian(features, std):
    """The difference of two draws is chi-distributed, with sqrt(2) times their spread."""
    points = std * np.random.default_rng(0).normal(size=(20_000, features))
    distance = stats.chi(features, scale=np.sqrt(2) * std)
    measured = scores.diversity(points, pairs=20_000)
    assert measured == pytest.approx(distance.mean(), abs=4 * distance.std() / np.sqrt(20_000))
    assert scores.diversity(points) == pytest.approx(
        distance.mean(), abs=4 * distance.std() / np.sqrt(300)
    )


def test_diversity_follows_its_seed_and_never_pairs_a_motion_with_itself():
    points = np.random.default_rng(0).normal(size=(50, 3))
    assert scores.diversity(points, seed=1) == scores.diversity(points, seed=1)
    assert scores.diversity(points, seed=1) != scores.diversity(points, seed=2)
    assert scores.diversity([[0.0], [7.0]]) == 7.0
    with pytest.raises(ValueError, match="at least 2"):
        scores.diversity([[0.0]])


def test_multimodality_is_the_diversity_within_a_prompt():
    random = np.random.default_rng(0)
    prompts = 100.0 * random.normal(size=(100, 1, 8))
    identical = np.repeat(prompts, 20, axis=1)
    assert scores.multimodality(identical) == 0.0
    spread = identical + random.normal(size=identical.shape)
    distance = stats.chi(8, scale=np.sqrt(2))
    tolerance = 4 * distance.std() / np.sqrt(1000)
    assert scores.multimodality(spread) == pytest.approx(distance.mean(), abs=tolerance)
    with pytest.raises(ValueError, match="multimodality"):
        scores.multimodality(prompts)


def test_a_copy_of_the_data_is_at_the_floor():
    random = np.random.default_rng(0)
    data, other, off = (random.normal(size=(500, 8)) for _ in range(3))
    floor = scores.frechet_distance(data, other)
    assert scores.frechet_distance(data, data.copy()) == pytest.approx(0, abs=1e-9)
    assert 0.01 < floor < 0.2
    # The means are 0.5 apart in each of 8 features.
    assert scores.frechet_distance(data, off + 0.5) == pytest.approx(8 * 0.25, abs=0.5)


def test_interval_of_three_repetitions_by_hand():
    """Student's t with two degrees of freedom is 4.3027; the standard error of 1, 2, 3 is 0.5774."""
    mean, half = scores.interval([1.0, 2.0, 3.0])
    assert mean == 2.0
    assert half == pytest.approx(4.302653 / np.sqrt(3), rel=1e-6)
    assert np.isnan(scores.interval([5.0]).half_width)


def test_interval_holds_the_truth_as_often_as_it_says():
    random = np.random.default_rng(0)
    held = [
        abs(mean - 1.0) < half
        for mean, half in (scores.interval(random.normal(1.0, 2.0, 4)) for _ in range(2000))
    ]
    low, high = stats.binom.interval(0.999, 2000, 0.95)
    assert low <= sum(held) <= high


def test_interval_refuses_what_has_none():
    with pytest.raises(ValueError, match="one number for each repetition"):
        scores.interval([])
    with pytest.raises(ValueError, match="between 0 and 1"):
        scores.interval([1.0, 2.0], confidence=95)

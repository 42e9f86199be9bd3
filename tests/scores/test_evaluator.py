"""The evaluator: what it was taught, what it knows, and how it is stored."""

import json
import math
from dataclasses import asdict
from importlib.resources import files

import numpy as np
import pytest
import torch

from data_synth import make_clips
from projflow_lite import scores
from projflow_lite.prior.text import Vocabulary
from projflow_lite.scores import evaluator_training as training
from projflow_lite.scores.evaluator import SHIPPED, Evaluator, Sizes, save_evaluator

TINY = training.Recipe(steps=3, batch=8, lengths=(24, 30))
SMALL = Sizes(motion=(8, 8, 8), text=8)


@pytest.fixture(scope="module")
def shipped():
    return scores.load_evaluator()


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    path = tmp_path_factory.mktemp("evaluator") / "tiny.safetensors"
    return path, training.train(path, seed=4, progress=False, recipe=TINY)


def test_the_loss_is_info_nce_on_squared_distances():
    """Two motions and two captions in one dimension, by hand."""
    motion, text = torch.tensor([[0.0], [3.0]]), torch.tensor([[1.0], [2.0]])
    by_motion = -math.log(math.exp(-1) / (math.exp(-1) + math.exp(-4)))  # and the same for 3
    loss = training.contrastive_loss(motion, text, ["a", "b"])
    assert loss.item() == pytest.approx(2 * by_motion, rel=1e-6)  # the mirrored half is the same


def test_equal_captions_are_not_wrong_answers_for_each_other():
    motion, text = torch.tensor([[0.0], [3.0]]), torch.tensor([[1.0], [1.0]])
    assert training.contrastive_loss(motion, text, ["a", "a"]).item() == 0
    motion = torch.tensor([[0.0], [3.0], [5.0]], requires_grad=True)
    text = torch.tensor([[1.0], [1.0], [4.0]])
    training.contrastive_loss(motion, text, ["a", "a", "b"]).backward()
    assert torch.isfinite(motion.grad).all()


def test_a_trained_file_says_what_it_is_and_equals_what_was_trained(trained):
    path, evaluator = trained
    again = scores.load_evaluator(path)
    assert again.recipe == json.loads(json.dumps(asdict(TINY) | {"seed": 4}))
    assert again.vocabulary.words == evaluator.vocabulary.words
    x = make_clips(3, 40).positions
    np.testing.assert_array_equal(again.embed_motion(x), evaluator.embed_motion(x))


def test_the_same_seed_trains_the_same_evaluator(trained, tmp_path):
    path, _ = trained
    training.train(tmp_path / "again.safetensors", seed=4, progress=False, recipe=TINY)
    assert (tmp_path / "again.safetensors").read_bytes() == path.read_bytes()


def test_training_improves_on_what_was_not_learnt(tmp_path):
    recipe = training.Recipe(steps=30, batch=32, lengths=(40,))
    before = training.retrieval(training.new_evaluator(recipe), 64, 40)["held-out"]["top3"]
    after = training.train(tmp_path / "e.safetensors", progress=False, recipe=recipe)
    assert training.retrieval(after, 64, 40)["held-out"]["top3"] > before + 0.1


def test_training_refuses_to_make_no_step(tmp_path):
    with pytest.raises(ValueError, match="steps is at least 1"):
        training.train(tmp_path / "e.safetensors", steps=0)


def test_files_that_are_no_evaluator_are_named(tmp_path, trained):
    with pytest.raises(FileNotFoundError, match=r"nowhere\.safetensors"):
        scores.load_evaluator(tmp_path / "nowhere.safetensors")
    half = tmp_path / "half.safetensors"
    half.write_bytes(trained[0].read_bytes()[:5000])
    with pytest.raises(ValueError, match=r"half\.safetensors is damaged"):
        scores.load_evaluator(half)
    with pytest.raises(ValueError, match="not a projflow_lite evaluator"):
        scores.load_evaluator(str(files("projflow_lite.prior") / "shipped.safetensors"))


def test_weights_that_do_not_fit_their_description_are_refused(tmp_path):
    evaluator = Evaluator(Vocabulary(["walks"]), SMALL)
    evaluator.sizes = Sizes(motion=(8, 8, 16), text=8)
    save_evaluator(evaluator, tmp_path / "wrong.safetensors")
    with pytest.raises(ValueError, match="does not fit its own sizes"):
        scores.load_evaluator(tmp_path / "wrong.safetensors")


def test_clips_of_any_length_together_are_what_they_are_alone(shipped):
    clips = [make_clips(1, frames, seed=frames).positions[0] for frames in (60, 20, 196, 60)]
    together = shipped.embed_motion(clips)
    assert together.shape == (4, 64)
    for clip, point in zip(clips, together, strict=True):
        np.testing.assert_allclose(shipped.embed_motion(clip[None])[0], point, atol=1e-4)


def test_where_a_clip_begins_on_the_ground_does_not_matter_but_its_height_does(shipped):
    x = make_clips(4, 60, seed=1).positions
    here = shipped.embed_motion(x)
    np.testing.assert_allclose(shipped.embed_motion(x + np.float32([3, 0, -2])), here, atol=1e-3)
    assert np.abs(shipped.embed_motion(x + np.float32([0, 0.5, 0])) - here).max() > 0.05


def test_what_cannot_be_embedded_is_refused_in_one_line(shipped):
    with pytest.raises(ValueError, match="19 frames; it takes 20 to 196"):
        shipped.embed_motion(np.zeros((1, 19, 22, 3)))
    with pytest.raises(ValueError, match=r"frames, 22, 3"):
        shipped.embed_motion(np.zeros((1, 60, 21, 3)))
    with pytest.raises(ValueError, match="list of texts"):
        shipped.embed_text("a person walks")
    with (
        pytest.warns(UserWarning, match="never saw 'qwertz'"),
        pytest.raises(ValueError, match="no word of"),
    ):
        shipped.embed_text(["qwertz"])


def test_equal_captions_have_equal_points_and_unknown_words_are_named(shipped):
    walk = "a person walks forward"
    points = shipped.embed_text([walk, "a person stands still", walk])
    np.testing.assert_array_equal(points[0], points[2])
    assert np.linalg.norm(points[0] - points[1]) > 0.5
    with pytest.warns(UserWarning, match="it never saw 'purple'"):
        purple = shipped.embed_text(["a purple person walks forward"])
    np.testing.assert_allclose(purple[0], points[0], atol=1e-5)


@pytest.mark.parametrize("frames", [40, 60, 120])
def test_the_shipped_one_finds_held_out_captions_and_no_shuffled_ones(shipped, frames):
    found = training.retrieval(shipped, clips=512, frames=frames)
    assert found["held-out"]["top3"] > 0.5
    assert found["held-out"]["matching"] < 0.7 * found["shuffled"]["matching"]
    assert found["shuffled"]["top3"] == pytest.approx(3 / 32, abs=0.05)


def test_the_shipped_one_is_small():
    assert len((files("projflow_lite.scores") / SHIPPED).read_bytes()) < 2e6


def test_its_distance_grows_with_what_is_wrong(shipped):
    """The more of a set is another action, the farther it is from a set of walks."""
    walk, other, squat = (
        shipped.embed_motion(make_clips(128, 60, seed=seed, actions=[action]).positions)
        for seed, action in ((1, "walk"), (2, "walk"), (3, "squat"))
    )
    few, half, all_ = (
        scores.frechet_distance(walk, np.concatenate([other[k:], squat[:k]])) for k in (8, 64, 128)
    )
    assert scores.frechet_distance(walk, other) < few < half < all_

"""The training watch without a page: it trains in the background, stops, and goes on exactly."""

from __future__ import annotations

import threading
import time

import numpy as np
import pytest
import torch

from projflow_lite.prior.training import Recipe, begin, train
from projflow_lite.widgets import training_watch
from projflow_lite.widgets.training_watch import TrainingWatch, logarithm, smoothed

RECIPE = Recipe(steps=40, batch=4, widths=(16, 24), lengths=(20,), learning_rate=2e-3)


def weights(prior):
    return torch.cat([w.flatten() for w in prior.network.parameters()])


def watch_of(folder, **options):
    return TrainingWatch(RECIPE, folder, every=10, **options)


def reach(watch, step, seconds=120):
    """Wait until the training has made so many steps."""
    end = time.monotonic() + seconds
    while watch.trainer.step < step:
        assert time.monotonic() < end, f"no step {step} after {seconds} s"
        time.sleep(0.002)


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """What `train` makes of the recipe: its losses and its folder."""
    losses = []
    folder = tmp_path_factory.mktemp("plain")
    train(RECIPE, folder, progress=False, on_step=lambda step, loss: losses.append(loss))
    return losses, folder


@pytest.fixture(scope="module")
def stopped(tmp_path_factory):
    """A watch that was stopped with its button and went on, and where it was stopped."""
    watch = watch_of(tmp_path_factory.mktemp("stopped"))
    watch.button.click()
    reach(watch, 12)
    watch.button.click()
    watch.wait()
    at, said, label = watch.trainer.step, watch.status.value, watch.button.description
    watch.button.click()
    watch.wait()
    return watch, at, said, label


def test_the_button_stops_between_two_steps_and_goes_on(stopped):
    watch, at, said, label = stopped
    assert 12 <= at < 40
    assert f"step {at} of 40" in said
    assert label == "Go on"
    assert "step 40 of 40" in watch.status.value
    assert watch.button.disabled
    assert watch.button.description == "Done"


def test_it_makes_the_steps_that_training_without_a_watch_makes(stopped, plain):
    watch, *_ = stopped
    losses, folder = plain
    np.testing.assert_array_equal(watch.losses, np.column_stack([np.arange(1, 41), losses]))
    assert torch.equal(weights(watch.prior), weights(watch.trainer.result()))
    stored = (watch.folder / "prior.safetensors").read_bytes()
    assert stored == (folder / "prior.safetensors").read_bytes()


def test_held_out_loss_falls_and_is_measured_when_it_should(stopped):
    watch, at, *_ = stopped
    steps, loss = watch.held_out.T
    assert set(steps) == {0, 10, 20, 30, 40, at}
    assert loss[-1] < 0.5 * loss[0]


def test_the_guess_is_what_the_prior_says_of_clip_and_noise(stopped):
    watch, *_ = stopped
    shown = watch.viewer.motion.positions
    np.testing.assert_array_equal(shown, watch.guess(watch.t.value))
    x_t = 0.2 * watch._noise + 0.8 * torch.as_tensor(watch.clip.positions[None]).float()
    by_hand = watch.prior.endpoint(x_t, 0.8, watch.prompt)[0]
    watch.t.value = 0.8
    np.testing.assert_allclose(watch.viewer.motion.positions, by_hand, atol=1e-6)
    assert watch.viewer.names == ["x̂₁ at t = 0.80", "the clip"]
    assert "waves with the left hand" in watch.prompt


def test_the_kernel_is_free_while_steps_are_made(tmp_path):
    watch = watch_of(tmp_path)
    begun = time.monotonic()
    watch.start()
    assert time.monotonic() - begun < 1
    assert watch.running
    reach(watch, 1)
    watch.t.value = 0.9
    assert watch.viewer.names[0] == "x̂₁ at t = 0.90"
    watch.stop()
    watch.wait()
    assert not watch.running
    assert watch.trainer.step < 40


def test_an_interrupted_wait_stops_the_training_and_stores_it(tmp_path, monkeypatch):
    watch = watch_of(tmp_path)
    join = threading.Thread.join

    def interrupted(thread, timeout=None):
        monkeypatch.setattr(threading.Thread, "join", join)
        reach(watch, 2)
        raise KeyboardInterrupt

    watch.start()
    monkeypatch.setattr(threading.Thread, "join", interrupted)
    prior = watch.wait()
    assert 2 <= watch.trainer.step < 40
    assert torch.equal(weights(prior), weights(watch.trainer.result()))
    assert begin(RECIPE, tmp_path).step == watch.trainer.step


def test_the_cell_run_again_goes_on_where_the_first_watch_was(tmp_path):
    first = watch_of(tmp_path).start()
    reach(first, 3)
    second = watch_of(tmp_path)
    assert not first.running
    assert second.trainer.step == first.trainer.step >= 3
    assert f"step {second.trainer.step} of 40" in second.status.value


def test_what_goes_wrong_is_shown_and_raised(tmp_path, monkeypatch):
    watch = watch_of(tmp_path)

    def broken():
        raise ValueError("train: the loss is <nan>")

    monkeypatch.setattr(watch.trainer, "advance", broken)
    watch.start()
    with pytest.raises(ValueError, match="the loss is <nan>"):
        watch.wait()
    assert "error: train: the loss is &lt;nan&gt;" in watch.status.value
    assert "pf-bad" in watch.status.value


def test_nobody_trains_on_when_the_kernel_ends(tmp_path):
    watch = watch_of(tmp_path).start()
    reach(watch, 1)
    training_watch.halt_all()
    assert not watch.running
    assert begin(RECIPE, tmp_path).step == watch.trainer.step


def test_wrong_arguments_are_named(tmp_path):
    with pytest.raises(ValueError, match="no held-out clip is called 'pirouettes'; one is called"):
        watch_of(tmp_path, prompt="pirouettes")
    with pytest.raises(ValueError, match="every is 0 steps, expected 1 or more"):
        TrainingWatch(RECIPE, tmp_path, every=0)


def test_smoothing_by_hand():
    curve = np.array([[1, 1.0], [2, 4.0], [3, 16.0], [4, 4.0]])
    np.testing.assert_allclose(smoothed(curve, window=2), [[1, 1], [2, 2], [3, 8], [4, 8]])
    np.testing.assert_allclose(smoothed(curve, window=9)[-1, 1], 256 ** (1 / 4))
    np.testing.assert_allclose(logarithm(np.array([[5, 0.01]])), [[5, -2]])

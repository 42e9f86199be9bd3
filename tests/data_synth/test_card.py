"""Known answers for the data card and for the two-sample test."""

import numpy as np
import pytest

from data_synth import make_clips
from data_synth.card import statistics, table
from data_synth.two_sample import two_sample_test
from projflow_lite.skeleton import FPS, JOINTS

J = {name: k for k, name in enumerate(JOINTS)}
SPEED, STRIDES, BOB, SWAY, SWING, LIFT, WIDTH = 1.3, 0.85, 0.030, 0.050, 0.30, 0.20, 0.10


def sinusoidal_walk(turned=0.0, frames=120):
    """A puppet that walks by sines: every measure of it is known beforehand."""
    t = np.arange(frames) / FPS
    angle = 2 * np.pi * STRIDES * t
    x = np.zeros((frames, 22, 3))
    x[:, :, 1] = 0.9
    x[:, 0] = np.stack([SWAY / 2 * np.sin(angle), 0.9 + BOB / 2 * np.cos(2 * angle), SPEED * t], 1)
    for j in range(1, 22):
        x[:, j] = x[:, 0] + [0, 0.02 * j, 0]
    for sign, side, other in ((1, "left", "right"), (-1, "right", "left")):
        x[:, J[f"{side}_hip"]] = x[:, 0] + [0.1 * sign, -0.1, 0]
        swing = sign * np.sin(angle)
        x[:, J[f"{side}_ankle"]] = x[:, 0] + np.stack(
            [0 * t + sign * WIDTH / 2, -0.8 - x[:, 0, 1] + 0.9, 0.3 * swing], 1
        )
        x[:, J[f"{side}_ankle"], 1] = 0.05 + LIFT / 2 * (1 + np.cos(angle + sign))
        x[:, J[f"{other}_wrist"]] = x[:, 0] + np.stack(
            [0 * t - sign * 0.3, 0 * t - 0.1, SWING / 2 * swing], 1
        )
    c, s = np.cos(turned), np.sin(turned)
    return (x @ np.array([[c, 0, -s], [0, 1, 0], [s, 0, c]]))[None]


@pytest.mark.parametrize("turned", [0.0, 1.0, -2.5])
def test_a_walk_made_of_sines_is_measured_as_it_was_made(turned):
    card = statistics(sinusoidal_walk(turned))
    for name, known, tolerance in (
        ("speed", SPEED, 0.01), ("cadence", 2 * STRIDES, 0.01),
        ("stride", SPEED / STRIDES, 0.01), ("bob", BOB, 0.05), ("sway", SWAY, 0.05),
        ("wrist_swing", SWING, 0.05), ("ankle_lift", LIFT, 0.02), ("step_width", WIDTH, 0.05),
        ("arm_leg_correlation", 1.0, 0.01), ("pelvis_height", 0.9, 0.01),
    ):  # fmt: skip
        assert card[name]["median"] == pytest.approx(known, rel=tolerance), name


def test_derivatives_of_one_sine_are_known():
    t, frequency, size = np.arange(200) / FPS, 0.5, 0.1
    x = np.zeros((1, 200, 22, 3))
    x[..., :] = (size * np.sin(2 * np.pi * frequency * t))[None, :, None, None] * [1.0, 0.0, 0.0]
    card, w = statistics(x), 2 * np.pi * frequency
    assert card["acceleration_mean"] == pytest.approx(size * w**2 * 2 / np.pi, rel=0.01)
    assert card["jerk_mean"] == pytest.approx(size * w**3 * 2 / np.pi, rel=0.02)


def test_the_spectrum_puts_a_tone_where_it_belongs():
    t = np.arange(100) / FPS
    x = np.zeros((1, 100, 22, 3))
    x[0, :, J["left_wrist"], 0] = 0.3 * np.sin(2 * np.pi * 0.6 * t)
    x[0, :, J["right_wrist"], 0] = 0.1 * np.sin(2 * np.pi * 3.0 * t)
    shares = statistics(x)["spectrum"]
    assert shares["0-1 Hz"] == pytest.approx(0.9, abs=1e-6)
    assert shares["2-4 Hz"] == pytest.approx(0.1, abs=1e-6)
    assert sum(shares.values()) == pytest.approx(1.0)


def test_a_clip_without_steps_has_a_speed_and_no_cadence():
    card = statistics(make_clips(5, seed=0, actions=["idle"]).positions)
    assert np.isnan(card["cadence"]["median"])
    assert card["speed"]["median"] < 0.1


def test_the_table_has_a_column_for_each_set():
    walk = statistics(sinusoidal_walk())
    text = table({"made by hand": walk, "again": walk})
    assert text.splitlines()[0] == "|  | made by hand | again |"
    assert "| cadence, steps/s | 1.7 [1.7..1.7] | 1.7 [1.7..1.7] |" in text


@pytest.mark.parametrize("shape", [(60, 22, 3), (2, 60, 21, 3), (2, 5, 22, 3)])
def test_other_shapes_are_refused(shape):
    with pytest.raises(ValueError, match="statistics: positions has shape"):
        statistics(np.zeros(shape))
    with pytest.raises(ValueError, match="not finite"):
        statistics(np.full((1, 20, 22, 3), np.nan))


def test_two_samples_of_one_kind_cannot_be_told_apart():
    accuracies = []
    for seed in range(4):
        one, other = (make_clips(60, 40, s, ["walk"]).positions for s in (2 * seed, 2 * seed + 1))
        accuracies.append(two_sample_test(one, other, seed)["accuracy"])
    # 480 clips in all: three standard errors of a tossed coin are 0.07.
    assert np.mean(accuracies) == pytest.approx(0.5, abs=0.07)


def test_calmer_bodies_are_told_apart_and_by_what():
    one, other = (make_clips(60, 40, s, ["walk"]).positions.astype(float) for s in (1, 2))
    hands = [J["left_wrist"], J["right_wrist"]]
    middle = other[:, :, hands].mean(axis=1, keepdims=True)
    along = (other[:, :, :1] - other[:, :, :1].mean(axis=1, keepdims=True)) * [1, 0, 1]
    other[:, :, hands] = middle + along + 0.3 * (other[:, :, hands] - middle - along)
    found = two_sample_test(one, other, seed=0)
    low, high = found["interval"]
    assert found["accuracy"] > 0.9
    assert 0.8 < low < high
    assert all("wrist" in name or "elbow" in name for name, _ in found["features"][:3])
    assert dict(found["features"])["wrist swing"] < -1


def test_the_two_sample_test_refuses_what_it_cannot_compare():
    walks = make_clips(12, 40, 0, ["walk"]).positions
    with pytest.raises(ValueError, match="clips of 40 and of 30 frames; cut both to one length"):
        two_sample_test(walks, walks[:, :30])
    with pytest.raises(ValueError, match="needs at least 10 clips of each set"):
        two_sample_test(walks, walks[:9])

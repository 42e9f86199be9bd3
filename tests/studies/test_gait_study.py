"""The gait that sliders make, the leg that a mouse pulls, and the checks of a reader's code."""

import numpy as np
import pytest
from scipy.optimize import brentq

from projflow_lite.skeleton import FPS, JOINTS, bone_lengths
from projflow_lite.studies import gait_explorer
from projflow_lite.studies.gait import (
    PRESETS,
    SLIDERS,
    averaged,
    cycle_of,
    facts_of,
    make_walk,
    toe_down,
    toe_speed,
)
from projflow_lite.studies.gait_exercises import check_knee, check_stance
from projflow_lite.studies.gait_explorer import GaitExplorer, LegExplorer, knee_of

FEET = [JOINTS.index("left_foot"), JOINTS.index("right_foot")]


@pytest.mark.parametrize("preset", PRESETS)
def test_a_preset_walks_as_fast_as_it_says_on_whole_bones_and_planted_feet(preset):
    at = PRESETS[preset]
    x = make_walk(at, frames=120).positions
    travelled = x[-1, 0, 2] - x[0, 0, 2]
    assert travelled == pytest.approx(at["speed"] * 119 / FPS, abs=0.1)
    assert np.ptp(bone_lengths(x), axis=0).max() < 1e-5
    assert toe_speed(x)[toe_down(x)].max() < 0.005
    # Stances are counted from the toes alone: so many steps a second.
    starts = np.diff(toe_down(x).astype(int), axis=0) == 1
    assert starts.sum() == pytest.approx(at["cadence"] * 119 / FPS, abs=2)


@pytest.mark.parametrize(("preset", "both", "none"), [("walk", True, False), ("run", False, True)])
def test_a_walk_has_both_feet_down_now_and_then_and_a_run_none(preset, both, none):
    walk = make_walk(PRESETS[preset], frames=196)
    standing = walk.stands.sum(1)
    assert (standing == 2).any() == both
    assert (standing == 0).any() == none
    facts = facts_of(walk, PRESETS[preset])
    assert (standing == 2).mean() == pytest.approx(facts["both"], abs=0.03)
    assert (standing == 0).mean() == pytest.approx(facts["none"], abs=0.03)


def test_slip_is_how_fast_planted_feet_slide():
    for slip in (0, 10, 25):
        at = {**PRESETS["walk"], "slip": slip}
        walk = make_walk(at)
        assert facts_of(walk, at)["slide"] == pytest.approx(1.2 * slip / 100, abs=0.005)
        gone = walk.positions[-1, 0, 2] - walk.positions[0, 0, 2]
        assert gone == pytest.approx(1.2 * 59 / FPS, abs=0.08)


def test_a_stride_too_long_for_the_legs_lowers_the_pelvis():
    short = make_walk({**PRESETS["walk"], "speed": 0.8}).lowered
    long = make_walk({**PRESETS["walk"], "speed": 2.2}).lowered
    assert long > short + 0.05


def test_the_mean_of_all_phases_glides_on_short_bones():
    one, all_ = averaged(PRESETS["walk"], 0), averaged(PRESETS["walk"], 1)

    def apart(x):
        return np.ptp(x[:, FEET[0], 2] - x[:, FEET[1], 2])

    np.testing.assert_allclose(one, make_walk(PRESETS["walk"]).positions, atol=1e-9)
    assert apart(one) > 1.0
    assert apart(all_) < 1e-6
    lost = 1 - bone_lengths(all_).mean(0) / bone_lengths(one).mean(0)
    assert lost.max() > 0.05
    assert lost.min() > -1e-9


def test_cycles_are_half_a_cycle_apart():
    cycles = cycle_of(PRESETS["walk"], 0.3, 50)
    assert cycles[0, 0] == pytest.approx(0.3)
    np.testing.assert_allclose((cycles[:, 1] - cycles[:, 0]) % 1, 0.5)


def test_speed_is_cadence_times_half_a_stride_whatever_is_moved():
    explorer = GaitExplorer()
    for name, value in (("speed", 2.0), ("cadence", 2.5), ("stride", 1.0), ("speed", 0.4)):
        explorer.sliders[name].value = value
        at = explorer.settings
        assert at["speed"] == pytest.approx(at["cadence"] * at["stride"] / 2, rel=0.02)
        for each in ("cadence", "stride"):  # the page knows whole steps only
            steps = at[each] / SLIDERS[each].step
            assert steps == pytest.approx(round(steps), abs=1e-6)
    before = explorer.walk.positions.copy()
    explorer.sliders["arms"].value += 20
    moved = np.abs(explorer.walk.positions - before).max((0, 2))
    assert moved[JOINTS.index("left_wrist")] > 0.1
    assert moved[FEET].max() < 1e-9


@pytest.mark.parametrize("preset", PRESETS)
def test_every_preset_shows_its_own_numbers(preset):
    explorer = GaitExplorer()
    explorer.sliders["slip"].value = 30
    explorer.preset.value = preset
    for name, value in PRESETS[preset].items():
        assert explorer.sliders[name].value == pytest.approx(value), name
    assert explorer.sliders["slip"].value == (30 if preset == "walk" else 0)
    np.testing.assert_allclose(explorer.viewer.motion.positions, explorer.walk.positions)
    assert "skating score" in explorer.said.value


@pytest.mark.parametrize("end", ["low", "high"])
@pytest.mark.parametrize("name", SLIDERS)
def test_no_place_of_a_slider_breaks_the_body(name, end):
    explorer = GaitExplorer()
    explorer.sliders[name].value = getattr(SLIDERS[name], end)
    x = explorer.walk.positions
    assert np.isfinite(x).all()
    assert np.isfinite([*explorer.facts.values()]).all()
    assert np.ptp(bone_lengths(x), axis=0).max() < 1e-5


def test_the_longest_strides_still_have_whole_bones():
    for duty in (SLIDERS["duty"].low, SLIDERS["duty"].high):
        at = {**PRESETS["walk"], "speed": 2.16, "cadence": 1.8, "duty": duty}  # stride 2.4 m
        assert np.ptp(bone_lengths(make_walk(at).positions), axis=0).max() < 1e-5


def test_a_stopped_body_has_its_time_marked():
    explorer = GaitExplorer()
    explorer.viewer.frame = 20
    assert np.isnan(explorer.footfalls._drawn["now"][1]).any()
    explorer.viewer.playing = False
    np.testing.assert_allclose(explorer.footfalls._drawn["now"][1][:, 0], 1.0)
    with pytest.raises(ValueError, match="GaitExplorer: 'trot' is not one of walk, stroll"):
        GaitExplorer("trot")


def test_the_knee_is_where_the_bones_meet():
    """Against a root finder: along the circle of the thigh, the point as far as the shank is."""
    random = np.random.default_rng(0)
    for _ in range(20):
        thigh, shank = random.uniform(0.3, 0.5, 2)
        distance = random.uniform(abs(thigh - shank) + 0.02, 0.97 * (thigh + shank))
        turned = random.uniform(-1.4, 1.4)
        ankle = distance * np.array([np.sin(turned), -np.cos(turned)])

        def excess(angle, ankle=ankle, thigh=thigh, shank=shank, turned=turned):
            knee = thigh * np.array([np.sin(turned + angle), -np.cos(turned + angle)])
            return np.linalg.norm(knee - ankle) - shank

        angle = turned + brentq(excess, 0, np.pi)  # the root ahead of the leg
        knee, missing = knee_of(ankle, thigh, shank)
        assert missing == pytest.approx(0, abs=1e-12)
        np.testing.assert_allclose(
            knee, thigh * np.array([np.sin(angle), -np.cos(angle)]), atol=1e-7
        )


def test_a_pulled_leg_keeps_its_bones_and_says_what_is_missing():
    leg = LegExplorer()
    for ankle in ((0.2, -0.7), (-0.4, -0.6), (0.9, 0.1), (0.0, 0.0), (0.005, -0.01)):
        leg.pull(ankle)
        reached = np.asarray(ankle) * (1 - leg.missing / max(np.linalg.norm(ankle), 1e-9))
        assert np.linalg.norm(leg.knee) == pytest.approx(0.41)
        if np.linalg.norm(ankle) > 1e-6:
            assert np.linalg.norm(leg.knee - reached) == pytest.approx(0.43, abs=1e-6)
    leg.pull((1.0, 0.0))
    assert leg.missing == pytest.approx(1.0 - 0.99 * 0.84)
    assert "out of reach by 17 cm" in leg.words.value
    leg.board.drag = {"moves": {"ankle": [0.1, -0.6, leg.board.seen + 1]}}
    np.testing.assert_allclose(leg.ankle, [0.1, -0.6])


def right_knee(hip, ankle, thigh, shank, sign=1.0):
    r = np.linalg.norm(ankle - hip)
    e = (ankle - hip) / r
    a = (r**2 + thigh**2 - shank**2) / (2 * r)
    return hip + a * e + sign * np.sqrt(thigh**2 - a**2) * np.array([-e[1], e[0]])


def right_stance(time, cadence, duty):
    return (time[:, None] * cadence / 2 + [0, 0.5]) % 1 < duty


def test_right_answers_are_right():
    for seed in range(5):
        assert check_knee(right_knee, seed)
        assert check_stance(right_stance, seed)
        assert check_stance(lambda *given: right_stance(*given).astype(int), seed)


WRONG_KNEES = [
    (lambda *given: right_knee(*given, sign=-1.0), "the knee bends backwards"),
    (lambda hip, ankle, thigh, shank: (hip + ankle) / 2, "the thigh should be"),
    (lambda hip, ankle, thigh, shank: right_knee(hip, ankle, shank, thigh), "the thigh should be"),
    (lambda hip, ankle, thigh, shank: ..., "not written yet"),
    (lambda hip, ankle, thigh, shank: hip * np.nan, "not a number"),
    (lambda hip, ankle, thigh, shank: np.zeros(3), "shape (3,)"),
    (lambda hip, ankle, thigh, shank: 1 / 0, "ZeroDivisionError"),
    (lambda hip: hip, "TypeError"),
]


@pytest.mark.parametrize(("function", "words"), WRONG_KNEES, ids=[w for _, w in WRONG_KNEES])
def test_a_wrong_knee_is_told_what_is_wrong(function, words):
    verdict = check_knee(function)
    assert not verdict
    assert words in str(verdict)


WRONG_STANCES = [
    (lambda t, c, d: right_stance(t, c, d)[:, ::-1], "left and right are exchanged"),
    (lambda t, c, d: ~right_stance(t, c, d), "when a foot swings"),
    (lambda t, c, d: np.repeat(right_stance(t, c, d)[:, :1], 2, 1), "the right foot is wrong"),
    (lambda t, c, d: right_stance(t, 2 * c, d), "at "),
    (lambda t, c, d: right_stance(t, c, d)[:, 0], "shape (40,)"),
    (lambda t, c, d: None, "not written yet"),
]


@pytest.mark.parametrize(("function", "words"), WRONG_STANCES, ids=[w for _, w in WRONG_STANCES])
def test_a_wrong_clock_is_told_what_is_wrong(function, words):
    verdict = check_stance(function)
    assert not verdict
    assert words in str(verdict)


def test_arcs_of_the_knee_meet_in_it():
    ankle = np.array([0.2, -0.7])
    knee, _ = knee_of(ankle, 0.41, 0.43)
    for arc in gait_explorer.circles(ankle, 0.41, 0.43):
        assert np.linalg.norm(arc - knee, axis=1).min() < 0.02

"""The study of sensitivity: that every constant is moved, and what is said of made-up numbers."""

from dataclasses import fields

import numpy as np
import pytest
from untrained import small_prior

from data_synth import held_out
from projflow_lite.samplers import GuideSettings
from projflow_lite.studies import control, sensitivity, sensitivity_words
from projflow_lite.studies.cells import ALL, Rival
from projflow_lite.studies.control_ways import Task, make
from projflow_lite.studies.sensitivity_figure import in_order
from projflow_lite.studies.sensitivity_sweeps import SWEEPS, USUAL, Sweep

C0 = next(sweep for sweep in SWEEPS if sweep.name == "c0")


@pytest.fixture(scope="module")
def prior():
    return small_prior()


@pytest.fixture(scope="module")
def clips():
    return held_out(2, 60, 3)


def moved(prior, clips, **options):
    """Motions of ProjFlow with other constants, float32 metres."""
    rival = Rival("", "projflow", tuple(options.items()))
    return make(prior, 0.76, rival, Task("left_wrist", 3, 60), clips, 6, seed=0).positions


@pytest.fixture(scope="module")
def usual(prior, clips):
    return moved(prior, clips)


def test_every_constant_of_the_guides_is_moved_and_usual_values_are_those_of_the_code():
    settings = GuideSettings()
    names = {field.name for field in fields(GuideSettings)} - {"form"}
    assert names | {"w_kin", "steps", "eta"} == {sweep.name for sweep in SWEEPS}
    for sweep in SWEEPS:
        assert sweep.usual not in sweep.values
        assert len(set(sweep.values)) == len(sweep.values) >= 3
        if sweep.name in names:
            assert getattr(settings, sweep.name) == sweep.usual
        if sweep.name not in ("pi_max", "steps"):
            assert sweep.usual == sweep.paper
    spelled = [rival.spelled for sweep in SWEEPS for rival in sweep.rivals]
    assert len(set(spelled)) == len(spelled)


@pytest.mark.parametrize("sweep", SWEEPS, ids=[sweep.name for sweep in SWEEPS])
def test_a_constant_changes_the_motion_and_no_keyframe(prior, clips, usual, sweep):
    """One end of a sweep may change nothing: what has no bends never meets the least trust."""
    frames, most = Task("left_wrist", 3, 60).keyframes(0), 0.0
    for value in (sweep.values[0], sweep.values[-1]):
        x = moved(prior, clips, **{sweep.name: value})
        np.testing.assert_allclose(x[:, frames, 20], clips.positions[:, frames, 20], atol=1e-6)
        most = max(most, np.abs(x - usual).max())
    assert most > 0.01


def test_only_the_quotient_of_the_metrics_weights_matters(prior, clips, usual):
    """Why the ridge has no sweep of its own."""
    np.testing.assert_allclose(moved(prior, clips, w_kin=30.0, ridge=3.0), usual, atol=1e-4)
    assert np.abs(moved(prior, clips, w_kin=30.0) - usual).max() > 0.01
    np.testing.assert_allclose(
        moved(prior, clips, ridge=0.5), moved(prior, clips, w_kin=20.0), atol=1e-4
    )


def test_a_quick_look_takes_the_nearest_values():
    assert C0.shortened().values == (1.0, 10.0)
    short = {sweep.name: sweep.shortened().values for sweep in SWEEPS}
    assert short["pi_max"] == (0.9, 1.0)
    assert short["w_kin"] == (3.0, 30.0)
    assert short["eta"] == (0.0, "ddpm")
    assert short["steps"] == (5, 100)
    names = [rival.name for rival in sensitivity.QUICK.rivals]
    assert names[:2] == ["no wish", "projflow"]
    assert "c0 = 10" in names
    assert "c0 = 30" not in names


def test_an_unknown_constant_is_refused_with_the_known_ones():
    assert [sweep.name for sweep in sensitivity.chosen(["p", "c0"])] == ["p", "c0"]
    assert sensitivity.chosen(None) == SWEEPS
    with pytest.raises(ValueError, match="'c1' has no sweep; these have: w_kin, l_min"):
        sensitivity.chosen(["c1"])


def test_a_run_shares_cells_with_the_study_of_control(prior, tmp_path, monkeypatch):
    made, real = [], control.measured

    def looking(*what):
        made.append(what[2].name)
        return real(*what)

    monkeypatch.setattr(control, "measured", looking)
    short = C0._replace(values=(1.0, 10.0))
    protocol = sensitivity.protocol_of((short,), 32, 2, 2, ("pelvis",), (5,))
    ours = protocol._replace(rivals=protocol.rivals[:2])
    control.run(prior, ours, tmp_path, progress=False)
    rows = sensitivity.run(prior, protocol, tmp_path, progress=False)
    assert made == ["no wish", "projflow"] * 2 + ["c0 = 1", "c0 = 10"] * 2
    text = sensitivity.table(rows)
    for part in (
        "2 seeds of 32 clips",
        "joint (pelvis) and density (5)",
        "held-out data",
        "c0 = 1",
    ):
        assert part in text
    said = sensitivity.sentences(rows)
    assert said[0].startswith("kinetic distance: of 2 values that differ from the usual ones")
    assert sum(line.startswith("c0, strength of guides: ") for line in said) == 2
    assert sensitivity.figure(rows, tmp_path / "sensitivity.png").stat().st_size > 10_000


def row(method, *values):
    """A row of the same made-up numbers for both scores."""
    cell = {"mean": float(np.mean(values)), "half width": 0.1, "values": list(values)}
    scores = dict.fromkeys(sensitivity_words.JUDGED, cell)
    about = {"joint": "average", "keys": ALL, "method": method, "steps": 25}
    return about | {"scores": scores}


ROWS = [
    row(USUAL.name, 2.0, 3.0, 4.0),
    row("c0 = 1", 1.0, 2.1, 3.0),
    row("c0 = 10", 4.0, 5.1, 6.0),
    row("c0 = 30", 1.0, 9.0, 4.0),
    row("steps = 5", 3.0, 4.1, 5.0),
    row("p = 4", 2.02, 3.03, 4.02),
]


def test_values_are_judged_by_differences_of_the_same_seeds():
    """Differences -1, -0.9, -1: mean -0.967, and 4.3027 standard errors of 0.0333 either side."""
    text = sensitivity_words.of_sweep(ROWS, C0, "FID")
    assert text == (
        "c0, strength of guides: FID 3.000 ± 0.100 at the usual 3; 1: -0.967 ± 0.14, better; "
        "10: +2.03 ± 0.14, worse; 30: +1.67 ± 9.4, undecided."
    )
    assert sensitivity_words.of_sweep(ROWS[:1], C0, "FID") is None
    steps = next(sweep for sweep in SWEEPS if sweep.name == "steps")
    assert "at the usual 25 (Table 5: 100); 5: +1.03" in sensitivity_words.of_sweep(
        ROWS, steps, "FID"
    )


def test_a_difference_that_is_certain_but_small_is_none():
    """Differences 0.02, 0.03, 0.02 of 3: below a twentieth, with all of the interval."""
    p = next(sweep for sweep in SWEEPS if sweep.name == "p")
    assert sensitivity_words.of_sweep(ROWS, p, "FID").endswith("4: +0.0233 ± 0.014, alike.")


def test_all_values_are_counted_and_constants_put_in_order():
    assert sensitivity_words.of_all(ROWS, "FID") == (
        "FID: of 5 values that differ from the usual ones 1 are better (c0 = 1), 2 are worse, 1 alike "
        "and 1 undecided."
    )
    assert sensitivity_words.of_order(ROWS, "FID") == (
        "FID, largest over smallest among the values tried: c0 2.48, steps 1.34, p 1.01."
    )


def test_values_are_drawn_by_size_and_words_last():
    values = [value for value, _ in in_order([("ddpm", {}), (0.5, {}), ("paper", {}), (0, {})])]
    assert values == [0, 0.5, "ddpm", "paper"]
    assert Sweep("", "", 1, 1.0, (0.5, 2.0)).label(0.5) == " = 0.5"

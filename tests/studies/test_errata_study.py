"""The study of errata: each reading is the formula that it says, and what is said of numbers."""

import json

import numpy as np
import pytest
import torch
from untrained import small_prior

from data_synth import held_out
from projflow_lite import equations as eq
from projflow_lite.constraints import pin
from projflow_lite.samplers import ProjectionStep
from projflow_lite.skeleton import EDGES, JOINTS
from projflow_lite.studies import errata, errata_words
from projflow_lite.studies.cells import ALL, DATA, Rival, published
from projflow_lite.studies.control_ways import AND, Task, make
from projflow_lite.studies.errata_forms import ERRATA
from projflow_lite.studies.errata_words import MATTERS, NOT, OPEN, effect_of
from projflow_lite.studies.readings import OrderAsPrinted, SharesAsSaid, as_printed
from projflow_lite.studies.sensitivity_sweeps import USUAL

L = eq.kinematic_laplacian(EDGES, 22)
WRIST, PELVIS = JOINTS.index("left_wrist"), 0


@pytest.fixture(scope="module")
def prior():
    return small_prior()


@pytest.fixture(scope="module")
def clips():
    return held_out(2, 60, 3)


# ------------------------------------------------------------------------------------- the readings


def test_the_printed_order_is_that_of_the_printed_formula():
    """The dense R of eq. 11 as printed, of two frames, against the order that takes it apart."""
    R = eq.kinematic_metric(2, L, 10, 1, form="printed")
    place = as_printed(np.arange(132))
    assert sorted(place) == list(range(132))
    np.testing.assert_allclose(eq.kinematic_metric(2, L, 10, 1)[np.ix_(place, place)], R)


def test_a_step_in_the_printed_order_is_the_dense_projection():
    random = np.random.default_rng(0)
    wish = pin(["left_wrist", "pelvis"], [0, 2], random.normal(size=(2, 2, 3)))
    wish = wish & pin("head", 1, [0.3, 1.6, 0.1], std=0.4)
    x = random.normal(size=(1, 3, 22, 3))
    step = OrderAsPrinted(wish, 3, dtype=torch.float64, guides=False)
    rows = wish.rows(3)
    R = eq.kinematic_metric(3, L, 10, 1, form="printed")
    there = eq.project(x.ravel(), rows.A.toarray(), rows.y, R, np.diag(rows.variance))
    np.testing.assert_allclose(step(torch.tensor(x), 0.5).numpy().ravel(), there, atol=1e-9)
    usual = ProjectionStep(wish, 3, dtype=torch.float64, guides=False)(torch.tensor(x), 0.5)
    assert np.abs(usual.numpy().ravel() - there).max() > 0.1


def test_guides_in_the_printed_order_read_the_same_printed_metric():
    """Its diagonal's inverse for eq. 18, and the length of a bend for eq. 17."""
    wish = pin("left_wrist", [0, 3], np.zeros((2, 3)))
    guides = OrderAsPrinted(wish, 4, dtype=torch.float64).guides
    R = eq.kinematic_metric(4, L, 10, 1, form="printed")
    columns = guides.column
    assert sorted(columns) == [n * 66 + 3 * WRIST + c for n in (1, 2) for c in range(3)]
    r = guides.r.numpy()[-len(guides) :]
    np.testing.assert_allclose(r, np.diag(np.linalg.inv(R))[columns])
    assert len(set(r.round(6))) > 1  # three axes, three neighbours in the vector
    bend = np.random.default_rng(1).normal(size=66)
    length = np.linalg.norm(bend @ guides.C.numpy())
    assert length == pytest.approx(np.sqrt(bend @ R[:66, :66] @ bend))


def test_shares_as_said_are_small_where_others_follow():
    wish = pin(["pelvis", "left_wrist"], [0, 9], np.zeros((2, 2, 3)))
    norm = np.linalg.norm(np.linalg.inv(eq.joint_metric(L, 10, 1)), axis=0)
    said, printed = (kind(wish, 10).guides for kind in (SharesAsSaid, ProjectionStep))
    joint = said.column // 3 % 22
    np.testing.assert_allclose(said.q, norm, rtol=1e-6)
    np.testing.assert_allclose(printed.q, 1 / norm, rtol=1e-6)
    x = torch.randn(1, 10, 22, 3, generator=torch.Generator().manual_seed(0))
    trust = []
    for guides in (said, printed):  # eq. 47 turned round
        soft = guides.variance(x, 0.9)[0, -len(guides) :].double()
        r = guides.r[-len(guides) :]
        pi = (r / (soft + r)).numpy()
        trust.append(pi[joint == PELVIS].mean() / pi[joint == WRIST].mean())
    assert trust[0] < 1 < trust[1]


@pytest.mark.parametrize("rival", errata.RIVALS, ids=[rival.name for rival in errata.RIVALS])
def test_every_reading_meets_every_keyframe(prior, clips, rival):
    task = Task(f"pelvis{AND}left_wrist", 3, 60)
    made = make(prior, 0.76, rival, task, clips, 4, seed=0)
    asked = ~np.isnan(made.targets)
    assert asked.sum((1, 2, 3)).tolist() == [18, 18]
    assert sorted(set(np.argwhere(asked)[:, 2])) == [PELVIS, WRIST]
    np.testing.assert_allclose(made.positions[asked], made.targets[asked], atol=1e-6)


def test_each_reading_changes_motions_but_shares_only_those_of_two_joints(prior, clips):
    def motion(rival, joint):
        return make(prior, 0.76, rival, Task(joint, 3, 60), clips, 4, seed=0).positions

    both = f"pelvis{AND}left_wrist"
    for erratum in ERRATA:
        printed, derived = (motion(rival, both) for rival in erratum.rivals)
        assert np.abs(printed - derived).max() > 1e-3, erratum.name
    one = [motion(rival, "left_wrist") for rival in ERRATA[-1].rivals]
    np.testing.assert_allclose(*one, atol=1e-5)


# ---------------------------------------------------------------------------------------- the study


def test_a_run_has_a_table_a_picture_and_a_file(prior, tmp_path):
    protocol = errata.QUICK._replace(seeds=2, steps=2, joints=errata.JOINTS[1:])
    rows = errata.run(prior, protocol, tmp_path / "runs", progress=False)
    assert rows[0]["method"] == DATA
    assert {row["method"] for row in rows[1:]} == {rival.name for rival in errata.RIVALS}
    text = errata.table(rows)
    for part in ("2 seeds of 32 clips", "eq. 11, keyframes: 5", "eq. 51, keyframes: 5"):
        assert part in text
    assert "keyframes: all" not in text  # it would repeat the only density
    said = errata.sentences(rows)
    assert "every reading meets them" in said[0]
    of_errata = [line for line in said if ": printed, it " in line]
    assert len(of_errata) == 4
    assert all("of 10 differences" in line for line in of_errata)
    one = next(line for line in said if line.startswith("eq. 51, left_wrist, 5 frames given: "))
    assert f"{NOT} in FID, kinetic distance, " in one
    assert MATTERS not in one
    published("errata", prior, rows, errata.figure, tmp_path)
    assert json.loads((tmp_path / "results/errata.json").read_text())["rows"] == rows
    assert (tmp_path / "pictures/errata.png").stat().st_size > 10_000


def row(method, *values, joint="pelvis", keys=ALL):
    """A row of the same made-up numbers for every score."""
    cell = {"mean": float(np.mean(values)), "half width": 0.1, "values": list(values)}
    scores = dict.fromkeys(errata_words.SHOWN, cell)
    about = {"joint": joint, "keys": keys, "method": method, "seeds": 3, "clips": 32, "steps": 9}
    return about | {"scores": scores}


@pytest.mark.parametrize(
    ("printed", "word"),
    [
        ((3.0, 4.0, 5.1), MATTERS),  # 1, 1, 1.1
        ((1.0, 2.0, 3.1), MATTERS),  # less is a difference too
        ((2.02, 3.03, 4.02), NOT),  # certain, but below a twentieth of 3
        ((2.0, 3.0, 4.0), NOT),
        ((1.0, 9.0, 4.0), OPEN),
    ],
)
def test_an_effect_is_judged_by_differences_of_the_same_seeds(printed, word):
    found = effect_of(row("a", *printed), row("b", 2.0, 3.0, 4.0), "FID")
    assert found.word == word
    assert found.mean == pytest.approx(np.mean(printed) - 3)


def test_two_exact_readings_do_not_differ():
    assert effect_of(row("a", 3e-8, 4e-8), row("b", 1e-8, 1e-8), "residual").word == NOT
    assert effect_of(row("a", 3e-2, 3.1e-2), row("b", 1e-8, 1e-8), "residual").word == MATTERS


def test_an_erratum_as_a_whole_has_wider_intervals():
    """Differences 1, 1.2, 0.8, of 5 scores: certain for each alone, and at 99 % no more."""
    usual, nine = row(USUAL.name, 2.0, 3.0, 4.0), row("eq. 9 printed", 3.0, 4.2, 4.8)
    rows = [row(DATA, 0, 0, 0, joint=ALL), usual, nine]
    assert effect_of(nine, usual, "FID").word == MATTERS
    assert effect_of(nine, usual, "FID", 0.99).word == OPEN
    text = errata_words.of_erratum(rows, ERRATA[0])
    assert text.endswith(
        "It is undecided: of 5 differences over all densities 0 are certain, 0 are certainly "
        "small, and 5 are undecided."
    )
    rows[2] = row("eq. 9 printed", 3.0, 4.0, 5.01)
    assert "It matters here: of 5" in errata_words.of_erratum(rows, ERRATA[0])
    rows[2] = row("eq. 9 printed", 2.0, 3.0, 4.01)
    assert "It does not matter here: of 5" in errata_words.of_erratum(rows, ERRATA[0])
    assert errata_words.of_erratum(rows, ERRATA[1]) is None


def test_an_unknown_reading_is_no_reading(clips):
    with pytest.raises(KeyError):
        make(
            None, 0.76, Rival("", "projflow", (("reading", "x"),)), Task("head", 2, 60), clips, 2, 0
        )

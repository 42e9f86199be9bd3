"""The score explorer: undamaged motion is noticed by nobody, and each fault by those it should be."""

import numpy as np
import pytest

from projflow_lite.skeleton import bone_lengths
from projflow_lite.studies.score_court import (
    FAULTS,
    SHOWN,
    TRUE_BONES,
    Court,
    Range,
    floor_by_size,
    multiple,
    noticed,
)
from projflow_lite.studies.score_explorer import ScoreExplorer, bar, place


@pytest.fixture(scope="module")
def explorer():
    return ScoreExplorer(Court(clips=64, sets=4), clip=3)


def choose(explorer, fault, size):
    explorer.fault.value = fault
    explorer.size.value = size
    return set(explorer.noticed)


def test_at_size_zero_nothing_is_noticed(explorer):
    for fault in FAULTS:
        if fault != "parrot":
            assert choose(explorer, fault, 0) == set()
            own = {name: explorer.court.floor[name].own for name in SHOWN}
            assert explorer.scores == pytest.approx(own, rel=1e-5, abs=1e-5)


def test_faults_are_noticed_by_those_who_see_them(explorer):
    spike = choose(explorer, "one-frame spike", 0.3)
    assert {"kinetic distance", "worst acceleration"} <= spike
    assert not spike & {"FID", "R top 3", "diversity", "bone error %", "skating gmd"}
    assert choose(explorer, "long forearm", 0.2) == {TRUE_BONES}
    assert "skating gmd" in choose(explorer, "sliding body", 0.51)
    assert {"jerk", "worst acceleration"} <= choose(explorer, "too smooth", 2)
    assert {"FID", "R top 3", "diversity"} <= choose(explorer, "parrot", 1)
    assert not choose(explorer, "parrot", 256) & {"FID", "R top 3", "diversity"}


def test_the_picture_shows_the_damaged_body_and_its_ghost(explorer):
    choose(explorer, "long forearm", 0.5)
    lengths = explorer.viewer.motion.bone_lengths()[0]
    was = bone_lengths(explorer.court.shown.positions[3])[0]
    assert sorted(lengths / was)[-2:] == pytest.approx([1.0, 1.5], abs=1e-4)
    assert explorer.viewer.shape[0] == 2
    explorer.clip.value = 5
    np.testing.assert_allclose(
        explorer.viewer.motion.positions[:, 0], explorer.court.shown.positions[5][:, 0]
    )
    assert explorer.court.shown.captions[5] in explorer.said.value


def test_a_parrot_speaks_in_clips_that_it_knows(explorer):
    said, was = explorer.court.damaged("parrot", 4)
    known = explorer.court.known.positions[:4]
    assert said is was
    assert all(any(np.array_equal(clip, one) for one in known) for clip in said)


def test_bars_by_hand():
    assert noticed(1.4, Range(1.0, 0.3))
    assert not noticed(0.8, Range(1.0, 0.3))
    assert multiple("jerk", 8.0, Range(4.0, 0.1)) == 2
    assert multiple("bone error %", 0.05, Range(1e-5, 0.1)) == 1
    assert multiple("bone error %", 0.3, Range(1e-5, 0.1)) == pytest.approx(3)
    assert [place(x) for x in (0.0, 0.1, 1, 10, 1e6)] == pytest.approx(
        [0, 0, 100 / 3, 200 / 3, 100]
    )
    assert "bold" in bar("jerk", 9.0, Range(4.0, 1.0))
    assert "bold" not in bar("jerk", 4.5, Range(4.0, 1.0))


def test_the_floor_falls_with_the_number_of_clips():
    """Two halves of the same data: the bias of a Fréchet distance goes with one over the clips."""
    found = floor_by_size((64, 256), pool=512, repetitions=3)
    floor, damaged = found["data"].mean(1), found["damaged"].mean(1)
    assert 2.5 < floor[0] / floor[1] < 8
    assert damaged[1] > floor[1] + 0.05
    with pytest.raises(ValueError, match="damages no clip"):
        floor_by_size(fault="parrot")
    with pytest.raises(ValueError, match="too few"):
        floor_by_size((64, 1024), pool=512)

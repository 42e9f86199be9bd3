"""The study of ablations: what it compares, and what it says of numbers worked out by hand."""

import pytest
from untrained import small_prior

from projflow_lite.samplers import METHODS
from projflow_lite.studies import ablations, ablations_words
from projflow_lite.studies.ablations import FULL, PARTS, QUICK, SETTINGS, Setting
from projflow_lite.studies.cells import DATA


def test_every_part_is_taken_under_every_setting():
    assert {tuple(setting) for setting in SETTINGS} == {
        ("implied", 1.0), ("implied", 2.0), ("original", 1.0), ("original", 2.0),
    }  # fmt: skip
    assert len(FULL.rivals) == len(set(FULL.rivals)) == 4 * len(PARTS)
    assert FULL.clips * FULL.seeds >= 512
    assert FULL.seeds == 5
    assert set(QUICK.rivals) < set(FULL.rivals)
    assert all(rival.method in METHODS for rival in FULL.rivals)


def test_what_is_usual_is_no_option():
    assert dict(ablations.rival_of("projflow", Setting("implied", 1.0)).options) == {}
    full = dict(ablations.rival_of("euclid", Setting("original", 2.0)).options)
    assert full == {"metric": "euclidean", "noise": "original", "guidance": 2.0}


def test_a_small_run_from_end_to_end(tmp_path):
    few = QUICK._replace(
        steps=2, joints=("pelvis",), densities=(2,), rivals=ablations.rivals_of(SETTINGS[:2])
    )
    rows = ablations.run(small_prior(), few, tmp_path, progress=False)
    own = ablations_words.single(rows)
    assert {(row["part"], row["guidance"]) for row in own} == {
        (part, guidance) for part in PARTS for guidance in (1.0, 2.0)
    }
    by_part = {row["part"]: row["scores"]["FID"]["values"] for row in own if row["guidance"] == 1}
    assert len({tuple(values) for values in by_part.values()}) == len(PARTS)
    guided = next(r for r in own if (r["part"], r["guidance"]) == ("projflow", 2.0))
    assert guided["scores"]["FID"]["values"] != by_part["projflow"]
    assert all(row["scores"]["residual"]["mean"] < 1e-5 for row in own)
    text = ablations.table(rows)
    assert "pelvis, 2 keyframes, implied noise, guidance 2" in text
    assert ablations.figure(rows, tmp_path / "ablations.png").stat().st_size > 10_000


def row(part, values, keys=5, noise="implied"):
    cell = {"mean": sum(values) / 2, "half width": 0.1, "values": values}
    scores = dict.fromkeys(ablations_words.SHOWN, cell)
    place = {"joint": "pelvis", "keys": keys, "noise": noise, "guidance": 1.0}
    return (
        place
        | {"part": part, "method": part, "seeds": 2, "clips": 32, "steps": 2}
        | {"scores": scores}
    )


@pytest.fixture
def by_hand():
    """Euclid is worse by 1.0 and 1.1, certain; no fresh noise by -1 and 1, which says nothing; and
    without guides it is better by 0.5 and 0.52."""
    data = row(DATA, [0.1, 0.1])
    whole = row("projflow", [1.0, 2.0])
    return [
        data, whole, row("euclid", [2.0, 3.1]), row("no fresh noise", [0.0, 3.0]),
        row("plain masking", [0.5, 1.48]), row("metric over time", [0.4, 1.3]),
        row("projflow", [3.0, 4.1], noise="original"),
    ]  # fmt: skip


def test_a_part_is_judged_by_the_interval_of_the_difference(by_hand):
    words = {
        part: next(ablations_words.effects(by_hand, part, "FID")).word
        for part in (*ablations_words.TAKEN, ablations_words.OURS)
    }
    assert words == {
        "euclid": ablations_words.EARNS,
        "no fresh noise": ablations_words.OPEN,
        "plain masking": ablations_words.HARMS,
        "metric over time": ablations_words.HARMS,
    }


def test_what_is_said_of_it(by_hand):
    said = ablations_words.sentences(by_hand)
    assert (
        "with implied noise it holds in 0 of 1 cells with all three intervals, is broken in 1 with "
        "at least one, and is undecided in 0"
    ) in said[0]
    of_ours = next(text for text in said if text.startswith("FID: a metric over time"))
    assert "better than ProjFlow's metric and guides in 1 of 1 cells" in of_ours
    of_guides = next(text for text in said if text.startswith("FID: without guides"))
    assert "worse in 0 of 1 cells, better in 1, and undecided in 0" in of_guides
    of_noise = next(text for text in said if text.startswith("FID: the implied noise"))
    assert "better than that of the start, as printed, in 1 of 1 cells" in of_noise

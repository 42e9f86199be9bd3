"""The data card: what it writes, that its numbers are those of the clips, and what it refuses."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from data_synth import ACTIONS, held_out, make_clips
from data_synth.card import statistics
from data_synth.two_sample import KINDS, two_sample_test
from projflow_lite.skeleton import FPS, JOINTS
from projflow_lite.studies import data_card, data_card_words

BOOK = Path(__file__).parents[2] / "book"
WRISTS = [JOINTS.index("left_wrist"), JOINTS.index("right_wrist")]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A file as of recorded motion, made of clips whose wrists shake."""
    random = np.random.default_rng(0)
    walk = make_clips(24, 60, 5, ["walk"]).positions
    other = make_clips(34, 60, 6).positions
    x = np.concatenate([walk, other])
    x[:, :, WRISTS] += 0.01 * random.normal(size=x[:, :, WRISTS].shape)
    run = np.pad(make_clips(4, 40, 7, ["run"]).positions, ((0, 0), (0, 9), (0, 0), (0, 0)), "edge")
    path = tmp_path_factory.mktemp("real") / "real.npz"
    labels = np.array(["walk"] * 24 + ["jump_turn"] * 4 + ["other"] * 30)
    skeleton = np.array(["subject"] * 12 + ["nearest"] * 46)
    np.savez(
        path, x60=x, x60_hml=1.1 * x, label60=labels, skeleton60=skeleton, xshort=run,
        label_short=np.array(["run"] * 4), len_short=np.array([40, 40, 40, 10]),
    )  # fmt: skip
    return path


@pytest.fixture(scope="module")
def made(recorded, tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(data_card, "QUICK", {"walk": 40, "run": 12, "jump": 12, "all": 68})
        patch.setattr(data_card, "clips_a_second", lambda: 1234.5)
        return data_card.run(tmp_path_factory.mktemp("book"), recorded, quick=True)


def test_every_action_is_in_one_family():
    listed = [action for family in data_card.FAMILIES.values() for action in family]
    assert sorted(listed) == sorted(ACTIONS)


def test_recorded_clips_are_sorted_by_label_and_cut_to_their_length(recorded):
    sets = data_card.read_real(recorded)
    assert {name: len(clips) for name, clips in sets.items()} == {
        "all": 58, "hml": 58, "walk": 24, "run": 3, "jump": 4, data_card.OWN: 12,
    }  # fmt: skip
    assert {len(clip) for clip in sets["run"]} == {40}


def test_what_is_no_recorded_motion_is_refused(tmp_path):
    with pytest.raises(FileNotFoundError):
        data_card.read_real(tmp_path / "none.npz")
    np.savez(tmp_path / "other.npz", x60=np.zeros((3, 50, 22, 3)))
    with pytest.raises(ValueError, match="has no array x60"):
        data_card.read_real(tmp_path / "other.npz")


def test_the_card_its_numbers_and_its_pictures_are_written(made):
    card = Path(made["card"]).read_text()
    for picture in made["pictures"]:
        assert Path(picture).read_bytes()[:4] == b"\x89PNG"
        assert f"(pictures/{Path(picture).name})" in card
    assert len(made["pictures"]) == 2 + len(data_card.FAMILIES)
    stored = json.loads(Path(made["results"]).read_text())
    assert stored["clips a second"] == pytest.approx(1234.5, rel=1e-3)
    assert "One core makes 1234 clips" in card
    assert "Recorded: real.npz. The two columns called *all*" in card
    assert "24 of the 58 recorded clips are walks" in card
    assert "nan" not in card
    assert "None" not in card


def test_the_table_has_what_the_clips_measure(made):
    expected = statistics(held_out(40, 60, 0, ["walk"]).positions)["speed"]["median"]
    assert made["rows"]["sets"]["synthetic, walk"]["speed"]["median"] == pytest.approx(expected)
    row = next(
        line for line in Path(made["card"]).read_text().splitlines() if line.startswith("| speed")
    )
    assert f"| {expected:.3g} [" in row


def test_shaking_wrists_are_told_apart_and_named(made):
    found = made["rows"]["two-sample"]["recorded"]["walk"]
    assert found["accuracy"] > 0.9
    assert "jerk of wrists" in found["features"][0][0]
    assert found["kinds"]["jerks"]["accuracy"] > found["kinds"]["gait"]["accuracy"] + 0.1
    card = Path(made["card"]).read_text()
    assert "**Walk: they are told apart**, best by" in card
    assert "jerk of wrists, log mean | +" in card


def test_sets_of_one_kind_are_not_told_apart_in_words():
    a, b = (held_out(100, 60, seed, ["walk"]).positions for seed in (11, 12))
    row = data_card.compared(a, b)
    assert data_card_words.verdict(row, "walk") == "**Walk:** not told apart."


def test_nothing_of_a_recorded_clip_is_written(made, recorded):
    """Statistics only: no list in the numbers is as long as a clip."""

    def longest(value):
        if isinstance(value, dict):
            return max(map(longest, value.values()), default=0)
        if isinstance(value, list):
            return max(len(value), *map(longest, value), 0)
        return 0

    assert longest(json.loads(Path(made["results"]).read_text())) <= data_card.MOST_TOLD


def test_without_recorded_motion_the_card_is_synthetic_only(made):
    numbers = {**made["rows"], "hml bones": None}
    numbers["sets"] = {k: v for k, v in numbers["sets"].items() if k.startswith("synthetic")}
    numbers["angles"] = {
        name: {kind: span for kind, span in row.items() if kind != "recorded"}
        for name, row in numbers["angles"].items()
    }
    pictures = {name: Path("x.png") for name in ("gait", "bones_and_spectrum", *data_card.FAMILIES)}
    text = data_card_words.card(numbers, pictures, data_card.FAMILIES)
    assert "no file of recorded motion" in text
    assert "Can they be told apart" not in text
    assert "CMU" not in text


def test_recorded_motion_is_acknowledged_as_its_file_asks(tmp_path):
    np.savez(tmp_path / "a.npz", licence=np.array("Free. Data from mocap.cs.cmu.edu, thanks."))
    assert "NSF EIA-0196217" in data_card.source_of(tmp_path / "a.npz")
    np.savez(tmp_path / "b.npz", x=np.zeros(1))
    assert data_card.source_of(tmp_path / "b.npz") == "b.npz"


def test_free_fall_is_measured_as_gravity():
    t = np.arange(20) / FPS
    x = np.zeros((60, 22, 3))
    rise = 4.0 * t[:16] - 0.5 * 9.81 * t[:16] ** 2
    x[20:36, :, 1] = rise[:, None]
    found = data_card.flight([x])
    assert found["frames"] >= 10
    assert found["pelvis"] == pytest.approx(-9.81, abs=1e-6)
    assert found["centre of mass"] == pytest.approx(-9.81, abs=1e-6)
    assert data_card.flight([np.zeros((60, 22, 3))])["frames"] == 0


def test_measures_outside_the_recorded_middle_are_named():
    def like(**medians):
        row = {name: {"median": 1.0, "p10": 0.5, "p90": 1.5} for name in data_card_words.UNITS}
        return row | {name: {"median": m, "p10": 0, "p90": 9} for name, m in medians.items()}

    text = data_card_words.outside(
        {"synthetic, walk": like(ankle_lift=3.0, speed=1.4), "recorded, walk": like()}
    )
    assert text.endswith("walk: ankle lift.")


def test_a_test_of_one_kind_sees_nothing_of_the_others():
    a, b = (make_clips(40, 40, s, ["walk"]).positions.astype(float) for s in (1, 2))
    b[:, :, WRISTS] += 0.01 * np.random.default_rng(0).normal(size=b[:, :, WRISTS].shape)
    names = [name for name, _ in two_sample_test(a, b, kinds=["gait"])["features"]]
    assert not any("jerk" in name or "of" in name.split() for name in names)
    every = [two_sample_test(a, b, kinds=[kind])["features"] for kind in KINDS]
    assert sum(map(len, every)) == len(two_sample_test(a, b)["features"])
    with pytest.raises(ValueError, match="kinds are gait, joint angles"):
        two_sample_test(a, b, kinds=["colour"])


def test_the_card_in_the_book_has_the_numbers_beside_it():
    card = (BOOK / "data-card.md").read_text()
    numbers = json.loads((BOOK / "results" / "data-card.json").read_text())
    assert numbers["quick"] is False
    assert numbers["captions"]["actions"] == len(ACTIONS)
    assert numbers["clips a second"] >= 500
    for row in numbers["two-sample"]["recorded"].values():
        assert f"{row['accuracy']:.2f} [" in card
    speed = numbers["sets"]["synthetic, walk"]["speed"]["median"]
    assert f"| {speed:.3g} [" in card
    for picture in re.findall(r"\((pictures/\S+\.png)\)", card):
        assert (BOOK / picture).stat().st_size < 120_000

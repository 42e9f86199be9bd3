"""The study of wishes from outside: what its file must hold, and what is said. No recorded clip."""

import json

import numpy as np
import pytest
from untrained import small_prior

from data_synth import held_out, make_clips
from projflow_lite.cli import main
from projflow_lite.studies import real_wishes, real_wishes_words
from projflow_lite.studies.cells import ALL, DATA, published
from projflow_lite.studies.control_ways import FREE, RIVALS
from projflow_lite.studies.real_wishes_words import COLUMNS, SOURCE, TO_RECORDED
from projflow_lite.studies.recorded import HOLDS, OWN, RECORDED, read_recorded


@pytest.fixture(scope="module")
def positions():
    """Clips that stand for recorded ones: of training seeds, larger by a tenth."""
    return 1.1 * make_clips(40, 60, 5).positions


def file_of(folder, **arrays):
    path = folder / "clips.npz"
    np.savez(path, **arrays)
    return path


def test_clips_are_read_and_put_over_the_origin(tmp_path, positions):
    away = positions + np.array([3.0, 0.0, -2.0], np.float32)
    sets = read_recorded(file_of(tmp_path, x60=away))
    assert list(sets) == [RECORDED]
    np.testing.assert_allclose(sets[RECORDED], positions, atol=1e-5)


def test_clips_with_guessed_bones_are_told_from_the_others(tmp_path, positions):
    known = np.array(["subject"] * 33 + ["nearest"] * 7)
    sets = read_recorded(file_of(tmp_path, x60=positions, skeleton60=known))
    assert len(sets[RECORDED]) == 40
    np.testing.assert_array_equal(sets[OWN], sets[RECORDED][:33])
    known[30:] = "nearest"  # too few are left
    assert list(read_recorded(file_of(tmp_path, x60=positions, skeleton60=known))) == [RECORDED]


WRONG = {
    "has no such x60 .found: none.": lambda x: {"y": x},
    r"has no such x60 .found: float32 \(40, 60, 21, 3\).": lambda x: {"x60": x[:, :, 1:]},
    "has 12 clips": lambda x: {"x60": x[:12]},
    "is 90.* high: not metres with y up": lambda x: {"x60": 100 * x},
    "bodies do not face": lambda x: {"x60": x * np.array([-1, 1, -1], np.float32)},
    "clip 3, frame 7 is not finite": lambda x: {"x60": np.where(marked(x), np.nan, x)},
}


def marked(x):
    one = np.zeros(x.shape, bool)
    one[3, 7, 5, 1] = True
    return one


@pytest.mark.parametrize("said", WRONG)
def test_a_file_that_holds_something_else_is_refused_in_one_line(tmp_path, positions, said):
    arrays = WRONG[said](positions)
    said = said.replace("is 90.*", "is [0-9.]+")
    with pytest.raises(ValueError, match=f"real-wishes: .*clips.npz.*{said}") as stopped:
        read_recorded(file_of(tmp_path, **arrays))
    assert "\n" not in str(stopped.value)


def test_what_is_no_npz_file_is_refused_and_nothing_is_unpickled(tmp_path, positions):
    for name, write in (
        ("text.npz", lambda path: path.write_text("no zip file")),
        ("single.npz", lambda path: np.save(path.open("wb"), positions)),
        (
            "half.npz",
            lambda path: path.write_bytes(file_of(tmp_path, x60=positions).read_bytes()[:900]),
        ),
        ("objects.npz", lambda path: np.savez(path, x60=np.array([{}], object))),
    ):
        write(tmp_path / name)
        with pytest.raises(ValueError, match=f"{name} cannot be read; it is an .npz file"):
            read_recorded(tmp_path / name)
    with pytest.raises(FileNotFoundError):
        read_recorded(tmp_path / "nowhere.npz")


def test_the_command_says_what_the_file_must_hold(capsys):
    assert main(["reproduce", "real-wishes"]) == 2
    error = capsys.readouterr().err
    assert "name a file of recorded clips by --real FILE" in error
    assert HOLDS in error
    assert error.count("\n") == 1


def test_every_seed_draws_other_clips_and_the_same_ones_again(positions):
    drawn = [real_wishes.drawn(positions, 32, seed).positions for seed in (0, 1, 0)]
    np.testing.assert_array_equal(drawn[0], drawn[2])
    assert not np.array_equal(drawn[0], drawn[1])
    places = {tuple(clip.ravel()[:9]) for clip in drawn[1]}
    assert len(places) == 32
    assert places <= {tuple(clip.ravel()[:9]) for clip in positions}


@pytest.fixture(scope="module")
def measured(positions, tmp_path_factory):
    """A small run on clips that stand for recorded ones, twice; the second one takes the files."""
    folder = tmp_path_factory.mktemp("real")
    known = np.array(["subject"] * 34 + ["nearest"] * 6)
    path = file_of(folder, x60=positions, skeleton60=known)
    protocol = real_wishes.QUICK._replace(clips=128, steps=2, rivals=(FREE, RIVALS[1], RIVALS[2]))
    made, real = [], real_wishes.measured

    def looking(*what):
        made.append(what[2])
        return real(*what)

    patch = pytest.MonkeyPatch()
    patch.setattr(real_wishes, "measured", looking)
    rows = real_wishes.run(small_prior(), path, protocol, folder / "runs", progress=False)
    assert real_wishes.run(small_prior(), path, protocol, folder / "runs", progress=False) == rows
    patch.undo()
    assert len(made) == 3 * 2 * 3  # sources, seeds and methods, once
    stored = [file for file in (folder / "runs").rglob("*") if file.is_file()]
    assert {file.suffix for file in stored} == {".json"}  # scores, and nothing of the clips
    return rows


def test_there_are_as_many_clips_of_every_source(measured):
    assert {row["clips"] for row in measured} == {34}
    data = real_wishes_words.data_of(measured)
    assert list(data) == ["held-out", RECORDED, OWN]
    assert TO_RECORDED in data["held-out"]["scores"]
    assert TO_RECORDED not in data[RECORDED]["scores"]
    for source in data:
        found = real_wishes_words.averages(measured, source)
        assert list(found) == ["no wish", "projflow", "ddnm"]
        for row in found.values():
            assert list(row["scores"]) == list(COLUMNS)
            assert all(np.isfinite(cell["half width"]) for cell in row["scores"].values())


def test_exact_methods_are_exact_on_recorded_wishes_too(measured):
    for source in (RECORDED, OWN):
        for name in ("projflow", "ddnm"):
            found = real_wishes_words.averages(measured, source)[name]
            assert max(found["scores"]["residual"]["values"]) < 1e-5
    said = real_wishes.sentences(measured)
    exact = next(line for line in said if line.startswith("Keyframes are met"))
    assert f"on {RECORDED} wishes by projflow, ddnm;" in exact
    assert not any(line.startswith("no wish, ") for line in said)


def test_the_table_the_picture_and_the_file_hold_the_numbers(measured, tmp_path):
    text = real_wishes.table(measured)
    for part in ("2 seeds of 34 clips", "recorded clips", "held-out wishes", TO_RECORDED):
        assert part in text
    published("real-wishes", small_prior(), measured, real_wishes.figure, tmp_path)
    assert json.loads((tmp_path / "results/real-wishes.json").read_text())["rows"] == measured
    assert (tmp_path / "pictures/real-wishes.png").stat().st_size > 10_000


def row(method, source, *values):
    """A row of the same made-up numbers for every score."""
    cell = {"mean": float(np.mean(values)), "half width": 0.1, "values": list(values)}
    joint = ALL if method == DATA else "average"
    about = {"joint": joint, "keys": ALL, "method": method, SOURCE: source}
    return about | {"scores": dict.fromkeys(COLUMNS, cell)}


ROWS = [
    row(DATA, "held-out", 1.0, 1.1),
    row(DATA, RECORDED, 5.0, 5.1),
    row("a", "held-out", 1.0, 2.0),
    row("b", "held-out", 3.0, 4.01),
    row("c", "held-out", 5.0, 6.02),
    row("d", "held-out", 4.0, 0.0),
    row("a", RECORDED, 3.0, 4.01),
    row("b", RECORDED, 2.0, 3.0),
    row("c", RECORDED, 9.0, 10.02),
    row("d", RECORDED, 4.0, 0.0),
]


def test_a_loss_is_a_difference_seed_by_seed():
    assert "FID +2 ± 0.064 (higher), " in real_wishes_words.of_method(ROWS, "a", RECORDED)
    assert "FID -1 ± 0.064 (lower), " in real_wishes_words.of_method(ROWS, "b", RECORDED)
    assert "FID +0 ± 0 (undecided), " in real_wishes_words.of_method(ROWS, "d", RECORDED)


def test_orders_are_compared_where_they_are_certain():
    """a, b, c are certain among each other; a and b change places; d is like none of them."""
    assert real_wishes_words.of_order(ROWS, "FID", RECORDED) == (
        "FID: of 3 pairs of methods whose order is certain on held-out wishes, 2 have the same "
        "order on recorded ones, 1 the other, and 0 are undecided there."
    )
    assert real_wishes_words.of_order(ROWS[:3] + ROWS[6:7], "FID", RECORDED) is None


def test_held_out_wishes_are_those_of_no_other_study():
    from projflow_lite.studies import control, lifting

    known = {*control.SEEDS, *lifting.SEEDS}
    assert not known & set(real_wishes.SEEDS)
    first = real_wishes.unprompted(held_out(2, 60, 1).positions)
    assert first.captions == [None, None]

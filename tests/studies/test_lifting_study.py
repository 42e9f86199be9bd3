"""The study of lifting: what is drawn, what the baselines do with it, and what its words say."""

import json

import numpy as np
import pytest
import torch
from untrained import small_prior

from data_synth import held_out, make_clips
from projflow_lite.constraints.cameras import rotation
from projflow_lite.prior.text import Vocabulary
from projflow_lite.projection import Projector
from projflow_lite.studies import (
    lifting,
    lifting_depths,
    lifting_direct,
    lifting_lessons,
    lifting_retrieval,
    lifting_ways,
    lifting_words,
)
from projflow_lite.studies.cells import ALL, DATA, Rival, published
from projflow_lite.studies.claims import TIME, Claim, claims_of
from projflow_lite.studies.control_ways import FREE
from projflow_lite.studies.lifting import Protocol
from projflow_lite.studies.lifting_depths import Lifter
from projflow_lite.studies.lifting_direct import Direct
from projflow_lite.studies.lifting_paper import DIRECT, LIFT, RETRIEVAL, TABLE
from projflow_lite.studies.lifting_pictures import (
    CROSS,
    Shot,
    draw_shot,
    errors_of,
    in_space,
    line_of_sight,
)
from projflow_lite.studies.lifting_retrieval import common_words, retrieve
from projflow_lite.studies.lifting_ways import (
    BASELINES,
    RIVALS_OF_LIFTING,
    Effort,
    Learnt,
    make,
)

pytestmark = pytest.mark.filterwarnings("ignore:prompt")

EXACT = ("projflow", "ddnm", LIFT, "euclid", "no fresh noise")
FEW = (FREE, RIVALS_OF_LIFTING[1], *BASELINES)


@pytest.fixture(scope="module")
def prior():
    return small_prior()


@pytest.fixture(scope="module")
def clips():
    return held_out(3, 60, 3)


@pytest.fixture(scope="module")
def learnt():
    """Baselines that have learnt nothing yet."""
    torch.manual_seed(0)
    stock = make_clips(50, 60, 5)
    return Learnt(stock, Lifter(16), Direct(Vocabulary.of(stock.captions), 8, 8))


# ----------------------------------------------------------------------------------- what is drawn


def test_cameras_are_those_of_the_paper_and_differ():
    cameras = [draw_shot(CROSS, seed).camera for seed in range(60)]
    assert all(camera.roll == 0 for camera in cameras)
    bounds = {"pitch": (0, 30), "yaw": (-45, 45), "scale": (0.8, 1.2)}
    for name, (low, high) in bounds.items():
        values = [getattr(camera, name) for camera in cameras]
        assert low <= min(values) < low + (high - low) / 5
        assert high - (high - low) / 5 < max(values) <= high


def test_one_path_is_drawn_or_one_to_six():
    assert draw_shot("head", 1).joints == (15,)
    chosen = [draw_shot(CROSS, seed).joints for seed in range(60)]
    assert {len(joints) for joints in chosen} == set(range(1, 7))
    assert all(set(joints) <= {0, 10, 11, 15, 20, 21} for joints in chosen)
    assert all(len(set(joints)) == len(joints) for joints in chosen)
    asked = Shot(draw_shot("head", 1).camera, (0, 15)).asked(60)
    assert asked[0].all()
    assert asked[1:].sum() == 2 * 59
    assert asked[:, [0, 15]].all()


@pytest.mark.parametrize("task", ["pelvis", CROSS])
def test_a_clip_looks_as_it_was_drawn_and_no_row_repeats_another(clips, task):
    shot = draw_shot(task, 4)
    drawings = shot.drawn(clips.positions)
    targets = shot.targets(drawings)
    for clip, drawing, y in zip(clips.positions, drawings, targets, strict=True):
        wish = shot.wish(drawing)
        rows = wish.rows(60)
        np.testing.assert_allclose(rows.y, y, atol=1e-12)
        assert len(y) == 2 * (22 + 59 * len(shot.joints))
        assert wish.residual(clip) < 1e-6  # of metres: clips are float32
    assert len(Projector(rows).keep) == len(y)


def test_a_drawing_and_its_depth_are_the_point(clips):
    shot = draw_shot("head", 9)
    depth = clips.positions @ line_of_sight(shot.camera)
    back = in_space(shot.camera, shot.drawn(clips.positions), depth)
    np.testing.assert_allclose(back, clips.positions, atol=1e-6)


def test_errors_are_worked_out_by_hand(clips):
    shot = draw_shot("left_wrist", 5)
    R, scale = rotation(shot.camera.pitch, shot.camera.yaw, 0), shot.camera.scale
    away = clips.positions + 0.3 * R[2]  # along the line of sight
    errors = errors_of(shot, away, clips.positions)
    np.testing.assert_allclose(errors.path_3d, 0.3, atol=1e-6)
    for name in ("pose_2d", "pose_3d", "path_2d", "residual"):
        np.testing.assert_allclose(getattr(errors, name), 0, atol=1e-6)
    bent = clips.positions.astype(float)
    bent[:, 0, 15] += 0.22 * R[0]  # the head, to the right in the picture
    bent[:, 7, 20] += 0.6 * R[1]  # the wrist, upwards in one frame of sixty
    bent[:, 9, 3] += 5.0  # nobody drew it
    errors = errors_of(shot, bent, clips.positions)
    np.testing.assert_allclose(errors.pose_2d, scale * 0.01, atol=1e-6)
    np.testing.assert_allclose(errors.pose_3d, 0.01, atol=1e-6)
    np.testing.assert_allclose(errors.path_2d, scale * 0.01, atol=1e-6)
    np.testing.assert_allclose(errors.residual, 0.6, atol=1e-6)


# --------------------------------------------------------------------------------------- retrieval


def test_words_in_common_are_shared_out_over_the_words_of_both():
    shared = common_words(["a man walks"], ["a man runs fast", "a man walks", "stop"])
    np.testing.assert_allclose(shared, [[2 / 5, 1, 0]])


def test_a_clip_of_the_stock_finds_itself(learnt):
    stock, shot = learnt.stock, draw_shot("pelvis", 2)
    found = retrieve(stock, shot, shot.drawn(stock.positions), stock.captions, kept=5)
    np.testing.assert_array_equal(found, stock.positions)


def test_the_nearest_drawing_wins_among_the_captions_that_are_kept(learnt, clips):
    stock, shot = learnt.stock, draw_shot(CROSS, 2)
    drawings, asked = shot.drawn(clips.positions), shot.asked(60)
    found = retrieve(stock, shot, drawings, clips.captions, kept=12)
    shared = common_words(clips.captions, stock.captions)
    for k, positions in enumerate(found):
        place = next(n for n in range(50) if np.array_equal(stock.positions[n], positions))
        rank = np.sort(shared[k])[-12]
        distance = [
            np.linalg.norm((shot.drawn(other) - drawings[k])[asked]) for other in stock.positions
        ]
        allowed = [n for n in range(50) if shared[k, n] >= rank]
        assert 12 <= len(allowed) < 50
        assert place == min(allowed, key=lambda n: distance[n])


# ---------------------------------------------------------------------------------- learnt baselines


def one_lesson(monkeypatch):
    """The same batch of clips and drawings over and over."""
    lesson = next(lifting_lessons.lessons(1, 60, clips=8))
    monkeypatch.setattr(lifting_lessons, "lessons", lambda steps, frames: [lesson] * steps)
    return lesson


def test_lessons_differ_and_hide_what_is_not_drawn():
    first, second = lifting_lessons.lessons(2, 60, clips=64)
    assert first.drawn.picture.shape == (32, 60, 22, 2)
    assert not first.drawn.picture[first.drawn.asked == 0].any()
    assert not torch.equal(first.drawn.sight, second.drawn.sight)
    again = next(lifting_lessons.lessons(1, 60, clips=64))
    assert torch.equal(first.drawn.picture, again.drawn.picture)
    assert first.captions == again.captions
    counts = first.drawn.asked[:, 1].sum(1)
    assert set(counts.int().tolist()) <= set(range(1, 7))
    assert len(set(counts.tolist())) > 2


def test_lifted_points_are_drawn_where_they_were_drawn(learnt, clips):
    shot = draw_shot("head", 3)
    drawings = shot.drawn(clips.positions)
    points = lifting_depths.lifted(learnt.lifter, shot, drawings)
    asked = shot.asked(60)
    np.testing.assert_allclose(shot.drawn(points)[:, asked], drawings[:, asked], atol=1e-6)
    step = lifting_depths.aim(shot, points)
    x1 = step(torch.zeros(3, 60, 22, 3), 0.5).numpy()
    np.testing.assert_allclose(x1[:, asked], points[:, asked], atol=1e-6)


def test_a_lifter_looks_at_one_frame_and_the_pose(learnt, clips):
    shot = draw_shot("head", 3)
    drawings = shot.drawn(clips.positions)
    usual = lifting_depths.lifted(learnt.lifter, shot, drawings)
    other = drawings.copy()
    other[:, 30, 15] += 0.5
    other[:, 30, 4] = 7.0  # not drawn
    moved = np.abs(lifting_depths.lifted(learnt.lifter, shot, other) - usual)[:, :, 15].max((0, 2))
    assert moved[30] > 0.1
    assert not np.delete(moved, 30).any()
    other[:, 0, 4] += 0.5  # of the pose
    moved = np.abs(lifting_depths.lifted(learnt.lifter, shot, other) - usual)[:, :, 15].max((0, 2))
    assert np.all(moved > 0)


def test_depth_does_not_jump_where_fewer_joints_are_drawn(learnt, clips):
    """A body that stands still, drawn whole in frame 0 and by its head from there on."""
    shot = draw_shot("head", 3)
    drawn = lifting_lessons.as_drawn([shot] * 3, shot.drawn(clips.positions[:, [0, 0]]))
    with torch.no_grad():
        depth = learnt.lifter(drawn)[..., 15]
        pose, seconds = drawn.picture[:, :1].expand(-1, 2, -1, -1), torch.zeros(3, 2, 1)
        alone = learnt.lifter.look(drawn.picture, drawn.asked, pose, drawn.sight, seconds)[..., 15]
    torch.testing.assert_close(depth[:, 0], alone[:, 0])
    assert (depth[:, 1] - depth[:, 0]).abs().max() < 0.2 * (alone[:, 1] - alone[:, 0]).abs().min()


def test_a_lifter_learns_depths(monkeypatch):
    lesson = one_lesson(monkeypatch)
    torch.manual_seed(1)
    lifter = Lifter(64)
    lifting_depths.learn(lifter, 60, steps=200)
    depth = (lesson.positions * lesson.drawn.sight[:, None, None]).sum(-1)
    drawn = lesson.drawn.asked > 0
    with torch.no_grad():
        miss = (lifter(lesson.drawn) - depth)[drawn]
    assert miss.square().mean() < 0.1 * depth[drawn].var()
    assert not any(parameter.requires_grad for parameter in lifter.parameters())


def test_the_direct_way_learns_motions_and_hears_the_prompt(monkeypatch):
    lesson = one_lesson(monkeypatch)
    torch.manual_seed(1)
    direct = Direct(Vocabulary.of(lesson.captions), 32, 8)
    lifting_direct.learn(direct, 60, steps=80)
    with torch.no_grad():
        x = direct(lesson.drawn, lesson.captions)
        other = direct(lesson.drawn, lesson.captions[::-1])
    miss = (x - lesson.positions).square().mean()
    assert miss < 0.1 * (lesson.positions - lesson.positions.mean((0, 1))).square().mean()
    assert (x - other).abs().max() > 0.01


def test_the_direct_way_does_not_see_what_is_not_drawn(learnt, clips):
    shot = draw_shot("head", 3)
    drawings = shot.drawn(clips.positions)
    blind = np.where(shot.asked(60)[..., None], drawings, np.nan)
    captions = learnt.stock.captions[:3]
    x, y = (lifting_direct.answered(learnt.direct, shot, d, captions) for d in (drawings, blind))
    np.testing.assert_array_equal(x, y)


def test_what_was_learnt_is_taken_from_its_file(tmp_path, monkeypatch):
    monkeypatch.setattr(lifting_retrieval, "SEED", 1)
    learned, real = [], lifting_lessons.lessons

    def few(steps, frames):
        learned.append(steps)
        return real(steps, frames, clips=40)

    monkeypatch.setattr(lifting_lessons, "lessons", few)
    first, second = (lifting_ways.school(60, Effort(20, 2, 3), tmp_path) for _ in range(2))
    assert learned == [2, 3]
    for a, b in ((first.lifter, second.lifter), (first.direct, second.direct)):
        for x, y in zip(a.state_dict().values(), b.state_dict().values(), strict=True):
            assert torch.equal(x, y)
    assert len(first.stock.captions) == 20


# ---------------------------------------------------------------------------------------- the study


@pytest.mark.parametrize("rival", RIVALS_OF_LIFTING, ids=[r.name for r in RIVALS_OF_LIFTING])
def test_every_rival_makes_a_motion_for_every_clip(prior, clips, learnt, rival, monkeypatch):
    monkeypatch.setattr(lifting_ways, "BATCH", 2)  # two batches, with cameras of their own
    if rival.name == "dno":
        rival = Rival("dno", "dno", (("iterations", 2), ("solver_steps", 2)))
    made = make(prior, prior.noise_std, rival, CROSS, clips, 3, 0, learnt)
    assert made.positions.shape == clips.positions.shape
    assert np.isfinite(made.positions).all()
    assert (made.errors.residual.max() < 1e-5) == (rival.name in EXACT)
    shots = [draw_shot(CROSS, number) for number in (0, 2)]
    assert shots[0] != shots[1]
    parts = [
        errors_of(shot, made.positions[part], clips.positions[part])
        for shot, part in zip(shots, (slice(0, 2), slice(2, 3)), strict=True)
    ]
    for name in ("path_3d", "pose_3d"):
        together = np.concatenate([getattr(part, name) for part in parts])
        np.testing.assert_allclose(getattr(made.errors, name), together)


@pytest.fixture(scope="module")
def measured(prior, learnt, tmp_path_factory):
    """A run that broke off, and the rows of the one that went on."""
    folder, made, real = tmp_path_factory.mktemp("lifting"), [], lifting.measured
    protocol = Protocol(32, 2, 2, ("pelvis", "head"), FEW)

    def breaking(*what):
        made.append(what)
        if len(made) == 4:
            raise KeyboardInterrupt
        return real(*what)

    patch = pytest.MonkeyPatch()
    patch.setattr(lifting, "measured", breaking)
    patch.setattr(lifting, "school", lambda frames, effort, place: learnt)
    with pytest.raises(KeyboardInterrupt):
        lifting.run(prior, protocol, folder, progress=False)
    rows = lifting.run(prior, protocol, folder, progress=False)
    assert lifting.run(prior, protocol, folder, progress=False) == rows
    patch.undo()
    assert len(made) == 2 * 3 * 5 + 1  # nothing was made twice but what broke
    return rows


def test_there_is_a_row_for_every_task_and_method(measured):
    assert measured[0]["method"] == DATA
    assert "MPJPE-2D" not in measured[0]["scores"]
    names = [rival.name for rival in FEW]
    tasks = ("pelvis", "head", "average", CROSS)
    expected = [(task, name) for task in tasks for name in names]
    assert [(row["joint"], row["method"]) for row in measured[1:]] == expected
    for row in measured[1:]:
        assert list(row["scores"]) == list(lifting_words.COLUMNS)
        assert row["keys"] == ALL
        assert row[TIME] > 0


def test_the_average_is_that_of_the_joints_seed_by_seed(measured):
    values = {
        row["joint"]: row["scores"]["average error 3D"]["values"]
        for row in measured
        if row["method"] == RETRIEVAL
    }
    np.testing.assert_allclose(values["average"], np.mean([values["pelvis"], values["head"]], 0))


def test_the_table_the_picture_and_the_file_hold_the_numbers(measured, prior, tmp_path):
    text = lifting.table(measured)
    for part in ("2 seeds of 32 clips", RETRIEVAL, LIFT, DIRECT, "sketch2anim", "0.331", "0.525"):
        assert part in text
    said = lifting.sentences(measured)
    assert said[0].startswith("projflow: both errors in the picture 0.000 (Table 2)")
    assert said[0].endswith(": reproduced.")
    assert sum(line.startswith(("average, ", "cross, ")) for line in said) == 2 * 3 * 8
    published("lifting", prior, measured, lifting.figure, tmp_path)
    assert json.loads((tmp_path / "results/lifting.json").read_text())["rows"] == measured
    assert (tmp_path / "pictures/lifting.png").stat().st_size > 10_000


def test_too_few_clips_or_seeds_are_refused(prior):
    with pytest.raises(ValueError, match="lifting: at least 32 clips and 2 seeds, not 32 and 1"):
        lifting.run(prior, Protocol(clips=32, seeds=1))


def row(method, joint="average", **columns):
    """A row of made-up numbers: (0.0, 0.0) wherever nothing is said."""
    columns = dict.fromkeys(lifting_words.COLUMNS, (0.0, 0.0)) | columns
    scores = {
        name: {"mean": float(np.mean(v)), "half width": 0.0, "values": list(v)}
        for name, v in columns.items()
    }
    return {"joint": joint, "keys": ALL, "method": method, "scores": scores, TIME: 1.0}


def test_exactness_is_judged_by_the_worst_seed_of_all_tasks():
    good = row("projflow", **{"MPJPE-2D": (0.0, 0.0004)})
    assert lifting_words.of_exactness([good]).endswith("0.0e+00 m: reproduced.")
    bad = row("projflow", "cross", **{"average error 2D": (0.0, 0.0006), "residual": (0.1, 0.2)})
    text = lifting_words.of_exactness([good, bad])
    assert text.endswith(
        "here the largest is 0.0006, the largest residual 2.0e-01 m: not reproduced."
    )
    assert lifting_words.of_exactness([row("ddnm")]) is None


def test_what_depth_gains_is_said_with_its_interval():
    columns = {"average error 3D": (0.1, 0.2), "bone error %": (3.0, 3.0)}
    rows = [row("projflow", **columns)]
    assert lifting_words.of_depth(rows, "average") is None
    rows.append(row(LIFT, **{"average error 3D": (0.4, 0.5), "bone error %": (1.0, 5.0)}))
    text = lifting_words.of_depth(rows, "average")
    assert "average error 3D 0.150 ± 0.000 against 0.450 ± 0.000 (less, -0.3 ±" in text
    assert "bone error % 3.000 ± 0.000 against 3.000 ± 0.000 (undecided, +0 ± 25)" in text


def test_claims_have_the_signs_of_the_printed_numbers():
    found = claims_of(TABLE, TABLE.columns)
    assert len(found) == 2 * 4 * 8
    assert Claim("average", "FID", "projflow", RETRIEVAL) in found
    assert Claim("cross", "FID", RETRIEVAL, "projflow") in found
    assert Claim("average", "skating gmd", LIFT, "projflow") in found
    assert Claim("cross", "average error 3D", DIRECT, "projflow") in found
    assert Claim("average", "R top 3", "projflow", LIFT) in found
    assert all(c.less == "projflow" for c in found if c.column in lifting_words.IN_PICTURE)

"""The blind page keeps its secret, shows every clip, and grades with the key."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from data_synth import make_clips
from projflow_lite.prior.training import RECIPES, train
from projflow_lite.studies import blind_page


@pytest.fixture(scope="module")
def prior(tmp_path_factory):
    return train(replace(RECIPES["smoke"], steps=2), tmp_path_factory.mktemp("run"), progress=False)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A file that looks like recorded motion; it begins with arrays that are no motion."""
    path = tmp_path_factory.mktemp("real") / "real.npz"
    clips = make_clips(5, 70, seed=9).positions
    np.savez(path, names=np.array(["a"]), short=clips[:, :30], clips=clips)
    return path


@pytest.fixture
def written(prior, recorded, tmp_path):
    return blind_page.run(prior, tmp_path, recorded, clips=3, frames=40, steps=2)


def test_the_key_knows_every_clip_and_the_page_does_not(written):
    page, key = written
    answers = json.loads(key.read_text())
    kinds = [answers[str(k)]["kind"] for k in range(1, 10)]
    assert sorted(kinds) == ["generated"] * 3 + ["real"] * 3 + ["synthetic"] * 3
    assert kinds != sorted(kinds)
    text = page.read_text()
    assert all(a["caption"] not in text for a in answers.values() if a["caption"])
    assert not re.search(r"https?://|src=|import ", text)


def test_without_recorded_motion_there_are_two_kinds(prior, tmp_path):
    _, key = blind_page.run(prior, tmp_path / "new" / "folder", clips=2, frames=40, steps=2)
    kinds = {answer["kind"] for answer in json.loads(key.read_text()).values()}
    assert kinds == {"generated", "synthetic"}


def test_recorded_clips_come_from_the_first_array_that_is_long_enough(recorded):
    random = np.random.default_rng(0)
    x = blind_page.read_real(recorded, 4, 60, random)
    known = make_clips(5, 70, seed=9).positions[:, :60]
    assert x.shape == (4, 60, 22, 3)
    assert all(any(np.array_equal(clip, one) for one in known) for clip in x)
    with pytest.raises(ValueError, match="5 clips of 6"):
        blind_page.read_real(recorded, 6, 60, random)
    with pytest.raises(ValueError, match="no array"):
        blind_page.read_real(recorded, 4, 90, random)
    with pytest.raises(FileNotFoundError):
        blind_page.read_real(recorded.with_name("nowhere.npz"), 4, 60, random)


@pytest.mark.browser
def test_the_page_moves_turns_pauses_and_grades(written, open_page, artefacts):
    path, key = written
    page = open_page(width=1000, height=900)
    page.set_content(path.read_text())
    assert page.locator("canvas").count() == 9
    inked = """() => [...document.querySelectorAll("canvas")].map(c => [...c.getContext("2d")
        .getImageData(0, 0, c.width, c.height).data].filter((v, i) => i % 4 == 3 && v).length)"""
    page.wait_for_function("document.body.dataset.frame > 2")
    assert min(page.evaluate(inked)) > 500
    page.click("#pause")
    picture = "() => document.querySelector('canvas').toDataURL()"
    page.wait_for_timeout(100)
    still = page.evaluate(picture)
    page.wait_for_timeout(200)
    assert page.evaluate(picture) == still
    box = page.locator("canvas").first.bounding_box()
    page.mouse.move(box["x"] + 50, box["y"] + 50)
    page.mouse.down()
    page.mouse.move(box["x"] + 150, box["y"] + 50, steps=4)
    page.mouse.up()
    page.wait_for_timeout(100)
    assert page.evaluate(picture) != still

    answers = json.loads(key.read_text())
    for k in range(8):  # the last clip is left open
        page.locator("select").nth(k).select_option(answers[str(k + 1)]["kind"])
    page.set_input_files("#key", str(key))
    page.wait_for_selector("#result table")
    counts = page.evaluate(
        "() => [...document.querySelectorAll('#result tr')].slice(1).map("
        "row => [...row.querySelectorAll('td')].map(cell => +cell.textContent))"
    )
    counts = np.array(counts)  # rows: generated, real, synthetic; columns: ? and the same
    assert counts.sum() == 9
    assert counts[:, 0].sum() == 1
    assert np.trace(counts[:, 1:]) == 8
    page.screenshot(path=artefacts / "blind_page.png", full_page=True)

"""The studio without a page: what a finished stroke, a changed control and an error do."""

from __future__ import annotations

import asyncio

import numpy as np
import pytest
from stage import walking, wished

from projflow_lite.widgets import WishStudio
from projflow_lite.widgets.front_end import pack

PATH = np.linspace([0.0, 1.0], [0.5, 1.5], 10)


@pytest.fixture
def calls():
    return []


@pytest.fixture
def studio(calls):
    def make(joint, plane, path, prompt):
        calls.append((joint, plane, path, prompt))
        if prompt == "wrong":
            raise ValueError("make: <wrong> prompt")
        if prompt == "broken":
            raise KeyError("broken")
        return wished(walking(10, prompt=prompt), joint)

    return WishStudio(make, samples=10)


def finish_stroke(studio, path=PATH):
    """What the page sends when the pointer goes up."""
    state = {"path_data": memoryview(pack(path)), "version": studio.pad.version + 1}
    studio.pad.set_state(state)


def test_a_stroke_makes_one_motion(studio, calls):
    assert studio.motion is None
    finish_stroke(studio)
    assert len(calls) == studio.runs == 1
    joint, plane, path, prompt = calls[0]
    assert (joint, plane, prompt) == ("left_wrist", "xy", "a person waves with the left hand")
    np.testing.assert_allclose(path, PATH, atol=1e-6)
    assert studio.viewer.motion is studio.motion
    assert "10 frames in 0." in studio.status.value
    assert "max |A x − y| = 0.0e+00 m" in studio.status.value
    np.testing.assert_allclose(
        studio.pad.joint_path, studio.motion.joint("left_wrist")[:, :2], atol=1e-6
    )


def test_joint_prompt_and_button_run_again(studio, calls):
    finish_stroke(studio)
    studio.joint.value = "right_ankle"
    studio.prompt.value = "a person jumps"
    studio.again.click()
    assert [call[0] for call in calls] == ["left_wrist"] + ["right_ankle"] * 3
    assert calls[-1][3] == "a person jumps"
    assert studio.viewer.trail == [8]


def test_a_warning_is_said_beside_the_result():
    import warnings

    def make(joint, plane, path, prompt):
        warnings.warn("prompt: the prior never saw 'pirouettes'; left out", stacklevel=1)
        return wished(walking(10, prompt=prompt), joint)

    studio = WishStudio(make, samples=10)
    finish_stroke(studio)
    assert "10 frames in" in studio.status.value
    assert studio.status.value.count("never saw") == 1


def test_another_plane_waits_for_a_new_path(studio, calls):
    finish_stroke(studio)
    studio.plane.value = "xz"
    assert studio.pad.path is None
    assert len(calls) == 1
    assert "Draw a path" in studio.status.value


def test_an_error_shows_in_the_status_and_is_escaped(studio):
    finish_stroke(studio)
    kept = studio.motion
    studio.prompt.value = "wrong"
    assert "error: make: &lt;wrong&gt; prompt" in studio.status.value
    assert "pf-bad" in studio.status.value
    assert studio.motion is kept
    studio.prompt.value = "broken"
    assert "error (KeyError)" in studio.status.value
    assert isinstance(studio.error, KeyError)
    studio.prompt.value = "fine"
    assert studio.error is None
    assert "pf-bad" not in studio.status.value


def test_busy_shows_before_the_work_starts():
    seen = []

    def make(*_):
        seen.append(studio.status.value)
        return walking(10)

    studio = WishStudio(make, samples=10)
    finish_stroke(studio)
    assert "pf-busy" in seen[0]


def test_many_quick_strokes_make_one_motion(studio, calls):
    async def draw():
        for shift in (0.0, 0.1, 0.2):
            finish_stroke(studio, PATH + shift)
        await asyncio.sleep(0.2)

    asyncio.run(draw())
    assert len(calls) == 1
    np.testing.assert_allclose(calls[0][2], PATH + 0.2, atol=1e-6)


def test_wrong_arguments_are_refused():
    with pytest.raises(ValueError, match="did you mean 'left_wrist'"):
        WishStudio(print, joint="left_wirst")
    with pytest.raises(ValueError, match="'yz' is not a plane; choose from xy, zy, xz"):
        WishStudio(print, plane="yz")
    with pytest.raises(ValueError, match="make must be a function"):
        WishStudio(None)

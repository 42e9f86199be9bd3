"""The viewer, the path pad and the studio in a real JupyterLab, by mouse and keyboard."""

from __future__ import annotations

import numpy as np
import pytest

pytestmark = pytest.mark.browser

SETUP = """
import time
import numpy as np
from projflow_lite.motion import Motion
from projflow_lite.skeleton import JOINTS
from projflow_lite.widgets import PLANES, PathPad, Viewer, WishStudio, view
from projflow_lite.widgets.standing import standing_pose

class Wish:  # a stand-in for projflow_lite.constraints: this joint at these places
    def __init__(self, joint, target):
        self.joint, self.target = JOINTS.index(joint), target
    def markers(self, frames):
        from types import SimpleNamespace
        k = len(self.target)
        return SimpleNamespace(joint=np.full(k, self.joint), frame=np.arange(k),
                               target=self.target, std=np.zeros(k))
    def residual(self, positions):
        return float(np.nanmax(np.abs(positions[:, self.joint] - self.target)))

def make(joint, plane, path, prompt):
    if "error" in prompt:
        raise ValueError("the prompt asks for <an error>")
    if "slowly" in prompt:
        time.sleep(1)
    positions = np.repeat(standing_pose(), len(path), axis=0)
    target = np.full((len(path), 3), np.nan)
    target[:, PLANES[plane]] = path
    arm = {"left_wrist": [18, 20], "right_wrist": [19, 21]}.get(joint, [JOINTS.index(joint)])
    for share, j in zip([0.5, 1.0][-len(arm):], arm):
        old = positions[:, j][:, PLANES[plane]]
        positions[:, j, PLANES[plane][0]] = old[:, 0] + share * (path[:, 0] - old[:, 0])
        positions[:, j, PLANES[plane][1]] = old[:, 1] + share * (path[:, 1] - old[:, 1])
    return Motion(positions, prompt, Wish(joint, target))
"""
STUDIO = "studio = WishStudio(make, samples=40)\nstudio"
VIEWER = """
still = np.repeat(standing_pose(), 30, axis=0)
still[..., 2] += np.linspace(0, 2, 30)[:, None]
viewer = view(Motion(still, "a statue on wheels"), Motion(still + [0.8, 0, 0]), playing=False,
              trail="left_wrist", names=["statue", "its friend"], height=300)
viewer
"""
PAD = "pad = PathPad('xz', samples=25, height=300)\npad"
ARC = [(0.35, 0.6), (0.4, 0.4), (0.5, 0.3), (0.6, 0.3), (0.7, 0.4), (0.75, 0.55)]


def test_draw_a_path_and_the_wrist_follows(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("studio.ipynb", SETUP, STUDIO), ratio=2)
    lab.run_all()
    before = lab.pixels(".pf-viewer")
    lab.drag(".pf-pad", ARC)
    lab.wait_for("studio.runs == 1")

    path, wrist = (
        np.array(lab.ask(f"studio.{what}"))
        for what in ("pad.path", "motion.joint('left_wrist')[:, :2]")
    )
    assert path.shape == (40, 2)
    assert np.ptp(path[:, 0]) > 0.5
    np.testing.assert_allclose(wrist, path, atol=1e-6)
    lab.page.wait_for_timeout(300)
    assert lab.pixels(".pf-viewer") != before
    assert lab.page.locator(".pf-viewer").get_attribute("data-met") == "40"
    assert "max |A x − y| = " in lab.page.locator(".pf-status").inner_text()
    assert lab.ask("studio.runs") == 1, "one stroke, one motion"
    lab.screenshot("studio_light", top=".jp-OutputArea")
    lab.theme("JupyterLab Dark")
    lab.screenshot("studio_dark", top=".jp-OutputArea")


def test_studio_shows_an_error_and_recovers(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("studio_error.ipynb", SETUP, STUDIO))
    lab.run_all()
    prompt = lab.page.get_by_label("prompt")
    prompt.fill("an error please")
    prompt.press("Enter")
    lab.page.get_by_label("Preset shape").select_option("Circle")
    status = lab.page.locator(".pf-status.pf-bad")
    status.wait_for(timeout=10_000)
    assert status.inner_text() == "error: the prompt asks for <an error>"
    lab.screenshot("studio_error", top=".jp-OutputArea")
    prompt.fill("a person waves slowly")
    prompt.press("Enter")
    lab.page.locator(".pf-status.pf-busy").wait_for(timeout=5_000)
    lab.wait_for("studio.runs == 1 and studio.error is None")
    assert lab.page.locator(".pf-status.pf-bad").count() == 0


def test_viewer_and_pad_by_keyboard(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("keys.ipynb", SETUP, VIEWER, PAD))
    lab.run_all()
    lab.canvas(".pf-viewer").click()
    before = lab.pixels(".pf-viewer")
    for key in ("ArrowRight", "ArrowRight", "d", "d", "ArrowUp"):
        lab.page.keyboard.press(key)
    lab.wait_for("viewer.frame == 12")
    assert lab.pixels(".pf-viewer") != before
    assert lab.ask("viewer.camera['yaw']") < 0.5, "d turns the body, as a drag to the right"
    lab.page.keyboard.press(" ")
    lab.wait_for("viewer.playing")
    lab.page.keyboard.press(" ")
    lab.wait_for("not viewer.playing")
    lab.screenshot("viewer_light", top=".jp-OutputArea")

    lab.page.get_by_label("Preset shape").select_option("Heart")
    lab.wait_for("pad.version == 1")
    start = np.array(lab.ask("pad.path"))
    lab.canvas(".pf-pad").focus()
    for key in ("ArrowUp", "ArrowUp", "Shift+ArrowLeft"):
        lab.page.keyboard.press(key)
    lab.wait_for("pad.version == 2")
    moved = np.array(lab.ask("pad.path")) - start
    np.testing.assert_allclose(moved, np.tile([0.1, 0.02], (25, 1)), atol=1e-6)  # left is +x
    count = lab.page.evaluate("window.jupyterapp.shell.currentWidget.content.widgets.length")
    assert count == 3, "the keys must not act on the notebook's cells"
    lab.screenshot("pad_light", top=".pf-pad")

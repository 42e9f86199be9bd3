"""The pose editor in JupyterLab: a wrist is dragged with the mouse, and the body follows exactly."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.browser

CELL = """
import torch
import projflow_lite as pf
torch.set_num_threads(1)
editor = pf.widgets.PoseEditor(pf.load_prior(), "a person waves with the left hand", frames=40, height=420)
editor
"""
WRIST = 20
PLACE = """
import numpy as np
def on_screen(joint):
    x = editor.motion.positions[editor.viewer.frame, joint]
    c = editor.viewer.camera
    sy, cy, sp, cp = np.sin(c["yaw"]), np.cos(c["yaw"]), np.sin(c["pitch"]), np.cos(c["pitch"])
    d = x - np.array(c["target"])
    depth = c["distance"] - d @ [sy * cp, sp, cy * cp]
    focal = 210 / np.tan(np.pi / 12)
    return [float(d @ [cy, 0, -sy]) * focal / depth, float(d @ [-sy * sp, cp, -cy * sp]) * focal / depth]
"""


def test_drag_a_wrist(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("pose.ipynb", CELL, PLACE), width=1100, height=900)
    lab.run_all(seconds=120)
    page = lab.page
    lab.ask(
        "setattr(editor.viewer, 'camera', dict(yaw=0.3, pitch=0.15, distance=4.5, target=[0, 0.95, 0], orthographic=False)) or 0"
    )
    page.wait_for_timeout(500)
    canvas = lab.canvas(".pf-viewer")
    canvas.scroll_into_view_if_needed()
    box = canvas.bounding_box()
    dx, dy = lab.ask(f"on_screen({WRIST})")
    x, y = box["x"] + box["width"] / 2 + dx, box["y"] + box["height"] / 2 - dy
    page.mouse.move(x - 3, y)
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(12):
        page.mouse.move(x + 4 * k, y - 7 * k)
        page.wait_for_timeout(30)
    lab.wait_for("editor.runs > 0", seconds=30)  # it follows while the hand is still moving
    page.mouse.up()
    lab.wait_for(f"list(editor.pins) == [({WRIST}, 0)] and editor.viewer.pull['done']", seconds=30)
    lab.wait_for(
        f"abs(editor.motion.positions[0, {WRIST}] - editor.pins[{WRIST}, 0]).max() < 1e-6",
        seconds=30,
    )
    # In the picture the wrist is now where the mouse let go of it.
    after = lab.ask(f"on_screen({WRIST})")
    assert after == pytest.approx([dx + 44, dy + 77], abs=6)
    assert lab.ask("editor.viewer.camera['yaw']") == pytest.approx(0.3)  # the view did not turn
    lab.screenshot("pose_editor", top=".jp-OutputArea")
    page.get_by_role("button", name="Clear").click()
    lab.wait_for("editor.pins == {}", seconds=30)
    page.mouse.move(box["x"] + 30, box["y"] + 60)
    page.mouse.down()
    page.mouse.move(box["x"] + 130, box["y"] + 60)
    page.mouse.up()
    lab.wait_for("abs(editor.viewer.camera['yaw'] - 0.3) > 0.1", seconds=20)
    assert lab.ask("editor.pins") == {}

"""The first notebook as a student meets it: run all, draw with the mouse, see the body follow."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.browser

NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "00_start_here.ipynb"
STROKE = [(0.30, 0.55), (0.33, 0.42), (0.40, 0.36), (0.46, 0.42), (0.44, 0.52), (0.36, 0.55)]


def test_a_drawn_path_becomes_a_motion_that_follows_it_exactly(jupyter_lab):
    lab = jupyter_lab(NOTEBOOK, width=1500, height=1100)
    lab.run_all(seconds=90)
    lab.screenshot("start_here_top", top=".jp-MarkdownCell")
    assert lab.ask("motion.residual") < 1e-6
    assert lab.page.locator(".pf-viewer").count() == 3

    before = lab.pixels(".pf-viewer", 2)
    lab.drag(".pf-pad", STROKE)
    lab.wait_for("studio.runs == 1", seconds=60)
    drawn = np.array(lab.ask("studio.pad.path"))
    wrist = np.array(lab.ask("studio.motion.joint('right_wrist')"))
    assert drawn.shape == (60, 2)
    assert np.ptp(drawn, axis=0).min() > 0.1
    np.testing.assert_allclose(wrist[:, :2], drawn, atol=1e-6)
    assert lab.ask("studio.motion.residual") <= 1e-6

    lab.page.wait_for_timeout(500)
    assert lab.pixels(".pf-viewer", 2) != before
    assert "max |A x − y| = " in lab.page.locator(".pf-status").inner_text()
    lab.screenshot("start_here_studio", top=".pf-pad")

    lab.page.get_by_label("joint").select_option("left wrist")
    lab.wait_for("studio.runs == 2", seconds=60)
    path = lab.ask("studio.motion.joint('left_wrist')[:, :2]")
    np.testing.assert_allclose(path, drawn, atol=1e-6)
    lab.theme("JupyterLab Dark")
    lab.screenshot("start_here_dark", top=".pf-pad")

"""The chapter on a metric over time in JupyterLab: sliders and keyframes move the paths."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_gait import press
from test_tasks import choose

pytestmark = pytest.mark.browser

NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "16_a_metric_over_time.ipynb"


def test_a_keyframe_and_a_slider_move_the_paths(jupyter_lab):
    lab = jupyter_lab(NOTEBOOK, width=1400, height=1000)
    lab.run_all(seconds=240)
    lab.screenshot("reach_top", top=".pf-board")
    before = lab.pixels(".pf-board")
    lab.drag_handle(0, "key 1", right=-120, down=-30)
    lab.wait_for("pinned.place('key 1')[0] < 28 and pinned.place('key 1')[1] > 0.42")
    assert lab.pixels(".pf-board") != before
    reached = lab.ask("pinned.paths['metric over time'][30]")
    press(lab, "flow time t", "ArrowRight", 20)
    lab.wait_for("pinned.t.value > 0.65")
    lab.wait_for(f"pinned.paths['metric over time'][30] < {reached} - 0.005")
    lab.screenshot("reach_moved", top=".pf-board")
    for name, place in (("walks", 2), ("columns", 3), ("clips", 4), ("strip", 5), ("cut", 6)):
        lab.screenshot(f"reach_{name}", top=f".pf-board >> nth={place}")
    lab.screenshot("reach_bodies", top=".pf-viewer")
    total = lab.ask("float(viewer.motion.positions.sum())")
    choose(lab, "joint", "pelvis")
    lab.wait_for(f"abs(float(viewer.motion.positions.sum()) - {total}) > 1e-3", seconds=60)
    lab.theme("JupyterLab Dark")
    lab.screenshot("reach_dark", top=".pf-board")
    lab.screenshot("reach_bodies_dark", top=".pf-viewer")

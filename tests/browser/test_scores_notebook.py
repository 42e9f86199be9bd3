"""Notebook 13 as a student meets it: run all, damage the motion, see who notices."""

from __future__ import annotations

from pathlib import Path

import pytest
from test_tasks import choose, press

pytestmark = pytest.mark.browser

NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "13_how_scores_lie.ipynb"


def test_each_fault_is_noticed_by_some_scores_and_not_by_others(jupyter_lab):
    lab = jupyter_lab(NOTEBOOK, width=1100, height=1000)
    lab.run_all(seconds=400)
    lab.screenshot("scores_undamaged", top=".widget-dropdown")
    assert lab.ask("explorer.noticed") == []
    press(lab, "size", "ArrowRight", 5)
    lab.wait_for("explorer.size.value == 0.3", seconds=60)
    lab.screenshot("scores_spike", top=".widget-dropdown")
    noticed = lab.ask("explorer.noticed")
    assert {"kinetic distance", "worst acceleration"} <= set(noticed)
    assert not {"FID", "diversity", "R top 3", "bone error %"} & set(noticed)

    choose(lab, "fault", "long forearm")
    lab.wait_for("explorer.size.value == 0 and explorer.noticed == []", seconds=60)
    press(lab, "size", "ArrowRight", 4)
    lab.wait_for("explorer.size.value == 0.3", seconds=60)
    assert lab.ask("explorer.noticed") == ["true bone error %"]
    lab.screenshot("scores_forearm", top=".widget-dropdown")
    shown = "explorer.viewer.motion.bone_lengths()[0]"
    was = "pf.skeleton.bone_lengths(court.shown.positions[explorer.clip.value])[0]"
    assert lab.ask(f"({shown} / {was}).max()") == pytest.approx(1.3, abs=0.01)

    choose(lab, "fault", "parrot")
    lab.wait_for("explorer.size.value == 512", seconds=60)
    press(lab, "size", "ArrowRight", 8)
    lab.wait_for("explorer.scores['diversity'] == 0", seconds=60)
    lab.screenshot("scores_parrot", top=".widget-dropdown")
    lab.screenshot("scores_by_size", top=".js-plotly-plot")

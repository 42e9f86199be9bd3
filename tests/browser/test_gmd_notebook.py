"""Guided motion diffusion in JupyterLab: three metrics answer a pull, and a post is dragged."""

from __future__ import annotations

import pytest
from test_gait import press
from test_tasks import choose

pytestmark = pytest.mark.browser

METRICS = """
from projflow_lite.studies.gmd_metrics import MetricFamily
family = MetricFamily((1.5, 0.25))
family
"""

POST = """
import torch
import projflow_lite as pf
from projflow_lite.studies.obstacle_walk import ObstacleWalk
torch.set_num_threads(1)
walk = ObstacleWalk(pf.load_prior(), steps=10)
walk
"""


def test_three_bodies_answer_one_pull(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("metrics.ipynb", METRICS), width=1180, height=760)
    lab.run_all(seconds=120)
    lab.screenshot("gmd_metrics", top=".jp-OutputArea")
    before, along = lab.pixels(".pf-viewer"), lab.ask("family.numbers[1][0]")
    press(lab, "emphasis c", "ArrowLeft", 10)
    lab.wait_for("abs(family.c.value - 1) < 0.01")
    lab.wait_for(f"family.numbers[1][0] > {along} + 3")
    lab.page.wait_for_timeout(500)
    assert lab.pixels(".pf-viewer") != before
    choose(lab, "joint", "pelvis")
    lab.wait_for("family.numbers[1][2] < 1e-6 and family.numbers[0][2] > 5")
    choose(lab, "A'", "Gaussian, as in the paper")
    lab.wait_for("family.numbers[1][2] > 1")
    lab.page.wait_for_timeout(500)
    lab.screenshot("gmd_metrics_gaussian", top=".jp-OutputArea")


def test_a_post_is_dragged_into_the_way_and_onto_the_start(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("post.ipynb", POST), width=1180, height=860)
    lab.run_all(seconds=120)
    lab.screenshot("gmd_post", top=".jp-OutputArea")
    before = lab.ask("walk.motion.positions.sum()")
    lab.drag_handle(0, "post 1", right=15, down=-40)
    lab.wait_for(f"abs(walk.motion.positions.sum() - {before}) > 1e-3", seconds=60)
    lab.drag_handle(0, "post 1", right=-15, down=170)
    lab.page.locator("text=an obstacle covers the start point").wait_for(timeout=30_000)
    lab.screenshot("gmd_post_refused", top=".jp-OutputArea")

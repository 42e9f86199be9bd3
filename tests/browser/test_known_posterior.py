"""Notebook 04 as a student meets it: drag the wish, scrub through a step, change the noise."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.browser

NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "04_the_sampler_step_by_step.ipynb"


def test_the_sampler_follows_the_wish_and_every_choice(jupyter_lab):
    lab = jupyter_lab(NOTEBOOK, width=1100, height=1000)
    lab.run_all(seconds=150)
    assert lab.page.locator(".pf-board").count() == 4
    lab.screenshot("known_posterior_top", top=".jp-OutputArea")

    lab.drag_handle(0, "y", 70)
    lab.wait_for("explorer.world.y[0] > 0.3 and explorer.plane.seen > 3")
    y = lab.ask("explorer.world.y[0]")
    ends = np.array(lab.ask("explorer.trace.x_next[-1]"))
    np.testing.assert_allclose(ends[:, 0], y, atol=1e-9)
    assert lab.ask("explorer.plane.problem") == ""

    before = ends[:, 1].std()
    lab.page.get_by_label("noise").first.select_option("original x0")
    lab.page.get_by_label("η, fresh").select_option("0: none fresh")
    lab.wait_for("explorer.noise.value == 'original' and explorer.eta.value == '0'")
    after = lab.ask("explorer.trace.x_next[-1][:, 1].std()")
    assert after > 1.2 * before, "the original noise with none fresh spreads"

    lab.ask("setattr(explorer.step, 'value', 12)")
    lab.page.wait_for_timeout(400)
    assert "13 of 20: t = 0.60 → 0.65" in lab.page.locator(".widget-html").all_inner_texts()
    lab.screenshot("known_posterior_scrubbed", top=".jp-OutputArea")


def test_the_exact_law_moves_onto_the_posterior_with_the_right_metric(jupyter_lab):
    lab = jupyter_lab(NOTEBOOK, width=1100, height=1000)
    lab.run_all(seconds=150)
    far = "posterior_exact.distances(law_now()[0], *law_now()[1])['mean error']"
    assert lab.ask(far) > 0.3
    lab.page.get_by_label("metric").nth(1).select_option("moving")
    lab.page.get_by_label("noise").nth(1).select_option("guided")
    lab.wait_for("metric.value == 'moving' and noise.value == 'guided'")
    assert lab.ask(far) < 1e-9
    lab.drag_handle(2, "y", -60)
    lab.wait_for("board.positions['y'][0] < 0.7")
    assert lab.ask(far) < 1e-9
    assert "error of the mean 0.00 posterior" in lab.ask("report.value")
    lab.page.locator(".pf-board").nth(2).scroll_into_view_if_needed()
    lab.screenshot("known_posterior_law")
    lab.page.locator(".pf-board").nth(3).scroll_into_view_if_needed()
    lab.theme("JupyterLab Dark")
    lab.screenshot("known_posterior_modes_dark")

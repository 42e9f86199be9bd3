"""The notebooks on the metric and on guides as a student meets them, in a real JupyterLab."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.browser

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"


def test_a_joint_pulled_in_the_page_is_pulled_in_the_kernel(jupyter_lab):
    lab = jupyter_lab(NOTEBOOKS / "03_the_skeletons_metric.ipynb", width=1500, height=1150)
    lab.run_all(seconds=120)
    assert lab.page.locator(".pf-explorer").count() == 2
    assert lab.page.locator(".pf-viewer").count() == 2
    assert lab.ask("[motion.residual < 1e-6 for motion in motions.values()]") == [True] * 8
    lab.screenshot("metric_top", top=".pf-explorer")

    canvas = lab.canvas(".pf-explorer")
    canvas.focus()
    for key in ("Escape", "Shift+ArrowUp", "Shift+ArrowRight", "ArrowRight"):
        lab.page.keyboard.press(key)
    lab.wait_for("np.allclose(explorer.pull, [0.11, 0.10, 0.0])")
    before = lab.pixels(".pf-explorer")
    lab.page.get_by_label("Weight of the bones, w").first.fill("0")
    lab.wait_for("explorer.w_kin == 0")
    assert lab.pixels(".pf-explorer") != before
    lab.page.get_by_label("Pulled joint").first.select_option("head")
    lab.wait_for("explorer.joint == 'head' and explorer.pull == [0, 0, 0]")

    lab.ask("[setattr(explorer, 'joint', 'left_wrist'), setattr(explorer, 'w_kin', 10.0)]")
    shown = lab.page.locator(".pf-explorer").first.locator(".pf-shares tr", has_text="left elbow")
    shown.locator("td", has_text="0.71").wait_for(timeout=5_000)

    own = lab.page.locator(".pf-explorer").nth(1).locator(".pf-shares td").evaluate_all(
        "(cells) => cells.map((cell) => Number(cell.dataset.share))"
    )  # fmt: skip
    expected = np.array(lab.ask("C[:, wrist] / C[wrist, wrist]"))
    np.testing.assert_allclose(np.reshape(own, (22, 3))[:, 2], expected, atol=1e-8)
    places = {
        "metric_curves": ".js-plotly-plot",
        "metric_data": ".pf-explorer >> nth=1",
        "metric_projected": ".pf-viewer",
        "metric_sampled": ".pf-viewer >> nth=1",
    }
    for name, top in places.items():
        lab.screenshot(name, top=top)
    lab.theme("JupyterLab Dark")
    lab.screenshot("metric_dark", top=".pf-explorer")


def test_sliders_and_keyframes_move_the_guides(jupyter_lab):
    lab = jupyter_lab(NOTEBOOKS / "05_pseudo_observations.ipynb", width=1500, height=1300)
    lab.run_all(seconds=120)
    lab.screenshot("guides_top", top=".pf-board")
    assert lab.page.locator(".pf-board").count() == 5  # the two below belong to the sampler scope
    before = lab.pixels(".pf-board")
    assert "t = 0.00" in lab.ask("guides.says.value")
    assert " 0 guides as hard" not in lab.ask("guides.says.value"), (
        "eq. 52 with Table 5: hard at first"
    )

    handle = lab.page.locator(".widget-slider", has_text="c0").locator(".noUi-handle")
    handle.focus()
    lab.page.keyboard.press("ArrowLeft")
    lab.wait_for("guides.sliders['c0'].value < 3")
    lab.page.locator(".widget-slider").first.locator(".noUi-handle").focus()
    lab.page.keyboard.press("End")
    lab.wait_for("'t = 0.99' in guides.says.value and ' 0 guides as hard' in guides.says.value")
    assert lab.pixels(".pf-board") != before
    lab.screenshot("guides_end", top=".pf-board")
    lab.page.get_by_role("button", name="Table 5").click()
    lab.wait_for("guides.sliders['c0'].value == 3")

    height = lab.ask("guides.path.positions['key 6'][1]")
    lab.page.locator(".pf-handle[data-name='key 6']").focus()
    for _ in range(3):
        lab.page.keyboard.press("ArrowUp")
    lab.wait_for(f"guides.path.positions['key 6'][1] > {height}")
    state = "(lambda c, t, observed, y: project(c, observed, y, *trust(c, t, observed)[1:]))(*guides.state())"
    path = np.array(lab.ask(state))
    assert path[6, 20] == pytest.approx(lab.ask("guides.path.positions['key 6'][1]"), abs=1e-9)

    assert lab.ask("[motion.residual < 1e-6 for motion in made.values()]") == [True, True]
    lab.screenshot("guides_sampler", top=".pf-viewer")
    lab.theme("JupyterLab Dark")
    lab.screenshot("guides_dark", top=".pf-board")

"""The notebook on how a body walks, as a student meets it: move sliders, drag an ankle."""

from __future__ import annotations

from pathlib import Path

import pytest

pytestmark = pytest.mark.browser

NOTEBOOK = Path(__file__).parents[2] / "notebooks" / "11_how_a_body_walks.ipynb"


def press(lab, description: str, key: str, times: int = 1) -> None:
    """Move a slider of the notebook with the keyboard."""
    slider = lab.page.locator(".widget-inline-hbox", has_text=description)
    handle = slider.locator(".noUi-handle").first
    handle.scroll_into_view_if_needed()
    handle.focus()
    for _ in range(times):
        lab.page.keyboard.press(key)


@pytest.fixture
def lab(jupyter_lab):
    lab = jupyter_lab(NOTEBOOK, width=1150, height=1000)
    lab.run_all(seconds=240)
    return lab


def test_sliders_move_the_body_and_the_plots_and_an_ankle_takes_its_knee_along(lab):
    lab.ask("explorer.viewer.set_trait('playing', False)")
    lab.screenshot("gait_explorer", top=".widget-toggle-buttons")
    before = lab.pixels(".pf-viewer"), lab.pixels(".pf-board", 0), lab.pixels(".pf-board", 1)
    press(lab, "speed, m/s", "ArrowRight", 3)
    lab.wait_for("explorer.sliders['speed'].value > 1.45")
    lab.wait_for("abs(explorer.sliders['stride'].value - 1.67) < 1e-6")
    assert lab.ask("explorer.sliders['cadence'].value") == pytest.approx(1.8)
    lab.wait_for("explorer.facts['slide'] < 0.01")
    press(lab, "slip, %", "ArrowRight", 2)
    lab.wait_for("explorer.sliders['slip'].value == 10")
    lab.wait_for("abs(explorer.facts['slide'] - 0.15) < 0.01", seconds=30)
    lab.page.wait_for_timeout(500)
    lab.screenshot("gait_slip", top=".widget-toggle-buttons")
    after = lab.pixels(".pf-viewer"), lab.pixels(".pf-board", 0), lab.pixels(".pf-board", 1)
    assert all(old != new for old, new in zip(before, after, strict=True))

    lab.page.get_by_role("button", name="run", exact=True).first.click()
    lab.wait_for("explorer.facts['none'] > 0.3 and explorer.sliders['slip'].value == 0")
    lab.page.wait_for_timeout(500)
    lab.screenshot("gait_run", top=".widget-toggle-buttons")

    knee = lab.ask("leg.knee")
    lab.drag_handle(2, "ankle", right=60, down=-40)
    lab.wait_for("leg.ankle[0] > 0.3")
    assert lab.ask("leg.knee") != knee
    assert lab.ask("float(sum(leg.knee**2)**0.5)") == pytest.approx(0.41)
    lab.page.wait_for_timeout(300)
    lab.screenshot("gait_leg", top=".pf-board >> nth=2")
    lab.drag_handle(2, "ankle", right=150, down=0)
    lab.wait_for("leg.missing > 0.01")
    lab.page.wait_for_timeout(300)
    lab.screenshot("gait_out_of_reach", top=".pf-board >> nth=2")

    press(lab, "spread", "ArrowRight", 20)
    lab.wait_for("spread.value == 1.0 and 'gets 0.00 m ahead' in words.value")
    lab.page.wait_for_timeout(500)
    lab.screenshot("gait_mean", top=".pf-viewer >> nth=2")

"""The sampler scope in JupyterLab: the slider scrubs through the steps, and body and dots follow."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.browser

CELL = """
import torch
import projflow_lite as pf
torch.set_num_threads(1)
wish = pf.pin("left_wrist", [5, 25, 35], [[0.3, 1.6, 0.3], [0.5, 1.2, 0.2], [0.3, 1.0, 0.4]])
scope = pf.widgets.SamplerScope(pf.load_prior(), wish, "a person waves with the left hand", frames=40, steps=12)
scope
"""
BLUE = "(canvas) => canvas.toDataURL()"


def test_scrubbing_shows_every_step(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("scope.ipynb", CELL), width=1180, height=820)
    lab.run_all(seconds=120)
    held = lab.page.locator("canvas.pf-board, .pf-board canvas").first
    before = held.evaluate(BLUE), lab.ask("bytes(scope.viewer.data).hex()[:4000]")
    handle = lab.page.locator(".noUi-handle").first
    handle.focus()
    for _ in range(4):
        lab.page.keyboard.press("ArrowRight")
    lab.wait_for("scope.step.value == 9", seconds=30)
    lab.wait_for("'t = 0.984' in scope.said.words", seconds=30)
    lab.page.wait_for_timeout(500)
    assert held.evaluate(BLUE) != before[0]
    assert lab.ask("bytes(scope.viewer.data).hex()[:4000]") != before[1]
    lab.page.locator("input[type=checkbox]").first.check()
    lab.wait_for("'state' in scope.viewer.names", seconds=30)
    lab.screenshot("sampler_scope", top=".jp-OutputArea")

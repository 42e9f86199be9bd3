"""The equation card in JupyterLab: the formula is set, a keystroke and a slider change the result."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.browser

CELL = """
from projflow_lite.widgets import EquationCard
card = EquationCard("ProjFlow", "7")
card
"""


def test_type_slide_and_choose(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("card.ipynb", CELL), width=1100, height=900)
    lab.run_all(seconds=90)
    page = lab.page
    page.locator("mjx-container, .MathJax").first.wait_for(timeout=30_000)
    before = lab.ask("card.result.tolist()")
    field = page.locator(".widget-text input").nth(2)
    field.fill("[4.0]")
    lab.wait_for("card.arguments.get('y') == [4.0]", seconds=30)
    assert lab.ask("card.result.tolist()") != before
    lab.screenshot("equation_card", top=".jp-OutputArea")
    page.locator(".widget-dropdown select").nth(1).select_option(index=8)
    lab.wait_for("card.record.number == '9' and 'eta' in card.fields", seconds=30)
    handle = page.locator(".noUi-handle").first
    handle.focus()
    page.keyboard.press("ArrowRight")
    lab.wait_for("abs(card.arguments['eta'] - 0.51) < 1e-9", seconds=30)
    page.get_by_text("mix_noise(…) =").wait_for(timeout=20_000)

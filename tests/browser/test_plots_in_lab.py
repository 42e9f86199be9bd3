"""Plotly's figures in JupyterLab: readable in the light theme and in the dark one."""

from __future__ import annotations

import pytest

pytestmark = pytest.mark.browser

CELL = """
import ipywidgets as widgets
from projflow_lite.widgets import Board
from projflow_lite.widgets.plots import go

plain = go.Figure()
for k in range(5):
    plain.add_scatter(x=[0, 1, 2], y=[k, k + 2, k + 1], name=f"trace {k}", mode="lines+markers")
plain.add_annotation(x=1, y=3, text="a remark")
plain.update_layout(title="A title", xaxis_title="time t", yaxis_title="distance, m", height=420,
    updatemenus=[dict(type="buttons", x=-0.1, buttons=[
        dict(label=name, method="restyle", args=["visible", True]) for name in ("one", "two")])],
    sliders=[dict(steps=[dict(label=str(k), method="skip") for k in range(4)])])
live = go.FigureWidget(plain)
widgets.VBox([live, Board(height=120)])
"""
WORST = """(kind) => {
  const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const light = (text) => text.match(/[0-9.]+/g).slice(0, 3).map(Number)
    .reduce((sum, v, i) => sum + linear(v / 255) * [0.2126, 0.7152, 0.0722][i], 0);
  const page = light(getComputedStyle(document.querySelector(".jp-Notebook")).backgroundColor);
  const words = [...document.querySelectorAll(".js-plotly-plot .main-svg text")]
    .filter((node) => node.textContent.trim() && node.matches(".updatemenu-item-text") === (kind === "button"));
  const contrast = words.map((node) => {
    const [low, high] = [page, light(getComputedStyle(node).fill)].sort((a, b) => a - b);
    return (high + 0.05) / (low + 0.05);
  });
  return { count: words.length, worst: Math.min(...contrast) };
}"""


def test_words_can_be_read_in_both_themes(jupyter_lab, write_notebook):
    lab = jupyter_lab(write_notebook("plots.ipynb", CELL, "plain.show()"), width=1100, height=1250)
    lab.run_all(seconds=60)
    lab.page.locator(".updatemenu-item-text").nth(3).wait_for()
    for theme in ("Light", "Dark"):
        lab.theme(f"JupyterLab {theme}")
        words = lab.page.evaluate(WORST, "words")
        assert words["count"] > 30
        assert words["worst"] >= 4.5, theme
        buttons = lab.page.evaluate(WORST, "button")
        assert buttons["count"] == 4
        assert buttons["worst"] >= 3.9, theme  # no grey reads better on white and on this black
        grounds = lab.page.locator(".js-plotly-plot .main-svg").evaluate_all(
            "(nodes) => nodes.map((node) => getComputedStyle(node).backgroundColor)"
        )
        assert set(grounds) == {"rgba(0, 0, 0, 0)"}
        box = lab.page.locator(".js-plotly-plot .nsewdrag").first.bounding_box()
        lab.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        lab.page.locator(".hovertext").first.wait_for()
        lab.screenshot(f"plots_{theme.lower()}", top=".js-plotly-plot")

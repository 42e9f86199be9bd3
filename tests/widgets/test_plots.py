"""The look of plotly's figures: readable on a white page and on a nearly black one."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import plotly.io
import pytest

from projflow_lite.widgets.plots import COLOURS, GREY, go

CSS = (Path(__file__).parents[2] / "projflow_lite/widgets/widgets.css").read_text()
PAGES = {"white": "#ffffff", "JupyterLab dark": "#111111", "the book dark": "#14181e"}


def channels(colour: str) -> np.ndarray:
    """Red, green and blue of ``#rrggbb``, from 0 to 255."""
    return np.array([int(colour[i : i + 2], 16) for i in (1, 3, 5)])


def linear(colour: str) -> np.ndarray:
    """The same as light, as WCAG 2.1 computes it."""
    share = channels(colour) / 255
    return np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)


def contrast(one: str, other: str) -> float:
    """WCAG's contrast ratio of two colours."""
    low, high = sorted(float(linear(c) @ [0.2126, 0.7152, 0.0722]) for c in (one, other))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize("page", PAGES.values(), ids=PAGES)
def test_lines_and_words_stand_out_on_every_page(page):
    for colour in COLOURS:
        assert contrast(colour, page) >= 3, f"{colour} on {page}"  # WCAG 1.4.11
    assert contrast(GREY, page) >= (4.5 if page == "#ffffff" else 3.9)


def test_the_first_four_colours_differ_with_a_common_colour_blindness():
    """Machado, Oliveira and Fernandes 2009: no green cones (deuteranopia), no red (protanopia)."""
    eyes = {
        "deuteranopia": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
        "protanopia": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    }
    for name, eye in eyes.items():
        seen = [np.clip(np.array(eye) @ linear(c), 0, 1) ** (1 / 2.2) for c in COLOURS[:4]]
        apart = [np.linalg.norm(a - b) for a, b in itertools.combinations(seen, 2)]
        assert min(apart) > 0.15, name


def test_a_figure_is_clear_and_takes_the_colours_in_order():
    assert plotly.io.templates.default == "projflow_lite"
    layout = go.Figure().to_dict()["layout"]["template"]["layout"]
    assert layout["paper_bgcolor"] == layout["plot_bgcolor"] == "rgba(0, 0, 0, 0)"
    assert tuple(layout["colorway"]) == COLOURS
    assert layout["font"]["color"] == GREY


def test_the_style_sheet_knows_the_grey():
    """Only words in the template's grey take the ink of JupyterLab's theme."""
    found = re.search(r'\[style\*="fill: rgb\((.*?)\)"\]', CSS)
    assert [int(number) for number in found[1].split(",")] == channels(GREY).tolist()

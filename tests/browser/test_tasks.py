"""Notebooks 06 to 09 as a student meets them: run all, move one thing, ask the kernel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.browser

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"


def choose(lab, label: str, option: str) -> None:
    """Choose from a dropdown of the notebook, as with the mouse."""
    lab.page.get_by_label(label).first.select_option(label=option)


def press(lab, description: str, key: str, times: int = 1) -> None:
    """Move a slider of the notebook with the keyboard."""
    slider = lab.page.locator(".widget-inline-hbox", has_text=description)
    handle = slider.locator(".noUi-handle").first
    handle.scroll_into_view_if_needed()
    handle.focus()
    for _ in range(times):
        lab.page.keyboard.press(key)


def test_every_erratum_has_its_card_and_trust_has_its_sliders(jupyter_lab):
    lab = jupyter_lab(
        NOTEBOOKS / "06_where_print_and_derivation_part.ipynb", width=1100, height=1000
    )
    lab.run_all(seconds=150)
    choose(lab, "equation", "52 · " + lab.ask("card.records['ProjFlow', '52'].title"))
    choose(lab, "equation", "51 · Weight of a joint")
    lab.wait_for("'0.253' in card.erratum.value")
    lab.screenshot("print_card", top=".jp-OutputArea")
    assert lab.ask("float(panel.data[1].y[0])") == 1.0
    press(lab, "joints", "ArrowRight", 7)
    lab.wait_for("shared_by.value == 8")
    assert lab.ask("float(panel.data[1].y[0])") == pytest.approx(1.5 / 8)
    lab.screenshot("print_trust", top=".js-plotly-plot >> nth=2")


def test_keyframes_are_filled_in_again_when_there_are_more(jupyter_lab):
    lab = jupyter_lab(NOTEBOOKS / "07_a_few_keyframes.ipynb", width=1100, height=1000)
    lab.run_all(seconds=150)
    assert lab.ask("viewer.motion.wish.rows(60).y.size") == 15
    lab.screenshot("keyframes", top=".jp-OutputArea")
    press(lab, "keyframes", "ArrowRight")
    lab.wait_for("viewer.motion.wish.rows(60).y.size == 24", seconds=60)
    assert lab.ask("viewer.motion.residual") <= 1e-6


def test_the_heart_stays_a_heart_from_another_side(jupyter_lab):
    lab = jupyter_lab(NOTEBOOKS / "08_draw_a_heart.ipynb", width=1100, height=1000)
    lab.run_all(seconds=150)
    lab.screenshot("heart", top=".jp-OutputArea")
    before = np.array(lab.ask("viewer.motion.joint('left_wrist')"))
    press(lab, "yaw", "ArrowRight", 5)
    lab.wait_for("yaw.value == 45")
    lab.wait_for("abs(pf.Orthographic(pitch=10, yaw=45).project(viewer.motion.joint('left_wrist')) - pf.Orthographic(pitch=10, yaw=45).project(root + [0, 1.0, 0]) - pad.path + [0, 1.0]).max() < 1e-5", seconds=60)  # fmt: skip
    assert np.abs(np.array(lab.ask("viewer.motion.joint('left_wrist')")) - before).max() > 0.05
    lab.screenshot("heart_from_the_side", top=".jp-OutputArea")


def test_loops_of_three_kinds(jupyter_lab):
    lab = jupyter_lab(NOTEBOOKS / "09_an_algebra_of_wishes.ipynb", width=1100, height=1000)
    lab.run_all(seconds=150)
    assert "velocity jumps by 0.00 m/s" in lab.ask("words.value")
    choose(lab, "loop", "the last frame is the first")
    lab.wait_for(
        "'moved on by 0.00 m' in words.value or 'moved on by -0.00 m' in words.value", seconds=60
    )
    lab.screenshot("loops", top=".pf-viewer >> nth=1")

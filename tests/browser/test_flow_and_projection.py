"""Notebooks 01 and 02 as a student meets them: run all, drag a handle, see the result move."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

pytestmark = pytest.mark.browser

NOTEBOOKS = Path(__file__).parents[2] / "notebooks"


def test_means_that_are_dragged_take_the_flow_along(jupyter_lab):
    lab = jupyter_lab(NOTEBOOKS / "01_flow_in_the_plane.ipynb", width=1100, height=1000)
    lab.run_all(seconds=120)
    assert lab.page.locator(".pf-board").count() == 5
    for board in range(5):
        lab.page.locator(".pf-board").nth(board).scroll_into_view_if_needed()
        lab.page.wait_for_timeout(200)
        lab.screenshot(f"flow_in_the_plane_{board}")

    lab.drag_handle(1, "probe", 60, -40)
    # Each question is one expression: between two of them the kernel may hear another move.
    lab.wait_for("np.linalg.norm(np.subtract(crossing.board.positions['probe'], (0.5, 0.3))) > 0.8")
    probe = "np.array(crossing.board.positions['probe'])"
    drawn = "np.frombuffer(crossing.board.data, '<f4').reshape(-1, 2)[-1]"
    tip, mean_end = np.array(lab.ask(f"[{drawn}, passing({probe}, 0.45)[1].mean(axis=0)]"))
    np.testing.assert_allclose(tip, mean_end, atol=0.15)  # x1_hat, of 200 paths near x

    before = np.array(lab.ask("river.paths[-1].mean(axis=0)"))
    lab.drag_handle(2, "m1", -110, 60)
    lab.wait_for("abs(river.board.positions['m1'][0] - 1.8) > 1")
    mean, after = np.array(lab.ask("[river.board.positions['m1'], river.paths[-1].mean(axis=0)]"))
    shift = mean - [1.8, 1.0]
    np.testing.assert_allclose(after - before, 0.3 * shift, atol=0.15)  # it has three tenths
    assert lab.ask("river.board.problem") == ""
    lab.theme("JupyterLab Dark")
    lab.screenshot("flow_in_the_plane_dark")


def test_the_projection_follows_the_wish(jupyter_lab):
    lab = jupyter_lab(NOTEBOOKS / "02_the_projection.ipynb", width=1100, height=1000)
    lab.run_all(seconds=120)
    assert lab.page.locator(".pf-board").count() == 3
    for board in range(3):
        lab.page.locator(".pf-board").nth(board).scroll_into_view_if_needed()
        lab.page.wait_for_timeout(200)
        lab.screenshot(f"the_projection_{board}")

    lab.drag_handle(0, "y", 60, 30)
    lab.wait_for("np.hypot(*shortest.board.positions['y']) > 1.4")
    drawn = "np.frombuffer(shortest.board.data, '<f4').reshape(-1, 2)[-1]"
    answer = lab.ask(f"[*shortest.read()[:4], {drawn}, shortest.board.positions['y']]")
    x1_hat, A, y, R, end, foot = (np.array(array) for array in answer)
    across = np.array([-A[0, 1], A[0, 0]])
    assert across @ foot == pytest.approx(0, abs=1e-9), "the handle stays on the axis of A"
    assert A @ end == pytest.approx(y, abs=1e-5), "the point lies on the dragged line"
    slope = across @ R @ (end - x1_hat)
    assert slope == pytest.approx(0, abs=1e-4), "and no neighbour on the line is cheaper"

    lab.drag_handle(2, "y2", -60, 20)
    lab.wait_for("two.board.problem != ''")
    problem = lab.page.locator(".pf-board-problem").nth(2)
    problem.wait_for(timeout=5_000)
    assert problem.inner_text() == "project: rows 0, 1 contradict each other"
    lab.theme("JupyterLab Dark")
    lab.screenshot("the_projection_dark")

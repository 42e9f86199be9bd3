"""The metric explorer's ES module in a blank page: its numbers against numpy, its controls."""

from __future__ import annotations

import numpy as np
import pytest
from stage import changed, contrast, mount, picture, update

from projflow_lite.skeleton import EDGES, JOINTS, PARENTS, bone_lengths
from projflow_lite.widgets import MetricExplorer
from projflow_lite.widgets.front_end import module

pytestmark = pytest.mark.browser

WRIST = JOINTS.index("left_wrist")
ALGEBRA = """async ([code, parents, metric]) => {
  const text = code + "\\nexport { inverse, jointMetric, laplacian };";
  const address = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
  const algebra = await import(address);
  const kinematic = algebra.jointMetric(algebra.laplacian(parents), 10, 1);
  return [kinematic, algebra.inverse(kinematic), algebra.inverse(metric)];
}"""

RIGHTMOST = """(canvas, panel) => {
  const width = Math.floor(canvas.width / 3);
  const top = 90;
  const { data } = canvas.getContext("2d").getImageData(panel * width + 4, top, width - 8, canvas.height - top - 60);
  const dark = (i) => data[i] + data[i + 1] + data[i + 2] < 480;
  for (let x = width - 9; x >= 0; x--) {
    const rows = [];
    for (let y = 0; y < canvas.height - top - 60; y++) if (dark((y * (width - 8) + x) * 4)) rows.push(y);
    if (rows.length > 2) return [panel * width + 4 + x - 4, top + rows[Math.floor(rows.length / 2)]];
  }
  return null;
}"""


def by_hand(w_kin=10.0, ridge=1.0):
    """The kinematic metric from its quadratic form, bone by bone."""
    R_J = ridge * np.eye(22)
    for a, b in EDGES:
        R_J[a, a] += w_kin
        R_J[b, b] += w_kin
        R_J[a, b] -= w_kin
        R_J[b, a] -= w_kin
    return R_J


def shares(page):
    """What the table says, ``(22, 3)``."""
    text = "(cells) => cells.map((cell) => Number(cell.dataset.share))"
    return np.array(page.locator(".pf-shares td").evaluate_all(text)).reshape(22, 3)


def worst(page):
    """The stretch of the worst bone of each body."""
    text = "(all) => all.map((caption) => Number(caption.dataset.worst))"
    return page.locator(".pf-caption").evaluate_all(text)


def test_the_inverse_against_numpy(open_page):
    page = open_page()
    page.set_content("<!doctype html><title>algebra</title>")
    root = np.random.default_rng(1).normal(size=(22, 30))
    metric = root @ root.T
    code = module("metric_explorer_algebra.js")
    kinematic, inverse, own = page.evaluate(ALGEBRA, [code, list(PARENTS), metric.tolist()])
    np.testing.assert_array_equal(kinematic, by_hand())
    np.testing.assert_allclose(inverse, np.linalg.inv(by_hand()), rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(np.array(own) @ metric, np.eye(22), atol=1e-10)
    assert np.linalg.cond(kinematic) == pytest.approx(54.3, abs=0.05)


@pytest.mark.parametrize("joint", ["left_wrist", "pelvis", "head", "right_foot"])
def test_shares_against_numpy_for_all_three_metrics(open_page, joint):
    page = open_page()
    root = np.random.default_rng(2).normal(size=(22, 40))
    own = root @ root.T
    mount(page, MetricExplorer(own, joint=joint, w_kin=25.0, ridge=0.5))
    p = JOINTS.index(joint)
    for column, R_J in enumerate([np.eye(22), by_hand(25.0, 0.5), own]):
        pulled = np.linalg.inv(R_J)[:, p]
        np.testing.assert_allclose(shares(page)[:, column], pulled / pulled[p], atol=1e-9)


def test_the_known_shares_of_a_pulled_wrist(open_page):
    page = open_page()
    mount(page, MetricExplorer())
    kinematic = shares(page)[:, 1]
    known = {"left_wrist": 1.0, "left_elbow": 0.71, "left_shoulder": 0.49, "pelvis": 0.05}
    for joint, share in known.items():
        assert round(kinematic[JOINTS.index(joint)], 2) == share
    row = page.locator(".pf-shares tr.pf-picked")
    assert row.locator("th").inner_text() == "left wrist"
    assert row.locator("td").all_inner_texts() == ["1.00"] * 3


def test_the_worst_stretch_against_numpy(open_page):
    page = open_page()
    pull = np.array([0.25, -0.1, 0.2])
    explorer = MetricExplorer(pull=pull)
    mount(page, explorer)
    rest = np.array(explorer.rest)
    for column in range(3):
        moved = rest + shares(page)[:, column][:, None] * pull
        stretch = bone_lengths(moved[None])[0] / bone_lengths(rest[None])[0] - 1
        largest = stretch[np.argmax(abs(stretch))]
        assert worst(page)[column] == pytest.approx(largest, abs=1e-9)
        text = page.locator(".pf-caption").nth(column).inner_text()
        sign = "+" if largest > 0 else "−"
        assert f"worst bone {sign}{abs(largest):.0%}" in text.replace(" %", "%")


def test_sliders_go_from_euclid_to_a_rigid_body(open_page):
    page = open_page()
    mount(page, MetricExplorer())
    weight = page.get_by_label("Weight of the bones, w")
    weight.fill("0")
    assert page.evaluate("model.get('w_kin')") == 0
    np.testing.assert_allclose(shares(page)[:, 1], shares(page)[:, 0])
    weight.fill("200")
    assert page.evaluate("model.get('w_kin')") == 1000
    assert shares(page)[:, 1].min() > 0.5
    page.get_by_label("Ridge, lambda").fill("0")
    assert page.evaluate("model.get('ridge')") == 0.001
    np.testing.assert_allclose(shares(page)[:, 1], 1, atol=1e-3)
    assert abs(worst(page)[1]) < 0.001
    assert "no bone changes" in page.locator(".pf-caption").nth(1).inner_text()


def test_only_the_ratio_of_weight_and_ridge_matters(open_page):
    page = open_page()
    explorer = MetricExplorer()
    mount(page, explorer)
    before = shares(page)
    explorer.w_kin, explorer.ridge = 30.0, 3.0
    update(page, explorer, "w_kin", "ridge")
    np.testing.assert_allclose(shares(page), before, atol=1e-12)
    explorer.ridge = 1.0
    update(page, explorer, "ridge")
    assert abs(shares(page) - before).max() > 0.05


@pytest.mark.parametrize("panel", [0, 1, 2])
def test_a_joint_is_pulled_with_the_mouse_in_any_body(open_page, panel):
    page = open_page(width=1100)
    explorer = MetricExplorer(joint="head", pull=(0, 0, 0))
    mount(page, explorer)
    start = wrist_on_page(page, panel)
    page.mouse.move(*start)
    assert page.locator("canvas").evaluate("(node) => node.style.cursor") == "grab"
    page.mouse.click(*start)  # takes hold of it, and draws a ring around it
    page.wait_for_timeout(80)
    ring = wrist_on_page(page, panel)
    page.mouse.down()
    page.mouse.move(start[0] + 40, start[1] - 20, steps=4)
    page.mouse.up()
    assert page.evaluate("model.get('joint')") == "left_wrist"
    pull = np.array(page.evaluate("model.get('pull')"))
    assert pull[0] / pull[1] == pytest.approx(2.0, rel=0.02), "in proportion to the mouse"
    assert pull[2] == pytest.approx(0, abs=1e-3), "in the plane of the picture"
    page.wait_for_timeout(80)
    np.testing.assert_allclose(np.subtract(wrist_on_page(page, panel), ring), [40, -20], atol=1.5)


def wrist_on_page(page, panel):
    """The rightmost dark place of a body with its left arm to the side: its wrist, or its ring."""
    box = page.locator("canvas").bounding_box()
    x, y = page.locator("canvas").evaluate(RIGHTMOST, panel)
    return box["x"] + x, box["y"] + y


def test_pulled_by_keys_and_by_touch(open_page):
    page = open_page(width=900, has_touch=True)
    mount(page, MetricExplorer(pull=(0, 0, 0)))
    page.locator("canvas").focus()
    for key in ("ArrowRight", "ArrowUp", "Shift+ArrowUp", "PageUp"):
        page.keyboard.press(key)
    np.testing.assert_allclose(page.evaluate("model.get('pull')"), [0.01, 0.11, 0.01], atol=1e-9)
    page.keyboard.press("p")
    assert page.evaluate("model.get('joint')") == "right_elbow"
    assert page.evaluate("model.get('pull')") == [0, 0, 0], "another joint starts at rest"
    page.get_by_label("Pulled joint").select_option("left wrist")
    page.locator(".pf-shares tr", has_text="head").click()
    assert page.evaluate("model.get('joint')") == "head"

    page.get_by_label("Pulled joint").select_option("left wrist")
    x, y = wrist_on_page(page, 0)
    client = page.context.new_cdp_session(page)
    for kind, points in (
        ("touchStart", [{"x": x, "y": y}]),
        ("touchMove", [{"x": x + 30, "y": y}]),
        ("touchEnd", []),
    ):
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    page.wait_for_timeout(100)
    assert page.evaluate("model.get('pull')")[0] > 0.05
    page.get_by_role("button", name="Let go").click()
    assert page.evaluate("model.get('pull')") == [0, 0, 0]
    assert worst(page) == [0, 0, 0]


def test_the_view_turns_and_comes_back(open_page):
    page = open_page()
    mount(page, MetricExplorer())
    front = picture(page)
    box = page.locator("canvas").bounding_box()
    page.mouse.move(box["x"] + 20, box["y"] + box["height"] - 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 90, box["y"] + box["height"] - 40, steps=3)
    page.mouse.up()
    page.wait_for_timeout(80)
    assert changed(front, picture(page)) > 200
    assert page.evaluate("model.get('pull')") == [0.3, 0.2, 0], "turning is not pulling"
    page.get_by_role("button", name="Front").click()
    page.wait_for_timeout(80)
    assert changed(front, picture(page)) == 0


def test_python_moves_the_picture(open_page):
    page = open_page()
    explorer = MetricExplorer()
    mount(page, explorer)
    before = picture(page)
    explorer.joint, explorer.pull = "head", [0.0, 0.3, 0.0]
    explorer.metric = np.eye(22) * 4
    update(page, explorer, "joint", "pull", "own")
    assert changed(before, picture(page)) > 100
    np.testing.assert_allclose(shares(page)[:, 2], np.eye(22)[JOINTS.index("head")], atol=1e-12)
    label = page.locator("canvas").get_attribute("aria-label")
    assert label.startswith("head pulled by 0.30 metres")


@pytest.mark.parametrize(("width", "name"), [(1100, "wide"), (420, "narrow")])
def test_readable_light_and_dark(open_page, artefacts, width, name):
    for dark in (False, True):
        page = open_page(width=width, height=1000 if width < 500 else 540, ratio=2)
        mount(page, MetricExplorer(), dark=dark)
        for selector in (
            ".pf-caption",
            ".pf-shares caption",
            ".pf-shares td",
            ".pf-shares th",
            ".pf-scale",
        ):
            assert contrast(page, selector) >= 4.5, selector
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), "no overflow"
        page.screenshot(
            path=artefacts / f"metric_explorer_{name}_{'dark' if dark else 'light'}.png"
        )

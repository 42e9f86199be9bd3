"""The path pad's ES module in a blank page: a known drag gives known metres."""

from __future__ import annotations

import math

import numpy as np
import pytest
from stage import changed, contrast, mount, picture, update, walking

from projflow_lite.widgets import PathPad

pytestmark = pytest.mark.browser

MARGIN = {"left": 50, "right": 16, "top": 32, "bottom": 42}  # of the drawing inside the canvas


def to_pixels(page, pad, point):
    """Where a point in metres must be on the page, worked out independently of the module."""
    box = page.locator("canvas").bounding_box()
    width = box["width"] - MARGIN["left"] - MARGIN["right"]
    height = box["height"] - MARGIN["top"] - MARGIN["bottom"]
    left, right, low, high = pad.bounds
    scale = min(width / (right - left), height / (high - low))
    sign = -1 if pad.plane == "xz" else 1
    x = box["x"] + MARGIN["left"] + width / 2 + sign * scale * (point[0] - (left + right) / 2)
    y = box["y"] + MARGIN["top"] + height / 2 - scale * (point[1] - (low + high) / 2)
    return x, y


def drag(page, pad, points, steps=8):
    page.mouse.move(*to_pixels(page, pad, points[0]))
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*to_pixels(page, pad, point), steps=steps)
    page.mouse.up()
    page.wait_for_timeout(50)


def at(page, milliseconds):
    """Set the clock that pointer events carry, so that a busy machine cannot change the rhythm."""
    page.evaluate(
        """(now) => new Promise((done) => requestAnimationFrame(() => {
            // earlier moves are delivered with this frame; what follows happens at `now`
            Object.defineProperty(Event.prototype, "timeStamp", { configurable: true, get: () => now });
            done();
        }))""",
        milliseconds,
    )


def sent(page):
    return np.array(page.evaluate("sent('path_data')")).reshape(-1, 2)


@pytest.mark.parametrize("plane", ["xy", "zy", "xz"])
def test_a_straight_drag_gives_the_line_in_metres(open_page, plane):
    page = open_page(width=500)
    pad = PathPad(plane, samples=11)
    mount(page, pad)
    start, end = (0.2, 0.5), (0.8, 1.4)
    drag(page, pad, [start, end])
    np.testing.assert_allclose(sent(page), np.linspace(start, end, 11), atol=0.012)  # 1 pixel
    assert page.evaluate("model.get('version')") == 1
    saves = page.evaluate("model.saves.map((save) => Object.keys(save).sort())")
    assert saves == [["path_data", "version"]], "one message, when the stroke is finished"


def test_points_are_even_in_arc_length_and_corners_are_smoothed(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=40, smoothing=0.05)
    mount(page, pad)
    drag(page, pad, [(-0.8, 0.5), (0.0, 1.5), (0.8, 0.5)], steps=25)
    path = sent(page)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1)
    away_from_corner = np.delete(steps, slice(17, 22))
    assert away_from_corner.max() / away_from_corner.min() < 1.01
    assert 0.02 < 1.5 - path[:, 1].max() < 0.12, "the corner is rounded"
    np.testing.assert_allclose(path[[0, -1]], [[-0.8, 0.5], [0.8, 0.5]], atol=0.012)

    slider = page.get_by_label("Smoothing in metres")
    slider.fill("0")
    assert 1.5 - sent(page)[:, 1].max() < 0.03, "the stroke itself is kept"
    assert page.evaluate("model.get('version')") == 2


def test_the_rhythm_of_the_hand_can_be_kept(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=30, smoothing=0.0, timing="drawn")
    mount(page, pad)
    at(page, milliseconds=0)
    page.mouse.move(*to_pixels(page, pad, (-0.5, 1)))
    page.mouse.down()
    for i in range(1, 11):  # slow, then fast
        at(page, milliseconds=30 * i)
        page.mouse.move(*to_pixels(page, pad, (-0.5 + 0.02 * i, 1)))
    at(page, milliseconds=330)
    page.mouse.move(*to_pixels(page, pad, (0.5, 1)))
    page.mouse.up()
    moments = np.linspace(0, 330, 30)
    x = np.interp(
        moments, np.append(30 * np.arange(11), 330), np.append(-0.5 + 0.02 * np.arange(11), 0.5)
    )
    np.testing.assert_allclose(sent(page)[:, 0], x, atol=0.025)  # 2 pixels
    np.testing.assert_allclose(sent(page)[:, 1], 1, atol=0.012)


def test_drawing_outside_stays_inside(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=10, smoothing=0.0)
    mount(page, pad)
    drag(page, pad, [(0, 1), (0, 9)])
    assert sent(page)[:, 1].max() < 2.4


def test_live_updates_come_without_a_version(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=10, live=True)
    mount(page, pad)
    page.mouse.move(*to_pixels(page, pad, (0, 1)))
    page.mouse.down()
    for i in range(6):
        page.mouse.move(*to_pixels(page, pad, (0.1 * i, 1)))
        page.wait_for_timeout(50)
    saves = page.evaluate("model.saves.map((save) => Object.keys(save))")
    assert len(saves) >= 2
    assert all(save == ["path_data"] for save in saves)
    page.mouse.up()
    assert page.evaluate("model.get('version')") == 1


def test_presets_by_keyboard(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=48)
    pad.show_reference(walking(5), "left_wrist")
    mount(page, pad)
    menu = page.get_by_label("Preset shape")
    menu.focus()
    for version, name in enumerate(["Circle", "Figure eight", "Heart", "Wave", "S-curve"], 1):
        menu.select_option(name)
        path = sent(page)
        assert path.shape == (48, 2)
        assert np.isfinite(path).all()
        closed = name in {"Circle", "Figure eight", "Heart"}
        assert (np.linalg.norm(path[0] - path[-1]) < 1e-3) == closed, name
        assert page.evaluate("model.get('version')") == version
        if name == "Circle":
            radius = np.linalg.norm(path - (path.max(0) + path.min(0)) / 2, axis=1)
            np.testing.assert_allclose(radius, 0.15 * 2.1, rtol=0.03)


def test_move_bend_undo_and_clear(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=21, smoothing=0.0)
    mount(page, pad)
    drag(page, pad, [(-0.5, 1.0), (0.5, 1.0)])
    line = sent(page)
    page.get_by_role("button", name="Move").click()
    drag(page, pad, [(0.0, 1.0), (0.2, 1.3)])
    np.testing.assert_allclose(sent(page) - line, np.tile([0.2, 0.3], (21, 1)), atol=0.012)
    page.get_by_role("button", name="Bend").click()
    drag(page, pad, [(0.2, 1.3), (0.2, 1.6)])
    bent = sent(page)
    assert bent[:, 1].max() == pytest.approx(1.6, abs=0.03)
    assert bent[[0, -1], 1].max() < 1.33, "the ends hardly move"
    page.get_by_role("button", name="Undo").click()
    page.locator("canvas").focus()
    page.keyboard.press("Control+z")
    np.testing.assert_allclose(sent(page), line, atol=1e-6)
    page.get_by_role("button", name="Clear").click()
    assert sent(page).size == 0
    page.get_by_role("button", name="Undo").click()
    np.testing.assert_allclose(sent(page), line, atol=1e-6)
    assert page.evaluate("model.get('version')") == 7


def test_arrow_keys_move_by_a_centimetre_and_count_once(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=5)
    pad.path = np.linspace([0, 1], [0.5, 1], 5)
    mount(page, pad)
    page.locator("canvas").focus()
    for key in ("ArrowUp", "ArrowUp", "ArrowRight", "Shift+ArrowDown"):
        page.keyboard.press(key)
    page.wait_for_timeout(500)
    np.testing.assert_allclose(sent(page) - pad.path, np.tile([0.01, -0.08], (5, 1)), atol=1e-6)
    assert page.evaluate("model.get('version')") == pad.version + 1


def test_a_path_from_the_kernel_is_drawn_as_it_is(open_page):
    page = open_page(width=500)
    pad = PathPad(samples=30)
    mount(page, pad)
    empty = picture(page)
    pad.path = np.stack([np.linspace(-0.5, 0.5, 30), 1 + 0.3 * np.sin(np.arange(30))], 1)
    update(page, pad, "path_data", "version")
    assert changed(empty, picture(page)) > 50
    assert "30 points" in page.locator(".pf-pad").inner_text()
    np.testing.assert_allclose(sent(page), pad.path, atol=1e-6)
    pad.path = None
    update(page, pad, "path_data", "version")
    assert changed(empty, picture(page)) < 5


def test_touch(open_page):
    page = open_page(width=500, has_touch=True)
    pad = PathPad(samples=9, smoothing=0.0)
    mount(page, pad)
    client = page.context.new_cdp_session(page)

    def touch(kind, point=None):
        places = (
            [] if point is None else [dict(zip("xy", to_pixels(page, pad, point), strict=True))]
        )
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    touch("touchStart", (0.0, 0.5))
    for i in range(1, 9):
        touch("touchMove", (0.0, 0.5 + i / 8))
    touch("touchEnd")
    page.wait_for_timeout(100)
    np.testing.assert_allclose(sent(page), np.linspace([0, 0.5], [0, 1.5], 9), atol=0.02)


def test_readable_light_and_dark(open_page, artefacts):
    for dark in (False, True):
        page = open_page(width=460, height=520, ratio=2)
        pad = PathPad(samples=40)
        pad.show_reference(walking(20), "left_wrist")
        mount(page, pad, dark=dark)
        for selector in (".pf-readout", ".pf-hint", "button", "label"):
            assert contrast(page, selector) >= 4.5, selector
        angles = [2 * math.pi * i / 30 for i in range(24)]
        drag(page, pad, [(0.4 * math.cos(a), 1.3 + 0.3 * math.sin(2 * a)) for a in angles], 2)
        page.screenshot(path=artefacts / f"path_pad_page_{'dark' if dark else 'light'}.png")

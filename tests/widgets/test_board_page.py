"""The board's ES module in a blank page: handles by mouse, touch and keys, and what is drawn."""

from __future__ import annotations

import numpy as np
import pytest
from stage import contrast, count_colour, encode, mount, update

from projflow_lite.widgets import Board
from projflow_lite.widgets.board import ROLES

pytestmark = pytest.mark.browser

MARGIN = {"left": 46, "right": 14, "top": 12, "bottom": 40}  # of the plane inside the canvas
COLOURS = {"data": (19, 88, 202), "wish": (173, 46, 3), "projected": (8, 145, 94)}


def to_pixels(page, board, point, index=0):
    """Where a point must be on the page, worked out independently of the module."""
    box = page.locator("canvas").nth(index).bounding_box()
    width = box["width"] - MARGIN["left"] - MARGIN["right"]
    height = box["height"] - MARGIN["top"] - MARGIN["bottom"]
    (left, right), (low, high) = board.x, board.y
    across, up = width / (right - left), height / (high - low)
    if board.equal:
        across = up = min(across, up)
    x = box["x"] + MARGIN["left"] + width / 2 + across * (point[0] - (left + right) / 2)
    y = box["y"] + MARGIN["top"] + height / 2 - up * (point[1] - (low + high) / 2)
    return x, y


def drag(page, board, points, steps=6):
    page.mouse.move(*to_pixels(page, board, points[0]))
    page.mouse.down()
    for point in points[1:]:
        page.mouse.move(*to_pixels(page, board, point), steps=steps)
    page.mouse.up()
    page.wait_for_timeout(80)


def sent(page, name):
    """The last place that was sent for a handle."""
    return page.evaluate("(name) => model.get('drag').moves[name]", name)[:2]


def middle(page, name, index=0):
    box = page.locator(f".pf-handle[data-name='{name}']").nth(index).bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def answer(page, board, count):
    """Play the kernel: hear the page's last drag, and send back what changed."""
    board.set_state({"drag": page.evaluate("model.get('drag')")})
    assert board.seen == count
    update(page, board, "layers", "data", "handles", "seen", "problem")


@pytest.mark.parametrize("equal", [True, False])
def test_a_drag_gives_the_place_in_units_of_the_plane(open_page, equal):
    page = open_page(width=640)
    board = Board(x=(-2, 6), y=(10, 12), equal=equal)
    board.handle("y", (1, 11))
    mount(page, board)
    assert middle(page, "y") == pytest.approx(to_pixels(page, board, (1, 11)), abs=0.6)
    drag(page, board, [(1, 11), (2, 11.5), (3, 11.25)])
    assert sent(page, "y") == pytest.approx([3, 11.25], abs=0.02)
    assert middle(page, "y") == pytest.approx(to_pixels(page, board, (3, 11.25)), abs=1)


def test_a_handle_does_not_jump_to_the_pointer(open_page):
    page = open_page(width=500)
    board = Board()
    board.handle("y", (0, 0))
    mount(page, board)
    x, y = to_pixels(page, board, (0, 0))
    page.mouse.move(x + 9, y - 7)
    page.mouse.down()
    page.mouse.move(x + 10, y - 7)
    page.mouse.up()
    page.wait_for_timeout(80)
    one_pixel = 6 / (420 - 2 - 52)
    assert sent(page, "y") == pytest.approx([one_pixel, 0], abs=1e-3)


def test_messages_are_few_and_the_last_place_arrives(open_page):
    page = open_page(width=500)
    board = Board()
    board.handle("y", (-2, -2))
    mount(page, board)
    page.evaluate("""() => { window.times = []; const save = model.save_changes.bind(model);
        model.save_changes = () => { times.push(performance.now()); save(); }; }""")
    page.mouse.move(*to_pixels(page, board, (-2, -2)))
    page.mouse.down()
    for i in range(60):
        page.mouse.move(*to_pixels(page, board, (-2 + i / 15, -2 + i / 15)))
    page.mouse.up()
    page.wait_for_timeout(120)
    times = page.evaluate("times")
    assert len(times) >= 2
    assert np.diff(times).min() >= 13  # SEND_EVERY, less what a clock of the page rounds
    assert sent(page, "y") == pytest.approx([-2 + 59 / 15] * 2, abs=0.02)
    assert all(list(save) == ["drag"] for save in page.evaluate("model.saves"))


def test_handles_stay_in_the_plane_and_on_their_axis(open_page):
    page = open_page(width=500)
    board = Board()
    board.handle("free", (0, 0))
    board.handle("level", (1, 1), along="x")
    board.handle("upright", (-1, -1), along="y")
    mount(page, board)
    drag(page, board, [(0, 0), (0, 5)])
    assert sent(page, "free") == pytest.approx([0, 3], abs=0.02)
    drag(page, board, [(1, 1), (2, 2)])
    assert sent(page, "level") == pytest.approx([2, 1], abs=0.02)
    assert sent(page, "level")[1] == 1
    drag(page, board, [(-1, -1), (2, 2)])
    assert sent(page, "upright")[0] == -1
    assert sent(page, "upright") == pytest.approx([-1, 2], abs=0.02)


def test_by_keyboard_and_read_aloud(open_page):
    page = open_page(width=500)
    board = Board(labels=("left", "up"))
    board.handle("goal", (1, 0.5), label="y")
    board.handle("time", (0, -2), label="t", along="x")
    mount(page, board)
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.dataset.name") == "goal"
    step = 0.1  # a tenth of the distance between ticks, 1
    for key in ("ArrowRight", "ArrowRight", "ArrowUp", "Shift+ArrowLeft"):
        page.keyboard.press(key)
    page.wait_for_timeout(600)
    assert sent(page, "goal") == pytest.approx([1 + 2 * step - 1, 0.5 + step])
    assert page.locator("[aria-live=polite]").inner_text() == "y: left 0.20, up 0.60"
    button = page.get_by_role("button", name="y: left 0.20, up 0.60. Arrow keys move it.")
    assert button.get_attribute("aria-roledescription") == "point to drag"

    page.keyboard.press("Tab")
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowLeft")
    page.wait_for_timeout(100)
    slider = page.get_by_role("slider", name="t")
    assert float(slider.get_attribute("aria-valuenow")) == pytest.approx(-step)
    assert slider.get_attribute("aria-valuetext") == "left −0.10"
    assert sent(page, "time")[1] == -2


def test_touch(open_page):
    page = open_page(width=500, has_touch=True)
    board = Board()
    board.handle("y", (0, 0))
    mount(page, board)
    client = page.context.new_cdp_session(page)

    def touch(kind, *point):
        places = [dict(zip("xy", to_pixels(page, board, at), strict=True)) for at in point]
        client.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": places})

    touch("touchStart", (0.1, 0.0))  # a finger does not hit the middle
    for i in range(1, 9):
        touch("touchMove", (0.1 + i / 8, -i / 8))
    touch("touchEnd")
    page.wait_for_timeout(100)
    assert sent(page, "y") == pytest.approx([1, -1], abs=0.03)


def test_the_hand_is_ahead_of_old_answers_but_python_may_lead(open_page):
    page = open_page(width=500)
    board = Board()
    board.handle("y", (0, 0))
    mount(page, board)
    page.mouse.move(*to_pixels(page, board, (0, 0)))
    page.mouse.down()
    page.mouse.move(*to_pixels(page, board, (1, 0)))
    page.wait_for_timeout(60)
    board.set_state({"drag": page.evaluate("model.get('drag')")})
    page.mouse.move(*to_pixels(page, board, (2, 0)))
    page.wait_for_timeout(10)
    update(page, board, "handles", "seen")  # the answer to the first move comes late
    assert middle(page, "y") == pytest.approx(to_pixels(page, board, (2, 0)), abs=1)

    board.on_move(lambda name, at: board.handle("y", (at[0], 1)))  # from now on at height 1
    answer(page, board, 2)
    assert middle(page, "y") == pytest.approx(to_pixels(page, board, (2, 1)), abs=1)
    page.mouse.move(*to_pixels(page, board, (2.5, 0)))
    assert middle(page, "y") == pytest.approx(to_pixels(page, board, (2, 1)), abs=1), "no flicker"
    page.wait_for_timeout(60)
    answer(page, board, 3)
    assert middle(page, "y") == pytest.approx(to_pixels(page, board, (2.5, 1)), abs=1)
    page.mouse.up()
    assert page.evaluate("model.get('drag').moves.y[2]") == 3


def test_python_moves_adds_and_removes_handles(open_page):
    page = open_page(width=500)
    board = Board()
    board.handle("a", (0, 0))
    mount(page, board)
    board.handle("a", (1, -1))
    board.handle("b", (-5, 0))
    update(page, board, "handles")
    assert middle(page, "a") == pytest.approx(to_pixels(page, board, (1, -1)), abs=1)
    outside = page.locator(".pf-handle[data-name='b']")
    assert "pf-outside" in outside.get_attribute("class")
    assert middle(page, "b") == pytest.approx(to_pixels(page, board, (-3, 0)), abs=1), "at the edge"
    board.remove("a")
    update(page, board, "handles")
    assert page.locator(".pf-handle").count() == 1


def test_two_views_of_one_board_stay_in_step(open_page):
    page = open_page(width=500, height=1000)
    board = Board()
    board.handle("y", (0, 0))
    mount(page, board)
    page.evaluate(
        """async (code) => { const address = URL.createObjectURL(new Blob([code], { type: "text/javascript" }));
        const { default: widget } = await import(address);
        const el = document.body.appendChild(document.createElement("div"));
        window.unmountSecond = await widget.render({ model, el }); }""",
        board._esm,
    )
    page.wait_for_timeout(100)
    drag(page, board, [(0, 0), (1.5, 1)])
    assert middle(page, "y", 1) == pytest.approx(to_pixels(page, board, (1.5, 1), 1), abs=1)
    answer(page, board, page.evaluate("model.get('drag').moves.y[2]"))
    first, second = page.locator(".pf-handle").all()
    second.focus()
    page.keyboard.press("ArrowRight")
    page.wait_for_timeout(80)
    assert middle(page, "y", 0) == pytest.approx(to_pixels(page, board, (1.6, 1), 0), abs=1)
    page.evaluate("unmountSecond(); undefined")
    first.focus()
    page.keyboard.press("ArrowLeft")
    page.wait_for_timeout(80)
    assert sent(page, "y") == pytest.approx([1.5, 1], abs=0.02)


def test_what_is_drawn_is_where_it_should_be(open_page):
    page = open_page(width=500)
    board = Board(x=(0, 4), y=(0, 3))
    board.points("dot", [[1, 2]], color="data", size=6, opacity=1)
    board.line("gap", [[0, 1], [1, 1], [np.nan, np.nan], [3, 1], [4, 1]], color="wish", width=4)
    board.arrow("arrow", (2, 0.5), (2, 2.5))
    mount(page, board)

    def colour(point):
        x, y = to_pixels(page, board, point)
        box = page.locator("canvas").bounding_box()
        place = [round(x - box["x"]), round(y - box["y"])]
        script = "([x, y]) => Array.from(document.querySelector('canvas').getContext('2d').getImageData(x, y, 1, 1).data).slice(0, 3)"
        return tuple(page.evaluate(script, place))

    assert colour((1, 2)) == COLOURS["data"]
    assert colour((0.5, 1)) == colour((3.5, 1)) == COLOURS["wish"]
    assert COLOURS["wish"] not in (colour((1.5, 1)), colour((2.5, 1))), "NaN lifts the pen"
    assert colour((2, 1.2)) == colour((2, 2.45)) == COLOURS["projected"]
    area = count_colour(page, COLOURS["data"])
    assert np.pi * 4.5**2 < area < np.pi * 6.5**2, "a disc of radius 6, less its soft edge"


def test_the_ellipse_reaches_as_far_as_its_deviations(open_page):
    page = open_page(width=500)
    board = Board(x=(-3, 3), y=(-3, 3))
    board.ellipse("prior", (0.5, 0), [[1.0, 0], [0, 0.25]], color="data", deviations=(2,))
    mount(page, board)
    left, right, top, bottom = page.evaluate(
        """([r, g, b]) => { const canvas = document.querySelector("canvas");
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        const xs = [], ys = [];
        for (let i = 0; i < data.length; i += 4)
          if (Math.abs(data[i] - r) + Math.abs(data[i + 1] - g) + Math.abs(data[i + 2] - b) < 40) {
            xs.push((i / 4) % canvas.width); ys.push(Math.floor(i / 4 / canvas.width)); }
        return [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)]; }""",
        list(COLOURS["data"]),
    )
    unit = (420 - 2 - 52) / 6  # pixels a unit
    assert (right - left) / unit == pytest.approx(2 * 2 * 1.0, abs=0.06)
    assert (bottom - top) / unit == pytest.approx(2 * 2 * 0.5, abs=0.06)


def test_a_message_is_one_picture_and_the_legend_follows(open_page):
    page = open_page(width=500)
    board = Board(title="A plane")
    board.points("cloud", np.zeros((3, 2)), label="data")
    mount(page, board)
    pictures = "Number(document.querySelector('.pf-board').dataset.pictures)"
    before = page.evaluate(pictures)
    with board.hold():
        for i in range(5):
            board.line(f"line{i}", [[0, 0], [1, i]], label=f"line {i}" if i < 2 else "")
    update(page, board, "layers", "data", "handles")
    assert page.evaluate(pictures) == before + 1
    assert page.locator(".pf-board-key").all_inner_texts() == ["data", "line 0", "line 1"]
    name = page.locator("canvas").get_attribute("aria-label")
    assert name == "A plane, axes x and y. Shown: data, line 0, line 1."
    legend, stage = (page.locator(at).bounding_box() for at in (".pf-board-legend", ".pf-stage"))
    assert legend["y"] + legend["height"] <= stage["y"], "the legend covers nothing"


def test_a_problem_is_shown_as_words_and_goes_away(open_page):
    page = open_page(width=500)
    board = Board()
    mount(page, board)
    assert not page.locator(".pf-board-problem").is_visible()
    board.problem = "rows <b>0</b> and 1 contradict each other"
    update(page, board, "problem")
    assert page.get_by_role("alert").inner_text() == board.problem
    board.problem = ""
    update(page, board, "problem")
    assert not page.locator(".pf-board-problem").is_visible()


def test_nothing_is_left_behind_when_the_view_is_closed(open_page):
    page = open_page(width=500)
    board = Board()
    board.handle("y", (0, 0))
    mount(page, board)
    page.mouse.move(*to_pixels(page, board, (0, 0)))
    page.mouse.down()
    for i in range(5):  # the last of these waits for its turn when the view goes
        page.mouse.move(*to_pixels(page, board, (i / 4, 0)))
    page.evaluate("unmount(); undefined")
    assert sent(page, "y") == pytest.approx([1, 0], abs=0.02)
    assert page.evaluate("Object.values(model.listeners).flat().length") == 0
    pictures = page.evaluate("document.querySelector('.pf-board').dataset.pictures")
    page.evaluate("document.body.classList.add('other'); undefined")
    page.evaluate("(state) => update(state)", encode({"title": "late"}))
    page.wait_for_timeout(150)
    assert page.evaluate("document.querySelector('.pf-board').dataset.pictures") == pictures


def test_readable_and_sharp_light_and_dark(open_page, artefacts):
    random = np.random.default_rng(0)
    for dark in (False, True):
        page = open_page(width=460, height=520, ratio=2)
        board = Board(title="Everything at once", labels=("x₁", "x₂"))
        for i, role in enumerate(ROLES[:3]):
            board.points(role, random.normal([i - 1, 1 - i], 0.6, (300, 2)), role, label=role)
        board.ellipse("prior", (1, 1), [[0.5, 0.2], [0.2, 0.4]], label="prior")
        board.line(
            "path", np.column_stack([np.linspace(-3, 3), np.sin(np.linspace(-3, 3))]), label="path"
        )
        board.line("wish", [[-3, 2], [3, -2]], "wish", dash=True, label="A x = y")
        board.arrow("pull", (-1, -1), (0.5, -2), label="Δ*")
        board.text("note", (-3, -2.7), "a note that stays inside")
        board.handle("y", (2.9, 0.5))
        board.handle("x", (-2, 2), label="x̂₁", color="prediction")
        mount(page, board, dark=dark)
        on_the_page = (".pf-board-key", ".pf-board-title") if dark else ()
        for selector in (".pf-handle-label", *on_the_page):
            assert contrast(page, selector) >= 4.5, selector
        size = page.evaluate(
            "(() => { const c = document.querySelector('canvas'); return [c.width, c.clientWidth]; })()"
        )
        assert size[0] == 2 * size[1]
        page.screenshot(path=artefacts / f"board_page_{'dark' if dark else 'light'}.png")


# How protan, deutan and tritan eyes see, in linear RGB: Machado, Oliveira and Fernandes 2009.
EYES = {
    "usual": np.eye(3),
    "protan": [[0.152286, 1.052583, -0.204868], [0.114503, 0.786281, 0.099216], [-0.003882, -0.048116, 1.051998]],
    "deutan": [[0.367322, 0.860646, -0.227968], [0.280085, 0.672501, 0.047413], [-0.011820, 0.042940, 0.968881]],
    "tritan": [[1.255528, -0.076749, -0.178779], [-0.078411, 0.930809, 0.147602], [0.004733, 0.691367, 0.303900]],
}  # fmt: skip


def to_lab(linear):
    """CIE L*a*b* of linear RGB under D65."""
    to_xyz = np.array(
        [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]]
    )
    xyz = to_xyz @ np.clip(linear, 0, 1) / [0.9505, 1, 1.089]
    x, y, z = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


@pytest.mark.parametrize("dark", [False, True])
def test_roles_can_be_told_apart_by_every_eye(open_page, dark):
    page = open_page(width=500)
    mount(page, Board(), dark=dark)
    read = "(role) => parse(getComputedStyle(document.querySelector('.pf-board')).getPropertyValue(`--pf-role-${role}`).trim())"
    parse = "const parse = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16) / 255);"
    srgb = np.array(
        [page.evaluate(f"(role) => {{ {parse} return ({read})(role); }}", role) for role in ROLES]
    )
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    for eye, matrix in EYES.items():
        seen = [to_lab(np.array(matrix) @ colour) for colour in linear]
        for i in range(len(ROLES)):
            for j in range(i):
                apart = np.linalg.norm(seen[i] - seen[j])
                assert apart > 20, f"{eye}: {ROLES[i]} and {ROLES[j]} look alike ({apart:.0f})"

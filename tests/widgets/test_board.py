"""The Python side of the board: what is sent, what moves do, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from traitlets import TraitError

from projflow_lite.widgets import Board
from projflow_lite.widgets.front_end import unpack


def drag(board, count, **moves):
    """What the page sends when handles are dragged."""
    state = {name: [float(x), float(y), count] for name, (x, y) in moves.items()}
    board.set_state({"drag": {"moves": state}})


def layer(board, name):
    """The style of a layer and its points, read from what is sent."""
    style = next(layer for layer in board.layers if layer["name"] == name)
    points = unpack(board.data, -1, 2)
    return style, points[style["start"] : style["start"] + style["count"]]


class Wire:
    """Stands in for the connection to the page: keeps every message."""

    def __init__(self):
        self.messages = []
        self.kernel = True
        self.comm_id = "wire"

    def on_msg(self, callback): ...

    def send(self, data=None, buffers=None):
        names = {*data["state"], *(path[0] for path in data["buffer_paths"])}
        self.messages.append(sorted(names))

    def close(self, *_, **__): ...


def wired(board):
    # The constructor has sent its state; from here on every message is counted.
    board.comm = wire = Wire()
    return wire


def test_layers_share_one_array_and_keep_their_order():
    board = Board()
    board.points("cloud", [[1, 2], [3, 4], [5, 6]], label="data")
    board.line("path", [[0, 0], [np.nan, np.nan], [1, 1]])
    board.arrow("pull", (0, 1), (2, 3))
    board.points("cloud", [[7, 8]], color="noise")
    assert [style["name"] for style in board.layers] == ["cloud", "path", "pull"]
    style, points = layer(board, "cloud")
    assert (style["kind"], style["color"], style["label"]) == ("points", "noise", "")
    np.testing.assert_array_equal(points, [[7, 8]])
    np.testing.assert_array_equal(layer(board, "path")[1], [[0, 0], [np.nan] * 2, [1, 1]])
    np.testing.assert_array_equal(layer(board, "pull")[1], [[0, 1], [2, 3]])
    board.remove("path")
    np.testing.assert_array_equal(layer(board, "pull")[1], [[0, 1], [2, 3]])


def test_an_ellipse_is_one_deviation_away_in_every_direction():
    C = np.array([[2.0, 0.6], [0.6, 0.5]])
    board = Board()
    board.ellipse("prior", (1, -1), C)
    mean, *half_axes = layer(board, "prior")[1]
    angle = np.linspace(0, 2 * np.pi, 17)[:, None]
    edge = np.cos(angle) * half_axes[0] + np.sin(angle) * half_axes[1]
    np.testing.assert_allclose(mean, [1, -1])
    np.testing.assert_allclose(np.einsum("ni,ij,nj->n", edge, np.linalg.inv(C), edge), 1, rtol=1e-5)


def test_a_singular_ellipse_is_a_stroke_along_its_one_direction():
    board = Board()
    board.ellipse("line", (0, 0), [[4, 2], [2, 1]])
    half_axes = layer(board, "line")[1][1:]
    np.testing.assert_allclose(np.abs(half_axes), [[0, 0], [2, 1]], atol=1e-6)


def test_handles_can_be_put_moved_and_read():
    board = Board()
    board.handle("y", (1, 0.5))
    board.handle("slider", (0, 2), label="t", along="x")
    assert board.positions == {"y": (1.0, 0.5), "slider": (0.0, 2.0)}
    assert [(h["label"], h["along"]) for h in board.handles] == [("y", None), ("t", "x")]
    board.handle("y", (2, 2))
    assert board.positions["y"] == (2.0, 2.0)
    board.remove("slider")
    assert list(board.positions) == ["y"]


def test_each_move_is_heard_once():
    board = Board()
    board.handle("a", (0, 0))
    board.handle("b", (0, 0))
    heard = []
    board.on_move(lambda name, at: heard.append((name, at)))
    drag(board, 1, a=(1, 2))
    # A page that has not had an answer yet sends the earlier move again.
    board.set_state({"drag": {"moves": {"b": [3, 4, 2], "a": [1, 2, 1]}}})
    drag(board, 3, gone=(9, 9))
    assert heard == [("a", (1.0, 2.0)), ("b", (3.0, 4.0))]
    assert board.positions == {"a": (1.0, 2.0), "b": (3.0, 4.0)}
    assert board.seen == 3


def test_python_leads_a_handle_that_it_puts_elsewhere():
    board = Board()
    board.handle("round", (1, 0))
    board.handle("free", (0, 0))

    def on_the_circle(name, at):
        if name == "round":
            board.handle("round", np.array(at) / np.linalg.norm(at))

    board.on_move(on_the_circle)
    drag(board, 1, round=(3, 4))
    np.testing.assert_allclose(board.positions["round"], [0.6, 0.8])
    assert board.handles[0]["led"]
    drag(board, 2, free=(1, 1))
    assert not board.handles[1]["led"]


def test_listeners_can_be_taken_away():
    board = Board()
    board.handle("a", (0, 0))
    heard = []
    function = board.on_move(lambda name, at: heard.append(at))
    board.on_move(function, remove=True)
    drag(board, 1, a=(1, 1))
    assert heard == []
    assert board.positions["a"] == (1.0, 1.0)


def test_what_a_listener_raises_is_shown_and_then_forgotten():
    board = Board()
    board.handle("a", (0, 0))

    def refuse(name, at):
        if at[0] > 1:
            raise ValueError("rows 0, 1 contradict each other")
        if at[0] < -1:
            raise KeyError("lost")

    board.on_move(refuse)
    drag(board, 1, a=(2, 0))
    assert board.problem == "rows 0, 1 contradict each other"
    assert board.positions["a"] == (2.0, 0.0)
    drag(board, 2, a=(-2, 0))
    assert board.problem == "KeyError: 'lost'"
    drag(board, 3, a=(0, 0))
    assert board.problem == ""


def test_many_changes_in_a_hold_are_one_message():
    board = Board()
    board.points("cloud", [[0, 0]])
    wire = wired(board)
    with board.hold():
        board.points("cloud", [[1, 1]])
        board.line("path", [[0, 0], [1, 1]])
        with board.hold():
            board.handle("a", (0, 0))
    assert wire.messages == [["data", "handles", "layers"]]
    board.points("cloud", [[2, 2]])
    assert wire.messages[1:] == [["data"]], "only the numbers changed"


def test_an_answer_to_a_move_is_one_message():
    board = Board()
    board.handle("a", (0, 0))
    wire = wired(board)

    @board.on_move
    def follow(name, at):
        board.points("cloud", [at])
        board.line("path", [at, (0, 0)])

    drag(board, 1, a=(1, 1))
    answers = [message for message in wire.messages if "drag" not in message]
    assert answers == [["data", "handles", "layers", "seen"]]


def test_an_error_inside_a_hold_still_shows_what_was_drawn_before():
    board = Board()

    def stop_halfway():
        with board.hold():
            board.points("cloud", [[1, 1]])
            raise KeyError("halfway")

    with pytest.raises(KeyError, match="halfway"):
        stop_halfway()
    assert layer(board, "cloud")[1].tolist() == [[1, 1]]


def test_a_board_with_equal_units_is_as_wide_as_its_plane():
    assert Board(height=452, x=(0, 4), y=(0, 2)).layout.width == "860px"  # 200 px a unit, + 60
    assert Board(equal=False).layout.width is None


@pytest.mark.parametrize(
    ("draw", "message"),
    [
        (
            lambda b: b.points("p", [1, 2, 3]),
            r"Board.points: xy has shape \(3,\), expected \(n, 2\)",
        ),
        (lambda b: b.points("p", [[np.nan, 0]]), "Board.points: xy has a value that is not finite"),
        (
            lambda b: b.points("p", [[0, 0]], color="red"),
            "'red' is no role; choose from data, noise",
        ),
        (lambda b: b.line("l", [[0, np.inf]]), "Board.line: xy has a value that is not finite"),
        (lambda b: b.line("l", [[0, 0, 0]]), r"expected \(n, 2\)"),
        (lambda b: b.ellipse("e", (0, 0), [[1, 0], [0, -0.5]]), "smallest eigenvalue is -0.5"),
        (lambda b: b.ellipse("e", (0, 0), [[1, 1], [0, 1]]), "covariance is not symmetric"),
        (lambda b: b.ellipse("e", (0, 0), 1.0), r"covariance has shape \(\), expected \(2, 2\)"),
        (lambda b: b.arrow("a", (0, 0), (1, 2, 3)), r"end has shape \(3,\), expected \(2,\)"),
        (lambda b: b.text("t", (0, np.nan), "x"), "Board.text: position has a value"),
        (lambda b: b.handle("h", (0, 0), along="z"), "along is 'z', expected 'x', 'y' or None"),
        (lambda b: b.handle("h", (0, np.inf)), "Board.handle: position has a value"),
        (lambda b: b.remove("clud"), "nothing is called 'clud'; there is cloud"),
    ],
)
def test_wrong_input_is_refused_in_one_line_and_changes_nothing(draw, message):
    board = Board()
    board.points("cloud", [[0, 0]])
    before = board.layers, board.data, board.handles
    with pytest.raises(ValueError, match=message) as error:
        draw(board)
    assert "\n" not in str(error.value)
    assert (board.layers, board.data, board.handles) == before


@pytest.mark.parametrize(
    ("traits", "message"),
    [
        ({"x": (1, 0)}, "x is .1, 0., expected two finite numbers"),
        ({"y": (0, np.inf)}, "y is .0, inf., expected"),
        ({"x": (0, 1, 2)}, "expected two finite numbers"),
        ({"height": 20}, "height is 20 pixels, expected 100 or more"),
        ({"labels": ("x",)}, "labels needs two names, got 1"),
    ],
)
def test_bad_planes_are_refused(traits, message):
    with pytest.raises((ValueError, TraitError), match=message):
        Board(**traits)


def test_a_drag_is_answered_without_an_echo(monkeypatch):
    board, said = Board(), []
    board.handle("h", (0, 0))
    board.on_move(lambda name, at: board.points("cloud", [at]))
    monkeypatch.setattr(type(board.comm), "kernel", object(), raising=False)
    monkeypatch.setattr(board, "_send", lambda message, buffers=None: said.append(message))
    board.set_state({"drag": {"moves": {"h": [1.0, 2.0, 1]}}})
    (message,) = said
    assert message["method"] == "update"
    assert {"layers", "handles", "seen"} <= set(message["state"])

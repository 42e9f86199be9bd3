"""What explorers on a board share: they draw anew when a hand moves something, or say why not."""

import numpy as np
import pytest

from projflow_lite.widgets import Board
from projflow_lite.widgets.board_explorer import BoardExplorer, legs, slider


class Halfway(BoardExplorer):
    """A dot at a share of the way to the handle; beyond it there is none."""

    def __init__(self):
        self.share = slider("share", 0.5, 0, 2)
        self.heard = []
        board = Board()
        board.handle("end", (2, 0))
        super().__init__(board, [self.share])

    def moved(self, name, position):
        self.heard.append((name, *position))

    def draw(self):
        self.board.line("way", [(0, 0), self.place("end")])
        if self.share.value > 1:
            raise ValueError("beyond the end")
        self.board.points("dot", [self.share.value * self.place("end")])


def last_point(explorer):
    return np.frombuffer(explorer.board.data, "<f4").reshape(-1, 2)[-1]


@pytest.fixture
def explorer():
    return Halfway()


def test_it_draws_at_once_and_after_every_move(explorer):
    assert last_point(explorer) == pytest.approx([1, 0])
    explorer.board.drag = {"moves": {"end": [0, 3, 1]}}
    assert explorer.heard == [("end", 0, 3)]
    assert last_point(explorer) == pytest.approx([0, 1.5])
    explorer.share.value = 1.0
    assert last_point(explorer) == pytest.approx([0, 3])


def test_what_cannot_be_drawn_is_said_until_it_can(explorer):
    explorer.share.value = 1.5
    assert explorer.board.problem == "beyond the end"
    explorer.board.drag = {"moves": {"end": [1, 1, 1]}}
    assert explorer.board.problem == "beyond the end"
    explorer.share.value = 1.0
    assert explorer.board.problem == ""
    assert last_point(explorer) == pytest.approx([1, 1])


def test_other_errors_are_not_swallowed(explorer):
    explorer.draw = lambda: 1 / 0
    with pytest.raises(ZeroDivisionError):
        explorer.share.value = 0.7


def test_a_slider_of_whole_numbers_stays_whole():
    assert slider("steps", 3, 1, 5, step=1).value == 3
    assert type(slider("steps", 3, 1, 5, step=1)).__name__ == "IntSlider"
    assert type(slider("t", 3.0, 1, 5)).__name__ == "FloatSlider"


def test_legs_lift_the_pen_between_them():
    line = legs([[0, 0], [1, 1]], [[2, 0], [1, 3]])
    expected = [[0, 0], [2, 0], [np.nan] * 2, [1, 1], [1, 3], [np.nan] * 2]
    np.testing.assert_array_equal(line, expected)

"""The boards of the notebooks on the flow and on the projection, with formulas known by hand."""

import numpy as np
import pytest

from projflow_lite.studies.flow_explorer import CrossingExplorer, RiverExplorer
from projflow_lite.studies.projection_explorer import (
    BayesExplorer,
    ProjectionExplorer,
    TwoRowsExplorer,
    level,
)


def layer(board, name):
    """The points of a layer, as the page gets them."""
    found = next(each for each in board.layers if each["name"] == name)
    points = np.frombuffer(board.data, "<f4").reshape(-1, 2)
    return points[found["start"] : found["start"] + found["count"]]


def drag(board, name, at):
    board.drag = {"moves": {name: [*at, board.seen + 1]}}


def problem(degrees, deviation, long_axis):
    """A row along x when the angle is 0, the metric the identity, whatever its handle says."""
    turn = np.radians(degrees)
    return np.array([[np.cos(turn), np.sin(turn)]]), np.eye(2), np.array([[deviation**2]])


def test_both_velocities_are_drawn_to_where_they_would_end():
    asked = []

    def passing(x, t):
        asked.append((*x, t))
        return np.zeros((60, 2)), np.ones((60, 2))

    average, exact = (lambda x, t: np.array([2.0, 0.0])), (lambda x, t: np.array([0.0, 4.0]))
    explorer = CrossingExplorer(passing, average, exact, probe=(1.0, -1.0))
    explorer.time.value = 0.5
    assert asked[-1] == (1.0, -1.0, 0.5)
    np.testing.assert_allclose(layer(explorer.board, "average"), [[1, -1], [2, -1]])
    np.testing.assert_allclose(layer(explorer.board, "exact"), [[1, -1], [1, 1]])
    assert len(layer(explorer.board, "ends")) == 40
    assert "average of 60: [2. 0.]" in explorer.words.value
    drag(explorer.board, "probe", (0.0, 0.0))
    np.testing.assert_allclose(layer(explorer.board, "average"), [[0, 0], [1, 0]])


@pytest.fixture
def river():
    def flow(means, steps):
        """30 particles that go from the origin to the first mean in equal steps."""
        share = np.linspace(0, 1, steps + 1)[:, None, None]
        return share * np.broadcast_to(means[0], (30, 2))

    return RiverExplorer([[2.0, 0.0], [0.0, 2.0]], flow, data=lambda means: means, steps=4)


def test_the_flow_follows_the_means_and_the_number_of_steps(river):
    assert river.paths.shape == (5, 30, 2)
    drag(river.board, "m0", (1.0, 1.0))
    np.testing.assert_allclose(river.paths[-1], np.ones((30, 2)))
    np.testing.assert_allclose(layer(river.board, "data"), [[1, 1], [0, 2]])
    river.steps.value = 2
    assert river.paths.shape == (3, 30, 2)
    paths = layer(river.board, "paths").reshape(25, 4, 2)
    np.testing.assert_allclose(paths[7], [[0, 0], [0.5, 0.5], [1, 1], [np.nan, np.nan]])


def test_particles_move_between_the_steps(river):
    for percent, x in ((0, 0.0), (40, 0.8), (75, 1.5), (100, 2.0)):
        river.percent.value = percent
        assert layer(river.board, "particles")[0] == pytest.approx([x, 0]), percent


def test_the_projection_is_drawn_and_priced():
    explorer = ProjectionExplorer(problem, lambda x, A, y, R, S: (np.array([y[0], 0]), 8.0, x))
    explorer.angle.value = 0
    drag(explorer.board, "y", (2.0, 1.5))
    assert explorer.board.positions["y"] == (2.0, 0.0)  # back onto the row's own line
    np.testing.assert_allclose(layer(explorer.board, "delta"), [[-1.2, 0.1], [2, 0]], atol=1e-6)
    np.testing.assert_allclose(layer(explorer.board, "wish")[:, 0], [2, 2])
    assert "wished for y = 2.00" in explorer.words.value
    assert "= 8.00" in explorer.words.value
    outer = next(each for each in explorer.board.layers if each["name"] == "R")["deviations"]
    assert outer == [1, 4]  # half of its square is the price
    explorer.deviation.value = 0.5
    band = layer(explorer.board, "band")[:, 0]
    np.testing.assert_allclose(band, [1.5, 1.5, np.nan, 2.5, 2.5])


def test_the_metric_travels_with_the_prediction():
    explorer = ProjectionExplorer(problem, lambda x, A, y, R, S: (x, 0.0, x))
    drag(explorer.board, "axis", (0.8, 1.1))
    assert explorer.axis == pytest.approx([2, 1])
    drag(explorer.board, "x1_hat", (0.0, 0.0))
    assert explorer.board.positions["axis"] == pytest.approx((2, 1))


def test_the_posterior_is_drawn_as_it_is_given():
    covariance = np.diag([0.09, 0.25])
    explorer = BayesExplorer(problem, lambda x, A, y, R, S: (np.array([1.0, 0.0]), covariance))
    explorer.angle.value = 0
    assert explorer.words.value == "posterior: ±0.30 in the direction of A, ±0.50 in its widest"
    np.testing.assert_allclose(layer(explorer.board, "mean"), [[1, 0]])


def test_two_rows_agree_until_they_are_dragged_apart():
    heard = []

    def project(x1_hat, y, deviation):
        heard.append(tuple(y))
        if y[1] != 2 * y[0]:
            raise ValueError("they contradict each other")
        return np.array([y[0], 0.0])

    explorer = TwoRowsExplorer([[1, 0], [2, 0]], project)
    assert heard[-1] == pytest.approx((1.2, 2.4))
    drag(explorer.board, "y2", (1.25, 0.7))  # a hand that trembles
    assert explorer.board.problem == ""
    np.testing.assert_allclose(layer(explorer.board, "x_new"), [[1.2, 0]], atol=1e-6)
    drag(explorer.board, "y2", (1.5, 0.7))
    assert heard[-1] == pytest.approx((1.2, 3.0))
    assert explorer.board.problem == "they contradict each other"
    assert len(layer(explorer.board, "x_new")) == 0
    assert explorer.board.positions["y2"] == (1.5, 0.0)


def test_a_line_is_level():
    A = np.array([[3.0, -4.0]])
    ends = level(A, 10.0)
    np.testing.assert_allclose(ends @ A[0], [10, 10])
    assert np.linalg.norm(ends[1] - ends[0]) > 100

"""Wishes as lines in the plane: the boards of the notebook on the projection."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from projflow_lite.widgets import Board
from projflow_lite.widgets.board_explorer import BoardExplorer, slider

Array = NDArray[np.float64]

Problem = Callable[[float, float, Array], tuple[Array, Array, Array]]
"""``problem(degrees, deviation, long_axis)`` gives A ``(1, 2)``, R ``(2, 2)``, Sigma ``(1, 1)``."""

STEADY = 0.06
"""Two wishes nearer than this are meant to be the same: no hand is steadier."""


class ProjectionExplorer(BoardExplorer):
    """Drag a prediction, a wish and the metric: the cheapest way from the one to the other.

    Args:
        problem: what the angle, the deviation and the end of the metric's long axis mean.
        correct: ``correct(x1_hat, A, y, R, Sigma)`` gives the corrected prediction ``(2,)``, the
            price of going there, and the point ``(2,)`` that DDNM would go to.
    """

    def __init__(
        self, problem: Problem, correct: Callable[..., tuple[Array, float, Array]]
    ) -> None:
        self.problem, self.correct = problem, correct
        self.angle, self.deviation = wish_sliders(deviation=0.0)
        self.axis = np.array([0.7, 0.7])  # half of the long axis, seen from the prediction
        board = plane("The shortest way to a wish", x1_hat=(-1.2, 0.1), y=0.9 * at_angle(20))
        board.handle("axis", (-0.5, 0.8), label="metric", color="prediction")
        super().__init__(board, [self.angle, self.deviation])

    def moved(self, name: str, position: Array) -> None:
        """The metric's handle is held as seen from the prediction, and travels with it."""
        if name == "axis":
            self.axis = position - self.place("x1_hat")

    def read(self) -> tuple[Array, ...]:
        """The five arrays of ProjFlow eq. 7, as the board and the sliders say."""
        A, R, Sigma = self.problem(self.angle.value, self.deviation.value, self.axis)
        return self.place("x1_hat"), A, A @ self.place("y"), R, Sigma

    def draw(self) -> None:
        """The wish, curves of equal cost around the prediction, and two ways to the wish."""
        x1_hat, A, y, R, Sigma = self.read()
        x_new, cost, ddnm = self.correct(x1_hat, A, y, R, Sigma)
        board = self.board
        board.handle("axis", x1_hat + self.axis, label="metric", color="prediction")
        show_wish(board, A, y, Sigma)
        sizes = (1, np.sqrt(2 * cost))
        R_inv = np.linalg.inv(R)
        board.ellipse("R", x1_hat, R_inv, deviations=sizes, label="equal cost around x̂₁")
        board.arrow("ddnm", x1_hat, ddnm, "quiet", label="DDNM (R = I, Σ = 0)")
        board.arrow("delta", x1_hat, x_new, "projected", label="Δ*")
        board.points("x_new", [x_new], "projected", size=6, opacity=1)
        got = f"wished for y = {y[0]:.2f}, &nbsp; got A x̂₁* = {(A @ x_new)[0]:.2f}"
        self.words.value = f"{got}, &nbsp; paid ½‖Δ*‖²<sub>R</sub> = {cost:.2f}"


class BayesExplorer(BoardExplorer):
    """The same point as the peak of a posterior: prior and wish, drawn as Gaussians.

    Args:
        problem: what the angle, the deviation and the end of the metric's long axis mean.
        posterior: ``posterior(x1_hat, A, y, R, Sigma)`` gives mean ``(2,)``, covariance ``(2, 2)``.
        axis: end of the metric's long axis, seen from the prediction.
    """

    def __init__(
        self,
        problem: Problem,
        posterior: Callable[..., tuple[Array, Array]],
        axis: ArrayLike = (0.9, 0.6),
    ) -> None:
        self.problem, self.posterior = problem, posterior
        self.angle, self.deviation = wish_sliders(deviation=0.6)
        self.axis = np.asarray(axis, float)
        board = plane("Prior × likelihood = posterior", x1_hat=(-1.0, 0.6), y=1.2 * at_angle(20))
        super().__init__(board, [self.angle, self.deviation])

    def draw(self) -> None:
        """The wish with its deviation, the prior and the posterior."""
        A, R, Sigma = self.problem(self.angle.value, self.deviation.value, self.axis)
        x1_hat, y = self.place("x1_hat"), A @ self.place("y")
        mean, covariance = self.posterior(x1_hat, A, y, R, Sigma)
        show_wish(self.board, A, y, Sigma)
        self.board.ellipse("prior", x1_hat, np.linalg.inv(R), "prediction", label="prior, R⁻¹")
        self.board.ellipse("posterior", mean, covariance, "projected", label="posterior")
        self.board.points("mean", [mean], "projected", size=6, opacity=1)
        along = np.sqrt(max(0, A[0] @ covariance @ A[0]))
        widest = np.sqrt(np.linalg.eigvalsh(covariance)[1])
        sizes = f"±{along:.2f} in the direction of A, ±{widest:.2f} in its widest"
        self.words.value = f"posterior: {sizes}"


class TwoRowsExplorer(BoardExplorer):
    """Two rows that look the same way: drag the second until it contradicts the first.

    Args:
        A: ``(2, 2)``, the second row a multiple of the first.
        project: ``project(x1_hat, y, deviation)`` gives the corrected prediction ``(2,)``, or
            raises a ValueError, which is shown.
    """

    def __init__(self, A: ArrayLike, project: Callable[[Array, Array, float], Array]) -> None:
        self.A, self.project = np.asarray(A, float), project
        self.times = float(self.A[1] @ self.A[0] / (self.A[0] @ self.A[0]))
        self.deviation = slider("√Σ of both", 0.0, 0, 1)
        share = {2.0: "½ "}.get(self.times, f"1/{self.times:g} ")
        self.labels = ("y₁", f"{share}y₂")
        board = plane("Two rows that look the same way", x1_hat=(-1.4, 0.9))
        for k, (label, color) in enumerate(zip(self.labels, ("wish", "noise"), strict=True)):
            board.handle(f"y{k + 1}", 1.2 * self.A[0], label=label, color=color)
        super().__init__(board, [self.deviation])

    def draw(self) -> None:
        """Both lines, and the point between them if there is one."""
        # In units of the first row, so that two equal numbers are one line.
        y = np.array([self.A[0] @ self.place(name) for name in ("y1", "y2")])
        if abs(y[1] - y[0]) < STEADY:
            y[1] = y[0]
        for k, (label, color) in enumerate(zip(self.labels, ("wish", "noise"), strict=True)):
            on_line = self.A[0] * y[k] / (self.A[0] @ self.A[0])
            self.board.handle(f"y{k + 1}", on_line, label=label, color=color)
            line = level(self.A[:1], y[k])
            self.board.line(f"row{k}", line, color, dash=bool(k), label=f"row {k}: {label}")
        self.board.points("x_new", np.empty((0, 2)), "projected")
        wanted = y * [1, self.times]
        x_new = self.project(self.place("x1_hat"), wanted, self.deviation.value)
        self.board.points("x_new", [x_new], "projected", size=6, opacity=1, label="x̂₁*")


def plane(title: str, x1_hat: ArrayLike, y: ArrayLike | None = None) -> Board:
    """A board with a prediction, and a wish if there is one, to drag."""
    board = Board((-3.5, 3.5), (-2.6, 2.6), ("x₁", "x₂"), title, height=430)
    board.handle("x1_hat", x1_hat, label="x̂₁", color="prediction")
    if y is not None:
        board.handle("y", y, label="y", color="wish")
    return board


def wish_sliders(deviation: float) -> tuple:
    """A slider for the direction of a row, and one for how much it forgives."""
    return slider("angle of A, °", 20, -90, 90, step=1), slider("√Σ", deviation, 0, 1.5)


def at_angle(degrees: float) -> Array:
    """The unit vector in a direction, ``(2,)``."""
    return np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])


def show_wish(board: Board, A: Array, y: Array, Sigma: Array) -> None:
    """The line of a wish, one standard deviation to either side, and its handle on A's own line.

    Args:
        board: to draw on.
        A: ``(1, 2)``.
        y: ``(1,)``.
        Sigma: ``(1, 1)``.
    """
    board.handle("y", A[0] * y / (A[0] @ A[0]), label="y", color="wish")
    across = A[:, ::-1] * [[1, -1]]
    board.line("A", level(across, 0), "quiet", width=0.7, label="direction of A")
    board.line("wish", level(A, y[0]), "wish", label="A x = y")
    below, above = (level(A, y[0] + sign * np.sqrt(Sigma[0, 0])) for sign in (-1, 1))
    band = np.vstack([below, [[np.nan, np.nan]], above])  # a row of NaN lifts the pen
    board.line("band", band, "wish", width=1, dash=True, label="± √Σ")


def level(A: Array, y: float, half_length: float = 12) -> Array:
    """The ends of the line A x = y, ``(2, 2)``, far outside the board.

    Args:
        A: ``(1, 2)``.
        y: one number.
        half_length: from the foot of the perpendicular to either end, over the length of A.
    """
    foot, along = A[0] * y / (A[0] @ A[0]), np.array([-A[0, 1], A[0, 0]])
    return np.stack([foot - half_length * along, foot + half_length * along])

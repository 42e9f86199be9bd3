"""The sampler and the posterior in one picture: drag the wish, scrub through the sampling."""

from __future__ import annotations

from typing import Any

import ipywidgets as widgets
import numpy as np
from numpy.typing import NDArray

from projflow_lite.studies import posterior_worlds as worlds
from projflow_lite.studies.posterior_figure import line_density
from projflow_lite.studies.posterior_modes import energy_distance
from projflow_lite.widgets import Board
from projflow_lite.widgets.board_explorer import legs

REACH = 2.4
"""Half the side of the plane that is shown."""

HEIGHT = 370
"""Of both pictures, pixels: they stand side by side in a notebook of usual width."""

NOISES = {
    "implied by the state": "implied",
    "original x0": "original",
    "implied by the projected endpoint": "guided",
}
SHARES = {
    "next time (paper)": "paper",
    "0: none fresh": "0",
    "1: all fresh": "1",
    "2 / steps": "2/steps",
}
SHAPES = {
    "Euclid: R = I": "euclid",
    "precision of the data": "data",
    "moving: Cov(x1 | x_t)⁻¹": "moving",
}


class PosteriorExplorer(widgets.VBox):
    """Three modes in the plane, a wish for the first coordinate, and all of the sampler's choices.

    Args:
        count: number of samples.
        shown: for how many of them the way of one step is drawn.
        seed: of all randomness.

    The last run is ``.trace``, its ends are held against the exact posterior in ``.scores``, and
    ``.plane`` and ``.beside`` are the two pictures.
    """

    def __init__(self, count: int = 300, shown: int = 14, seed: int = 0) -> None:
        self.count, self.shown, self.seed = count, shown, seed
        self.world = worlds.three_modes()
        self.plane = Board(
            (-REACH, REACH), (-REACH, REACH), ("x", "z"), "one step of the sampler", height=HEIGHT
        )
        self.beside = Board(
            (0, 2.2), (-REACH, REACH), ("density", "z"), "where it ends",
            height=HEIGHT, equal=False, layout=widgets.Layout(width="255px", min_width="200px"),
        )  # fmt: skip
        self.noise = self._choice("noise", NOISES, "250px")
        self.eta = self._choice("η, fresh", SHARES, "240px")
        self.metric = self._choice("metric", SHAPES, "240px")
        self.steps = widgets.Dropdown(
            options=[5, 10, 20, 50], value=20, description="steps",
            layout=widgets.Layout(width="130px"), style={"description_width": "48px"},
        )  # fmt: skip
        self.step = widgets.IntSlider(
            min=0, max=19, value=9, description="step", readout=False,
            layout=widgets.Layout(width="440px"), style={"description_width": "40px"},
        )  # fmt: skip
        self.said = widgets.HTML()
        self.time = widgets.HTML()
        super().__init__(self._rows())
        self._draw_data()
        self.sample()
        self._observe()

    @staticmethod
    def _choice(name: str, options: dict[str, str], width: str) -> widgets.Dropdown:
        layout, style = widgets.Layout(width=width), {"description_width": "56px"}
        items = list(options.items())
        return widgets.Dropdown(options=items, description=name, layout=layout, style=style)

    def _rows(self) -> list[widgets.Widget]:
        wrap = widgets.Layout(flex_flow="row wrap", width="100%", grid_gap="4px 10px")
        controls = widgets.Box([self.noise, self.eta, self.metric, self.steps], layout=wrap)
        scrub = widgets.Box([self.step, self.time], layout=wrap)
        pictures = widgets.Box([self.plane, self.beside], layout=wrap)
        return [controls, scrub, pictures, self.said]

    def _observe(self) -> None:
        self.plane.on_move(self._moved)
        for control in (self.noise, self.eta, self.metric):
            control.observe(self.sample, "value")
        self.steps.observe(self._other_steps, "value")
        self.step.observe(self.show_step, "value")

    def _moved(self, name: str, position: tuple[float, float]) -> None:
        self.world = worlds.three_modes(position[0])
        self.sample()

    def _other_steps(self, change: dict[str, Any]) -> None:
        """Stay at about the same time when the number of steps changes."""
        share = self.step.value / max(self.step.max, 1)
        with self.step.hold_trait_notifications():
            self.step.max = self.steps.value - 1
            self.step.value = round(share * self.step.max)
        self.sample()

    def sample(self, change: dict[str, Any] | None = None) -> None:
        """Run the sampler anew and draw everything."""
        choice = self.metric.value, self.noise.value, self.eta.value
        self.trace = worlds.sample(self.world, *choice, self.steps.value, self.count, self.seed)
        with self.plane.hold():
            self._draw_wish()
            self.show_step()
        self._draw_ends()

    def _draw_data(self) -> None:
        rng = np.random.default_rng(1)
        mode = rng.choice(3, size=500, p=self.world.weights)
        roots = np.linalg.cholesky(self.world.covariances)[mode]
        data = self.world.means[mode] + np.einsum("nij,nj->ni", roots, rng.normal(size=(500, 2)))
        self.plane.points("data", data, "quiet", size=2, opacity=0.35, label="data")

    def _draw_wish(self) -> None:
        x = float(self.world.y[0])
        self.plane.line("wish", [[x, -REACH], [x, REACH]], "wish", width=2, dash=True)
        self.plane.handle("y", (x, -REACH + 0.2), label="y", along="x")

    def show_step(self, change: dict[str, Any] | None = None) -> None:
        """Draw the step that the slider is at."""
        k = min(self.step.value, len(self.trace.x_t) - 1)
        x_t, x1_hat, x1, x_next = (part[k] for part in self.trace[1:])
        t, t_next = self.trace.times[k : k + 2]
        n = self.shown
        with self.plane.hold():
            self.plane.points("all", x_t, "noise", size=2, opacity=0.3)
            self.plane.line("corrected", legs(x1_hat[:n], x1[:n]), "projected", width=1.5)
            self.plane.line("carried", legs(x1[:n], x_next[:n]), "flow", width=1, dash=True)
            self.plane.points("x_t", x_t[:n], "noise", 4, 0.9, label="x_t")
            self.plane.points("x1_hat", x1_hat[:n], "prediction", 4, 0.9, label="x̂₁")
            self.plane.points("x1", x1[:n], "projected", 4, 0.9, label="x̂₁*")
            self.plane.points("x_next", x_next[:n], "flow", 4, 0.9, label="next x_t")
        self.time.value = f"{k + 1} of {len(self.trace.x_t)}: t = {t:.2f} → {t_next:.2f}"

    def _draw_ends(self) -> None:
        """The posterior as a curve, the samples as a histogram, and the distance in words."""
        ends = self.trace.x_next[-1]
        z = np.linspace(-REACH, REACH, 200)
        with self.beside.hold():
            curve = np.stack([line_density(self.world, z), z], axis=1)
            self.beside.line("samples", histogram(ends[:, 1]), "flow", 2, label="samples")
            self.beside.line("posterior", curve, "data", 2.5, label="exact posterior")
        exact = [worlds.exact_samples(self.world, self.count, seed) for seed in (1, 2)]
        weights, shares = self.world.posterior[0], worlds.shares_of_modes(self.world, ends)
        distance, floor = energy_distance(ends, exact[0]), energy_distance(exact[1], exact[0])
        self.scores = {"energy distance": distance, "floor": floor, "shares": shares}
        in_words = (" / ".join(f"{100 * s:.0f}" for s in part) for part in (shares, weights))
        self.said.value = (
            "shares of the three modes: {} %, exact {} %. Energy distance to exact samples: "
            "{:.2f}, exact against exact {:.2f}.".format(*in_words, distance, floor)
        )


def histogram(z: NDArray, bins: int = 40) -> NDArray:
    """Outline ``(2 bins, 2)`` of a histogram that grows to the right: density, z."""
    density, edges = np.histogram(z, bins, (-REACH, REACH))
    height = density / len(z) / (edges[1] - edges[0])
    return np.stack([np.repeat(height, 2), np.repeat(edges, 2)[1:-1]], axis=1)

r"""Does projection sampling draw from the posterior p(x | y)?

On data whose posterior is known. Where the data is Gaussian nothing is sampled: the law of the
sampler's output follows from a recursion (`equations.sampler_moments`), so every number in those
rows is exact. On a mixture of Gaussians samples are compared with exact samples, beside two sets
of exact samples compared with each other.

What can be shown by hand for Gaussian data, and is checked in the tests:

- A fixed share of fresh noise at every step narrows what is free, however many steps are taken:
  eq. 9 preserves the variance of noise, but what it mixes is a conditional mean, which has less.
  In the limit the variance is :math:`(1 + \sqrt{1 - \eta}) / 2` of the true one; the paper's eta
  ends at 1, hence a half. A share in proportion to the step does not narrow.
- The original noise with none fresh spreads without bound, like the cube root of the steps.
- With :math:`R_t = \mathrm{Cov}(x_1 \mid x_t)^{-1}` eq. 7 is conditioning, and with the noise that
  the *projected* endpoint implies the loop is Euler's method on the flow of p(x | y).
- With hard rows, R = I, the implied noise and none fresh, the loop comes to p(x | y) as well, with
  an error like :math:`N^{-1/3}`. With the data's own constant precision it does not.
- A constant metric uses soft rows up: each step counts the same evidence again.
"""

from __future__ import annotations

from typing import Any

from projflow_lite.studies.posterior_exact import gaussian_rows, path_rows
from projflow_lite.studies.posterior_figure import figure
from projflow_lite.studies.posterior_modes import mixture_rows
from projflow_lite.studies.posterior_words import sentences

__all__ = ["figure", "run", "sentences", "table"]

STEPS = (5, 10, 20, 50, 100, 200, 500)


def run(quick: bool = False, progress: bool = True) -> list[dict[str, Any]]:
    """Measure everything; see the module's docstring.

    Args:
        quick: fewer step counts, samples and seeds: seconds instead of minutes.
        progress: whether to show bars.

    Returns:
        One record a row. On Gaussian data scores are lists, one entry for each number of steps.
    """
    steps = (5, 20, 100) if quick else STEPS
    size = (50, 400, 3) if quick else (100, 2000, 8)
    exact = gaussian_rows(steps, progress) + path_rows(steps, progress)
    return exact + mixture_rows(*size, progress)


def table(rows: list[dict[str, Any]]) -> str:
    """The records as text, one line each, and what they say in sentences."""
    exact = [row for row in rows if row["world"] != "three modes"]
    sampled = [row for row in rows if row["world"] == "three modes"]
    head = f"{'world':6s} {'wish':16s} {'metric':9s} {'noise':9s} {'eta':8s}"
    steps = "".join(f"{count:8d}" for count in exact[0]["steps"])
    lines = [f"{head} | {'mean error, posterior standard deviations':{len(steps)}s} | spread ratio"]
    lines += [f"{'steps':52s} | {steps} | {steps}"]
    for row in exact:
        cells = f"{row['world']:6s} {row['wish']:16s} {name_of(row)}"
        for score in ("mean error", "spread"):
            cells += " | " + "".join(f"{value:8.3f}" for value in row["scores"][score])
        lines.append(cells)
    lines += ["", f"three modes, {sampled[0]['steps']} steps"]
    lines += [f"{'method':13s} {head[24:]} | energy distance  | weight misplaced | weights"]
    for row in sampled:
        cells = f"{row['method']:13s} {name_of(row)}"
        for score in ("energy distance", "weight misplaced"):
            cell = row["scores"][score]
            cells += f" | {cell['mean']:7.3f} ±{cell['half width']:7.3f}"
        cells += " | " + " ".join(f"{w:.2f}" for w in row["scores"]["weights"])
        lines.append(cells)
    return "\n".join([*lines, "", *sentences(rows)])


def name_of(row: dict[str, Any]) -> str:
    """Metric, noise and eta in columns; empty where a method has none."""
    return f"{row.get('metric', ''):9s} {row.get('noise', ''):9s} {row.get('eta', ''):8s}"

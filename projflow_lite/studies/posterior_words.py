"""What the numbers of the posterior study say, in sentences made from the numbers."""

from __future__ import annotations

from typing import Any

import numpy as np


def pick(rows: list[dict[str, Any]], **wanted: str) -> dict[str, Any]:
    """The one row with these entries.

    Raises:
        ValueError: if there is none, or more than one.
    """
    found = [row for row in rows if all(row.get(key) == value for key, value in wanted.items())]
    if len(found) != 1:
        raise ValueError(f"pick: {len(found)} rows have {wanted}; name every choice")
    return found[0]


def exponent(row: dict[str, Any], score: str) -> float:
    """By which power of the number of steps a score grows, from its last two entries."""
    (a, b), (n, m) = row["scores"][score][-2:], row["steps"][-2:]
    return float(np.log(b / a) / np.log(m / n))


def sentences(rows: list[dict[str, Any]]) -> list[str]:
    """A dozen findings, each with its numbers.

    Args:
        rows: what `posterior.run` returned.
    """
    return [*about_noise(rows), *about_metrics(rows), *about_soft_rows(rows), *about_modes(rows)]


def about_noise(rows: list[dict[str, Any]]) -> list[str]:
    """How eta and the reading of the noise change the spread, without a wish."""
    line = {"world": "line", "wish": "none"}
    euler = pick(rows, **line, noise="implied", eta="0")
    paper = pick(rows, **line, noise="implied", eta="paper")
    fresh = pick(rows, **line, noise="implied", eta="1")
    slow = pick(rows, **line, noise="implied", eta="2/steps")
    original = pick(rows, **line, noise="original", eta="0")
    printed = pick(rows, **line, noise="original", eta="paper")
    last = euler["steps"][-1]
    spread = {id(row): row["scores"]["spread"][-1] for row in (euler, paper, fresh, slow, printed)}
    low, high = min(paper["scores"]["spread"]), max(paper["scores"]["spread"])
    widths = ", ".join(
        f"{value:.2f} at {count}"
        for count, value in zip(original["steps"], original["scores"]["spread"], strict=True)
    )
    return [
        f"Without a wish, implied noise and none fresh: the spread is {spread[id(euler)]:.3f} of "
        f"the true one at {last} steps. This is Euler's method on the flow, exact in the limit.",
        f"With the paper's eta and implied noise it is {low:.2f} to {high:.2f} of the true one at "
        f"{paper['steps'][0]} to {last} steps, and with all noise fresh "
        f"{spread[id(fresh)]:.3f} at {last}: both go to {np.sqrt(0.5):.3f}, the root of a half.",
        f"With a fresh share in proportion to the step it is {spread[id(slow)]:.3f} at {last}.",
        f"The original noise with none fresh widens with every step: {widths} steps, like steps "
        f"to the power {exponent(original, 'spread'):.2f}. With the paper's eta it widens "
        f"too, from {printed['scores']['spread'][0]:.2f} at {printed['steps'][0]} steps to "
        f"{spread[id(printed)]:.2f} at {last}, and passes the right one on its way by chance.",
    ]


def about_metrics(rows: list[dict[str, Any]]) -> list[str]:
    """Which metric and noise come to the posterior under a hard wish."""
    plane = {"world": "plane", "wish": "hard", "eta": "0"}
    moving = pick(rows, **plane, metric="moving", noise="guided")
    euclid = pick(rows, **plane, metric="euclid", noise="implied")
    data = pick(rows, **plane, metric="data", noise="implied")
    opposite = pick(rows, **plane, metric="opposite", noise="implied")
    guided = pick(rows, **plane, metric="euclid", noise="guided")
    half = pick(rows, **{**plane, "eta": "paper"}, metric="moving", noise="guided")
    error = {id(r): r["scores"]["mean error"] for r in (moving, euclid, data, opposite, guided)}
    last = moving["steps"][-1]
    return [
        f"Hard wish, moving metric, guided noise, none fresh: the mean is right to rounding "
        f"({max(error[id(moving)]):.0e} standard deviations) at any number of steps, and the "
        f"spread is {moving['scores']['spread'][-1]:.3f} at {last}. On Gaussian data this is "
        f"exact in the limit; with the paper's eta the spread is "
        f"{half['scores']['spread'][-1]:.2f}.",
        f"Hard wish, Euclidean metric, implied noise, none fresh comes to the posterior too, "
        f"slowly: the mean is off by {error[id(euclid)][0]:.2f} at {euclid['steps'][0]} steps and "
        f"{error[id(euclid)][-1]:.2f} at {last}, like steps to the power "
        f"{exponent(euclid, 'mean error'):.2f}; the spread is "
        f"{euclid['scores']['spread'][-1]:.3f}. With guided noise it does not: "
        f"{error[id(guided)][-1]:.2f}.",
        f"The data's own constant precision does not: {error[id(data)][-1]:.2f} at {last} steps, "
        f"and a metric of the wrong sign {error[id(opposite)][-1]:.1f}.",
    ]


def about_soft_rows(rows: list[dict[str, Any]]) -> list[str]:
    """What many steps make of soft rows and of guides."""
    plane = {"world": "plane", "wish": "soft", "eta": "0"}
    constant = pick(rows, **plane, metric="data", noise="implied")
    moving = pick(rows, **plane, metric="moving", noise="guided")
    rowwise = constant["scores"]["spread along rows"]
    first, last = constant["steps"][0], constant["steps"][-1]
    path = {"world": "path", "metric": "euclid", "noise": "implied", "eta": "paper"}
    plain = pick(rows, **path, wish="hard")
    guides = pick(rows, **path, wish="hard and guides")
    return [
        f"Soft row, the data's precision, implied noise, none fresh: the spread along the row is "
        f"{rowwise[0]:.2f} of the right one at {first} steps and {rowwise[-1]:.0e} at {last}: the "
        f"same evidence is counted at every step, until it is hard. The moving metric with guided "
        f"noise keeps {moving['scores']['spread along rows'][-1]:.3f}.",
        f"On a path between two keyframes, Euclidean metric and the paper's eta, the spread is "
        f"{plain['scores']['spread'][-1]:.2f} of the right one at {last} steps; with guides "
        f"between the keyframes it is {guides['scores']['spread'][-1]:.2f}.",
    ]


def about_modes(rows: list[dict[str, Any]]) -> list[str]:
    """Whether the modes of a mixture get their weights."""
    modes = [row for row in rows if row["world"] == "three modes"]
    floor = pick(modes, method="exact samples")["scores"]
    flow = pick(modes, method="exact flow")["scores"]
    tried = [row for row in modes if row["method"] == "projection"]
    best = min(tried, key=lambda row: row["scores"]["energy distance"]["mean"])
    worst = max(tried, key=lambda row: row["scores"]["energy distance"]["mean"])
    gauss = pick(tried, metric="moving", noise="guided", eta="0")
    named = "Three modes: energy distance {}, share of samples in the wrong mode {}: {}."

    def say(scores: dict[str, Any], who: str) -> str:
        energy, weight = (
            f"{scores[name]['mean']:.3f} ± {scores[name]['half width']:.3f}"
            for name in ("energy distance", "weight misplaced")
        )
        return named.format(energy, weight, who)

    def choice(row: dict[str, Any]) -> str:
        return f"{row['metric']} metric, {row['noise']} noise, eta {row['eta']}"

    return [
        say(floor, "exact samples against exact samples"),
        say(flow, "Euler's method on the exact flow of the posterior"),
        say(best["scores"], f"the best of {len(tried)} choices, {choice(best)}"),
        say(gauss["scores"], f"what is exact for a Gaussian, {choice(gauss)}"),
        say(worst["scores"], f"the worst, {choice(worst)}"),
    ]

"""How much faster is the projection than other ways to solve the same equation?

Each rival solves ProjFlow eq. 7 for one motion, in float64, and gets for nothing whatever does not
change from one step to the next: factors, products with the metric, dense copies. What is timed is
what has to be done anew in every step, because the variances of the guides change:

    dense formula     equations.project, every matrix written out
    full Cholesky     factorise A R^-1 A^T + Sigma, all rows at once
    sparse direct     scipy's spsolve on the same matrix
    sparse KKT        scipy's spsolve on the metric and the rows together
    gradients         scipy's conjugate gradients, to 1e-10

All answers are compared with the projection's: see the column "apart". A rival that would take
minutes is not run where it would; its cell stays empty. The projection also takes a batch at once;
its time is then given a motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import measuring
import numpy as np
from numpy.typing import NDArray
from scipy import linalg, sparse
from scipy.sparse.linalg import cg, spsolve

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.joint_metric import kinematic_joint_metric
from projflow_lite.skeleton import EDGES, N_JOINTS

FRAMES, BATCHES = (20, 60, 196, 784), (1, 16, 64)
LARGEST_DENSE_ROWS = 4000
"""Above, factorising takes minutes and gigabytes."""

DENSE_FRAMES = {"one keyframe": 20, "five joints, a quarter of the frames": 196, "everything": 20}
"""Longest motion on which the dense formula is tried; 196 frames take minutes, once."""

BAR_CASE = ("five joints, a quarter of the frames", 196)
COLOURS = {
    "projection": "#0072B2", "dense formula": "#D55E00", "full Cholesky": "#E69F00",
    "sparse direct": "#009E73", "sparse KKT": "#CC79A7", "gradients": "#56B4E9",
}  # fmt: skip


SPARSE = ["sparse direct", "sparse KKT", "gradients"]


def rivals(case: measuring.Problem, wanted: Sequence[str]) -> dict[str, Callable[[], NDArray]]:
    """Other ways to project the first motion of a problem; matrices are written out if wanted."""
    rows, variance = case.rows, case.rows.variance
    if case.variance is not None:
        variance = case.variance[0].numpy()
    active = np.isfinite(variance)
    A, y, variance = rows.A[active], rows.y[active], variance[active]
    x = case.x1_hat[0].numpy().ravel()
    frames, R_J = case.x1_hat.shape[1], kinematic_joint_metric()
    R = over_frames(R_J, frames)
    back = (over_frames(np.linalg.inv(R_J), frames) @ A.T).tocsr()
    observed = (A @ back).tocsc()
    K = sparse.bmat([[R, A.T], [A, -sparse.diags(variance)]], format="csc")

    def covariance() -> sparse.csc_matrix:
        return observed + sparse.diags(variance, format="csc")

    def sparse_kkt() -> NDArray:
        return x + spsolve(K, np.concatenate([np.zeros(len(x)), y - A @ x]))[: len(x)]

    ways: dict[str, Callable[[], NDArray]] = {
        "sparse direct": lambda: x + back @ spsolve(covariance(), y - A @ x),
        "sparse KKT": sparse_kkt,
        "gradients": lambda: x + back @ cg(covariance(), y - A @ x, rtol=1e-10)[0],
    }
    if "full Cholesky" in wanted:
        full = observed.toarray()

        def full_cholesky() -> NDArray:
            S = full.copy()
            np.fill_diagonal(S, S.diagonal() + variance)
            factor = linalg.cho_factor(S, lower=True, overwrite_a=True)
            return x + back @ linalg.cho_solve(factor, y - A @ x)

        ways["full Cholesky"] = full_cholesky
    if "dense formula" in wanted:
        L = equations.kinematic_laplacian(EDGES, N_JOINTS)
        R_full, A_full = equations.kinematic_metric(frames, L, 10, 1), A.toarray()
        ways["dense formula"] = lambda: equations.project(x, A_full, y, R_full, np.diag(variance))
    return {way: ways[way] for way in wanted}


def over_frames(joints: NDArray, frames: int) -> sparse.csr_matrix:
    """A matrix on joints, ``(22, 22)``, as one on motions."""
    return sparse.kron(sparse.eye(frames), sparse.kron(joints, sparse.eye(3)), format="csr")


def measure(name: str, frames: int, batch: int, seconds: float, dense: bool) -> dict[str, Any]:
    """Time the projection of one problem and, for a single motion, its rivals."""
    case = measuring.problem(frames, *measuring.CASES[name], batch)
    projector = pf.Projector(case.rows, dtype=case.x1_hat.dtype)
    wanted = [*SPARSE]
    wanted += ["full Cholesky"] if len(case.rows.y) <= LARGEST_DENSE_ROWS else []
    wanted += ["dense formula"] if dense else []
    ways = rivals(case, wanted) if batch == 1 else {}
    answer = projector.project(case.x1_hat, case.variance)[0].numpy().ravel()
    runs = {"projection": lambda: projector.project(case.x1_hat, case.variance)}
    answers: dict[str, NDArray] = {}
    for way, solve in ways.items():
        runs[way] = lambda way=way, solve=solve: answers.__setitem__(way, solve())
    times = {
        way: timing.best / batch for way, timing in measuring.take_turns(runs, seconds).items()
    }
    apart = [float(np.abs(answers[way] - answer).max()) for way in ways]
    row: dict[str, Any] = {"case": name, "frames": frames, "batch": batch, "rows": len(case.rows.y)}
    row["projection, ms a motion"] = 1e3 * times["projection"]
    row |= {
        f"{way} / projection": times[way] / times["projection"] for way in COLOURS if way in ways
    }
    return row | ({"apart, m": max(apart)} if apart else {})


def bars(rows: list[dict[str, Any]]) -> list[measuring.Bar]:
    """The two ratios that were promised."""
    case = next(row for row in rows if (row["case"], row["frames"], row["batch"]) == (*BAR_CASE, 1))
    where = "196 frames, five joints in a quarter of them, guides:"
    return [
        measuring.Bar(
            f"{where} dense formula / projection", case["dense formula / projection"], 10_000, True
        ),
        measuring.Bar(
            f"{where} full Cholesky / projection", case["full Cholesky / projection"], 200, True
        ),
    ]


def draw(figure: Any, rows: list[dict[str, Any]]) -> None:
    """Time over frames, a panel for each case, a line for each way."""
    panels = figure.subplots(1, len(measuring.CASES), sharey=True)
    for axes, name in zip(panels, measuring.CASES, strict=True):
        mine = [row for row in rows if row["case"] == name and row["batch"] == 1]
        for way, colour in COLOURS.items():
            ratio = [1.0 if way == "projection" else row.get(f"{way} / projection") for row in mine]
            points = [
                (row["frames"], row["projection, ms a motion"] * r)
                for row, r in zip(mine, ratio, strict=True)
                if r is not None
            ]
            if points:
                axes.loglog(*zip(*points, strict=True), "o-", color=colour, label=way, ms=4)
        frames = [row["frames"] for row in mine]
        axes.set_xticks(frames, frames)
        axes.minorticks_off()
        axes.set_title(name, fontsize=9)
        axes.set_xlabel("frames")
        axes.grid(alpha=0.3)
    panels[0].set_ylabel("one projection of one motion, ms")
    handles, labels = panels[1].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside lower center", ncols=6, fontsize=8, frameon=False)


def main(arguments: list[str] | None = None) -> None:
    """Run everything and report it."""
    options = measuring.read_options(__doc__, arguments)
    sizes = (8, 16) if options.quick else FRAMES
    batches = (1, 4) if options.quick else BATCHES
    seconds = 0.02 if options.quick else 0.3
    rows = [
        measure(name, frames, batch, seconds, batch == 1 and frames <= DENSE_FRAMES[name])
        for name in measuring.CASES
        for frames in sizes
        for batch in batches
    ]
    measuring.report(options, __doc__, rows, [] if options.quick else bars(rows), draw)


if __name__ == "__main__":
    main()

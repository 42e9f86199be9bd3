"""How much faster the exact projection is than the dense formula, and what it adds to sampling.

Only ratios of times taken in the same run are worth comparing between machines.
"""

from __future__ import annotations

import argparse
import json
import platform
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import torch

import projflow_lite as pf
from projflow_lite import equations
from projflow_lite.skeleton import EDGES, N_JOINTS


def seconds(run: Callable[[], object], repeats: int) -> float:
    """Median time of a call, after one that is not counted."""
    run()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def against_dense(frames: int) -> dict:
    """Two joints pinned in a quarter of the frames: dense formula against `Projector`."""
    random = np.random.default_rng(0)
    keys = random.choice(frames, max(1, frames // 4), replace=False)
    rows = pf.pin(["left_wrist", "pelvis"], keys, random.normal(size=(len(keys), 2, 3))).rows(
        frames
    )
    x = torch.as_tensor(random.normal(size=(frames, N_JOINTS, 3)))
    A, Sigma = rows.A.toarray(), np.diag(rows.variance)
    R = equations.kinematic_metric(frames, equations.kinematic_laplacian(EDGES, N_JOINTS), 10, 1)
    projector = pf.Projector(rows, dtype=torch.float64)
    dense = seconds(lambda: equations.project(x.numpy().ravel(), A, rows.y, R, Sigma), 1)
    fast = seconds(lambda: projector.project(x), 30)
    build = seconds(lambda: pf.Projector(rows, dtype=torch.float64), 5)
    return {
        "frames": frames,
        "dense / project": round(dense / fast),
        "dense / (build + project)": round(dense / (fast + build), 1),
        "project, ms": round(1e3 * fast, 3),
    }


def sampling(batch: int, steps: int = 20) -> dict:
    """Sampling with a pinned wrist against sampling without a wish, at the same steps."""
    prior, path = pf.load_prior(), np.zeros((60, 3)) + [0.3, 1.2, 0.3]
    every = pf.pin("left_wrist", None, path)
    keys = pf.pin("left_wrist", [10, 30, 50], path[:3])
    free = seconds(lambda: pf.sample(prior, steps=steps, batch=batch), 3)
    return {
        "batch": batch,
        "every frame / free": round(seconds(lambda: pf.sample(prior, every, steps=steps, batch=batch), 3) / free, 3),
        "keyframes with guides / free": round(seconds(lambda: pf.sample(prior, keys, steps=steps, batch=batch), 3) / free, 3),
        "free, ms a step": round(1e3 * free / steps, 2),
    }  # fmt: skip


def main() -> None:
    """Run everything and print it."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--json", type=Path)
    parser.add_argument("--threads", type=int, default=1)
    options = parser.parse_args()
    torch.set_num_threads(options.threads)
    result = {
        "machine": f"{platform.machine()}, {platform.system()}, torch {torch.__version__}, "
        f"{options.threads} thread(s)",
        "projection": [against_dense(frames) for frames in (10, 20, 40)],
        "sampling": [sampling(batch) for batch in (1, 16)],
    }
    print(result["machine"])
    for row in result["projection"] + result["sampling"]:
        print(row)
    if options.json:
        options.json.write_text(json.dumps(result, indent=2) + "\n")


if __name__ == "__main__":
    main()

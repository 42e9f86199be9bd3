"""Files of the priors that see keyframes: one holds a whole network, one a branch alone.

A branch speaks to the inside of one network, and means nothing to another. So its file says which
prior it was trained on, and it is joined to no other.
"""

from __future__ import annotations

import json
from importlib.resources import as_file, files
from importlib.resources.abc import Traversable
from pathlib import Path

from safetensors import safe_open

from projflow_lite.prior.checkpoint import description, load_prior, pack, read, unpack, write
from projflow_lite.prior.conditioned import ControlledPrior, MaskedPrior
from projflow_lite.prior.model import Prior
from projflow_lite.skeleton import shown

MASKED = "projflow_lite masked prior 1"
BRANCH = "projflow_lite control branch 1"
PREFIX = "network.branch."


def save_masked_prior(model: MaskedPrior, path: str | Path) -> None:
    """Write a masked prior to one file, weights in half precision.

    Args:
        model: what to save.
        path: where; replaced in one step.
    """
    tensors, about = pack(model)
    about |= {"format": MASKED, "start": model.start}
    write(tensors, {"masked prior": json.dumps(about)}, path)


def load_masked_prior(path: str | Path | None = None) -> MaskedPrior:
    """Load a masked prior; without a path, the one shipped in the package.

    Raises:
        FileNotFoundError: if there is no such file; the message says how to make it.
        ValueError: if the file is damaged or is something else; the message names it.
    """
    if path is None:
        with as_file(shipped("masked", "load_masked_prior")) as file:
            return load_masked_prior(file)
    tensors, metadata = read(path)
    about = description(metadata, "masked prior", MASKED, path, "load_masked_prior")
    model: MaskedPrior = unpack(tensors, about, path, "load_masked_prior", MaskedPrior)
    model.start = str(about.get("start", ""))
    return model


def save_control_branch(model: ControlledPrior, path: str | Path) -> None:
    """Write the branch of a controlled prior, and no more, to one file in half precision.

    Args:
        model: what to save.
        path: where; replaced in one step.
    """
    tensors, about = pack(model)
    branch = {name: value for name, value in tensors.items() if name.startswith(PREFIX)}
    about = {"format": BRANCH, "start": model.start, "recipe": about["recipe"]}
    write(branch, {"control branch": json.dumps(about)}, path)


def load_control_branch(
    path: str | Path | None = None, prior: Prior | None = None
) -> ControlledPrior:
    """Load a branch and join it to its prior; without a path, the one shipped in the package.

    Args:
        path: a file written by `save_control_branch`.
        prior: what it was trained on; None for the prior shipped in the package.

    Raises:
        FileNotFoundError: if there is no such file; the message says how to make it.
        ValueError: if the file is damaged or is something else, or if the branch was trained on
            another prior; the message names the file.
    """
    if path is None:
        with as_file(shipped("control_branch", "load_control_branch")) as file:
            return load_control_branch(file, prior)
    if prior is not None and not isinstance(prior, Prior):
        raise ValueError(f"load_control_branch: prior is a Prior, not {shown(prior)}")
    tensors, metadata = read(path)
    about = description(metadata, "control branch", BRANCH, path, "load_control_branch")
    model = ControlledPrior.of(prior or load_prior())
    if about.get("start") != model.start:
        raise ValueError(
            f"load_control_branch: {path} was trained on another prior (weights "
            f"{about.get('start')}, not {model.start}); give that prior, or train a branch for "
            "this one: projflow-lite train --recipe control_branch"
        )
    try:
        branch = {name.removeprefix(PREFIX): value.float() for name, value in tensors.items()}
        model.network.branch.load_state_dict(branch)
        model.recipe = about["recipe"]
    except (KeyError, RuntimeError) as error:
        reason = shown(str(error).splitlines()[-1].strip())
        raise ValueError(
            f"load_control_branch: {path} does not fit its own description: {reason}"
        ) from error
    return model


def shipped_start(name: str) -> str | None:
    """Which prior a file of the package was made from, without loading its weights.

    Args:
        name: "masked" or "control_branch".

    Returns:
        the fingerprint of that prior's weights; None if the package has no such file.
    """
    kind = {"masked": "masked prior", "control_branch": "control branch"}[name]
    try:
        file = shipped(name, "shipped_start")
    except FileNotFoundError:
        return None
    with as_file(file) as path, safe_open(path, framework="pt") as opened:
        return str(json.loads((opened.metadata() or {}).get(kind, "{}")).get("start", ""))


def shipped(name: str, who: str) -> Traversable:
    """A file of the package.

    Raises:
        FileNotFoundError: if it is not there; the message says how to make it.
    """
    file = files("projflow_lite.prior") / f"{name}.safetensors"
    if not file.is_file():
        raise FileNotFoundError(
            f"{who}: the package has no {name}.safetensors; make one with projflow-lite train "
            f"--recipe {name}, and load it by its path, runs/{name}/prior.safetensors"
        )
    return file

"""Checkpoints without pickle: safetensors for the weights, JSON for what they mean."""

from __future__ import annotations

import hashlib
import json
import os
from importlib.resources import as_file, files
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError, safe_open
from safetensors.torch import save_file

from projflow_lite.prior.model import Prior
from projflow_lite.prior.text import Vocabulary
from projflow_lite.skeleton import shown

FORMAT = "projflow_lite prior 1"
SHIPPED = "shipped.safetensors"


def save_prior(prior: Prior, path: str | Path, dtype: torch.dtype = torch.float16) -> None:
    """Write a prior to one file, by default in half precision.

    Args:
        prior: what to save.
        path: where; replaced in one step, so that an interruption never leaves half a file.
        dtype: of the stored weights; they are used in float32.
    """
    tensors, about = pack(prior, dtype)
    # One key only: safetensors keeps several in no fixed order, and equal priors make equal files.
    write(tensors, {"prior": json.dumps({"format": FORMAT} | about)}, path)


def load_prior(path: str | Path | None = None) -> Prior:
    """Load a prior; without a path, the one shipped in the package.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if the file is damaged or is not a prior; the message names it.
    """
    if path is None:
        with as_file(files("projflow_lite.prior") / SHIPPED) as shipped:
            return load_prior(shipped)
    tensors, metadata = read(path)
    about = description(metadata, "prior", FORMAT, path, "load_prior")
    return unpack(tensors, about, path, "load_prior")


def pack(prior: Prior, dtype: torch.dtype = torch.float16) -> tuple[dict[str, Any], dict[str, Any]]:
    """Weights of a prior, by default in half precision, and what they mean."""
    tensors = {
        name: value.detach().cpu().to(torch.float32 if name == "mean" else dtype).contiguous()
        for name, value in prior.state_dict().items()
    }
    about = {
        "words": prior.vocabulary.words,
        "noise_std": prior.noise_std,
        "lengths": prior.lengths,
        "network": prior.sizes,
        "recipe": prior.recipe,
    }
    return tensors, about


def unpack(
    tensors: dict[str, torch.Tensor],
    about: dict[str, Any],
    path: str | Path,
    who: str,
    kind: type[Prior] = Prior,
) -> Any:
    """The inverse of `pack`: a prior of some kind, ready for use.

    Raises:
        ValueError: if weights and description do not fit; the message names the file.
    """
    try:
        prior = kind(
            Vocabulary(about["words"]),
            tensors["mean"],
            about["noise_std"],
            tuple(about["lengths"]),
            about["network"],
            about["recipe"],
        )
        prior.load_state_dict({name: value.float() for name, value in tensors.items()})
    except (KeyError, TypeError, ValueError, RuntimeError) as error:
        reason = shown(str(error).splitlines()[-1].strip())
        raise ValueError(f"{who}: {path} does not fit its own description: {reason}") from error
    return prior.eval().requires_grad_(False)


def fingerprint(model: torch.nn.Module) -> str:
    """Tells a model's weights from all others: eight characters."""
    parts = [tensor.cpu().numpy().tobytes() for tensor in model.state_dict().values()]
    return hashlib.sha256(b"".join(parts)).hexdigest()[:8]


def description(
    metadata: dict[str, Any], kind: str, wanted: str, path: str | Path, who: str
) -> dict[str, Any]:
    """What a file says of itself, if it is of the kind and format wanted.

    Raises:
        ValueError: if it is not; the message names the file.
    """
    try:
        about = json.loads(metadata.get(kind, "{}"))
    except ValueError:
        about = None
    if not isinstance(about, dict) or about.get("format") != wanted:
        raise ValueError(f"{who}: {path} is not a projflow_lite {kind}")
    return about


def write(tensors: dict[str, torch.Tensor], metadata: dict[str, str], path: str | Path) -> None:
    """Write tensors and text to a file that appears whole or not at all."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    half_written = path.with_name(path.name + ".part")
    save_file(tensors, half_written, metadata)
    os.replace(half_written, path)


def read(path: str | Path) -> tuple[dict[str, torch.Tensor], dict[str, Any]]:
    """Read a file written by `write`.

    Raises:
        FileNotFoundError: if there is no such file.
        ValueError: if it is damaged; the message names it.
    """
    if not isinstance(path, str | Path):
        raise ValueError(f"a checkpoint is named by its path, not by {shown(path)}")
    if not Path(path).is_file():
        raise FileNotFoundError(f"there is no checkpoint at {path}")
    try:
        with safe_open(path, framework="pt") as file:
            return {name: file.get_tensor(name) for name in file.keys()}, file.metadata() or {}  # noqa: SIM118
    except (SafetensorError, OSError, ValueError) as error:
        raise ValueError(f"{path} is damaged or is not a checkpoint ({error})") from error

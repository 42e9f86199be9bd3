r"""A prior that lives in GMD's projected space, where two numbers of the body count more.

Which numbers a frame is, and how they are projected, stands in `projflow_lite.prior.features`. What
does the projection do to a flow?
A linear map carries a whole flow along: its endpoints, its velocities and every step. White noise
in projected space is therefore nothing but noise of covariance
:math:`R^{-1} = (k^2 A^\top A)^{-1}` on features (`projflow_lite.equations.emphasis_metric`): little
of it where c is large. These two are the same model:

* one trained in projected space, with white noise;
* one trained on motions, with noise of covariance :math:`R^{-1}`, its samples projected.

So emphasis belongs to training, but only through the noise: a network must have seen the noise that
it is to remove. What a sampler may still choose is where it measures distances, and that is the
metric of its projection. We train in the second way, with the network of the plain prior, and begin
with its weights: a state is un-projected before the network sees it, and limbs are evened where
they are limbs. Only the noise has another colour.
"""

from __future__ import annotations

import json
from importlib.resources import as_file, files
from pathlib import Path

import torch
from torch import nn

from projflow_lite.prior.checkpoint import description, pack, read, unpack, write
from projflow_lite.prior.features import features_of, positions_of, spread_of_features
from projflow_lite.prior.model import Prior, Text
from projflow_lite.prior.network import CHANNELS
from projflow_lite.skeleton import N_JOINTS

FORMAT = "projflow_lite emphasised prior 1"


class EmphasisedPrior(nn.Module):
    r"""A flow on projected motions ``(batch, frames, 66)``, white noise at t = 0.

    Calling it gives the velocity in projected space: ``prior(x_t, t, text)``. What it is asked and
    what it answers are projected; `project` and `unproject` lead there and back.

    With :math:`\sigma` metres the noise on the body, and s that of the plain prior, a state
    un-projected is :math:`t\, x_1 + (1 - t)\, g\, n`, with :math:`g = \sigma / s`. Divided by
    :math:`t + (1 - t)\, g` it is one that the plain network knows, at another time t' and with
    noise n that is as loud as usual on the body.

    Args:
        plain: predicts motions from motions and such noise; no prior of its own.
        A: ``(66, 66)``, acts on features of mean 0 and variance 1.
        scale: k.
        c: the emphasis in A, for the record.
        spreads: of the place on the ground and of the body, metres, see `spreads_of`.

    Attributes:
        noise_std: 1: the noise in projected space is standard normal.
        along: True: to overwrite where the pelvis is takes the body along, see `Imputation`.
        noise: ``(22, 3)`` what it is on features, metres.
        g: noise on the body beside that of the plain prior.
    """

    noise_std = 1.0
    along = True

    def __init__(
        self,
        plain: Prior,
        A: torch.Tensor,
        scale: float,
        c: float,
        spreads: tuple[float, float],
    ) -> None:
        super().__init__()
        self.plain, self.scale, self.c = plain, float(scale), float(c)
        self.spreads = spreads
        there = self.scale * A.double().cpu() / spread_of_features(spreads)
        back = torch.linalg.inv(there)
        self.noise = back.norm(dim=1).unflatten(0, (N_JOINTS, 3))
        self.g = float(self.noise[1:].square().mean().sqrt()) / plain.noise_std
        self.A: torch.Tensor
        self.there: torch.Tensor
        self.back: torch.Tensor
        self.register_buffer("A", A.float())
        self.register_buffer("there", there, persistent=False)
        self.register_buffer("back", back, persistent=False)

    @property
    def lengths(self) -> tuple[int, int]:
        """Shortest and longest motion it was trained on, frames."""
        return self.plain.lengths

    def project(self, motion: torch.Tensor) -> torch.Tensor:
        r"""Project motions: :math:`x^{proj} = k A x`, x being features of variance 1.

        Args:
            motion: ``(..., frames, 22, 3)`` metres.

        Returns:
            ``(..., frames, 66)``.

        Raises:
            ValueError: for another shape.

        Source: GMD section 4.1 (a).
        """
        if motion.shape[-2:] != (N_JOINTS, 3):
            raise ValueError(
                f"project: expected shape (..., {N_JOINTS}, 3), got {tuple(motion.shape)}"
            )
        features = features_of(motion - self.plain.mean.to(motion))
        return features.flatten(-2) @ self.there.to(motion).mT

    def unproject(self, x_proj: torch.Tensor) -> torch.Tensor:
        r"""Undo `project`, its factor included: :math:`x = (k A)^{-1} x^{proj}`.

        Args:
            x_proj: ``(..., frames, 66)``.

        Returns:
            ``(..., frames, 22, 3)`` metres.

        Raises:
            ValueError: for another shape.

        Source: GMD section 4.1 (d).
        """
        if x_proj.shape[-1] != CHANNELS:
            raise ValueError(
                f"unproject: expected shape (..., {CHANNELS}), got {tuple(x_proj.shape)}"
            )
        return self.coloured(x_proj) + self.plain.mean.to(x_proj)

    def coloured(self, x_proj: torch.Tensor) -> torch.Tensor:
        """What a change ``(..., 66)``, or noise, is on joint positions, ``(..., 22, 3)`` metres."""
        features = x_proj @ self.back.to(x_proj).mT
        return positions_of(features.unflatten(-1, (N_JOINTS, 3)))

    def endpoint(
        self, x_t: torch.Tensor, t: float | torch.Tensor, text: Text = None
    ) -> torch.Tensor:
        r"""Predict the clean projected motion :math:`\hat x_1^{proj}`.

        Args:
            x_t: ``(batch, frames, 66)`` projected.
            t: flow time, one number or ``(batch,)``; 0 is noise, 1 is data.
            text: a prompt, one for each motion, or None.

        Raises:
            ValueError: for a shape or a length that the prior does not know.
        """
        if x_t.ndim != 3 or x_t.shape[-1] != CHANNELS:
            raise ValueError(
                f"emphasised prior: expected a projected motion (batch, frames, {CHANNELS}), "
                f"got {tuple(x_t.shape)}; see project"
            )
        t = torch.as_tensor(t, dtype=x_t.dtype, device=x_t.device).expand(len(x_t))
        size = t + (1 - t) * self.g
        shown = self.coloured(x_t) / size.view(-1, 1, 1, 1)
        at_mean = (t / size).view(-1, 1, 1, 1) * self.plain.mean.to(x_t)
        return self.project(self.plain.endpoint(shown + at_mean, t / size, text))

    def forward(
        self, x_t: torch.Tensor, t: float | torch.Tensor, text: Text = None
    ) -> torch.Tensor:
        r"""Velocity :math:`v = (\hat x_1 - x_t) / (1 - t)`, same shape as ``x_t``, for t < 1."""
        remaining = 1 - torch.as_tensor(t, dtype=x_t.dtype, device=x_t.device).view(-1, 1, 1)
        return (self.endpoint(x_t, t, text) - x_t) / remaining

    velocity = forward

    def check_frames(self, frames: int) -> None:
        """Refuse a length outside those of the training data."""
        self.plain.check_frames(frames)


def save_emphasised(prior: EmphasisedPrior, path: str | Path) -> None:
    """Write an emphasised prior to one file: weights in half precision, its random A in full.

    Args:
        prior: what to save.
        path: where; replaced in one step.
    """
    tensors, about = pack(prior.plain)
    about |= {"format": FORMAT, "scale": prior.scale, "c": prior.c, "spreads": prior.spreads}
    write(tensors | {"A": prior.A.cpu()}, {"emphasised prior": json.dumps(about)}, path)


def load_emphasised(path: str | Path | None = None, c: float = 10) -> EmphasisedPrior:
    """Load an emphasised prior; without a path, one of those shipped in the package.

    Args:
        path: a file written by `save_emphasised`.
        c: which of the shipped ones: 10 as in GMD, or 1, mixed without emphasis. A path ignores it.

    Raises:
        FileNotFoundError: if there is no such file, or none with this c is shipped.
        ValueError: if the file is damaged or something else; the message names it.
    """
    if path is None:
        with as_file(files("projflow_lite.prior") / f"emphasis_{c:g}.safetensors") as shipped:
            return load_emphasised(shipped)
    tensors, metadata = read(path)
    about = description(metadata, "emphasised prior", FORMAT, path, "load_emphasised")
    A = tensors.pop("A", torch.zeros(0))
    plain = unpack(tensors, about, path, "load_emphasised")
    if A.shape != (CHANNELS, CHANNELS) or not {"scale", "c", "spreads"} <= about.keys():
        raise ValueError(f"load_emphasised: {path} does not fit its own description: no matrix A")
    return EmphasisedPrior(plain, A, about["scale"], about["c"], tuple(about["spreads"])).eval()

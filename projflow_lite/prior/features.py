r"""A frame of a motion as GMD writes it: where the pelvis is, and the body as seen from it.

It is 66 numbers: the pelvis, and the 21 other joints as seen from it. In joint positions emphasis
would make little sense, for all 22 joints know where the body stands. As features, only the pelvis'
x and z do. They are brought to mean 0 and variance 1 by two spreads, one of the place on the ground
and one of the body, so that metres stay metres within each. The projection is GMD's,
:math:`x^{proj} = k A' B\, x`, with a weight c in B for the place, and A' random.

**A' is orthogonal here**, with rows as long as Gaussian ones have on average. Then A' drops out of
:math:`R = k^2 A^\top A`, and the noise is independent from feature to feature:
:math:`1 / (k \sqrt{66})` of the spread of the body, and c times less of the spread of the place. A
square Gaussian A' squeezes some directions almost to nothing, and they drown in noise until the
very end.

**The plain prior is emphasised already.** People walk metres and move their limbs by decimetres.
Noise that is white in metres is small beside the former and large beside the latter, see
`emphasis_in_metres`. What GMD needs an emphasis for is a representation in which every number
varies alike.
"""

from __future__ import annotations

import numpy as np
import torch
from numpy.typing import NDArray

from projflow_lite.equations.gmd_emphasis import emphasis_matrix, emphasis_scale
from projflow_lite.prior.network import CHANNELS
from projflow_lite.skeleton import N_JOINTS

EMPHASISED = (0, 2)
"""Features that count more: x and z of the pelvis, its place on the ground."""


def mixing_matrix(c: float, seed: int = 0, orthogonal: bool = True) -> tuple[NDArray, float]:
    """Draw A = A'B for the features of a body, and its factor k.

    Args:
        c: how much more the pelvis' x and z count; 1 mixes without emphasis.
        seed: of A'.
        orthogonal: whether to take the orthogonal part of a Gaussian A' for A'.

    Returns:
        A ``(66, 66)`` and k.

    Source: GMD section 4.1 (a), where A' is Gaussian.
    """
    A_prime = np.random.default_rng(seed).standard_normal((CHANNELS, CHANNELS))
    if orthogonal:
        A_prime = np.linalg.qr(A_prime)[0] * np.sqrt(CHANNELS)
    return emphasis_matrix(A_prime, EMPHASISED, c), emphasis_scale(CHANNELS, EMPHASISED, c)


def features_of(x: torch.Tensor) -> torch.Tensor:
    """The pelvis, and the other joints as seen from it; positions or changes ``(..., 22, 3)``."""
    return torch.cat([x[..., :1, :], x[..., 1:, :] - x[..., :1, :]], dim=-2)


def positions_of(features: torch.Tensor) -> torch.Tensor:
    """The inverse of `features_of`."""
    rest = features[..., 1:, :] + features[..., :1, :]
    return torch.cat([features[..., :1, :], rest], dim=-2)


def spreads_of(motions: torch.Tensor) -> tuple[float, float]:
    """Spread of the place on the ground, and of the body, metres.

    Args:
        motions: ``(clips, frames, 22, 3)``, around their mean.
    """
    variance = features_of(motions).square().mean((0, 1)).flatten()
    place = variance[list(EMPHASISED)]
    body = (variance.sum() - place.sum()) / (CHANNELS - len(EMPHASISED))
    return float(place.mean().sqrt()), float(body.sqrt())


def spread_of_features(spreads: tuple[float, float]) -> torch.Tensor:
    """The spread that each feature is divided by, ``(66,)`` metres: that of the place or body."""
    place, body = spreads
    spread = torch.full((CHANNELS,), body, dtype=torch.float64)
    spread[list(EMPHASISED)] = place
    return spread


def mixing_of_positions(A: NDArray, spreads: tuple[float, float]) -> NDArray:
    r"""What A is on joint positions: :math:`A\, S^{-1} F`, features being :math:`S^{-1} F x`.

    Its `projflow_lite.equations.emphasis_metric` is the metric of ProjFlow's projection that
    measures as projected space does.

    Args:
        A: ``(66, 66)``, see `mixing_matrix`.
        spreads: S, see `spreads_of`.

    Returns:
        ``(66, 66)``, for one frame of positions in metres, joint by joint.
    """
    F = features_of(torch.eye(CHANNELS).double().unflatten(1, (N_JOINTS, 3))).flatten(1).mT
    return A @ (F / spread_of_features(spreads).unsqueeze(1)).numpy()


def emphasis_in_metres(spreads: tuple[float, float]) -> float:
    """The c that noise amounts to which is white in metres.

    On a joint as seen from the pelvis there is the noise of both.
    """
    place, body = spreads
    return float(np.sqrt(2) * place / body)

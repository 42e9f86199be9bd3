r"""A velocity field of your own: another order of axes, another normalisation, another direction.

Models are trained on normalised motion :math:`u = (x - m) / s` and noise :math:`\mathcal N(0, I)`.
Their state :math:`u_t = (1 - t) n + t u` is, in metres, :math:`x_t = s\, u_t + t\, m`: a path from
noise :math:`\mathcal N(0, s^2)` to x. So the velocity in metres is :math:`s\, v(u_t, t) + m`, and
the projection needs no change at all: rows, metric and residual stay in the world.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import torch
from numpy.typing import ArrayLike

from projflow_lite.skeleton import N_JOINTS, number_array, shown

HERE = ("batch", "frames", "joints", "axes")


class Adapter:
    """Makes a model of another layout and normalisation a prior that `sample` takes.

    Args:
        velocity: the model, ``velocity(u_t, t, text)``, on normalised motion in its own layout.
        mean: of the data, broadcast to ``(frames, 22, 3)``, metres: a number, ``(3,)`` for each
            axis, ``(22, 3)`` for each joint and axis.
        std: the same for its standard deviation; above 0.
        layout: the order of the model's dimensions, of "batch", "frames", "joints" and "axes";
            parentheses merge some: "batch axes joints frames", "batch frames (joints axes)".
        noise_at_one: the model's time runs the other way, from data at 0 to noise at 1.

    Attributes:
        noise_std: standard deviation of the noise in metres, which `sample` draws with.

    Raises:
        ValueError: if the layout does not name each dimension once, or std is not above 0.
    """

    def __init__(
        self,
        velocity: Callable[..., torch.Tensor],
        mean: ArrayLike = 0.0,
        std: ArrayLike = 1.0,
        layout: str = "batch frames joints axes",
        noise_at_one: bool = False,
    ) -> None:
        self.velocity, self.noise_at_one = velocity, noise_at_one
        self.groups = read_layout(layout)
        self.order = [HERE.index(name) for group in self.groups for name in group]
        if not isinstance(noise_at_one, bool):
            raise ValueError(f"Adapter: noise_at_one is True or False, not {shown(noise_at_one)}")
        self.mean = torch.as_tensor(number_array(mean, "Adapter: mean"))
        self.noise_std = torch.as_tensor(number_array(std, "Adapter: std"))
        for name, value in (("mean", self.mean), ("std", self.noise_std)):
            joints, axes = (1, 1, *value.shape)[-2:]
            if joints not in (1, N_JOINTS) or axes not in (1, 3):
                raise ValueError(f"Adapter: {name} has shape {tuple(value.shape)}, not (22, 3)")
        if not (torch.isfinite(self.noise_std).all() and (self.noise_std > 0).all()):
            raise ValueError("Adapter: std is above 0 everywhere")
        if not torch.isfinite(self.mean).all():
            raise ValueError("Adapter: mean has a value that is not finite")

    def __call__(self, x_t: torch.Tensor, t: float, text: Any = None) -> torch.Tensor:
        """Velocity in metres at ``(batch, frames, 22, 3)``, same shape."""
        if not callable(self.velocity):
            raise ValueError(f"Adapter: velocity is a function, not {shown(self.velocity)}")
        mean, std = self.mean.to(x_t), self.noise_std.to(x_t)
        u_t = self.to_model((x_t - t * mean) / std)
        v = -self.velocity(u_t, 1 - t, text) if self.noise_at_one else self.velocity(u_t, t, text)
        if not isinstance(v, torch.Tensor) or v.shape != u_t.shape:
            returned = tuple(v.shape) if isinstance(v, torch.Tensor) else shown(v)
            raise ValueError(
                f"Adapter: the model returned {returned} for {tuple(u_t.shape)}; "
                "does it predict a velocity?"
            )
        return self.from_model(v, x_t.shape) * std + mean

    def to_model(self, x: torch.Tensor) -> torch.Tensor:
        """Bring ``(batch, frames, 22, 3)`` into the model's layout."""
        sizes = dict(zip(HERE, x.shape, strict=True))
        merged = [math.prod(sizes[name] for name in group) for group in self.groups]
        return x.permute(self.order).reshape(merged)

    def from_model(self, v: torch.Tensor, shape: torch.Size) -> torch.Tensor:
        """Bring the model's layout back to ``(batch, frames, 22, 3)``."""
        apart = v.reshape([shape[k] for k in self.order])
        return apart.permute([self.order.index(k) for k in range(4)])


def read_layout(layout: str) -> list[list[str]]:
    """Read "batch (joints axes) frames" as ``[[batch], [joints, axes], [frames]]``.

    Raises:
        ValueError: if it does not name each of the four dimensions once.
    """
    groups: list[list[str]] = []
    merging = False
    paired = isinstance(layout, str) and re.fullmatch(r"([^()]*\([^()]*\))*[^()]*", layout)
    if not paired:
        raise ValueError(f"Adapter: layout is a text with closed parentheses, not {shown(layout)}")
    for word in layout.replace("(", " ( ").replace(")", " ) ").split():
        if word in "()":
            merging = word == "("
            groups += [[]] * merging
        elif merging:
            groups[-1] = [*groups[-1], word]
        else:
            groups.append([word])
    if sorted(name for group in groups for name in group) != sorted(HERE):
        raise ValueError(f"Adapter: layout names {', '.join(HERE)} once each, not {layout!r}")
    return groups

r"""Two priors that were taught to see keyframes: the trained rivals of zero-shot control.

What is known of a motion is one tensor, `observed`: metres, and NaN where nothing is known. The
network gets 132 numbers a frame, 66 values (0 where unknown) and 66 marks that say which of them
are known; `marked` makes them. One layer, the *hint*, adds them to what the network makes of the
noisy motion at its door. The values are not places but distances: how far the prediction of a
network that is told nothing is from what is known (`miss_of`). What to do about a distance is
learned in minutes, what to do about a place is not. For that the network is asked twice: a step
costs the way in and the way out twice.

There are two ways to go on from the prior.

* `MaskedPrior`, as CondMDI: all weights are trained further. Known coordinates of the state lose
  their noise, and a hint is added, as if the first layer had got 132 more inputs. (CondMDI itself
  shows places.)
* `ControlledPrior`, a ControlNet: the prior's weights stay as they are. A *branch*, a copy of the
  inward half of its U-Net, gets the hint and is trained; what it sees is added to what the prior
  sees, through two layers that begin at zero.

Both learn :math:`E[x_1 \mid x_t, \text{text}, \text{observed}]`, in which known coordinates are as
observed, exactly. A trained network comes near to that, no more; ProjFlow's projection needs no
training and has no error, but knows nothing of what bodies do around a keyframe.

Source: ControlNet (Zhang, Rao, Agrawala, 2023), for motion in OmniControl (Xie et al., 2024);
CondMDI (Cohan et al., 2024).
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import deepcopy
from typing import Any, Self

import torch
from torch import nn
from torch.func import functional_call
from torch.nn import functional

from projflow_lite.prior.checkpoint import fingerprint
from projflow_lite.prior.model import Prior, Text
from projflow_lite.prior.network import CHANNELS, Inward, Network

LOUD = 8.0
"""By which values and marks are multiplied: a few coordinates have to be heard among thousands."""


def marked(values: torch.Tensor) -> torch.Tensor:
    """Known values and marks as channels over time: ``(batch, 132, frames)``.

    Args:
        values: ``(batch, frames, 22, 3)``, NaN where nothing is known.
    """
    known = ~values.isnan()
    both = LOUD * torch.cat([values.nan_to_num(0.0), known.to(values)], dim=2).flatten(2)
    # Frames that are there only because two halvings need them know nothing.
    return functional.pad(both.mT, (0, -values.shape[1] % 4))


def miss_of(observed: torch.Tensor, plain: torch.Tensor, t: torch.Tensor) -> torch.Tensor:
    """How far a prediction is from what is known, NaN where nothing is.

    Over about what predictions miss at this time: so it has one scale.
    """
    return (observed - plain) / (1.05 - t).view(-1, 1, 1, 1)


def zeroed(layer: nn.Conv1d) -> nn.Conv1d:
    """The layer with all weights 0: it learns, but until then it says nothing."""
    for weight in layer.parameters():
        nn.init.zeros_(weight)
    return layer


def hint_layer(width: int) -> nn.Conv1d:
    """From 132 channels to features at half frame rate; it says nothing where nothing is known.

    It begins with random weights, loud enough to be read by all that learns behind it. Those of a
    masked prior that began at zero, shown places, were ignored after 3000 steps as before.
    """
    layer = nn.Conv1d(2 * CHANNELS, width, 4, 2, 1, bias=False)
    nn.init.normal_(layer.weight, std=0.1)
    return layer


class MaskedNetwork(Network):
    """The prior's network with more inputs; see `Network` for the arguments."""

    def __init__(self, words: int, *sizes: Any, **named: Any) -> None:
        super().__init__(words, *sizes, **named)
        self.hint = hint_layer(self.enter.out_channels)

    def forward(
        self,
        x: torch.Tensor,
        t: torch.Tensor,
        ids: torch.Tensor,
        observed: torch.Tensor | None = None,
    ) -> torch.Tensor:
        """Predict the clean motion, see `Network.forward`.

        Args:
            x: ``(batch, frames, 22, 3)`` noisy motion, centred and scaled.
            t: ``(batch,)`` flow time in 0..1.
            ids: ``(batch, words)`` word numbers.
            observed: ``(batch, frames, 22, 3)`` clean motion, centred and scaled, NaN where nothing
                is known; None knows nothing.
        """
        if observed is None:
            return super().forward(x, t, ids)
        with torch.autocast(x.device.type, enabled=False):
            hint = self.hint(marked(miss_of(observed, self.untold(x, t, ids), t)))
        x = torch.where(observed.isnan(), x, t.view(-1, 1, 1, 1) * observed)  # without noise
        seen, condition = self.look(x), self.told(t, ids)
        half, quarter = self.inward(seen, condition, hint)
        return self.outward(half, quarter, seen, condition, t, x.shape[1])

    def untold(self, x: torch.Tensor, t: torch.Tensor, ids: torch.Tensor) -> torch.Tensor:
        """What it predicts when told nothing. Training learns nothing from this first look."""
        fixed = {name: weight.detach() for name, weight in self.named_parameters()}
        plain: torch.Tensor = functional_call(self, fixed, (x, t, ids))
        return plain


class Branch(Inward):
    """A copy of a network's inward half that also sees what is known, joined by zero layers.

    Args:
        network: what is copied, weights and all.
    """

    def __init__(self, network: Network) -> None:
        super().__init__()
        for name in Inward.__annotations__:
            setattr(self, name, deepcopy(getattr(network, name)))
        a, b = self.enter.out_channels, self.to_quarter.out_channels
        self.hint = hint_layer(a)
        self.join_half = zeroed(nn.Conv1d(a, a, 1))
        self.join_quarter = zeroed(nn.Conv1d(b, b, 1))

    def forward(
        self, seen: torch.Tensor, condition: torch.Tensor, miss: torch.Tensor | None
    ) -> tuple[torch.Tensor, torch.Tensor]:
        """What to add to the network's own features at half and at quarter frame rate.

        Args:
            seen, condition: see `Inward.inward`.
            miss: ``(batch, frames, 22, 3)``, NaN where nothing is known; None knows nothing.
        """
        with torch.autocast(seen.device.type, enabled=False):
            hint = None if miss is None else self.hint(marked(miss))
        half, quarter = self.inward(seen, condition, hint)
        return self.join_half(half), self.join_quarter(quarter)


class ControlledNetwork(Network):
    """The prior's network and its branch; see `Network` for the arguments."""

    def __init__(self, words: int, *sizes: Any, **named: Any) -> None:
        super().__init__(words, *sizes, **named)
        self.branch = Branch(self)

    def forward(
        self,
        x: torch.Tensor,
        t: torch.Tensor,
        ids: torch.Tensor,
        observed: torch.Tensor | None = None,
    ) -> torch.Tensor:
        """Predict the clean motion; arguments as of `MaskedNetwork.forward`."""
        seen, condition = self.look(x), self.told(t, ids)
        half, quarter = self.inward(seen, condition)
        miss = None
        if observed is not None:
            plain = self.outward(half, quarter, seen, condition, t, x.shape[1])
            miss = miss_of(observed, plain, t)
        more_half, more_quarter = self.branch(seen, condition, miss)
        half, quarter = half + more_half, quarter + more_quarter
        return self.outward(half, quarter, seen, condition, t, x.shape[1])


class ConditionedPrior(Prior):
    """A prior that is told what is known of the motion: ``prior(x_t, t, text, observed)``.

    Without `observed` it is a prior like any other, and any sampler takes it.

    Attributes:
        trained_for: the method of `sample` that tells it.
        start: `fingerprint` of the prior that it was made from.
    """

    trained_for = ""
    start = ""

    @classmethod
    def of(cls, prior: Prior) -> Self:
        """A model that begins with a prior's weights; told nothing, it gives the same answers."""
        new = cls(
            prior.vocabulary,
            prior.mean,
            prior.noise_std,
            prior.lengths,
            prior.sizes,
            prior.recipe,
        )
        new.network.load_state_dict(prior.network.state_dict(), strict=False)
        new.start = fingerprint(prior)
        return new.eval().requires_grad_(False)

    def learning(self) -> Iterator[nn.Parameter]:
        """The weights that training may change."""
        return self.network.parameters()

    def endpoint(
        self,
        x_t: torch.Tensor,
        t: float | torch.Tensor,
        text: Text = None,
        observed: torch.Tensor | None = None,
    ) -> torch.Tensor:
        r"""Predict the clean motion :math:`\hat x_1` from a noisy one and what is known of it.

        Args:
            x_t: ``(batch, frames, 22, 3)`` metres.
            t: flow time, one number or ``(batch,)``; 0 is noise, 1 is data.
            text: a prompt, one for each motion, or None.
            observed: ``(frames, 22, 3)`` metres, or one for each motion, NaN where nothing is
                known; None knows nothing. With fewer than motions they are repeated in turn.

        Raises:
            ValueError: for a shape or a length that the prior does not know.
        """
        if observed is None:
            return self.asked(x_t, t, text)
        return self.asked(x_t, t, text, self.scaled(observed, x_t))

    def forward(
        self,
        x_t: torch.Tensor,
        t: float | torch.Tensor,
        text: Text = None,
        observed: torch.Tensor | None = None,
    ) -> torch.Tensor:
        r"""Velocity :math:`v = (\hat x_1 - x_t) / (1 - t)`, same shape as ``x_t``, for t < 1."""
        remaining = 1 - torch.as_tensor(t, dtype=x_t.dtype, device=x_t.device).view(-1, 1, 1, 1)
        return (self.endpoint(x_t, t, text, observed) - x_t) / remaining

    velocity = forward

    def scaled(self, observed: torch.Tensor, x_t: torch.Tensor) -> torch.Tensor:
        """What is known as the network wants it: centred, scaled, one for each motion."""
        each = observed if observed.ndim == 4 else observed[None]
        if each.shape[1:] != x_t.shape[1:] or not len(each) or len(x_t) % len(each):
            raise ValueError(
                f"prior: what is known of motions of shape {tuple(x_t.shape)} has the shape "
                f"{tuple(x_t.shape[1:])}, or one for each motion, not {tuple(observed.shape)}"
            )
        each = each.to(self.mean).repeat(len(x_t) // len(each), 1, 1, 1)
        return (each - self.mean) / self.noise_std


class MaskedPrior(ConditionedPrior):
    """A prior whose own network was trained to see what is known, as CondMDI's."""

    network_type = MaskedNetwork
    trained_for = "condmdi"


class ControlledPrior(ConditionedPrior):
    """A prior with frozen weights, and a branch beside it that was trained to control it."""

    network_type = ControlledNetwork
    network: ControlledNetwork
    trained_for = "control_branch"

    @classmethod
    def of(cls, prior: Prior) -> Self:
        """A prior with a branch that copies it and says nothing yet, whatever it is told."""
        new = super().of(prior)
        new.network.branch = Branch(new.network)
        return new

    def learning(self) -> Iterator[nn.Parameter]:
        """The weights of the branch."""
        return self.network.branch.parameters()

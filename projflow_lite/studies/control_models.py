"""The models that trained rivals bring to the study of control, or what is said without them.

A trained rival is compared on the prior that it was made from, or not at all.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

from projflow_lite.prior import Prior
from projflow_lite.prior.conditioned import ConditionedPrior
from projflow_lite.prior.conditioned_files import (
    load_control_branch,
    load_masked_prior,
    shipped_start,
)
from projflow_lite.samplers.projflow import Velocity
from projflow_lite.studies.cells import Rival, fingerprint
from projflow_lite.studies.control_ways import elsewhere

Models = Mapping[str, ConditionedPrior]

LOADERS: dict[str, Callable[[Prior], ConditionedPrior]] = {
    "control_branch": lambda prior: load_control_branch(prior=prior),
    "masked": lambda prior: load_masked_prior(),
}
"""How the shipped models are loaded, by the name of the recipe that makes them."""

MISSING, ELSEWHERE = "is not in the package", "was trained from another prior"


class Field(NamedTuple):
    """The rivals of a run, and the flow that each of them asks.

    Attributes:
        rivals: those whose models are there; trained ones are named by their weights too, so that
            results of other weights lie apart.
        velocities: by the model of a rival; of the prior under "".
        absent: why a rival is left out, by its name and its model's.
    """

    rivals: tuple[Rival, ...]
    velocities: dict[str, Velocity]
    absent: dict[tuple[str, str], str]

    def velocity(self, rival: Rival) -> Velocity:
        """The flow that a rival asks."""
        return self.velocities[rival.model]


def field_of(
    prior: Prior, rivals: Sequence[Rival], device: str, models: Models | None = None
) -> Field:
    """Find every rival's model.

    Args:
        prior: what rivals without a model of their own share.
        rivals: who is to be compared.
        device: where networks are computed.
        models: by name; None for those in the package.
    """
    present: list[Rival] = []
    velocities, absent = {"": elsewhere(prior, device)}, {}
    own = fingerprint(prior)
    for rival in rivals:
        model: ConditionedPrior | str | None = None
        if rival.model:
            model = found(rival.model, prior, own, models)
            if isinstance(model, str):
                absent[rival.name, rival.model] = model
                continue
            rival = rival._replace(model=f"{rival.model}-{fingerprint(model)}")
            velocities[rival.model] = elsewhere(model, device)
        present.append(rival)
    return Field(tuple(present), velocities, absent)


def found(name: str, prior: Prior, own: str, models: Models | None) -> ConditionedPrior | str:
    """A model that was made from this prior, or why there is none."""
    try:
        model = LOADERS[name](prior) if models is None else models[name]
    except (FileNotFoundError, KeyError):
        return MISSING
    except ValueError as error:
        if "another prior" in str(error):
            return ELSEWHERE
        raise
    return model if model.start == own else ELSEWHERE


def absent_of(prior: Velocity, rivals: Sequence[Rival]) -> dict[tuple[str, str], str]:
    """Why shipped models are of no use with a prior, by rival and model; nothing is loaded."""
    own = fingerprint(prior) if isinstance(prior, Prior) else ""
    absent = {}
    for rival in rivals:
        start = shipped_start(rival.model) if rival.model else own
        if start != own:
            absent[rival.name, rival.model] = MISSING if start is None else ELSEWHERE
    return absent


def said_of(absent: Mapping[tuple[str, str], str]) -> str | None:
    """One sentence on the rivals that are left out, or None."""
    if not absent:
        return None
    parts = [f"{name}, whose model {why}" for (name, _), why in absent.items()]
    recipes = " and ".join(dict.fromkeys(recipe for _, recipe in absent))
    return (
        f"Left out: {'; '.join(parts)}; projflow-lite train --recipe makes {recipes} from the "
        "shipped prior."
    )

"""A prior for tests of studies: quick, and of no quality at all."""

import torch

from data_synth import held_out
from projflow_lite.prior import Prior
from projflow_lite.prior.text import Vocabulary


def small_prior(seed=0):
    """A network that has learnt nothing, but where joints usually are."""
    torch.manual_seed(seed)
    clips = held_out(680, 60, 1)
    mean = torch.from_numpy(clips.positions.mean((0, 1)))
    sizes = {"widths": (8, 8), "condition": 16}
    return Prior(Vocabulary.of(clips.captions), mean, 0.76, (20, 196), sizes)

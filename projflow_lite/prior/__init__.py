"""The tiny flow: network, prompts, training and checkpoint."""

from projflow_lite.prior.checkpoint import load_prior, save_prior
from projflow_lite.prior.model import Prior

__all__ = ["Prior", "load_prior", "save_prior"]

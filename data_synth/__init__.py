"""Synthetic human motion by rotations and inverse kinematics: thousands of clips in seconds."""

from data_synth.dataset import ACTIONS, Clips, held_out, make_clips, stream

__all__ = ["ACTIONS", "Clips", "held_out", "make_clips", "stream"]

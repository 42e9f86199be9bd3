"""Synthetic human motion by rotations and inverse kinematics: thousands of clips in seconds."""

from data_synth.dataset import ACTIONS, Clips, make_clips

__all__ = ["ACTIONS", "Clips", "make_clips"]

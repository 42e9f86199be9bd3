"""Clips by the thousand: the same seed gives the same clips."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from itertools import count
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from data_synth.actions import MAKERS
from data_synth.body import assemble, sample_bones
from data_synth.captions import caption

ACTIONS: tuple[str, ...] = tuple(MAKERS)
SHORTEST, LONGEST = 20, 196
ROUNDS = 10
"""Held-out clips are made ten of each action at a time: a small set begins every larger one."""


class Clips(NamedTuple):
    """A set of clips of one length.

    Attributes:
        positions: ``(n, frames, 22, 3)`` float32, metres; the pelvis is over the origin and faces
            +z in frame 0, the floor is at y = 0.
        captions: a sentence for each clip.
        actions: the name of each clip's action.
        parameters: what was drawn, ``(n,)`` each; NaN where an action has no such parameter.
    """

    positions: NDArray[np.float32]
    captions: list[str]
    actions: list[str]
    parameters: dict[str, NDArray[np.float64]]


def make_clips(
    n: int, frames: int = 60, seed: int = 0, actions: Sequence[str] | None = None
) -> Clips:
    """Make `n` clips of synthetic motion at 20 frames a second.

    Args:
        n: how many.
        frames: length of each, 20 to 196.
        seed: from 0 to 2^63 - 1; the same seed, and the same other arguments, give the same clips.
        actions: names of `ACTIONS`; by default all. Each comes equally often, in random order.

    Raises:
        ValueError: for an unknown action, a length or a seed out of range, or fewer than one clip.
    """
    names = check(n, frames, actions)
    random = np.random.default_rng(check_seed("make_clips", seed))
    return drawn_with(random, shuffled(random, n, names), frames, names)


def stream(
    batch: int,
    frames: int = 60,
    seed: int = 0,
    actions: Sequence[str] | None = None,
    first: int = 0,
) -> Iterator[Clips]:
    """Batches of fresh clips without end, for training: no clip comes twice.

    Args:
        batch: how many clips at a time.
        frames: length of each, 20 to 196.
        seed: from 0 to 2^63 - 1; the same seed gives the same stream.
        actions: names of `ACTIONS`; by default all.
        first: number of the batch to begin with, to resume a stream.

    Raises:
        ValueError: as `make_clips` does.
    """
    names = check(batch, frames, actions)
    seed = check_seed("stream", seed)
    generators = (np.random.default_rng([seed, number]) for number in count(first))
    return (drawn_with(r, shuffled(r, batch, names), frames, names) for r in generators)


def held_out(
    n: int, frames: int = 60, seed: int = 0, actions: Sequence[str] | None = None
) -> Clips:
    """The clips to evaluate on: always the same, and out of reach of every training seed.

    A generator of `make_clips` or `stream` starts from one or two numbers. These start from a
    spawned sequence, which no numbers, however large, lead to.

    Args:
        n: how many; fewer clips are the first of more. Each action comes equally often, give or
            take one.
        frames: length of each, 20 to 196.
        seed: from 0 to 2^63 - 1; another seed gives other clips, none of them for training either.
        actions: names of `ACTIONS`; by default all.

    Raises:
        ValueError: as `make_clips` does.
    """
    names = check(n, frames, actions)
    seed = check_seed("held_out", seed)
    blocks = [held_out_block(seed, k, frames, names) for k in range(-(-n // (ROUNDS * len(names))))]
    keys = dict.fromkeys(key for block in blocks for key in block.parameters)
    missing = np.full(ROUNDS * len(names), np.nan)
    return Clips(
        np.concatenate([block.positions for block in blocks])[:n],
        [caption for block in blocks for caption in block.captions][:n],
        [action for block in blocks for action in block.actions][:n],
        {
            key: np.concatenate([block.parameters.get(key, missing) for block in blocks])[:n]
            for key in keys
        },
    )


def held_out_block(seed: int, number: int, frames: int, names: list[str]) -> Clips:
    """Some rounds of held-out clips; each round has every action once."""
    # The length is part of the key: one seed would draw the same captions for every length.
    random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(frames, number)))
    order = np.concatenate([random.permutation(len(names)) for _ in range(ROUNDS)])
    return drawn_with(random, order, frames, names)


def shuffled(random: np.random.Generator, n: int, names: list[str]) -> NDArray[np.int64]:
    """Numbers of `n` actions, each equally often, in random order."""
    return random.permutation(np.arange(n) % len(names))


def drawn_with(
    random: np.random.Generator, order: NDArray[np.int64], frames: int, names: list[str]
) -> Clips:
    """Make clips with the numbers of one generator; `order` ``(n,)`` says which action each is."""
    n = len(order)
    positions = np.zeros((n, frames, 22, 3), dtype=np.float32)
    captions, done = [""] * n, [names[k] for k in order]
    parameters: dict[str, NDArray] = {}
    for k, name in enumerate(names):
        members = np.flatnonzero(order == k)
        if len(members) == 0:
            continue
        bones = sample_bones(random, len(members))
        pose, drawn = MAKERS[name](random, len(members), frames, bones)
        x = assemble(pose, bones)
        x[..., [0, 2]] -= x[:, :1, :1, [0, 2]]
        positions[members] = x
        for key, values in drawn.items():
            parameters.setdefault(key, np.full(n, np.nan))[members] = values
        for place, clip in enumerate(members):
            own = {key: float(values[place]) for key, values in drawn.items()}
            captions[clip] = caption(name, own, random)
    return Clips(positions, captions, done, parameters)


def is_whole(number: object) -> bool:
    """Whether it is a whole number; True and False are none."""
    return isinstance(number, int | np.integer) and not isinstance(number, bool)


def check_seed(where: str, seed: int) -> int:
    """Refuse seeds that belong to the held-out clips, or that are none."""
    if not is_whole(seed) or not 0 <= seed < 2**63:
        raise ValueError(f"{where}: seed is a whole number from 0 to 2^63 - 1, not {seed!r}")
    return int(seed)


def check(n: int, frames: int, actions: Sequence[str] | None) -> list[str]:
    """Refuse what cannot be made; return the names of the actions."""
    if not is_whole(n) or n < 1:
        raise ValueError(f"make_clips: n is a whole number of at least 1, not {n!r}")
    if not is_whole(frames) or not SHORTEST <= frames <= LONGEST:
        raise ValueError(f"make_clips: frames is {SHORTEST} to {LONGEST}, not {frames!r}")
    names = (
        list(ACTIONS)
        if actions is None
        else [actions]
        if isinstance(actions, str)
        else list(actions)
    )
    for name in names:
        if name not in ACTIONS:
            near = get_close_matches(str(name), ACTIONS, n=1)
            hint = f"did you mean '{near[0]}'?" if near else f"the actions are {', '.join(ACTIONS)}"
            raise ValueError(f"make_clips: '{name}' is not an action; {hint}")
    if not names:
        raise ValueError("make_clips: actions is an empty list")
    return names

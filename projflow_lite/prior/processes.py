"""Several processes teach one network: each answers for its part of every batch.

Torch's own launcher starts them and tells each who it is::

    torchrun --nproc-per-node=2 -m projflow_lite train --recipe classroom

The batch of the recipe is split, not multiplied. Every process makes the same clips, flow times and
noise, computes the loss of its own part, and the gradients are averaged. As the parts are equally
large, the mean of their means is the mean of the batch: the number of processes changes nothing but
the rounding, and a run may go on with another number. With a GPU for each process they use the
GPUs, otherwise the processor.
"""

from __future__ import annotations

import atexit
import os
from collections.abc import Iterable
from dataclasses import dataclass

import torch
from torch import distributed

CPU = torch.device("cpu")


@dataclass(frozen=True)
class Processes:
    """The processes of a run, as one of them sees them; by default it is alone.

    Attributes:
        rank: number of this process, from 0.
        count: how many there are.
        device: where this one computes.
    """

    rank: int = 0
    count: int = 1
    device: torch.device = CPU

    @property
    def first(self) -> bool:
        """Whether this is the process that writes the files and talks to the reader."""
        return self.rank == 0

    def part(self, batch: int) -> slice:
        """The motions of a batch that this process answers for.

        Raises:
            ValueError: if the batch has no such number of equal parts.
        """
        size, rest = divmod(batch, self.count)
        if rest or not size:
            raise ValueError(
                f"train: a batch of {batch} has no {self.count} equal parts; "
                "choose another number of processes"
            )
        return slice(self.rank * size, (self.rank + 1) * size)

    @torch.no_grad()
    def average(self, tensors: Iterable[torch.Tensor]) -> None:
        """Replace tensors by their mean over all processes, in one message."""
        if self.count == 1:
            return
        tensors = list(tensors)
        together = torch.cat([tensor.flatten().float() for tensor in tensors])
        distributed.all_reduce(together)
        parts = (together / self.count).split([tensor.numel() for tensor in tensors])
        for tensor, mean in zip(tensors, parts, strict=True):
            tensor.copy_(mean.view_as(tensor))

    def wait(self) -> None:
        """Go on only when all processes are here."""
        if self.count > 1:
            distributed.barrier()


def join() -> Processes:
    """Find the other processes of this run, if torchrun started any."""
    rank, count, here, neighbours = (
        int(os.environ.get(name, alone))
        for name, alone in (
            ("RANK", 0),
            ("WORLD_SIZE", 1),
            ("LOCAL_RANK", 0),
            ("LOCAL_WORLD_SIZE", 1),
        )
    )
    enough = torch.cuda.is_available() and torch.cuda.device_count() >= neighbours
    device = torch.device("cuda", here) if enough else CPU
    if enough:
        torch.cuda.set_device(device)
    if count > 1 and not distributed.is_initialized():
        distributed.init_process_group("nccl" if enough else "gloo")
        atexit.register(distributed.destroy_process_group)
    return Processes(rank, count, device)

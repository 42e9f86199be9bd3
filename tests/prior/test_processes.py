"""Two processes teach one network, and it learns what one process would have taught it."""

import json
import os
import signal
import subprocess
import sys
import time
from dataclasses import replace

import pytest
import torch
from safetensors.torch import load_file

import projflow_lite as pf
from projflow_lite.prior.processes import Processes
from projflow_lite.prior.training import RECIPES, Trainer, begin, train

SMOKE = RECIPES["smoke"]
WORKER = """
import json, sys
from pathlib import Path
from dataclasses import replace
import torch
from projflow_lite.prior import training
from projflow_lite.prior.processes import join
from safetensors.torch import save_file

out, here = Path(sys.argv[1]), join()
values = [torch.full((2, 3), here.rank + 1.0), torch.tensor(10.0 * here.rank)]
here.average(values)

trainer = training.Trainer(training.RECIPES["smoke"], here)
loss = trainer.advance()
grads = {k: w.grad for k, w in trainer.network.named_parameters()}
save_file(grads, out / f"grads{here.rank}.safetensors")

written = []
write = training.write
training.write = lambda *given: (written.append(str(given[2])), write(*given))
training.train(replace(training.RECIPES["smoke"], steps=3), out / "run", progress=False)
said = {"average": [v.tolist() for v in values], "loss": loss, "written": written,
        "world": [here.rank, here.count]}
(out / f"said{here.rank}.json").write_text(json.dumps(said))
"""
ENVIRONMENT = os.environ | {"OMP_NUM_THREADS": "1"}


def torchrun(*arguments, processes=2):
    """Start a command the way the documentation says; return the launcher."""
    launch = [sys.executable, "-m", "torch.distributed.run", "--standalone"]
    return subprocess.Popen(
        [*launch, f"--nproc-per-node={processes}", *map(str, arguments)],
        env=ENVIRONMENT,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def finished(launcher, seconds=300):
    output, _ = launcher.communicate(timeout=seconds)
    assert launcher.returncode == 0, output
    return output


def weights(prior):
    return torch.cat([w.flatten() for w in prior.network.parameters()])


@pytest.fixture(scope="module")
def worked(tmp_path_factory):
    """What two processes that ran `WORKER` left."""
    folder = tmp_path_factory.mktemp("workers")
    (folder / "worker.py").write_text(WORKER)
    finished(torchrun(folder / "worker.py", folder))
    return folder, [json.loads((folder / f"said{rank}.json").read_text()) for rank in (0, 1)]


@pytest.fixture(scope="module")
def whole():
    """A trainer that has made its first step with the whole batch, and the loss."""
    trainer = Trainer(SMOKE)
    return trainer, trainer.advance()


@pytest.fixture(scope="module")
def alone(tmp_path_factory):
    """A run of one process: its folder and its prior."""
    folder = tmp_path_factory.mktemp("alone")
    return folder, train(replace(SMOKE, steps=100), folder, progress=False)


def test_parts_are_equal_and_make_up_the_batch():
    parts = [Processes(rank, 3).part(12) for rank in range(3)]
    assert [list(range(12))[part] for part in parts] == [
        [0, 1, 2, 3],
        [4, 5, 6, 7],
        [8, 9, 10, 11],
    ]


@pytest.mark.parametrize(("count", "batch"), [(3, 8), (16, 8)])
def test_a_batch_that_does_not_divide_is_refused_before_anything_is_written(
    count, batch, tmp_path, monkeypatch
):
    monkeypatch.setattr("projflow_lite.prior.training.join", lambda: Processes(rank=0, count=count))
    with pytest.raises(ValueError, match=f"a batch of {batch} has no {count} equal parts; choose"):
        begin(SMOKE, tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_two_processes_find_each_other_and_average(worked):
    for rank, said in enumerate(worked[1]):
        assert said["world"] == [rank, 2]
        assert said["average"] == [[[1.5] * 3] * 2, 5.0]


def test_the_averaged_gradient_is_that_of_the_whole_batch(worked, whole):
    folder, said = worked
    trainer, loss = whole
    for rank in (0, 1):
        assert said[rank]["loss"] == pytest.approx(loss, rel=1e-5)
        grads = load_file(folder / f"grads{rank}.safetensors")
        for name, weight in trainer.network.named_parameters():
            torch.testing.assert_close(grads[name], weight.grad, rtol=1e-3, atol=1e-6)


def test_half_of_the_batch_alone_would_have_another_gradient(whole):
    """The test above could fail: the parts differ."""
    half = Trainer(SMOKE)
    half.part, half.chunk = slice(0, 4), whole[0].chunk
    assert abs(half.advance() - whole[1]) > 0.01
    one, other = (trainer.network.enter.weight.grad for trainer in (half, whole[0]))
    assert (one - other).norm() > 0.1 * other.norm()


def test_only_the_first_process_writes(worked):
    folder, (first, second) = worked
    assert first["written"]
    assert set(first["written"]) <= {str(folder / "run" / "run.safetensors")}
    assert second["written"] == []
    assert (folder / "run" / "prior.safetensors").exists()


def test_the_loss_curve_does_not_depend_on_the_number_of_processes(alone, tmp_path):
    command = ["-m", "projflow_lite", "train", "--recipe", "smoke", "--steps", "100"]
    finished(torchrun(*command, "--out", tmp_path))
    logs = [(folder / "loss.jsonl").read_text().splitlines() for folder in (alone[0], tmp_path)]
    one, two = ([json.loads(line) for line in log] for log in logs)
    assert [line["step"] for line in two] == [50, 100]
    assert [line["loss"] for line in two] == pytest.approx([line["loss"] for line in one], rel=1e-3)
    difference = weights(pf.load_prior(tmp_path / "prior.safetensors")) - weights(alone[1])
    moved = weights(Trainer(SMOKE).result()) - weights(alone[1])
    assert difference.norm() < 0.01 * moved.norm()


def test_terminated_processes_go_on_as_one(alone, tmp_path):
    """Stop two processes from outside, go on with one: the same curve as without a break."""
    command = ["-m", "projflow_lite", "train", "--recipe", "smoke", "--steps", "100"]
    launcher = torchrun(*command, "--out", tmp_path)
    while launcher.poll() is None and not (tmp_path / "loss.jsonl").exists():
        time.sleep(0.01)
    launcher.send_signal(signal.SIGTERM)
    launcher.communicate(timeout=120)
    assert not (tmp_path / "prior.safetensors").exists()
    trainer = begin(replace(SMOKE, steps=100), tmp_path)
    assert 50 <= trainer.step < 100
    train(replace(SMOKE, steps=100), tmp_path, progress=False)
    one, two = (
        [json.loads(line)["loss"] for line in (folder / "loss.jsonl").read_text().splitlines()]
        for folder in (alone[0], tmp_path)
    )
    assert two == pytest.approx(one, rel=1e-3)

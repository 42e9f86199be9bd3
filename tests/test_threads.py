"""The choice of threads, on work whose time is known."""

import time

import pytest
import torch

from projflow_lite.threads import choose, convolutions, fastest_threads, use_fastest_threads


@pytest.fixture(autouse=True)
def same_threads_afterwards():
    before = torch.get_num_threads()
    yield
    torch.set_num_threads(before)


def wait(seconds):
    """Work that takes a known time for every number of threads."""
    return lambda: time.sleep(seconds[torch.get_num_threads()])


@pytest.mark.parametrize(
    ("seconds", "fastest"),
    [
        ({1: 10.0, 2: 5.5, 4: 3.0}, 4),
        ({1: 10.0, 2: 5.5, 4: 5.0}, 2),  # a tenth is not worth two more processors
        ({1: 10.0, 2: 60.0, 4: 90.0}, 1),
        ({1: 10.0, 2: 9.5, 4: 4.0}, 4),
        ({1: 10.0}, 1),
    ],
)
def test_more_threads_must_be_clearly_faster(seconds, fastest):
    assert choose(seconds) == fastest


def test_the_fastest_number_is_found_and_the_setting_is_left_alone():
    torch.set_num_threads(1)
    assert fastest_threads(wait({1: 0.02, 2: 0.002}), most=2) == 2
    assert fastest_threads(wait({1: 0.002, 2: 0.02}), most=2) == 1
    assert torch.get_num_threads() == 1


def test_slow_work_is_not_tried_for_long():
    calls = []
    fastest_threads(lambda: calls.append(time.sleep(0.02)), most=2, turns=50, longest=0.05)
    assert len(calls) <= 8


def test_a_failure_leaves_the_setting_alone():
    torch.set_num_threads(1)

    def fail():
        raise RuntimeError("no")

    with pytest.raises(RuntimeError, match="no"):
        fastest_threads(fail, most=2)
    assert torch.get_num_threads() == 1


def test_what_the_user_has_chosen_stays(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    torch.set_num_threads(1)
    assert use_fastest_threads(wait({1: 0.01, 2: 0.001})) == 1


def test_otherwise_torch_is_told(monkeypatch):
    monkeypatch.delenv("OMP_NUM_THREADS", raising=False)
    monkeypatch.setattr("os.cpu_count", lambda: 2)
    torch.set_num_threads(1)
    assert use_fastest_threads(wait({1: 0.02, 2: 0.002})) == 2
    assert torch.get_num_threads() == 2


def test_the_sample_of_work_is_a_stack_of_the_priors_convolutions():
    assert convolutions()().shape == (1, 192, 30)

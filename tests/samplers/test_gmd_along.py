"""Imputation that takes the body along with its pelvis: overwriting in GMD's features."""

import pytest
import torch

from projflow_lite.samplers import flow_times, gmd
from projflow_lite.samplers.gmd_imputation import Imputation

FRAMES = 4
RANDOM = torch.Generator().manual_seed(3)


def draw(*shape):
    return torch.randn(shape, generator=RANDOM, dtype=torch.float64)


@pytest.fixture
def known():
    """The pelvis in x and z of frames 1 and 3, and all of a wrist in frame 1."""
    mask = torch.zeros(FRAMES, 22, 3, dtype=torch.bool)
    mask[[1, 3], 0, 0] = mask[[1, 3], 0, 2] = True
    mask[1, 20] = True
    return Imputation(mask, draw(FRAMES, 22, 3), along=True)


def test_overwriting_is_that_of_features(known):
    x = draw(2, FRAMES, 22, 3)
    out = known(x)
    assert torch.equal(out[:, known.mask], known.values[known.mask].expand(2, -1))
    seen, before = (each[:, :, 1:] - each[:, :, :1] for each in (out, x))
    free = [j for j in range(21) if j != 19]  # all but the wrist
    torch.testing.assert_close(seen[:, :, free], before[:, :, free])
    assert torch.equal(out[:, [0, 2]], x[:, [0, 2]])
    assert torch.equal(out[:, [1, 3], 0, 1], x[:, [1, 3], 0, 1])  # nobody asked for a height


def test_a_push_moves_the_body_around_its_pelvis_where_that_is_known(known):
    push = draw(2, FRAMES, 22, 3)
    kept = known.protect(push)
    assert (kept[:, known.mask] == 0).all()
    expected = push[:, 3, 5] - push[:, 3, 0] * torch.tensor([1.0, 0.0, 1.0])
    torch.testing.assert_close(kept[:, 3, 5], expected)
    assert torch.equal(kept[:, [0, 2]], push[:, [0, 2]])


def test_more_to_impute_is_taken_along_too(known):
    line = known.line()
    assert line.along
    x = draw(2, FRAMES, 22, 3)
    out = line(x)
    torch.testing.assert_close(out[:, 2, 9] - out[:, 2, 0], x[:, 2, 9] - x[:, 2, 0])
    assert (out[:, 2, 0] != x[:, 2, 0]).any()


def test_the_sampler_takes_bodies_along_if_told_so_or_if_the_flow_is_on_features(known):
    def still(x_t, t, text=None):
        return -x_t / (1 - t)  # every body ends in the origin

    class Features:
        along = True

        def project(self, motion):
            return motion

        unproject = project

    def wrist(**options):
        x0 = torch.zeros(1, FRAMES, 22, 3, dtype=torch.float64)
        x = gmd(still, known, x0, flow_times(3), until=1.0, pull=0.0, **options)
        return x[0, 3, 21, 0]

    taken = float(known.values[3, 0, 0])
    for options in ({}, {"along": False}, {"space": Features(), "along": False}):
        assert float(wrist(**options)) == pytest.approx(0, abs=1e-12)
    for options in ({"along": True}, {"space": Features()}):
        assert float(wrist(**options)) == pytest.approx(taken, abs=1e-12)

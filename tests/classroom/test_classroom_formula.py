"""Answers that are sympy expressions, and right answers written with torch."""

import numpy as np
import pytest
import sympy
import torch

from projflow_lite.classroom import check

x0, x1, t, v, x_t = sympy.symbols("x0 x1 t v x_t")
l_min, l_max, tau_min, pi, r, variance = sympy.symbols(
    "l_min l_max tau_min pi r variance", positive=True
)
RIGHT = {
    "projflow:2": (1 - t) * x0 + t * x1,
    "projflow:5": x_t + v - t * v,
    "projflow:14": l_max - t * (l_max - l_min),
    "projflow:16": 1 - t + t * tau_min,
    "projflow:18": r / pi - r,
    "projflow:46": 1 / (1 + variance / r),
}
WRONG = {
    "projflow:2": t * x0 + (1 - t) * x1,
    "projflow:5": x_t + t * v,
    "projflow:14": (1 - t) * l_min + t * l_max,
    "projflow:16": tau_min + (1 - tau_min) * t,
    "projflow:18": r * (1 - pi),
    "projflow:46": variance / (r + variance),
}


@pytest.mark.parametrize("id", RIGHT)
def test_a_right_formula_in_another_shape_passes(id):
    assert check(id, RIGHT[id]), str(check(id, RIGHT[id]))
    assert check(id, sympy.expand(RIGHT[id]))


@pytest.mark.parametrize("id", WRONG)
def test_a_wrong_formula_is_caught_and_recognised(id):
    verdict = check(id, WRONG[id])
    assert not verdict
    assert verdict.mistake, str(verdict)


def test_a_symbol_of_another_name_is_named():
    verdict = check("projflow:2", (1 - t) * x0 + t * sympy.Symbol("x2"))
    assert not verdict
    assert "the formula has a symbol x2; the names here are x0, x1, t" in str(verdict)


def test_a_formula_that_forgets_a_name_is_wrong_but_no_crash():
    assert not check("projflow:14", l_min + 0 * t)


def test_torch_is_another_style():
    def interpolate(x0, x1, t):
        x0, x1, t = (torch.as_tensor(np.asarray(z)) for z in (x0, x1, t))
        return torch.add((1 - t) * x0, t * x1)

    def project(x1_hat, A, y, R, Sigma):
        x1_hat, A, y, R, Sigma = (torch.as_tensor(z) for z in (x1_hat, A, y, R, Sigma))
        spread = torch.linalg.solve(R, A.T)
        return x1_hat + spread @ torch.linalg.solve(A @ spread + Sigma, y - A @ x1_hat)

    assert check("projflow:2", interpolate), str(check("projflow:2", interpolate))
    assert check("projflow:7", project), str(check("projflow:7", project))

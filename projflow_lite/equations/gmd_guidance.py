r"""Pushing a motion towards a goal while it is sampled: GMD section 4.2.

Here :math:`\Sigma_t` is one number, the variance of a sampling step (`ddpm_posterior`), and f the
denoiser, which predicts the clean motion.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .checks import one_of, real_array, same_shape, true_or_false
from .gmd_emphasis import emphasise, unemphasise
from .gmd_goals import fill_trajectory, take_trajectory

Gradient = Callable[[NDArray], NDArray]


def goal_step(
    x0: ArrayLike, goal_gradient: Gradient, rows: Sequence[int], form: str = "derived"
) -> NDArray:
    r"""Move a predicted motion downhill on a goal of its trajectory.

    .. math:: x_0 = x_{0,\theta} + \Delta_{x_0}, \qquad
              \Delta_{x_0} = -\nabla_{x_0} G_z(P_x^z x_{0,\theta}) = -P_z^x\, \nabla_z G_z

    There is no step size: with the keyframe goal at p = 1, a coordinate moves by exactly 1 if it
    is not there yet, however near it is.

    Args:
        x0: ``(N, M)``, the predicted clean motion.
        goal_gradient: function of a trajectory ``(L, M)`` that returns :math:`\nabla_z G_z`.
        rows: which L features are the trajectory.
        form: ``"derived"`` as above. ``"printed"`` applies :math:`P_z^x` to the motion, which has
            N rows where that projection expects L.

    Returns:
        ``(N, M)``.

    Raises:
        ValueError: if shapes do not fit, as they never do in the printed form with L below N.

    Source: GMD section 4.2 (a).
    """
    x0 = real_array("goal_step", "x0", x0, (None, None))
    z = _trajectory("goal_step", x0, rows, form)
    return x0 - fill_trajectory(goal_gradient(z), rows, len(x0))


def state_gradient(
    x0: ArrayLike,
    jacobian: ArrayLike,
    goal_gradient: Gradient,
    rows: Sequence[int],
    form: str = "derived",
) -> NDArray:
    r"""Gradient of the goal with respect to the noisy state, through the denoiser.

    .. math:: \nabla_{x_t} G_z(P_x^z f(x_t)) = J^\top P_z^x\, \nabla_z G_z, \qquad
              J = \frac{d f(x_t)}{d x_t}

    Args:
        x0: ``(N, M)``, :math:`f(x_t)`.
        jacobian: ``(N M, N M)``, J, of motions vectorised in C order.
        goal_gradient: function of a trajectory ``(L, M)`` that returns :math:`\nabla_z G_z`.
        rows: which L features are the trajectory.
        form: ``"derived"`` or ``"printed"``, see `goal_step`.

    Returns:
        ``(N, M)``. It is dense even where the goal looks at few steps: the denoiser spreads it.

    Raises:
        ValueError: if shapes do not fit, as they never do in the printed form with L below N.

    Source: the gradient in GMD section 4.2 (b) and (c).
    """
    x0 = real_array("state_gradient", "x0", x0, (None, None))
    J = real_array("state_gradient", "jacobian", jacobian, (x0.size, x0.size))
    z = _trajectory("state_gradient", x0, rows, form)
    return (J.T @ fill_trajectory(goal_gradient(z), rows, len(x0)).ravel()).reshape(x0.shape)


def guided_mean(
    mean: ArrayLike, gradient: ArrayLike, mask: ArrayLike, s: float, variance: float
) -> NDArray:
    r"""Mean of a sampling step, pushed downhill wherever nothing is imputed.

    .. math:: \mu_t = \tilde\mu_t - (1 - M_z^x) \odot s\, \Sigma_t\, \nabla_{x_t} G_z

    Args:
        mean: ``(N, M)``, :math:`\tilde\mu_t`, the mean after imputation.
        gradient: ``(N, M)``, from `state_gradient`.
        mask: booleans ``(N, M)``, where something is imputed.
        s: strength of the guidance.
        variance: :math:`\Sigma_t`, at least 0.

    Returns:
        ``(N, M)``.

    Raises:
        ValueError: if shapes differ or the variance is negative.

    Source: GMD section 4.2 (b).
    """
    mu, g, M = same_shape("guided_mean", mean=mean, gradient=gradient, mask=mask)
    free = ~true_or_false("guided_mean", "mask", M)
    return mu - free * (s * _variance("guided_mean", variance) * g)


def unprojected_step(
    gradient: ArrayLike,
    A: ArrayLike,
    scale: float,
    s: float,
    variance: float,
    form: str = "derived",
) -> NDArray:
    r"""Step of guidance that was found in projected space, as a change of the motion.

    .. math:: \Delta_\mu = -s\, \Sigma_t\, (k A)^{-1}\, \nabla_{x_t^{proj}} G_z

    With :math:`R = k^2 A^\top A` (`emphasis_metric`) this is :math:`-s\, \Sigma_t\, R^{-1}
    \nabla_{x_t} G_z`: emphasised features are pushed less, by about :math:`1 / c^2`.

    Args:
        gradient: ``(N, M)``, with respect to the projected state.
        A: ``(N, N)``.
        scale: k.
        s: strength of the guidance.
        variance: :math:`\Sigma_t`, at least 0.
        form: ``"derived"`` as above. ``"printed"`` leaves out k.

    Returns:
        ``(N, M)``.

    Raises:
        ValueError: if shapes do not fit or the variance is negative.

    Source: GMD section 4.2 (c).
    """
    change = unemphasise(gradient, A, scale, form)
    return -s * _variance("unprojected_step", variance) * change


def guided_mean_emphasised(
    mean_proj: ArrayLike,
    delta_mu: ArrayLike,
    mask: ArrayLike,
    A: ArrayLike,
    scale: float,
    form: str = "derived",
) -> NDArray:
    r"""Mean of a projected sampling step, pushed wherever nothing is imputed.

    .. math:: \mu_t^{proj} = \tilde\mu_t^{proj} + k A \bigl((1 - M_z^x) \odot \Delta_\mu\bigr)

    Args:
        mean_proj: ``(N, M)``, the mean after imputation, projected.
        delta_mu: ``(N, M)``, from `unprojected_step`.
        mask: booleans ``(N, M)``, in motion space.
        A: ``(N, N)``.
        scale: k.
        form: ``"derived"`` as above. ``"printed"`` has no k and no bracket: read from left to
            right it multiplies by :math:`A (1 - M)` entry by entry. The shapes fit, but imputed
            coordinates move.

    Returns:
        ``(N, M)``.

    Raises:
        ValueError: if shapes do not fit.

    Source: GMD section 4.2 (d).
    """
    one_of("guided_mean_emphasised", form, ("printed", "derived"))
    mu, delta, M = same_shape("guided_mean_emphasised", mean=mean_proj, delta=delta_mu, mask=mask)
    free = ~true_or_false("guided_mean_emphasised", "mask", M)
    if form == "printed":
        return mu + emphasise(free, A, 1.0) * delta
    return mu + emphasise(free * delta, A, scale)


def _trajectory(who: str, x0: NDArray, rows: Sequence[int], form: str) -> NDArray:
    """Take the trajectory with the right projection, or try the one in print."""
    one_of(who, form, ("printed", "derived"))
    return take_trajectory(x0, rows) if form == "derived" else fill_trajectory(x0, rows, len(x0))


def _variance(who: str, variance: float) -> float:
    """Refuse a negative variance."""
    if not 0 <= variance < np.inf:
        raise ValueError(f"{who}: variance is {variance}, expected a number from 0 on")
    return float(variance)

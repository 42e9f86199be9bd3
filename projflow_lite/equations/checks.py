"""What every equation asks of its arguments, so that the equations themselves stay short.

numpy broadcasts shapes that do not belong together without a word: subtracting a column from a
vector gives a matrix. Each check names the function, the argument and what was expected.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray


def real_array(
    who: str, name: str, value: ArrayLike, shape: tuple[int | None, ...] | None = None
) -> NDArray:
    """Return `value` as a finite float64 array of the wanted shape; ``None`` leaves a size free.

    Raises:
        ValueError: if a value is not finite or the shape is another one.
    """
    raw = np.asarray(value)
    if raw.size and raw.dtype.kind not in "biuf":
        raise ValueError(f"{who}: {name} should be real numbers")
    array = raw.astype(np.float64)
    if not np.isfinite(array).all():
        raise ValueError(f"{who}: {name} has a value that is not finite")
    if shape is not None:
        same = len(shape) == array.ndim
        if not same or any(s not in (None, n) for s, n in zip(shape, array.shape, strict=True)):
            wanted = str(tuple("any" if s is None else s for s in shape)).replace("'", "")
            raise ValueError(f"{who}: {name} has shape {array.shape}, expected {wanted}")
    return array


def same_shape(who: str, **values: ArrayLike) -> list[NDArray]:
    """Return the named values as finite float64 arrays that all have one shape.

    Raises:
        ValueError: if a value is not finite or two shapes differ.
    """
    arrays = {name: real_array(who, name, value) for name, value in values.items()}
    if len({array.shape for array in arrays.values()}) > 1:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items())
        raise ValueError(f"{who}: the shapes differ: {shapes}")
    return list(arrays.values())


def fraction(who: str, name: str, value: ArrayLike, x: NDArray | None = None) -> NDArray:
    """Return a number in [0, 1], or one per sample of `x`, ready to multiply `x`.

    Args:
        who: the function to name in an error message.
        name: the argument to name in an error message.
        value: a scalar, or an array whose shape is how the shape of `x` begins.
        x: the array it will multiply, if any.

    Raises:
        ValueError: if a value is outside [0, 1] or the shape does not fit `x`.
    """
    array = real_array(who, name, value)
    if ((array < 0) | (array > 1)).any():
        raise ValueError(f"{who}: {name} = {array} is outside 0..1")
    if x is None:
        return array
    if array.shape != x.shape[: array.ndim]:
        raise ValueError(
            f"{who}: {name} has shape {array.shape}; expected a scalar or the leading "
            f"axes of {x.shape}"
        )
    return array.reshape(array.shape + (1,) * (x.ndim - array.ndim))


def positive_definite(who: str, name: str, matrix: NDArray, hint: str = "") -> NDArray:
    """Return `matrix` if it is symmetric with only positive eigenvalues.

    Raises:
        ValueError: if it is not; `hint` says what to do.
    """
    if not np.allclose(matrix, matrix.T, rtol=1e-10, atol=1e-12 * np.abs(matrix).max(initial=0)):
        raise ValueError(f"{who}: {name} is not symmetric")
    try:
        np.linalg.cholesky(matrix)
    except np.linalg.LinAlgError:
        raise ValueError(f"{who}: {name} is not positive definite{hint}") from None
    return matrix


def positive_semidefinite(who: str, name: str, matrix: NDArray) -> NDArray:
    """Return `matrix` if it is symmetric with no negative eigenvalue.

    Raises:
        ValueError: if it is not.
    """
    largest = np.abs(matrix).max(initial=0)
    if not np.allclose(matrix, matrix.T, rtol=1e-10, atol=1e-12 * largest):
        raise ValueError(f"{who}: {name} is not symmetric")
    diagonal = np.diag(matrix)
    is_diagonal = np.count_nonzero(matrix) == np.count_nonzero(diagonal)
    smallest = (diagonal if is_diagonal else np.linalg.eigvalsh(matrix)).min(initial=0)
    if smallest < (0 if is_diagonal else -1e-12 * largest):
        raise ValueError(f"{who}: {name} has a negative variance ({smallest:.3g})")
    return matrix


def linear_model(
    who: str, x1_hat: ArrayLike, A: ArrayLike, y: ArrayLike, R: ArrayLike, Sigma: ArrayLike
) -> tuple[NDArray, NDArray, NDArray, NDArray, NDArray]:
    """Check the five arrays of a linear-Gaussian model and return them as float64.

    Args:
        who: the function to name in an error message.
        x1_hat: ``(d,)``.
        A: ``(m, d)``.
        y: ``(m,)``.
        R: ``(d, d)``, symmetric positive definite.
        Sigma: ``(m, m)``, symmetric positive semidefinite.

    Raises:
        ValueError: if shapes do not fit, a value is not finite, or a matrix is not definite.
    """
    if np.ndim(x1_hat) == 3:
        raise ValueError(f"{who}: x1_hat has shape {np.shape(x1_hat)}; vectorise it first")
    x1_hat = real_array(who, "x1_hat", x1_hat, (None,))
    A = real_array(who, "A", A, (None, len(x1_hat)))
    m, d = A.shape
    y = real_array(who, "y", y, (m,))
    R = positive_definite(who, "R", real_array(who, "R", R, (d, d)))
    Sigma = positive_semidefinite(who, "Sigma", real_array(who, "Sigma", Sigma, (m, m)))
    return x1_hat, A, y, R, Sigma


def one_of(who: str, form: str, forms: tuple[str, ...]) -> None:
    """Refuse a `form` that this equation does not have.

    Raises:
        ValueError: naming the forms that exist.
    """
    if form not in forms:
        raise ValueError(f"{who}: form is {form!r}, expected one of {', '.join(forms)}")


def whole_number(who: str, name: str, value: int, least: int = 1) -> int:
    """Return `value` if it is an integer of at least `least`.

    Raises:
        ValueError: if it is not.
    """
    if isinstance(value, bool) or not isinstance(value, int | np.integer) or value < least:
        raise ValueError(f"{who}: {name} is {value!r}, expected a whole number from {least} on")
    return int(value)


def true_or_false(who: str, name: str, value: ArrayLike) -> NDArray:
    """Return `value` as an array of booleans.

    Raises:
        ValueError: if an entry is neither true nor false (nor 1 nor 0).
    """
    array = real_array(who, name, value)
    if not np.isin(array, (0, 1)).all():
        raise ValueError(f"{who}: {name} has an entry that is neither true nor false")
    return array.astype(bool)


def diagonal_mask(who: str, name: str, M: ArrayLike, d: int) -> NDArray:
    """Return `M` if it is a ``(d, d)`` diagonal matrix of zeros and ones.

    Raises:
        ValueError: if it is not.
    """
    M = real_array(who, name, M, (d, d))
    diagonal = np.diag(M)
    if not np.isin(diagonal, (0, 1)).all() or np.count_nonzero(M) > np.count_nonzero(diagonal):
        raise ValueError(f"{who}: {name} is not a diagonal matrix of zeros and ones")
    return M

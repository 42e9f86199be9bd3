"""What the check says about functions that misbehave in every way a notebook has seen."""

import inspect

import numpy as np
import pytest

from projflow_lite import equations
from projflow_lite.classroom import check, exercises, hint
from projflow_lite.classroom.attempt import deviation
from projflow_lite.classroom.checking import standard
from projflow_lite.classroom.shelf import EXERCISES

IDS = [record.id for record in exercises()]


def right(x1_hat, A, y, R, Sigma):
    R_inv_At = np.linalg.solve(R, A.T)
    return x1_hat + R_inv_At @ np.linalg.solve(A @ R_inv_At + Sigma, y - A @ x1_hat)


def unwritten(x1_hat, A, y, R, Sigma): ...


def not_implemented(x1_hat, A, y, R, Sigma):
    raise NotImplementedError


def crash(x1_hat, A, y, R, Sigma):
    return x1_hat / undefined_name  # noqa: F821


def leave(x1_hat, A, y, R, Sigma):
    raise SystemExit(3)


def recursion(x1_hat, A, y, R, Sigma):
    return recursion(x1_hat, A, y, R, Sigma)


def generator(x1_hat, A, y, R, Sigma):
    yield right(x1_hat, A, y, R, Sigma)


async def coroutine(x1_hat, A, y, R, Sigma):
    return right(x1_hat, A, y, R, Sigma)


def nan(x1_hat, A, y, R, Sigma):
    return right(x1_hat, A, y, R, Sigma) * np.nan


def column(x1_hat, A, y, R, Sigma):
    return right(x1_hat, A, y, R, Sigma)[:, None]


def words(x1_hat, A, y, R, Sigma):
    return "the corrected endpoint"


def ragged(x1_hat, A, y, R, Sigma):
    return [[1.0], [2.0, 3.0]]


def imaginary(x1_hat, A, y, R, Sigma):
    return right(x1_hat, A, y, R, Sigma) + 0j


def in_place(x1_hat, A, y, R, Sigma):
    result = right(x1_hat, A, y, R, Sigma)
    y *= 2
    return result


def huge(x1_hat, A, y, R, Sigma):
    return np.full(len(x1_hat), -1.7e308)


class Treacherous:
    def __array__(self, *_, **__):
        raise RuntimeError("no array for you")

    def toarray(self):
        raise RuntimeError("nor a dense one")


class UnprintableError(Exception):
    def __str__(self):
        raise RuntimeError("cannot even say it")


def treacherous(x1_hat, A, y, R, Sigma):
    return Treacherous()


def unprintable(x1_hat, A, y, R, Sigma):
    raise UnprintableError


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (unwritten, "not written yet"),
        (not_implemented, "not written yet"),
        (lambda *_: ..., "not written yet"),
        (crash, "stops with NameError: name 'undefined_name' is not defined"),
        (leave, "stops with SystemExit: 3"),
        (recursion, "calls itself without end"),
        (generator, "use return instead"),
        (coroutine, "use return instead"),
        (nan, "not finite, at [0]"),
        (column, "has shape (5, 1), expected (5,)"),
        (words, "real numbers, not a value of type str"),
        (ragged, "real numbers, not a list of 2"),
        (imaginary, "real numbers, not one array of shape (5,) with complex128 in it"),
        (in_place, "the function changes its argument y"),
        (huge, "deviates by up to 1.7e+308"),
        (treacherous, "real numbers, not a value of type Treacherous"),
        (unprintable, "stops with UnprintableError"),
        (lambda x1_hat: x1_hat, "project(x1_hat, A, y, R, Sigma); yours are (x1_hat)"),
        (np.ones(3), "this is not a function; write check('projflow:7', project)"),
        (None, "this is not a function"),
        (np.linalg.solve, "yours are (a, b)"),
        (print, "not written yet"),
        (int, "the function stops with TypeError"),
    ],
)
def test_misbehaviour_is_a_verdict(function, words):
    verdict = check("projflow:7", function)
    assert not verdict
    assert words in str(verdict)
    assert "\n" not in verdict.problem
    assert verdict.hint == hint("projflow:7")


@pytest.mark.parametrize("id", IDS)
def test_every_exercise_survives_every_misbehaviour(id):
    for returned in (None, np.nan, [], (), "x", {}, object(), [1, "a"], np.zeros((1, 1, 1, 1, 1))):
        verdict = check(id, lambda *_, value=returned: value)
        assert not verdict, returned
        assert verdict.mistake == ""

    def crash(*_):
        raise ZeroDivisionError

    assert check(id, crash).mistake == ""


@pytest.mark.parametrize("id", IDS)
@pytest.mark.parametrize("seed", [0, 7])
def test_the_standard_accepts_itself_and_its_numbers_are_finite(id, seed):
    exercise = EXERCISES[id]
    verdict = check(id, exercise.reference, seed)
    cases, expected = standard(id, seed)
    assert verdict
    assert verdict.cases == verdict.passed == len(cases) >= 8
    assert all(np.isfinite(part).all() for parts in expected for part in parts)
    assert len({case.name for case in cases}) == len(cases)


@pytest.mark.parametrize("id", IDS)
def test_a_small_error_in_one_number_of_one_case_is_found(id):
    """The loudest entry of a single case, off by a thousandth, must not pass."""
    exercise, calls = EXERCISES[id], []

    def almost(*arguments):
        calls.append(1)
        result = exercise.reference(*arguments)
        if len(calls) != 1:
            return result
        parts = [np.array(p, float) for p in (result if len(exercise.returns) > 1 else (result,))]
        place = np.unravel_index(np.argmax(np.abs(parts[0])), parts[0].shape)
        parts[0][place] *= 1.001
        return parts if len(parts) > 1 else parts[0]

    verdict = check(id, almost)
    assert not verdict
    assert verdict.passed == verdict.cases - 1


def test_deviation_counts_in_units_of_rounding():
    assert deviation(np.array([1.0, 2.0]), np.array([1.0, 2.0])) == 0
    assert deviation(np.array([1.0, 2.0 + 1e-8]), np.array([1.0, 2.0])) < 1
    assert deviation(np.array([1.0, 2.001]), np.array([1.0, 2.0])) > 1
    assert deviation(np.array([1e-4]), np.array([0.0])) > 1
    assert deviation(np.array([1.0]), np.array([[1.0]])) == np.inf
    assert deviation(np.array([np.nan]), np.array([1.0])) == np.inf


def single_precision(function):
    def rounded(*arguments):
        return function(*(a.astype("f4") if isinstance(a, np.ndarray) else a for a in arguments))

    return rounded


def test_single_precision_and_other_containers_are_welcome():
    assert check("projflow:2", single_precision(lambda x0, x1, t: (1 - t) * x0 + t * x1))
    assert check("projflow:7", single_precision(right))
    assert check("projflow:7", lambda *a: tuple(right(*a).tolist()))
    assert not check("projflow:36", lambda *a: equations.offset_rows(*a)[0])


def test_tensors_are_welcome():
    torch = pytest.importorskip("torch")
    assert check("projflow:5", lambda x, v, t: torch.tensor(x) + (1 - t) * torch.tensor(v))


def test_the_first_wrong_case_can_be_called_once_more():
    verdict = check("projflow:7", lambda x1_hat, A, y, R, Sigma: x1_hat)
    assert list(verdict.arguments) == ["x1_hat", "A", "y", "R", "Sigma"]
    wanted = equations.project(**verdict.arguments)
    off = np.abs(wanted - verdict.arguments["x1_hat"])
    assert f"deviates by up to {off.max():.3g}, at [{off.argmax()}]" in verdict.problem
    verdict.arguments["x1_hat"][:] = 0
    assert check("projflow:7", right)  # the cases are not the ones handed out


def test_the_verdict_as_text():
    def with_r(x1_hat, A, y, R, Sigma):
        return x1_hat + R @ A.T @ np.linalg.solve(A @ R @ A.T + Sigma, y - A @ x1_hat)

    verdict = check("projflow:7", with_r)
    assert str(verdict) == repr(verdict)
    first, *rest = str(verdict).splitlines()
    assert first.startswith(
        "Not yet: projflow:7, Corrected endpoint: 4 of 14 cases are right. Case 1, two rows, five "
        "coordinates, correlated noise: the endpoint deviates by up to "
    )
    assert rest == [
        "Known mistake with exactly these numbers: R is used where its inverse belongs.",
        "Hint: Begin with the misfit: what does the prediction still lack of y? Then follow the "
        "shapes from m numbers to d numbers.",
    ]
    assert verdict._repr_markdown_().startswith("✗ **Not yet** — projflow:7")
    good = check("projflow:7", right)
    assert str(good) == "Right: projflow:7, Corrected endpoint (14 cases)"
    assert good._repr_markdown_() == "✓ **Right** — projflow:7, Corrected endpoint (14 cases)"


def test_a_students_error_does_not_turn_into_markup():
    def fail(x1_hat, A, y, R, Sigma):
        raise TypeError("<b>*no*</b> x1_hat_ costs $5")

    shown = check("projflow:7", fail)._repr_markdown_()
    assert r"TypeError: \<b>\*no\*\</b> x1\_hat\_ costs \$5" in shown


def test_nothing_is_printed(capsys):
    check("projflow:7", crash)
    check("projflow:7", right)
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("id", "near"),
    [
        ("project", "projflow:7"),
        ("7", "projflow:7"),
        (7, "projflow:7"),
        ("projflow:8", "projflow:7"),
        ("projflow:22", "projflow:7"),
        ("projflow:47", "projflow:18"),
        ("projflow:48", "projflow:15"),
        ("halo_raduis", "projflow:14"),
        ("projflo:52", "projflow:52"),
    ],
)
def test_an_unknown_exercise_gets_a_suggestion(id, near):
    with pytest.raises(ValueError, match=f"check: .* is not an exercise; did you mean '{near}'"):
        check(id, right)


def test_an_exercise_without_neighbour_gets_the_list():
    with pytest.raises(ValueError, match="hint: '§§§' is not an exercise; there are projflow:2, "):
        hint("§§§")
    assert check(" ProjFlow: 7 ", right)


def test_the_list_of_exercises_names_functions_of_the_package():
    assert [int(id.split(":")[1]) for id in IDS] == [
        2, 3, 5, 7, 9, 10, 11, 14, 15, 16, 17, 18, 21, 31, 36, 38, 46, 50, 51, 52,
    ]  # fmt: skip
    for record in exercises():
        name, arguments = record.signature.rstrip(")").split("(")
        own = list(inspect.signature(getattr(equations, name)).parameters)
        assert arguments.split(", ") == [p for p in own if p != "form"]
        assert record.latex
        assert record.task.count(". ") <= 2
    catalog = {r.number: r for r in equations.catalog() if r.paper == "ProjFlow"}
    for record in exercises():
        if record.id != "projflow:7":
            number = record.id.split(":")[1]
            assert record.latex == catalog[number].latex
            assert catalog[number].function.endswith("." + record.signature.split("(")[0])


def test_another_seed_draws_other_numbers():
    (first, *_), _ = standard("projflow:7", 0)
    (other, *_), _ = standard("projflow:7", 1)
    assert first.name == other.name
    assert not np.allclose(first.arguments[0], other.arguments[0])

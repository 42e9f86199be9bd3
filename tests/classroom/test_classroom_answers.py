"""The lecturer's answers: derived by sympy from first principles, and no hint gives them away."""

import functools
import re
import subprocess
import sys

import numpy as np
import pytest
import sympy

from projflow_lite.classroom import answer as derive_answer
from projflow_lite.classroom import check, hint
from projflow_lite.classroom.answers import ANSWERS
from projflow_lite.classroom.answers.derivation import Answer, Derivation, Step, confirmed, vanishes
from projflow_lite.classroom.attempt import as_arrays
from projflow_lite.classroom.shelf import EXERCISES

answer = functools.cache(derive_answer)


def written(id):
    """The function that an answer's code defines."""
    names = {"np": np}
    exec(answer(id).code, names)
    return names[EXERCISES[id].function]


def free_symbols(value):
    if isinstance(value, np.ndarray | tuple):
        return set().union(*(free_symbols(v) for v in np.ravel(value) if not np.isscalar(v)), set())
    return getattr(value, "free_symbols", set())


def numeric(value, numbers):
    """Turn sympy into numpy: a column becomes a vector, an array stays one."""
    if isinstance(value, sympy.MatrixBase):
        entries = np.array(value.subs(numbers).evalf().tolist(), dtype=float)
        return entries[:, 0] if value.shape[1] == 1 else entries
    if isinstance(value, np.ndarray):
        return np.vectorize(lambda v: float(v.subs(numbers)), otypes=[float])(value)
    if isinstance(value, int):
        return value
    return float(value.subs(numbers))


@pytest.mark.parametrize("id", EXERCISES)
def test_what_sympy_derives_is_what_numpy_computes(id):
    """Twice: `projflow_lite.equations` and the answer's own code, at random numbers."""
    exercise, derivation = EXERCISES[id], ANSWERS[id].derive()
    symbols = set().union(*(free_symbols(argument) for argument in derivation.arguments), set())
    rng = np.random.default_rng(5)
    for _ in range(3):
        numbers = {s: rng.uniform(0.1, 0.9) for s in sorted(symbols, key=str)}
        arguments = [numeric(argument, numbers) for argument in derivation.arguments]
        result = derivation.result if isinstance(derivation.result, tuple) else (derivation.result,)
        derived = [numeric(part, numbers) for part in result]
        for function in (exercise.reference, written(id)):
            parts = as_arrays(function(*arguments), len(exercise.returns))
            for part, wanted in zip(parts, derived, strict=True):
                np.testing.assert_allclose(part, wanted, rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("id", EXERCISES)
def test_the_answers_code_passes_its_own_check(id):
    verdict = check(id, written(id))
    assert verdict, verdict


@pytest.mark.parametrize("id", EXERCISES)
def test_an_answer_shows_equation_derivation_confirmation_and_code(id):
    found = answer(id)
    text = str(found)
    assert text == found._repr_markdown_()
    assert found.record.latex in text
    assert found.derivation in text
    assert all(f"- {claim}" in text for claim in found.confirmed)
    assert len(found.confirmed) >= 1
    assert f"def {found.record.signature}:" in found.code
    assert text.count("$") % 2 == 0


def test_a_false_claim_is_refused():
    x = sympy.Symbol("x")
    false = Answer("", "", lambda: Derivation([Step("x is x squared", x - x**2)], (x,), x))
    with pytest.raises(ArithmeticError, match="projflow:0: sympy does not confirm: x is x squared"):
        confirmed(false, "projflow:0")


def test_vanishing_is_that_of_every_entry():
    x = sympy.Symbol("x")
    assert vanishes((x + 1) ** 2 - x**2 - 2 * x - 1)
    assert vanishes(sympy.Matrix([sympy.sin(x) ** 2 + sympy.cos(x) ** 2 - 1, 0]))
    assert not vanishes(sympy.Matrix([0, x]))


@pytest.mark.parametrize("id", EXERCISES)
def test_no_hint_contains_the_answer(id):
    hints = [hint(id, level) for level in (1, 2, 3)]
    assert len(set(hints)) == 3
    assert hint(id) == hints[0]
    code = ANSWERS[id].code.splitlines()[1:]
    pieces = {re.sub(r"\s", "", re.split(r"return | = ", line)[-1]) for line in code}
    for sentence in hints:
        packed = re.sub(r"\s", "", sentence)
        assert not any(piece in packed for piece in pieces)
        assert not re.search(r"np\.|@|return [^t]|\*|def ", sentence), sentence


@pytest.mark.parametrize("level", [0, 4, "one", None])
def test_there_are_three_levels_of_hints(level):
    with pytest.raises(ValueError, match="expected 1, 2 or 3"):
        hint("projflow:7", level)


def test_checking_does_not_load_sympy():
    """A student who checks a function does not wait for computer algebra."""
    lines = (
        "import sys; from projflow_lite.classroom import check, hint, exercises, mutation_score\n"
        "check('projflow:7', lambda *_: None); exercises(); hint('projflow:7')\n"
        "assert 'sympy' not in sys.modules; assert 'torch' not in sys.modules"
    )
    subprocess.run([sys.executable, "-c", lines], check=True)

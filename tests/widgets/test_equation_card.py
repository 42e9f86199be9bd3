"""The equation card: what it computes is what the function says, for every equation there is."""

import numpy as np
import pytest

from projflow_lite import equations
from projflow_lite.widgets import EquationCard
from projflow_lite.widgets.equation_card import read
from projflow_lite.widgets.equation_examples import BY_FUNCTION, example, forms

RECORDS = [r for r in equations.catalog() if r.function]
NO_VALUE = {  # as printed: the erratum, live
    "imputation_region": "acts on 3 rows, not on 2",
    "euclidean_masked_update": "singular",
    "euclidean_masked_average": "singular",
    "masked_update": "singular",
    "masked_average": "singular",
}
TAKE_FUNCTIONS = {"flow_map", "goal_conditioned", "motion_goal", "goal_step"}


@pytest.fixture(scope="module")
def card():
    return EquationCard()


def pick(card, record):
    card.paper.value = record.paper
    card.equation.value = record.number


@pytest.mark.parametrize("record", RECORDS, ids=lambda r: f"{r.paper} {r.number}")
def test_every_equation_has_numbers_to_play_with(card, record):
    pick(card, record)
    assert card.record == record
    assert record.latex in card.formula.value
    name = record.function.rpartition(".")[2]
    assert f"code of {name}" in card.code.value
    if name in TAKE_FUNCTIONS:
        assert "takes a function" in card.output.value
        return
    for form in card.form.options or (None,):
        if form is not None:
            card.form.value = form
        if form == "printed" and name in NO_VALUE:
            assert card.result is None
            assert NO_VALUE[name] in card.output.value
            continue
        assert card.result is not None, card.output.value
        assert f"{name}(…)" in card.output.value


def flat(result):
    return np.concatenate(
        [np.ravel(part) for part in (result if isinstance(result, tuple) else (result,))]
    )


def test_every_own_example_belongs_to_a_function():
    assert {name for name in BY_FUNCTION if not hasattr(equations, name)} == set()


def test_readings_that_differ_give_different_numbers():
    """A choice between readings that all say the same would be no choice."""
    same = []
    for name in {r.function.rpartition(".")[2] for r in RECORDS} - TAKE_FUNCTIONS:
        function = getattr(equations, name)
        if len(forms(function)) < 2 or name in NO_VALUE:
            continue
        results = [flat(function(**example(function), form=form)) for form in forms(function)]
        if results[0].shape == results[1].shape and np.allclose(*results, rtol=0, atol=1e-12):
            same.append(name)
    assert sorted(same) == []


def test_a_slider_moves_the_result():
    card = EquationCard("ProjFlow", 2)
    card.fields["t"].value = 0.25
    np.testing.assert_allclose(card.result, 0.75 * np.array([1, 0]) + 0.25 * np.array([0, 2]))
    assert "[0.75 0.5 ]" in card.output.value


def test_text_is_read_as_numbers_and_refused_in_words():
    card = EquationCard("ProjFlow", "7")
    card.fields["y"].value = "[5]"
    # One hard-ish row on the first coordinate: R^-1 = [[2, 1], [1, 2]] / 3, so S = 2/3 + 0.1.
    share = (2 / 3) / (2 / 3 + 0.1)
    np.testing.assert_allclose(card.result, [4 * share, 2 * share])
    card.fields["y"].value = "[5"
    assert card.result is None
    assert "y: write a number, or lists of numbers" in card.output.value
    card.fields["y"].value = "[5, 6]"
    assert card.result is None
    assert "#c33" in card.output.value
    card.fields["y"].value = "[2.0]"
    assert card.result is not None


def test_nothing_but_literals_is_read():
    with pytest.raises(ValueError, match="x: write a number"):
        read("x", "__import__('os').getcwd()")


def test_an_equation_without_a_function_says_so(card):
    card.paper.value = "BMM"
    assert "no function for this equation yet" in card.output.value
    assert card.code.value == ""


def test_errata_are_shown(card):
    pick(card, next(r for r in RECORDS if r.paper == "ProjFlow" and r.number == "51"))
    assert card.record.erratum
    assert "⚠" in card.erratum.value
    card.equation.value = "2"
    assert card.erratum.value == ""


def test_an_unknown_equation_is_refused():
    with pytest.raises(ValueError, match="there is no equation 99 of 'ProjFlow'"):
        EquationCard("ProjFlow", 99)

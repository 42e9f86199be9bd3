"""GMD's formulas are derived again, and would not be if one were wrong."""

import math

import numpy as np
import pytest

from projflow_lite import derivations
from projflow_lite import equations as eq
from projflow_lite.derivations import registry

CATALOG = {record.number: record for record in eq.catalog() if record.paper == "GMD"}
ENTRIES = registry.OTHER_DERIVATIONS


@pytest.mark.parametrize("number", CATALOG)
def test_every_formula_is_derived_and_holds(number):
    found = derivations.run([number], seed=1, paper="GMD")
    assert found
    for row in found:
        assert (row.paper, row.equation, row.problem) == ("GMD", number, "")
        assert row.title == CATALOG[number].title
        assert row.holds, row


@pytest.mark.parametrize("entry", ENTRIES, ids=lambda e: f"{e.equation}: {e.method}")
def test_no_derivation_is_for_show(entry, monkeypatch):
    """Each one by itself refuses a formula that is off by half."""
    name = CATALOG[entry.equation].function.rsplit(".", 1)[1]
    right = getattr(eq, name)

    def wrong(*args, **kwargs):
        value = right(*args, **kwargs)
        if isinstance(value, tuple):
            return tuple(np.asarray(part) * 1.5 for part in value)
        return np.asarray(value) * 1.5

    monkeypatch.setattr(eq, name, wrong)
    rows = derivations.run([entry.equation], paper="GMD")
    (row,) = [row for row in rows if row.method == entry.method]
    assert not row.holds
    assert row.problem == ""


MISTAKES = {
    "rows of the trajectory swapped": (
        "4 (c)", "take_trajectory", lambda f: lambda x, rows: f(x, rows)[::-1],
    ),
    "free and imputed swapped": (
        "4.1 (c)", "impute", lambda f: lambda x, z, m, rows: np.where(m, x, f(x, z, m, rows)),
    ),
    "the printed factor": (
        "4.1 (a)", "emphasis_scale", lambda f: lambda *a: f(*a, form="printed"),
    ),
    "the factor forgotten": (
        "4.1 (d)", "unemphasise", lambda f: lambda *a: f(*a, form="printed"),
    ),
    "the factor forgotten around an imputation": (
        "4.1 (e)", "impute_emphasised", lambda f: lambda *a: f(*a, form="printed"),
    ),
    "uphill": ("4.2 (a)", "goal_step", lambda f: lambda x, g, rows: 2 * x - f(x, g, rows)),
    "a standard deviation for a variance": (
        "4.2 (b)", "guided_mean", lambda f: lambda a, b, c, s, v: f(a, b, c, s, v**0.5),
    ),
    "the transpose for the inverse": (
        "4.2 (c)", "unprojected_step",
        lambda f: lambda g, A, k, s, v: -s * v * (k * A).T @ g,
    ),
    "no bracket": (
        "4.2 (d)", "guided_mean_emphasised", lambda f: lambda *a: f(*a, form="printed"),
    ),
    "the mask forgotten": (
        "12", "keyframe_goal", lambda f: lambda z, y, m, *a: f(z, y, np.ones_like(y), *a),
    ),
    "alpha for its root": (
        "4.1 (b)", "diffuse", lambda f: lambda x, e, a: a * x + (1 - a) * e,
    ),
    "a line from the origin": (
        "5.2 (c)", "point_to_point", lambda f: lambda *a: f(*a, form="released"),
    ),
}  # fmt: skip


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_that_people_make_is_noticed(mistake, monkeypatch):
    number, name, change = MISTAKES[mistake]
    module = __import__("projflow_lite.equations.gmd_keyframes", fromlist=[name])
    wrong = change(getattr(eq, name))
    for place in (eq, module):  # one formula calls the other inside its module
        if hasattr(place, name):
            monkeypatch.setattr(place, name, wrong)
    assert not all(row.holds for row in derivations.run([number], paper="GMD"))


def test_printed_forms_deviate_by_what_was_found_by_hand():
    found = derivations.run_as_printed(paper="GMD")
    assert all(row.deviates and not row.problem for row in found)
    values = {}
    for row in found:
        values.setdefault(row.equation, []).append(row.deviation)
    assert values.pop("4 (a)") == pytest.approx([1], abs=0.3)  # drawn
    assert values.pop("4.1 (a)") == pytest.approx([1 - 560**-0.5, 0.44], abs=0.12)
    assert values == {
        "4.1 (b)": pytest.approx([0.25]),
        "4.1 (d)": pytest.approx([1 - 300**-0.5]),
        "4.1 (e)": pytest.approx([560**0.5 - 1]),
        "4.2 (a)": [math.inf, pytest.approx(0.99)],
        "4.2 (b)": [math.inf],
        "4.2 (c)": pytest.approx([1 - 300**-0.5]),
        "4.2 (d)": pytest.approx([1]),
        "12": [math.inf, pytest.approx(1)],
        "5.2 (a)": pytest.approx([2]),
        "5.2 (b)": [math.inf],
        "5.2 (c)": pytest.approx([4]),
    }


def test_every_erratum_has_its_counterexample():
    shown = {row.equation for row in derivations.run_as_printed(paper="GMD")}
    assert shown == {number for number, record in CATALOG.items() if record.erratum}


def test_both_papers_stand_in_one_table_under_their_names():
    rows = derivations.run([2, 7]) + derivations.run(["4 (c)", "12"], paper="GMD")
    printed = derivations.run_as_printed([14]) + derivations.run_as_printed(["12"], paper="GMD")
    lines = derivations.table(rows, printed).splitlines()
    assert lines.count("GMD") == 2
    first = lines.index("GMD")
    assert lines.index("   7  Smallest correction in closed form") < first
    assert (
        first
        < lines.index("4 (c)  Trajectory of a motion")
        < lines.index("  12  Goal of keyframes")
    )
    assert lines[-1].startswith("4 equations, ")
    assert lines[-1].endswith("; all hold.")
    assert max(map(len, lines[:-1])) <= 98
    alone = derivations.table(derivations.run([2, 7]))
    assert "GMD" not in alone


def test_a_formula_that_fails_is_named_with_its_paper():
    row = derivations.run(["4 (c)"], paper="GMD")[0]._replace(holds=False, deviation=1.0)
    assert derivations.table([row]).endswith("GMD 4 (c) DOES NOT HOLD.")


def test_equal_numbers_of_two_papers_are_two_equations():
    text = derivations.table(derivations.run([12]) + derivations.run(["12"], paper="GMD"))
    assert text.splitlines()[-1].startswith("2 equations, ")


@pytest.mark.parametrize("run", [derivations.run, derivations.run_as_printed])
def test_what_does_not_exist_is_named(run):
    with pytest.raises(ValueError, match=r"GMD has no equation 9, expected 4 \(a\), 4 \(b\)"):
        run(["9"], paper="GMD")
    with pytest.raises(ValueError, match="no equation of 'BMM' is checked"):
        run(paper="BMM")


def test_the_papers_do_not_mix():
    assert {entry.paper for entry in derivations.DERIVATIONS} == {"ProjFlow"}
    assert {entry.paper for entry in ENTRIES} == {"GMD"}
    assert {row.paper for row in derivations.run([7])} == {"ProjFlow"}
    assert len({entry[:2] for entry in ENTRIES}) == len(ENTRIES)


def test_a_formula_gets_the_same_problems_alone_and_in_company():
    alone = derivations.run(["4.1 (d)"], seed=5, paper="GMD")
    company = derivations.run(["4.1 (a)", "4.1 (d)"], seed=5, paper="GMD")
    assert alone[0].deviation in [r.deviation for r in company if r.equation == "4.1 (d)"]

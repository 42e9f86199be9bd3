import ast
import importlib
import inspect
import re
from pathlib import Path

import pytest

from projflow_lite import equations as eq

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = Path(eq.__file__).parent
LATEX = [
    "Bigl",
    "Bigr",
    "Delta",
    "Sigma",
    "alpha",
    "arg",
    "bar",
    "begin",
    "beta",
    "bigl",
    "bigr",
    "binom",
    "bmod",
    "bmatrix",
    "cdots",
    "dots",
    "ell",
    "end",
    "epsilon",
    "eta",
    "exp",
    "frac",
    "ge",
    "hat",
    "in",
    "infty",
    "lVert",
    "lambda",
    "le",
    "lfloor",
    "log",
    "delta",
    "det",
    "mathbb",
    "mathbf",
    "mathcal",
    "mathrm",
    "max",
    "mid",
    "min",
    "mu",
    "nabla",
    "ne",
    "odot",
    "otimes",
    "pi",
    "prod",
    "propto",
    "psi",
    "qquad",
    "quad",
    "rVert",
    "rfloor",
    "sigma",
    "sim",
    "sqrt",
    "sum",
    "tau",
    "text",
    "tfrac",
    "theta",
    "tilde",
    "top",
    "widehat",
]
PROJFLOW = [record for record in eq.catalog() if record.paper == "ProjFlow"]
GMD = [record for record in eq.catalog() if record.paper == "GMD"]


def numbers_in_source(function):
    """Equation numbers that the "Source" of a docstring names, ranges written out."""
    source = inspect.getdoc(function).split("Source:")[1]
    source = re.sub(r"section [A-C\d.]+", "", source)
    numbers = set()
    for first, last in re.findall(r"(\d+)(?:–(\d+))?", source):
        numbers |= set(range(int(first), int(last or first) + 1))
    return numbers


def test_every_number_of_projflow_has_one_checked_record():
    assert [record.number for record in PROJFLOW] == [str(n) for n in range(1, 53)]
    assert {record.status for record in PROJFLOW} == {"checked"}


def test_every_formula_of_gmd_is_checked_and_bmm_is_open():
    others = [record for record in eq.catalog() if record.paper != "ProjFlow"]
    bmm = [record.number for record in others if record.paper == "BMM"]
    assert bmm == [str(n) for n in range(1, 17)]
    assert {record.status for record in others if record.paper == "BMM"} == {"open"}
    gmd = [record.number for record in GMD]
    assert len(gmd) == len(set(gmd)) == 17
    assert {record.status for record in GMD} == {"checked"}
    assert len(bmm) + len(gmd) == len(others)


@pytest.mark.parametrize("record", PROJFLOW, ids=lambda r: r.number)
def test_function_exists_and_names_its_equation(record):
    module, name = record.function.rsplit(".", 1)
    function = getattr(importlib.import_module(module), name)
    assert callable(function)
    assert int(record.number) in numbers_in_source(function)


@pytest.mark.parametrize("record", GMD, ids=lambda r: r.number)
def test_function_of_gmd_exists_and_names_its_formula(record):
    function = getattr(eq, record.function.rsplit(".", 1)[1])
    source = inspect.getdoc(function).split("Source:")[1]
    named = f"eq. {record.number}" if record.number.isdigit() else f"section {record.number}"
    assert f"GMD {named}." in source


@pytest.mark.parametrize("record", PROJFLOW + GMD, ids=lambda r: f"{r.paper}:{r.number}")
def test_check_exists(record):
    path, name = record.check.rsplit(".", 1)
    source = (ROOT / Path(*path.split("."))).with_suffix(".py").read_text()
    functions = {n.name: n for n in ast.parse(source).body if isinstance(n, ast.FunctionDef)}
    assert name in functions
    used = {n.attr for n in ast.walk(functions[name]) if isinstance(n, ast.Attribute)}
    names = {n.id for n in ast.walk(functions[name]) if isinstance(n, ast.Name)}
    short = record.function.rsplit(".", 1)[1]
    assert short in used | names, f"{record.check} never calls {short}"


@pytest.mark.parametrize("record", eq.catalog(), ids=lambda r: f"{r.paper}:{r.number}")
def test_texts_are_there_and_latex_is_balanced(record):
    assert record.title
    assert record.title[0].isupper()
    assert record.latex.count("{") == record.latex.count("}") > 0 or "{" not in record.latex
    assert not re.search(r"\$|\\\\", record.latex)
    assert all(isinstance(field, str) for field in record)


def test_catalog_hands_out_its_own_list():
    eq.catalog().clear()
    assert len(eq.catalog()) == 85


def test_latex_uses_only_commands_that_exist():
    """A misspelt command would only show in the rendered book."""
    formulas = [record.latex for record in eq.catalog()]
    for name in eq.__all__:
        formulas += re.findall(
            r"\.\. math::(.*?)\n\n", inspect.getdoc(getattr(eq, name)) or "", re.S
        )
    assert len(formulas) > 120
    for formula in formulas:
        for command in re.findall(r"\\([A-Za-z]+)", formula):
            assert command in LATEX, f"\\{command} in {formula}"


def all_functions():
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef):
                yield path, node


def test_no_function_is_longer_than_a_blackboard():
    for path, node in all_functions():
        body = node.body[1:] if ast.get_docstring(node) else node.body
        lines = body[-1].end_lineno - body[0].lineno + 1
        assert lines <= 15, f"{path.name}: {node.name} has {lines} lines"


def test_every_exported_function_says_what_where_and_how_it_fails():
    for name in eq.__all__:
        value = getattr(eq, name)
        if inspect.isfunction(value) and name != "catalog":
            text = inspect.getdoc(value)
            for part in ("Args:", ".. math::", "Raises:", "Source: "):
                assert part in text, f"{name} has no {part}"


def test_only_numpy_and_scipy_are_imported():
    allowed = {"__future__", "collections", "itertools", "typing", "numpy", "scipy"}
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                assert {alias.name.split(".")[0] for alias in node.names} <= allowed, path
            if isinstance(node, ast.ImportFrom) and node.level == 0:
                assert node.module.split(".")[0] in allowed, path

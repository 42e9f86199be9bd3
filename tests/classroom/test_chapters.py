"""The exercises of the tutorial notebooks, as nbgrader finds them; without a kernel."""

import ast
import contextlib
import io
import itertools
import json
from pathlib import Path

import nbformat
import numpy as np
import pytest
from nbgrader.preprocessors import ClearHiddenTests, ClearSolutions

from projflow_lite.classroom import check, course
from projflow_lite.classroom.course.chapter import CHECK
from projflow_lite.classroom.course.notebook import HIDDEN_SEED
from projflow_lite.cli import main

NOTEBOOKS = sorted((Path(__file__).parents[2] / "notebooks").glob("*.ipynb"))
WITH_EXERCISES = [p for p in NOTEBOOKS if r"check(\"projflow:" in p.read_text(encoding="utf-8")]
FIRST = NOTEBOOKS[0].with_name("02_the_projection.ipynb")

each = pytest.mark.parametrize("path", WITH_EXERCISES, ids=lambda path: path.stem)


def metadata(name, **flags):
    return {"cell_type": "code", "grade_id": name, "schema_version": 3, "task": False, **flags}


def run(source, names):
    """Run a cell; what it prints comes back."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(source, names)
    return printed.getvalue()


def imports(cells):
    """What the cells import, without the rest of them."""
    names = {}
    for cell in cells:
        if cell.cell_type == "code":
            for part in ast.parse(cell.source).body:
                if isinstance(part, ast.Import | ast.ImportFrom):
                    exec(ast.unparse(part), names)
    return names


def test_most_tutorials_have_exercises():
    assert len(WITH_EXERCISES) >= 9


@each
def test_every_check_is_graded_and_stands_right_below_its_answer(path):
    cells = nbformat.read(path, as_version=4).cells
    for above, cell in itertools.pairwise(cells):
        if cell.cell_type != "code" or 'check("projflow:' not in cell.source:
            continue
        call = CHECK.fullmatch(cell.source)
        assert call, f"a check has its cell for itself, without {cell.source!r}"
        name = call["function"]
        points = cell.metadata.get("nbgrader", {}).get("points")
        assert points in (1, 2, 3)
        assert cell.metadata["nbgrader"] == metadata(
            f"test_{name}", grade=True, solution=False, locked=True, points=points
        )
        assert f"def {name}(" in above.source
        assert above.metadata["nbgrader"] == metadata(
            name, grade=False, solution=True, locked=False
        )


@each
def test_names_are_unique_and_each_belongs_to_an_exercise(path):
    cells = nbformat.read(path, as_version=4).cells
    names = [c.metadata.nbgrader.grade_id for c in cells if "nbgrader" in c.metadata]
    assert len(set(names)) == len(names)
    assert sorted(names) == sorted(
        name
        for exercise in course.chapter(path).exercises
        for name in (exercise.function, f"test_{exercise.function}")
    )


@each
def test_who_learns_alone_is_told_that_nothing_is_written_yet(path):
    cells = nbformat.read(path, as_version=4).cells
    names = imports(cells)
    for answer, test in itertools.pairwise(cells):
        if test.metadata.get("nbgrader", {}).get("grade"):
            run(answer.source, names)
            assert "not written yet" in str(eval(test.source, names))


@each
def test_the_answers_of_a_notebook_pass_the_lecturers_tests(path):
    made = course.chapter(path)
    nbformat.validate(made.notebook)
    names = imports(made.notebook.cells)
    for exercise in made.exercises:
        run(exercise.answer.source, names)
        assert run(exercise.test.source, names).startswith(f"Right: {exercise.id}")
        right = names[exercise.function]
        learned = by_heart(right, check(exercise.id, right).cases)
        with pytest.raises(AssertionError, match="other numbers"):
            run(exercise.test.source, {**names, exercise.function: learned})


def by_heart(right, visible):
    """A function that is right for the visible cases only."""
    calls = []

    def learned(*arguments):
        calls.append(arguments)
        return right(*arguments) if len(calls) <= visible else np.zeros(1)

    return learned


@each
def test_what_is_released_holds_no_answer_and_all_of_the_rest(path):
    made = course.chapter(path)
    solutions = [exercise.answer.source for exercise in made.exercises]
    released = made.notebook
    for clear in (ClearSolutions(code_stub={"python": "..."}), ClearHiddenTests()):
        released, _ = clear.preprocess(released, {})
    sources = [cell.source for cell in released.cells]
    whole = "\n".join(sources)
    for word in ("SOLUTION", "HIDDEN", "One answer", str(HIDDEN_SEED)):
        assert word not in whole
    for solution in solutions:
        body = solution.split("### BEGIN SOLUTION\n")[1].split("    ### END SOLUTION")[0]
        assert body.strip()
        assert not [line for line in body.splitlines() if line.strip() in whole]
    for exercise in made.exercises:
        assert exercise.answer.source.endswith("\n    ...")
    for cell in nbformat.read(path, as_version=4).cells:
        if "nbgrader" not in cell.metadata:
            *_, below = cell.source.rpartition("</details>\n\n")
            rest = below if "One answer" in cell.source else cell.source
            assert rest in sources or rest.endswith("</details>")


@each
def test_the_file_itself_stays_as_it_is(path):
    before = path.read_bytes()
    course.chapter(path)
    assert path.read_bytes() == before


def write(path, *cells):
    nbformat.write(nbformat.v4.new_notebook(cells=list(cells)), path)
    return path


def code(source, **marked):
    return nbformat.v4.new_code_cell(source, metadata={"nbgrader": metadata(**marked)})


ANSWER = code("def f(x):\n    ...", name="f", grade=False, solution=True, locked=False)
WRITTEN = code("def f(x):\n    pass", name="f", grade=False, solution=True, locked=False)
TEST = code('check("projflow:7", f)', name="t", grade=True, solution=False, locked=True, points=1)
MORE = code("check('projflow:7', f)", name="t", grade=True, solution=False, locked=True, points=1)


def text(answer):
    block = f"<details><summary>One answer</summary>\n\n```python\n{answer}\n```\n</details>"
    return nbformat.v4.new_markdown_cell(block)


@pytest.mark.parametrize(
    ("cells", "words"),
    [
        ([], "mistake.ipynb has no exercises"),
        ([ANSWER], "mistake.ipynb has no exercises"),
        ([ANSWER, TEST], "mistake.ipynb has no answer to f; below its check, add"),
        ([text("return x"), ANSWER, TEST], "has no answer to f"),
        ([TEST, text("return x")], "no cell asks for f"),
        ([ANSWER, MORE, text("return x")], "the cell 't' is graded, but is not a check"),
        ([WRITTEN, TEST, text("return x")], "the cell of f has no line of three dots"),
        ([ANSWER, TEST, text("return (x")], "an answer in mistake.ipynb is no Python"),
        ([ANSWER, TEST, text("a = 1\ndef f(x):\n    return a")], "code outside of the function"),
    ],
)
def test_a_mistake_in_a_notebook_is_named(tmp_path, cells, words):
    path = write(tmp_path / "mistake.ipynb", *cells)
    with pytest.raises(ValueError, match=words) as refused:
        course.chapter(path)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("content", ["", "hello", "[1]", '{"cells": 3}', "\ud800"])
def test_what_is_no_notebook_is_refused(tmp_path, content):
    path = tmp_path / "other.ipynb"
    path.write_bytes(content.encode("utf-8", "surrogatepass"))
    with pytest.raises(ValueError, match=r"other.ipynb is no notebook; name"):
        course.chapter(path)
    with pytest.raises(FileNotFoundError, match=r"there is no file"):
        course.chapter(tmp_path / "nothing.ipynb")
    with pytest.raises(ValueError, match=r"'a \+ b.ipynb' gives no name to an assignment"):
        course.chapter(tmp_path / "a + b.ipynb")


def test_an_answer_may_be_a_function_in_one_line(tmp_path):
    cells = ANSWER, TEST, text("def f(x): return x"), text("return 2 * x")
    made = course.chapter(write(tmp_path / "short.ipynb", *cells))
    assert made.exercises[0].answer.source == (
        "def f(x):\n    ### BEGIN SOLUTION\n    return x\n    ### END SOLUTION"
    )
    assert [cell.source for cell in made.notebook.cells[2:]] == [
        cells[3].source
    ]  # of nothing asked


def test_a_course_has_the_chapters_that_were_named(tmp_path, capsys):
    chapters = [str(FIRST), str(FIRST.with_name("04_the_sampler_step_by_step.ipynb"))]
    folder = tmp_path / "course"
    assert main(["classroom", "--course", str(folder), "--chapters", *chapters]) == 0
    made = {path.parent.name: path for path in (folder / "source").rglob("*.ipynb")}
    assert set(made) == {"sheet1", "sheet2", "sheet3", *(Path(name).stem for name in chapters)}
    assert "BEGIN SOLUTION" in made["02_the_projection"].read_text(encoding="utf-8")
    readme = (folder / "README.md").read_text(encoding="utf-8")
    assert "| `02_the_projection` | `02_the_projection.ipynb` | 4 | 7, 21 |" in readme
    assert main(["classroom", "--chapters", *chapters]) == 2
    assert "--course FOLDER" in capsys.readouterr().err


def test_a_course_is_not_begun_if_a_chapter_cannot_be_had(tmp_path):
    for chapters in ([FIRST, NOTEBOOKS[0]], [FIRST, FIRST], [tmp_path / "none.ipynb"]):
        with pytest.raises((ValueError, FileNotFoundError)):
            course.create(tmp_path / "course", chapters=chapters)
        assert not (tmp_path / "course").exists()


def test_the_lecturers_version_is_the_same_every_time():
    one, two = (json.dumps(course.chapter(FIRST).notebook, sort_keys=True) for _ in range(2))
    assert one == two

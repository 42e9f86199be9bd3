"""The sheets, their notebooks and the folder, without nbgrader and without a kernel."""

import contextlib
import io

import nbformat
import numpy as np
import pytest

from projflow_lite import equations
from projflow_lite.classroom import check, course
from projflow_lite.classroom.course import read_sheet

SHEETS = course.sheets()
CHECKED = [(sheet, cell) for sheet in SHEETS for cell in sheet.cells if cell.role == "test"]
PLAY = {"sampler", "pull", "metric"}


def sources(sheet):
    return {cell.id: cell.source for cell in course.notebook(sheet).cells}


def run(source, names):
    """Run a cell; what it prints comes back."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(source, names)
    return printed.getvalue()


@pytest.mark.parametrize("sheet", SHEETS, ids=lambda sheet: sheet.assignment)
def test_a_sheet_is_one_to_enjoy(sheet):
    text = "\n".join(cell.body for cell in sheet.cells if cell.role == "text")
    roles = [cell.role for cell in sheet.cells]
    assert sheet.points == 10
    assert roles.count("written") == 1
    assert text.count("\n## ") <= 12
    for cell in sheet.cells:
        if cell.role == "answer":
            assert f"def {cell.name}(" in cell.body
            assert f"test_{cell.name}" in [c.name for c in sheet.cells]
    for section in text.split("\n## ")[1:]:
        if "(eq." in section.splitlines()[0] or "(ProjFlow eq." in section.splitlines()[0]:
            assert "$$" in section
            assert "**Predict first.**" in section
            assert section.count("<details>") == section.count("</details>") == 1


def test_the_course_covers_what_it_promises():
    numbers = [[cell.exercise for cell in sheet.cells if cell.exercise] for sheet in SHEETS]
    assert numbers == [
        [f"projflow:{n}" for n in (2, 3, 5, 9, 10)],
        [f"projflow:{n}" for n in (38, 21, 7, 31, 46)],
        [f"projflow:{n}" for n in (11, 51, 14, 16, 17, 52)],
    ]


@pytest.mark.parametrize(("sheet", "cell"), CHECKED, ids=lambda x: getattr(x, "exercise", ""))
def test_hidden_tests_accept_the_right_function_and_refuse_one_that_is_off(sheet, cell):
    function = cell.name.removeprefix("test_")
    right = getattr(equations, function)

    def off(*arguments):
        result = right(*arguments)
        return (result[0] + 1e-3, result[1]) if isinstance(result, tuple) else result + 1e-3

    run(cell.body, {"np": np, function: right})
    with pytest.raises(AssertionError):
        run(cell.body, {"np": np, function: off})


@pytest.mark.parametrize(("sheet", "cell"), CHECKED, ids=lambda x: getattr(x, "exercise", ""))
def test_a_function_right_for_the_visible_numbers_only_gets_no_points(sheet, cell):
    function = cell.name.removeprefix("test_")
    right, calls = getattr(equations, function), []
    visible = check(cell.exercise, right).cases

    def learned_by_heart(*arguments):
        calls.append(arguments)
        result = right(*arguments)
        if len(calls) <= visible:
            return result
        return tuple(2 * r + 1 for r in result) if isinstance(result, tuple) else 2 * result + 1

    with pytest.raises(AssertionError):
        run(sources(sheet)[cell.name], {function: learned_by_heart})
    assert len(calls) > visible  # it came past the visible check


@pytest.mark.parametrize("sheet", SHEETS, ids=lambda sheet: sheet.assignment)
def test_the_lecturers_version_runs_in_one_go(sheet, monkeypatch):
    import plotly.graph_objects as go

    shown = []
    monkeypatch.setattr(go.Figure, "show", lambda figure, renderer: shown.append(len(figure.data)))
    names = {}
    for cell in course.notebook(sheet).cells:
        if cell.cell_type == "code":
            printed = run(cell.source, names)
            assert printed.startswith("Right:") == cell.id.startswith("test_")
    assert shown == {"sheet1": [42], "sheet2": [2], "sheet3": []}[sheet.assignment]


def test_sections_to_play_with_say_what_is_true():
    names = {}
    for cell in course.notebook(SHEETS[0]).cells:
        if cell.cell_type == "code" and cell.id not in PLAY:
            run(cell.source, names)
    run(sources(SHEETS[0])["sampler"].split("random = np.random")[0], names)
    start = np.random.default_rng(3).normal(size=(150, 2))
    ends = names["my_sampler"](start, steps=1, eta=0.0, random=np.random.default_rng(4))[-1]
    assert np.allclose(ends, names["places"].mean(axis=0))  # "into one point, the average"
    ends = names["my_sampler"](start, steps=40, eta=0.0, random=np.random.default_rng(4))[-1]
    distance = np.linalg.norm(ends[:, None] - names["places"], axis=-1).min(axis=1)
    assert np.median(distance) < 3 * np.sqrt(0.05)  # the three places are found


def test_create_lays_out_a_course_that_is_the_same_every_time(tmp_path):
    one = course.create(tmp_path / "a" / "course", course_id="motion-26", seconds_per_cell=12)
    two = course.create(tmp_path / "b", course_id="motion-26", seconds_per_cell=12)
    files = sorted(f.relative_to(one).as_posix() for f in one.rglob("*") if f.is_file())
    assert files == [
        "README.md",
        "nbgrader_config.py",
        "source/sheet1/from_noise_to_motion.ipynb",
        "source/sheet2/the_projection.ipynb",
        "source/sheet3/the_metric_and_the_guides.ipynb",
    ]
    for name in files:
        assert (one / name).read_bytes() == (two / name).read_bytes()
    config = (one / "nbgrader_config.py").read_text()
    assert 'course_id = "motion-26"' in config
    assert "c.Execute.timeout = 12\n" in config
    readme = (one / "README.md").read_text()
    assert "after 12 seconds" in readme
    assert "| `sheet2` | `the_projection.ipynb` | 10 | 38, 21, 7, 31, 46 |" in readme
    for name in files[2:]:
        nbformat.validate(nbformat.read(one / name, as_version=4))


def test_create_never_overwrites(tmp_path):
    (tmp_path / "notes.txt").write_text("mine")
    with pytest.raises(FileExistsError, match="not an empty folder; name a new one"):
        course.create(tmp_path)
    with pytest.raises(FileExistsError, match=r"notes.txt is not an empty folder"):
        course.create(tmp_path / "notes.txt")
    assert [f.name for f in tmp_path.iterdir()] == ["notes.txt"]
    (tmp_path / "empty").mkdir()
    assert course.create(tmp_path / "empty") == tmp_path / "empty"


@pytest.mark.parametrize("course_id", ["", "a b", "../x", 'x"\nimport os'])
def test_a_course_id_that_cannot_be_used_is_refused(tmp_path, course_id):
    with pytest.raises(ValueError, match="is no course id"):
        course.create(tmp_path / "course", course_id=course_id)
    assert not (tmp_path / "course").exists()


@pytest.mark.parametrize("seconds", [0, -1, 2.5])
def test_a_limit_that_cannot_be_used_is_refused(tmp_path, seconds):
    with pytest.raises(ValueError, match="seconds_per_cell"):
        course.create(tmp_path / "course", seconds_per_cell=seconds)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("```python anser f\npass\n```\n", "'anser f' does not open a cell"),
        ("```python test projflow:7 project\n```\n", "does not open a cell"),
        ("```python play a\n```\n```python play a\n```\n", "two cells are called 'a'"),
    ],
)
def test_a_mistake_in_a_sheet_is_named(text, words):
    with pytest.raises(ValueError, match=words):
        read_sheet("sheet9_mistake", text)


def test_fences_without_a_role_stay_text():
    sheet = read_sheet("sheet9_plain", "# T\n```python\nx = 1\n```\n## A\nb\n")
    assert [cell.role for cell in sheet.cells] == ["text", "text"]
    assert "x = 1" in sheet.cells[0].body

"""A whole term with nbgrader: sheets go out, three students hand in, marks come back."""

import re

import pytest
from nbgrader_term import Term

from projflow_lite.classroom import course

SHEETS = {sheet.assignment: sheet for sheet in course.sheets()}
WRITTEN = {"sheet1": "by_hand", "sheet2": "same_motion", "sheet3": "columns"}

# What the students wrote instead of the right thing.
R_IN_PLACE_OF_ITS_INVERSE = """
def project(x1_hat, A, y, R, Sigma):
    return x1_hat + R @ A.T @ np.linalg.solve(A @ R @ A.T + Sigma, y - A @ x1_hat)
"""
THE_OTHER_SHARE = "def trust_from_variance(variance, r):\n    return variance / (r + variance)\n"
RIGHT_WITH_A_WARNING = """
def ddnm(x1_hat, A, y):
    np.zeros(1) / np.zeros(1)  # numpy warns, on stderr
    return x1_hat + np.linalg.pinv(A) @ (y - A @ x1_hat)
"""
A_CELL_THAT_CRASHES = "def interpolate(x0, x1, t):\n    return x0\n\nraise RuntimeError('oh no')\n"
A_FUNCTION_THAT_NEVER_ENDS = "def flow_matching_loss(v, x0, x1):\n    while True:\n        pass\n"

# Right answers, by student and sheet, are worth 8 points by machine and 2 by hand.
MARKS = {
    ("ada", "sheet1"): 8 + 2,
    ("ada", "sheet2"): 8 + 2,
    ("ada", "sheet3"): 8 + 2,
    ("ben", "sheet2"): 8 - 3 - 1 + 0.5,  # eq. 7 and eq. 46; half a point by hand
    ("cleo", "sheet1"): 8 - 1 - 2 + 0,  # eq. 2 and eq. 3; nothing written
}


def mark_by_hand(term, student, assignment, score, words):
    key = WRITTEN[assignment], SHEETS[assignment].notebook, assignment, student
    with term.gradebook() as book:
        grade = book.find_grade(*key)
        assert grade.needs_manual_grade
        grade.manual_score, grade.needs_manual_grade = score, False
        book.find_comment(*key).manual_comment = words
        book.db.commit()


@pytest.fixture(scope="module")
def term(tmp_path_factory):
    term = Term(tmp_path_factory.mktemp("term"))
    for assignment in SHEETS:
        term.nbgrader("generate_assignment", assignment)
        term.hand_in("ada", assignment, term.solutions(assignment))
    wrong = {
        "project": R_IN_PLACE_OF_ITS_INVERSE,
        "trust_from_variance": THE_OTHER_SHARE,
        "ddnm": RIGHT_WITH_A_WARNING,
        "same_motion": "By the Woodbury identity.",
    }
    term.hand_in("ben", "sheet2", term.solutions("sheet2") | wrong)
    broken = {"interpolate": A_CELL_THAT_CRASHES, "flow_matching_loss": A_FUNCTION_THAT_NEVER_ENDS}
    answers = term.solutions("sheet1") | broken
    del answers["by_hand"]
    term.hand_in("cleo", "sheet1", answers, deleted=["test_mix_noise"])
    for assignment in SHEETS:
        term.nbgrader("autograde", assignment)
        mark_by_hand(term, "ada", assignment, 2, "Well done.")
    mark_by_hand(term, "ben", "sheet2", 0.5, "Show that it applies here.")
    term.nbgrader("generate_feedback", "sheet2", "--student", "ben")
    return term


@pytest.mark.parametrize("assignment", SHEETS)
def test_what_is_handed_out_holds_no_answer(term, assignment):
    text = (term.course / "release" / assignment).rglob("*.ipynb")
    whole = "".join(path.read_text() for path in text)
    assert "BEGIN" not in whole
    assert "HIDDEN" not in whole.upper()
    released = {cell.id: cell.source for cell in term.read("release", assignment).cells}
    for cell in SHEETS[assignment].cells:
        if cell.role == "answer":
            given = released[cell.name].split('"""')
            assert given[2].strip() == "..."
            assert given[:2] == cell.body.split('"""')[:2]  # the name and the docstring stayed
        if cell.role == "test":
            assert released[cell.name].endswith('what is wrong"')
        if cell.role == "written":
            assert released[cell.name] == "*Your answer here.*"


@pytest.mark.parametrize("assignment", SHEETS)
def test_an_untouched_sheet_is_said_to_be_unwritten(term, assignment, capsys):
    roles = {cell.name: cell.role for cell in SHEETS[assignment].cells}
    names = {}
    for cell in term.read("release", assignment).cells:
        if roles[cell.id] in ("setup", "answer"):
            exec(cell.source, names)
        if roles[cell.id] == "test":
            with pytest.raises(AssertionError, match="not right yet"):
                exec(cell.source, names)
            assert "not written yet" in capsys.readouterr().out


def test_everybody_gets_the_marks_they_earned(term):
    rows = term.exported()
    handed_in = {
        (row["student_id"], row["assignment"]): float(row["score"])
        for row in rows
        if row["timestamp"] or float(row["score"]) > 0
    }
    assert handed_in == MARKS
    assert {float(row["max_score"]) for row in rows} == {10.0}


@pytest.mark.parametrize(
    ("student", "assignment", "lost"),
    [
        ("ada", "sheet1", set()),
        ("ada", "sheet2", set()),
        ("ada", "sheet3", set()),
        ("ben", "sheet2", {"test_project", "test_trust_from_variance"}),
        ("cleo", "sheet1", {"test_interpolate", "test_flow_matching_loss", "by_hand"}),
    ],
)
def test_points_are_lost_where_the_mistakes_are_and_nowhere_else(term, student, assignment, lost):
    assert term.lost(student, assignment) == lost


def test_a_cell_without_end_is_interrupted_and_the_cells_below_it_are_run(term):
    cells = {cell.id: cell for cell in term.read("autograded/cleo", "sheet1").cells}
    errors = {
        name: [output.ename for output in cell.get("outputs", []) if output.output_type == "error"]
        for name, cell in cells.items()
    }
    assert errors["interpolate"] == ["RuntimeError"]
    assert errors["test_interpolate"] == ["AssertionError"]
    assert "CellTimeoutError" in errors["test_flow_matching_loss"]
    assert errors["test_recompose"] == []
    assert "Right: projflow:10" in cells["test_recompose"].outputs[0].text


def test_a_check_that_was_deleted_is_put_back(term):
    sources = [cell.source for cell in term.read("autograded/cleo", "sheet1").cells]
    assert any("test_mix_noise) was missing" in source for source in sources)


def test_feedback_says_in_words_what_was_wrong(term):
    html = (term.course / "feedback" / "ben" / "sheet2" / "the_projection.html").read_text()
    assert "Not yet: projflow:7" in html
    assert "Right: projflow:31" in html
    assert "Show that it applies here." in html
    assert "Score: 4.5 / 10.0" in re.sub(r"\s+", " ", html)

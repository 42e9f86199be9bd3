"""A tutorial notebook as homework: it goes out, two students hand in, marks come back."""

from pathlib import Path

import pytest
from nbgrader_term import Term

CHAPTER = "02_the_projection"
NOTEBOOK = Path(__file__).parents[2] / "notebooks" / f"{CHAPTER}.ipynb"
WITHOUT_THE_METRIC = """
def my_project(x1_hat, A, y, R, Sigma):
    return x1_hat + A.T @ np.linalg.pinv(A @ A.T + Sigma) @ (y - A @ x1_hat)
"""


@pytest.fixture(scope="module")
def term(tmp_path_factory):
    term = Term(tmp_path_factory.mktemp("term"), seconds_per_cell=60, chapters=[NOTEBOOK])
    term.nbgrader("generate_assignment", CHAPTER)
    term.hand_in("ada", CHAPTER, term.solutions(CHAPTER))
    term.hand_in("ben", CHAPTER, term.solutions(CHAPTER) | {"my_project": WITHOUT_THE_METRIC})
    term.nbgrader("autograde", CHAPTER)
    return term


def test_what_is_handed_out_is_the_tutorial_without_its_answers(term):
    released = term.path("release", CHAPTER).read_text(encoding="utf-8")
    for word in ("BEGIN", "HIDDEN", "One answer", "R_inv_At"):
        assert word not in released
    cells = term.cells("release", CHAPTER)
    assert cells["my_project"].source == "def my_project(x1_hat, A, y, R, Sigma):\n    ..."
    assert cells["test_my_project"].source.endswith('what is wrong"')


def test_everybody_gets_the_marks_they_earned(term):
    rows = [row for row in term.exported() if row["assignment"] == CHAPTER]
    marks = {row["student_id"]: (float(row["score"]), float(row["max_score"])) for row in rows}
    assert marks == {"ada": (4, 4), "ben": (1, 4)}
    assert term.lost("ben", CHAPTER) == {"test_my_project"}


def test_the_whole_notebook_ran_with_every_submission(term):
    for student, wrong in (("ada", []), ("ben", ["AssertionError"])):
        cells = term.read(f"autograded/{student}", CHAPTER).cells
        outputs = [output for cell in cells for output in cell.get("outputs", [])]
        assert [o.ename for o in outputs if o.output_type == "error"] == wrong
        assert any("minimiser" in output.get("text", "") for output in outputs)

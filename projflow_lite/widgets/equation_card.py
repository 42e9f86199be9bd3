"""The equation card: any printed equation, its function, numbers to change, and what is wrong."""

from __future__ import annotations

import ast
import html
import inspect
from collections.abc import Callable
from typing import Any

import ipywidgets as widgets
import numpy as np

from projflow_lite import equations
from projflow_lite.equations.records.record import Record
from projflow_lite.widgets.equation_examples import example, forms

SLIDERS = {
    "t": (0.0, 1.0), "t_next": (0.0, 1.0), "eta": (0.0, 1.0), "pi": (0.01, 1.0),
    "alpha_bar": (0.0, 1.0), "tau_min": (0.0, 1.0), "w_kin": (0.0, 100.0), "ridge": (0.1, 10.0),
    "variance": (0.0, 2.0), "scale": (1.0, 20.0), "c0": (0.0, 10.0), "p": (0.5, 4.0),
    "lambda_s": (0.0, 5.0), "l_min": (0.0, 10.0), "l_max": (0.0, 20.0), "s": (0.1, 3.0),
}  # fmt: skip
"""Arguments that are moved with a slider, and its ends."""


class EquationCard(widgets.VBox):
    """One equation of the three papers at a time: formula, erratum, live numbers, code.

    Change an argument, and the result follows. A list of lists is a matrix. Where an equation has
    more than one reading, choose between them. Equations without a function say so.

    Args:
        paper: "ProjFlow", "GMD" or "BMM".
        number: of the equation, as `equations.catalog` has it, e.g. ``"7"``.

    Raises:
        ValueError: if there is no such equation.

    ``.record`` is the line of the catalog, ``.arguments`` what the function was called with,
    ``.result`` what it returned, None if it refused.
    """

    def __init__(self, paper: str = "ProjFlow", number: str | int = "7") -> None:
        self.records = {(r.paper, r.number): r for r in equations.catalog()}
        if (paper, str(number)) not in self.records:
            raise ValueError(
                f"EquationCard: there is no equation {number!r} of {paper!r}; "
                "see projflow_lite.equations.catalog()"
            )
        self.paper = widgets.Dropdown(
            options=list(dict.fromkeys(r.paper for r in self.records.values())),
            description="paper", layout={"width": "170px"}, style={"description_width": "45px"},
        )  # fmt: skip
        self.equation = widgets.Dropdown(
            description="equation", layout={"width": "440px"}, style={"description_width": "65px"}
        )
        self.formula, self.erratum = widgets.HTMLMath(), widgets.HTML()
        self.inputs = widgets.Box(
            layout={"flex_flow": "row wrap", "width": "100%", "grid_gap": "2px 14px"}
        )
        self.output, self.code = widgets.HTML(), widgets.HTML()
        self.choice = widgets.Box(
            layout={"flex_flow": "row wrap", "grid_gap": "2px 10px"},
        )
        parts = [self.choice, self.formula, self.erratum, self.inputs, self.output, self.code]
        super().__init__(parts)
        self.paper.value = paper
        self._list()
        self.equation.value = str(number)
        self._open()
        self.paper.observe(self._list, "value")  # from here on: it was opened once
        self.equation.observe(self._open, "value")

    @property
    def record(self) -> Record:
        """The line of the catalog that is shown."""
        return self.records[self.paper.value, self.equation.value]

    @property
    def function(self) -> Callable[..., Any] | None:
        """The function of the equation, None while there is none."""
        name = self.record.function.rpartition(".")[2]
        return getattr(equations, name) if name else None

    def _list(self, change: dict[str, Any] | None = None) -> None:
        """List the equations of the chosen paper."""
        mine = [r for r in self.records.values() if r.paper == self.paper.value]
        self.equation.options = [(f"{r.number} · {r.title}", r.number) for r in mine]

    def _open(self, change: dict[str, Any] | None = None) -> None:
        """Show the chosen equation with fresh numbers."""
        if self.equation.value is None:
            return
        record, function = self.record, self.function
        self.formula.value = f"$$\n{record.latex}\n$$"
        self.erratum.value = f"<b>⚠ {html.escape(record.erratum)}</b>" if record.erratum else ""
        values = example(function) if function else None
        self.fields = {name: self._field(name, v) for name, v in (values or {}).items()}
        self.form = widgets.Dropdown(
            options=forms(function) if function else (), description="reading",
            layout={"width": "190px"}, style={"description_width": "55px"},
        )  # fmt: skip
        self.form.observe(self._compute, "value")
        self.choice.children = [self.paper, self.equation, *[self.form] * bool(self.form.options)]
        self.inputs.children = list(self.fields.values())
        self.code.value = code_of(function, record.check) if function else ""
        self._compute()

    def _field(self, name: str, value: Any) -> widgets.Widget:
        """A slider for a number with known ends, a line of text for anything else."""
        field: widgets.Widget
        if name in SLIDERS and isinstance(value, float):
            low, high = SLIDERS[name]
            field = widgets.FloatSlider(
                value=value, min=low, max=high, step=(high - low) / 100, description=name,
                layout={"width": "300px"}, style={"description_width": "75px"},
            )  # fmt: skip
        else:
            text = str(value)
            field = widgets.Text(
                value=text, description=name, continuous_update=True,
                layout={"width": f"{min(700, 130 + 8 * len(text))}px"},
                style={"description_width": "75px"},
            )  # fmt: skip
        field.observe(self._compute, "value")
        return field

    def _compute(self, change: dict[str, Any] | None = None) -> None:
        """Call the function with what the fields say."""
        self.result, self.arguments = None, {}
        function = self.function
        if function is None:
            self.output.value = "There is no function for this equation yet."
            return
        if not self.fields:
            self.output.value = "It takes a function as an argument; see the code for how."
            return
        try:
            self.arguments = {name: read(name, field.value) for name, field in self.fields.items()}
            reading = {"form": self.form.value} if self.form.value else {}
            self.result = function(**self.arguments, **reading)
        except (ValueError, TypeError, np.linalg.LinAlgError) as error:
            self.output.value = f'<span style="color: #c33">{html.escape(str(error))}</span>'
            return
        self.output.value = shown(function.__name__, self.result)


def read(name: str, value: Any) -> Any:
    """The value of a field: a number, or lists of numbers written as Python writes them.

    Raises:
        ValueError: if it cannot be read.
    """
    if not isinstance(value, str):
        return value
    try:
        return ast.literal_eval(value)
    except (ValueError, SyntaxError):
        raise ValueError(
            f"{name}: write a number, or lists of numbers as in [[1, 0], [0, 1]]"
        ) from None


def shown(name: str, result: Any) -> str:
    """A result with the shape of every array in it."""
    parts = result if isinstance(result, tuple) else (result,)
    lines = []
    for part in parts:
        array = np.asarray(part)
        digits = np.array2string(array, precision=4, suppress_small=True, threshold=200)
        lines.append(f"{digits}\n{array.shape}" if array.ndim else digits)
    text = html.escape("\n".join(lines))
    return f'<pre style="line-height: 1.4">{html.escape(name)}(…) =\n{text}</pre>'


def code_of(function: Callable[..., Any], check: str) -> str:
    """The source of a function, to be unfolded, and the test that checks it from outside."""
    source = html.escape(inspect.getsource(function))
    return (
        f"<details><summary>code of {html.escape(function.__name__)}</summary>"
        f'<pre style="line-height: 1.35; white-space: pre-wrap">{source}</pre></details>'
        f"checked from outside by <code>{html.escape(check)}</code>"
    )

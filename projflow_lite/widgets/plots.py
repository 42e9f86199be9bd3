"""Plotly in the package's own look: ``from projflow_lite.widgets.plots import go``.

A figure is clear, so that the page shows through, light or dark. Its words and lines are of one
grey that can be read on both. No grey reaches a contrast of 4.5 on white and on a nearly black page
at once; this one does on white. Where the page's theme is known, `widgets.css` (JupyterLab) and the
book's own script give the words the theme's ink instead.
"""

from __future__ import annotations

import plotly.graph_objects as go
import plotly.io

__all__ = ["COLOURS", "GREY", "GRID", "TEMPLATE", "go"]

COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#767676")
"""Of the traces, in this order: Okabe and Ito's, as far as they stand out on white and on black."""

GREY = "#767676"
GRID = "rgba(128, 128, 128, 0.3)"
CLEAR = "rgba(0, 0, 0, 0)"


def look() -> go.layout.Template:
    """The template: clear ground, grey words, the package's colours."""
    axis = {
        "automargin": True, "gridcolor": GRID, "linecolor": GREY, "tickcolor": GREY,
        "zerolinecolor": "rgba(128, 128, 128, 0.6)", "title": {"standoff": 12},
    }  # fmt: skip
    words = {"font": {"color": GREY}}
    return go.layout.Template(
        layout={
            "paper_bgcolor": CLEAR, "plot_bgcolor": CLEAR, "colorway": COLOURS,
            "font": {"color": GREY}, "xaxis": axis, "yaxis": axis,
            "legend": {"bgcolor": CLEAR},
            "hoverlabel": {"bgcolor": "#333333", "bordercolor": GREY, "font": {"color": "#ffffff"}},
            "modebar": {"bgcolor": CLEAR, "color": GREY, "activecolor": COLOURS[0]},
            "annotationdefaults": {"arrowcolor": GREY},
            "updatemenudefaults": {"bgcolor": CLEAR, "bordercolor": GREY} | words,
            "sliderdefaults": {"bgcolor": GREY, "bordercolor": GREY, "tickcolor": GREY} | words,
            "colorscale": {"sequential": "Cividis", "sequentialminus": "Cividis"},
        }
    )  # fmt: skip


TEMPLATE = look()
plotly.io.templates["projflow_lite"] = TEMPLATE
plotly.io.templates.default = "projflow_lite"

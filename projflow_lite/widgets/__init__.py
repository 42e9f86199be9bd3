"""What a person touches: the motion viewer, the path pad, and the studio that joins them."""

from projflow_lite.widgets.board import Board
from projflow_lite.widgets.equation_card import EquationCard
from projflow_lite.widgets.flipbook import Flipbook
from projflow_lite.widgets.metric_explorer import MetricExplorer
from projflow_lite.widgets.path_pad import BOUNDS, PLANES, PathPad
from projflow_lite.widgets.pose_editor import PoseEditor
from projflow_lite.widgets.sampler_scope import SamplerScope
from projflow_lite.widgets.studio import WishStudio
from projflow_lite.widgets.viewer import Viewer, view

__all__ = [
    "BOUNDS",
    "PLANES",
    "Board",
    "EquationCard",
    "Flipbook",
    "MetricExplorer",
    "PathPad",
    "PoseEditor",
    "SamplerScope",
    "Viewer",
    "WishStudio",
    "view",
]

"""What ProjFlow's paper prints of the methods that the study of lifting measures: its Table 2."""

from __future__ import annotations

from projflow_lite.studies.claims import Printed

RETRIEVAL, LIFT, DIRECT = "motion retrieval", "lift-and-control", "direct 2D-to-motion"

TABLE = Printed(
    columns=(
        "FID", "skating gmd", "MPJPE-2D", "MPJPE-3D", "average error 2D", "average error 3D",
        "matching", "R top 3",
    ),
    rows={
        "average": {
            RETRIEVAL: (0.69, 0.064, 0.057, 0.076, 0.29, 0.41, 4.06, 0.64),
            LIFT: (0.979, 0.089, 0.054, 0.071, 0.261, 0.34, 3.297, 0.752),
            DIRECT: (2.553, 0.112, 0.04, 0.055, 0.193, 0.275, 3.723, 0.687),
            "sketch2anim": (0.525, 0.103, 0.036, 0.048, 0.087, 0.134, 3.077, 0.802),
            "projflow": (0.349, 0.146, 0, 0.042, 0, 0.331, 3.363, 0.748),
        },
        "cross": {
            RETRIEVAL: (0.103, 0.067, 0.055, 0.073, 0.307, 0.423, 3.405, 0.724),
            LIFT: (0.738, 0.101, 0.051, 0.067, 0.209, 0.283, 3.135, 0.778),
            DIRECT: (2.31, 0.123, 0.04, 0.056, 0.189, 0.266, 3.606, 0.709),
            "sketch2anim": (0.577, 0.102, 0.033, 0.046, 0.079, 0.132, 3.042, 0.796),
            "projflow": (0.168, 0.139, 0, 0.037, 0, 0.298, 3.259, 0.764),
        },
    },
    table="Table 2",
    elsewhere={},
)  # fmt: skip
"""The rows of the three baselines are those of Sketch2Anim's authors, whose baselines they are."""

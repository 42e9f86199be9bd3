"""What ProjFlow's paper prints of the methods that the study of control measures."""

from __future__ import annotations

from projflow_lite.studies.claims import Printed
from projflow_lite.studies.control_ways import EDIT

PRINTED = (
    "FID", "R top 3", "diversity", "skating gmd", "trajectory error", "location error",
    "average error",
)  # fmt: skip
"""Columns of its tables."""

EDITED = ("FID", "R top 1", "R top 2", "R top 3", "matching", "diversity")
"""Columns of the rows on editing the upper body."""

SOURCES = {"euclid": "Table 6", "no fresh noise": "Table 6", "plain masking": "Table 6"}
"""Where the numbers of a method are printed, if not in Table 7."""

PAPER: dict[str, dict[str, tuple[float | None, ...]]] = {
    "pelvis": {
        "imputation": (1.792, 0.673, 9.131, 0.1019, 0.4022, 0.3076, 0.5959),
        "gmd": (0.238, 0.763, 10.011, 0.1009, 0.0931, 0.0321, 0.1439),
        "dno": (0.151, 0.802, None, 0.061, 0.0027, 0.0002, 0.0089),
        "control branch": (0.075, 0.805, 10.536, 0.0603, 0.0081, 0.0011, 0.0134),
        "projflow": (0.107, 0.784, 10.645, 0.063, 0, 0, 0),
        "euclid": (4.36, 0.686, 8.953, 0.055, 0, 0, 0),
        "no fresh noise": (2.439, 0.734, 9.666, 0.096, 0, 0, 0),
        "plain masking": (2.091, 0.726, 9.838, 0.0658, 0, 0, 0),
    },
    "left_foot": {
        "dno": (0.147, 0.799, None, 0.0602, 0.0082, 0.0003, 0.0133),
        "control branch": (0.063, 0.8, 10.542, 0.059, 0.0186, 0.0034, 0.024),
        "projflow": (0.095, 0.771, 10.644, 0.0609, 0, 0, 0),
        "euclid": (0.476, 0.743, 10.399, 0.0643, 0, 0, 0),
        "no fresh noise": (4.45, 0.68, 9.209, 0.0969, 0, 0, 0),
        "plain masking": (0.576, 0.746, 10.309, 0.0681, 0, 0, 0),
    },
    "right_foot": {
        "dno": (0.153, 0.8, None, 0.0597, 0.0086, 0.0003, 0.0138),
        "control branch": (0.071, 0.803, 10.591, 0.0583, 0.0205, 0.003, 0.0251),
        "projflow": (0.096, 0.77, 10.651, 0.0613, 0, 0, 0),
        "euclid": (0.486, 0.745, 10.359, 0.0655, 0, 0, 0),
        "no fresh noise": (4.805, 0.673, 9.129, 0.0944, 0, 0, 0),
        "plain masking": (0.52, 0.748, 10.335, 0.0675, 0, 0, 0),
    },
    "head": {
        "dno": (0.138, 0.801, None, 0.0591, 0.0025, 0.0002, 0.0084),
        "control branch": (0.081, 0.805, 10.52, 0.0598, 0.0051, 0.0009, 0.0152),
        "projflow": (0.099, 0.788, 10.754, 0.0595, 0, 0, 0),
        "euclid": (0.56, 0.761, 10.332, 0.0547, 0, 0, 0),
        "no fresh noise": (1.852, 0.75, 9.714, 0.0706, 0, 0, 0),
        "plain masking": (1.076, 0.751, 10.175, 0.0594, 0, 0, 0),
    },
    "left_wrist": {
        "dno": (0.149, 0.799, None, 0.06, 0.0076, 0.0004, 0.0138),
        "control branch": (0.065, 0.804, 10.48, 0.0604, 0.0085, 0.0014, 0.0206),
        "projflow": (0.089, 0.783, 10.601, 0.0586, 0, 0, 0),
        "euclid": (0.524, 0.754, 10.256, 0.0583, 0, 0, 0),
        "no fresh noise": (3.507, 0.703, 9.019, 0.0801, 0, 0, 0),
        "plain masking": (0.506, 0.759, 10.242, 0.059, 0, 0, 0),
    },
    "right_wrist": {
        "dno": (0.143, 0.798, None, 0.0598, 0.0081, 0.0004, 0.0142),
        "control branch": (0.066, 0.802, 10.484, 0.0599, 0.0091, 0.0016, 0.0201),
        "projflow": (0.096, 0.78, 10.61, 0.0584, 0, 0, 0),
        "euclid": (0.506, 0.753, 10.343, 0.0591, 0, 0, 0),
        "no fresh noise": (3.522, 0.705, 9.111, 0.0799, 0, 0, 0),
        "plain masking": (0.514, 0.759, 10.224, 0.0594, 0, 0, 0),
    },
    "average": {
        "dno": (0.147, 0.8, None, 0.06, 0.0034, 0.0003, 0.0121),
        "control branch": (0.07, 0.803, 10.526, 0.0596, 0.0117, 0.0019, 0.0197),
        "projflow": (0.097, 0.779, 10.651, 0.0603, 0, 0, 0),
        "euclid": (1.152, 0.74, 10.107, 0.0595, 0, 0, 0),
        "no fresh noise": (3.429, 0.707, 9.308, 0.0863, 0, 0, 0),
        "plain masking": (0.881, 0.748, 10.187, 0.0632, 0, 0, 0),
    },
}
"""The zero-shot rows of Table 7, that of a ControlNet branch on ProjFlow's own prior, trained on
all joints, and the ablations of Table 6, in the order of `PRINTED`; means over the densities 1, 2,
5, 49 and 196 of 196 frames. Imputation is MDM's row. CondMDI has none. All is as printed, the
average trajectory error of DNO too, where the mean of the six joints would be 0.0063."""


EDITS: dict[str, dict[str, tuple[float | None, ...]]] = {
    EDIT: {
        "imputation": (1.918, 0.359, 0.556, 0.654, 4.793, 9.21),
        "control branch": (0.076, 0.532, 0.719, 0.82, 3.098, 10.586),
        "projflow": (0.087, 0.501, 0.69, 0.787, 3.319, 10.571),
    },
}
"""Those rows of Tables 1 and 7 on editing, in the order of `EDITED`."""

TABLES = Printed(PRINTED, PAPER, "Table 7", SOURCES)
EDIT_TABLE = Printed(EDITED, EDITS, "Table 7", {})

"""BMM eq. 1–16, waiting for their functions."""

from .record import Record

RECORDS = [
    Record("BMM", number, title, latex, erratum=erratum)
    for number, title, latex, erratum in [
        (
            "1",
            "Noising, step by step",
            r"q(x_1, \dots, x_T \mid x_0) = \prod_{t=1}^T q(x_t \mid x_{t-1})",
            "",
        ),
        (
            "2",
            "Learned denoising step",
            r"p_\theta(x_{t-1} \mid x_t)"
            r" = \mathcal{N}(x_{t-1}; \mu_\theta(x_t, t), \Sigma_\theta(x_t, t))",
            "",
        ),
        (
            "3",
            "Bézier curve",
            r"B(t) = \sum_{i=0}^n \binom{n}{i} (1 - t)^{n-i} t^i P_i",
            "",
        ),
        ("4", "Loss at constrained points", r"\lVert C \odot (P - \hat{P}) \rVert_2", ""),
        (
            "5",
            "Fréchet distance of two Gaussians",
            r"\lVert \mu - \hat\mu \rVert_2^2"
            r" + \mathrm{tr}\bigl(\Sigma + \hat\Sigma - 2 (\Sigma \hat\Sigma)^{1/2}\bigr)",
            "",
        ),
        ("6", "Diversity", r"\frac{1}{S_d} \sum_{i=1}^{S_d} \lVert v_i - v'_i \rVert_2", ""),
        (
            "7",
            "Multimodality",
            r"\frac{1}{C S_m} \sum_{c=1}^{C} \sum_{i=1}^{S_m} \lVert v_{c,i} - v'_{c,i} \rVert_2",
            "Sums to S_m, while the two subsets that it pairs hold S_m / 2 samples each.",
        ),
        ("8", "Loss of control points", r"\lVert P - \hat{P} \rVert_2", ""),
        ("9", "Loss of tangents", r"\lVert T - \hat{T} \rVert_2", ""),
        ("10", "Loss of orientations", r"\lVert O - \hat{O} \rVert_2", ""),
        ("11", "Loss of sampled positions", r"\lVert P_d - \hat{P}_d \rVert_2", ""),
        (
            "12",
            "Velocity by differences",
            r"v_{d,j}^i = P_{d,j}^i - P_{d,j}^{i-1}",
            "Used from i = 1 on, where it needs a frame before the first.",
        ),
        ("13", "Loss of velocities", r"\lVert V_d - \hat{V}_d \rVert_2", ""),
        ("14", "Loss at constrained points, again", r"\lVert C \odot (P - \hat{P}) \rVert_2", ""),
        ("15", "Loss of contact labels", r"\lVert GC - \widehat{GC} \rVert_2", ""),
        (
            "16",
            "Loss of sliding feet",
            r"\sum_{j \in feet} \lVert \widehat{GC}_j \odot \hat{V}_j \rVert_2",
            "",
        ),
    ]
]

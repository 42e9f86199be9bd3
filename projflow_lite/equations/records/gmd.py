"""GMD's equations, most of them without a number, waiting for their functions.

P_z takes the trajectory z out of a motion x; P_x puts a trajectory into an empty motion.
"""

from .record import Record

RECORDS = [
    Record("GMD", number, title, latex, erratum=erratum)
    for number, title, latex, erratum in [
        (
            "4 (a)",
            "Motions that reach a goal",
            r"p(x \mid G_x(X) = 0)",
            "",
        ),
        (
            "4 (b)",
            "Motions whose trajectory reaches a goal",
            r"p(x \mid G_z(P_z X) = 0)",
            "",
        ),
        (
            "4.1 (a)",
            "Emphasis projection",
            r"x^{proj} = \frac{1}{\sqrt{N - 3 + 3 c^2}}\, A x, \quad A = A' B",
            "Printed without the square root that unit variance needs; the public code has it.",
        ),
        (
            "4.1 (b)",
            "Noising of a projected motion",
            r"q(x_t^{proj} \mid x_0^{proj})"
            r" = \mathcal{N}(\sqrt{\alpha_t}\, x_0^{proj}, (1 - \alpha_t) I)",
            "",
        ),
        (
            "4.1 (c)",
            "Imputation of a trajectory",
            r"\tilde{x}_0 = (1 - M) \odot x_{0,\theta} + M \odot P_x z^*",
            "The two projections trade names in print; the shapes then do not compose.",
        ),
        (
            "4.1 (d)",
            "Projection undone",
            r"x_0 = \sqrt{N - 3 + 3 c^2}\, A^{-1} x_0^{proj}",
            "Printed without the factor that the projection put in.",
        ),
        (
            "4.1 (e)",
            "Imputation of a projected motion",
            r"\tilde{x}_0^{proj}"
            r" = A \bigl((1 - M) \odot (A^{-1} x_0^{proj}) + M \odot P_x z^*\bigr)",
            "The factor is missing on both sides of the imputation, see 4.1 (d).",
        ),
        (
            "4.2 (a)",
            "Step that lowers the goal",
            r"x_0 = x_{0,\theta} + \Delta_{x_0}, \quad"
            r" \Delta_{x_0} = -\nabla_{x_0} G_z(P_z x_{0,\theta})",
            "The projections trade names in print, see 4.1 (c).",
        ),
        (
            "4.2 (b)",
            "Guidance where nothing is imputed",
            r"\mu_t = \tilde\mu_t - (1 - M) \odot s \Sigma_t \nabla_{x_t} G_z(P_z f(x_t))",
            "The projections trade names in print, see 4.1 (c).",
        ),
        (
            "4.2 (c)",
            "Guidance of a projected motion",
            r"\Delta_\mu = -s \Sigma_t A^{-1} \nabla_{x_t} G_z(P_z A^{-1} f(x_t^{proj}))",
            "The projections trade names in print, see 4.1 (c).",
        ),
        (
            "4.2 (d)",
            "Mean of a projected step",
            r"\mu_t^{proj} = \tilde\mu_t^{proj} + A (1 - M) \odot \Delta_\mu",
            "",
        ),
        (
            "12",
            "Goal of keyframes",
            r"G_x(x) = \sum_i \lVert M_y (P_z x - y) \rVert_p",
            "The projections trade names in print, see 4.1 (c).",
        ),
        (
            "5.2 (a)",
            "Goal of keyframes, of a trajectory",
            r"G_z(z) = \sum_i \lVert M_y (z - y) \rVert_p",
            "",
        ),
    ]
]

"""GMD's formulas, most of them without a number.

:math:`P_x^z` takes the trajectory z out of a motion x; :math:`P_z^x` puts one into an empty motion.
"""

from .record import Record


def gmd(
    number: str, title: str, latex: str, function: str, check: str, erratum: str = ""
) -> Record:
    """Return a checked GMD record, from short names of its function and its test."""
    return Record(
        "GMD",
        number,
        title,
        latex,
        f"projflow_lite.equations.{function}",
        f"tests.equations.{check}",
        "checked",
        erratum,
    )


RECORDS = [
    gmd(
        "4 (a)",
        "Motions that reach a goal",
        r"p(x \mid G_x(X) = 0)",
        "goal_conditioned",
        "test_gmd_goals.test_conditioning_finds_the_gaussian_posterior",
        "Not settled by where the goal is 0: goals with the same zeros can give different answers,"
        " because reaching them has probability 0.",
    ),
    gmd(
        "4 (b)",
        "Motions whose trajectory reaches a goal",
        r"p(x \mid G_z(P_x^z X) = 0)",
        "motion_goal",
        "test_gmd_goals.test_goal_of_a_motion_sees_its_trajectory_alone",
    ),
    gmd(
        "4 (c)",
        "Trajectory of a motion",
        r"z = P_x^z\, x",
        "take_trajectory",
        "test_gmd_goals.test_taking_and_filling_entry_by_entry",
    ),
    gmd(
        "4 (d)",
        "Motion that is only a trajectory",
        r"x = P_z^x\, z",
        "fill_trajectory",
        "test_gmd_goals.test_filling_is_the_transpose_of_taking",
    ),
    gmd(
        "4.1 (a)",
        "Emphasis projection",
        r"x^{proj} = \frac{1}{\sqrt{N - 3 + 3 c^2}}\, A x, \quad A = A' B",
        "emphasise",
        "test_gmd_emphasis.test_unit_variance_of_a_projected_motion",
        "Printed without the square root that unit variance needs (standard deviation 0.042 at"
        " N = 263, c = 10); the public code has it. Even so the variance is 1 on average only.",
    ),
    gmd(
        "4.1 (b)",
        "Noising of a projected motion",
        r"q(x_t^{proj} \mid x_0^{proj})"
        r" = \mathcal{N}(\sqrt{\alpha_t}\, x_0^{proj}, (1 - \alpha_t) I)",
        "diffuse",
        "test_gmd_diffusion.test_noising_in_one_go_is_noising_step_by_step",
        "Here alpha_t is the product over all steps so far; where both appear, that product is"
        " written alpha-bar.",
    ),
    gmd(
        "4.1 (c)",
        "Imputation of a trajectory",
        r"\tilde{x}_0 = (1 - M_z^x) \odot x_{0,\theta} + M_z^x \odot P_z^x z^*",
        "impute",
        "test_gmd_emphasis.test_imputing_entry_by_entry",
    ),
    gmd(
        "4.1 (d)",
        "Projection undone",
        r"x_0 = \sqrt{N - 3 + 3 c^2}\, A^{-1} x_0^{proj}",
        "unemphasise",
        "test_gmd_emphasis.test_undoing_the_projection_solves_a_linear_system",
        "Printed without the factor that the projection put in; the public code inverts both.",
    ),
    gmd(
        "4.1 (e)",
        "Imputation of a projected motion",
        r"\tilde{x}_0^{proj} = k A \bigl((1 - M_z^x) \odot"
        r" (\tfrac{1}{k} A^{-1} x_0^{proj}) + M_z^x \odot P_z^x z^*\bigr)",
        "impute_emphasised",
        "test_gmd_emphasis.test_imputing_a_projected_motion_by_solving_for_it",
        "Printed without the factor k on both sides: the trajectory arrives 24 times too large at"
        " N = 263, c = 10. Undone, it is plain imputation, whatever A and c are.",
    ),
    gmd(
        "4.2 (a)",
        "Step that lowers the goal",
        r"x_0 = x_{0,\theta} + \Delta_{x_0}, \quad"
        r" \Delta_{x_0} = -\nabla_{x_0} G_z(P_x^z x_{0,\theta})",
        "goal_step",
        "test_gmd_guidance.test_goal_step_goes_down_the_numerical_gradient",
        "Printed with the projection that fills in, whose shape does not fit. It has no step size:"
        " with eq. 12 at p = 1 a coordinate moves by 1, however near its keyframe it is.",
    ),
    gmd(
        "4.2 (b)",
        "Guidance where nothing is imputed",
        r"\mu_t = \tilde\mu_t - (1 - M_z^x) \odot s \Sigma_t \nabla_{x_t} G_z(P_x^z f(x_t))",
        "guided_mean",
        "test_gmd_guidance.test_guided_mean_entry_by_entry",
        "Printed with the projection that fills in, see 4.2 (a). The public code guides everywhere"
        " and imputes the mean afterwards, which is the same.",
    ),
    gmd(
        "4.2 (c)",
        "Guidance of a projected motion",
        r"\Delta_\mu = -s \Sigma_t (k A)^{-1}"
        r" \nabla_{x_t^{proj}} G_z(P_x^z (k A)^{-1} f(x_t^{proj}))",
        "unprojected_step",
        "test_gmd_guidance.test_unprojected_step_is_a_gradient_step_in_another_metric",
        "Printed with the projection that fills in, see 4.2 (a), without the factor k, and with a"
        " gradient along x_t where the one along the projected state is meant.",
    ),
    gmd(
        "4.2 (d)",
        "Mean of a projected step",
        r"\mu_t^{proj} = \tilde\mu_t^{proj} + k A \bigl((1 - M_z^x) \odot \Delta_\mu\bigr)",
        "guided_mean_emphasised",
        "test_gmd_guidance.test_imputed_coordinates_stay_and_the_others_follow_the_step",
        "Printed without a bracket: read from left to right the shapes still fit, but the mask"
        " then protects nothing. And without k, which cancels only if 4.2 (c) has none either.",
    ),
    gmd(
        "12",
        "Goal of keyframes",
        r"G_x(x) = \sum_i \lVert (M_y \odot (P_x^z x - y))^{(i)} \rVert_p",
        "keyframe_goal_of_motion",
        "test_gmd_keyframes.test_goal_of_keyframes_step_by_step",
        "Printed as a product of two matrices of 2 rows and M columns, which has no value; the sum"
        " is over steps, and p is left open. The public code takes the mean at p = 1.",
    ),
    gmd(
        "5.2 (a)",
        "Goal of keyframes, of a trajectory",
        r"G_z(z) = \sum_i \lVert (M_y \odot (z - y))^{(i)} \rVert_p",
        "keyframe_goal",
        "test_gmd_keyframes.test_goal_of_keyframes_step_by_step",
        "Printed as a product of matrices, see 12.",
    ),
    gmd(
        "5.2 (b)",
        "Where keyframes are imputed",
        r"M_y^x = P_z^x M_y^z",
        "imputation_region",
        "test_gmd_keyframes.test_region_of_imputation_entry_by_entry",
        "Printed with the projection that takes out, whose shape does not fit a mask of z.",
    ),
    gmd(
        "5.2 (c)",
        "Point-to-point trajectory",
        r"z^{(i)} = \frac{(n' - i)\, y^{(n)} + (i - n)\, y^{(n')}}{n' - n}",
        "point_to_point",
        "test_gmd_keyframes.test_straight_lines_against_fractions",
        "In words only. The public code also starts from the origin at step 0, unless there is a"
        " keyframe.",
    ),
]

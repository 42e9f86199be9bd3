"""ProjFlow eq. 1–20, the main paper."""

from .record import projflow

RECORDS = [
    projflow(
        1,
        "Flow of a velocity field",
        r"\frac{d\psi_t(x_0)}{dt} = v_\theta(\psi_t(x_0), t), \quad \psi_0(x_0) = x_0",
        "flow_map",
        "test_flow.test_flow_map_meets_the_known_solution_of_a_rotating_field",
        "Section C.1 speaks of 100 steps; the public code makes 99 updates (see time_grid).",
    ),
    projflow(
        2,
        "Straight path from noise to data",
        r"x_t = (1 - t)\, x_0 + t\, x_1",
        "interpolate",
        "test_flow.test_interpolate_coordinate_by_coordinate",
    ),
    projflow(
        3,
        "Flow-matching loss",
        r"\mathcal{L}(\theta) = \mathbb{E}\,\lVert v_\theta(x_t, t) - (x_1 - x_0) \rVert_2^2",
        "flow_matching_loss",
        "test_flow.test_flow_matching_loss_is_least_at_the_conditional_mean",
    ),
    projflow(
        4,
        "Linear measurement with noise",
        r"y = A x + \epsilon, \quad \epsilon \sim \mathcal{N}(0, \Sigma)",
        "observe",
        "test_inverse_problem.test_observe_entry_by_entry",
    ),
    projflow(
        5,
        "Predicted clean endpoint",
        r"\hat{x}_1 = \mathbb{E}[x_1 \mid x_t] = x_t + (1 - t)\, v_\theta(x_t, t)",
        "tweedie_endpoint",
        "test_flow.test_tweedie_endpoint_is_the_conditional_mean_of_gaussian_data",
    ),
    projflow(
        6,
        "Price of a correction",
        r"\min_{\Delta} \tfrac12 \lVert \Delta \rVert_R^2"
        r" + \tfrac12 \lVert y - A(\hat{x}_1 + \Delta) \rVert_{\Sigma^{-1}}^2",
        "projection_objective",
        "test_inverse_problem.test_objective_symbolically",
        "Has no value at Sigma = 0, the hard constraints; there it becomes A(x + delta) = y.",
    ),
    projflow(
        7,
        "Smallest correction in closed form",
        r"\Delta^* = R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1} (y - A \hat{x}_1)",
        "projection_correction",
        "test_inverse_problem.test_minimiser_of_the_objective_is_eq_7",
        "The inverse exists only for independent or noisy rows. The public code adds 1e-8 to the"
        " diagonal, so its constraints are nearly, not exactly, met.",
    ),
    projflow(
        8,
        "Corrected endpoint",
        r"\hat{x}_1^* = \hat{x}_1 + \Delta^*",
        "project",
        "test_projection.test_hard_projection_against_a_generic_solver",
    ),
    projflow(
        9,
        "Noise, partly fresh",
        r"\tilde{x}_0 = \sqrt{1 - \eta_t}\, x_0 + \sqrt{\eta_t}\, \epsilon,"
        r" \quad \epsilon \sim \mathcal{N}(0, I)",
        "mix_noise",
        "test_flow.test_mix_noise_keeps_unit_variance_of_independent_noise",
        "Printed with the noise the run started from; the public code mixes the noise that the"
        " state implies, whose variance is below 1 (see implied_noise).",
    ),
    projflow(
        10,
        "Next state from endpoint and noise",
        r"x_{t + \Delta t} = (t + \Delta t)\, \hat{x}_1^* + (1 - t - \Delta t)\, \tilde{x}_0",
        "recompose",
        "test_flow.test_recompose_without_projection_and_fresh_noise_is_an_euler_step",
    ),
    projflow(
        11,
        "Metric of the skeleton",
        r"R = w_{kin} (I_N \otimes L_{kin} \otimes I_3) + \lambda I_d,"
        r" \quad L_{kin} = D_{kin} - A_{kin}",
        "kinematic_metric",
        "test_metric.test_metric_is_the_sum_over_frames_bones_and_axes",
        "Printed as I_3 x I_N x L, the order of a vector sorted axis by axis, next to a text that"
        " sorts frame by frame.",
    ),
    projflow(
        12,
        "Observed coordinates of a motion",
        r"y_{obs} = M_{obs}\, x",
        "masked_observation",
        "test_masks.test_mask_keeps_observed_coordinates_and_zeroes_the_rest",
        "As A in eq. 7, a square mask is singular wherever nothing is observed and Sigma is 0"
        " (see selection_rows). The public code reads the mask of the x axis for all three.",
    ),
    projflow(
        13,
        "Keyframes and guides together",
        r"y^{(t)} = M^{(t)} x + \epsilon^{(t)}, \quad M^{(t)} = M_{obs} + M_{aug}^{(t)},"
        r" \quad y^{(t)} = y_{obs} + M_{aug}^{(t)} y_{src}",
        "combined_observation",
        "test_masks.test_guides_fill_their_coordinates_and_leave_the_others",
        "The guides' variance is called non-zero, but with Table 5 it is 0 early on (eq. 15).",
    ),
    projflow(
        14,
        "Shrinking reach of the guides",
        r"\ell(t) = (1 - t)\, \ell_{max} + t\, \ell_{min}",
        "halo_radius",
        "test_pseudo_observations.test_halo_radius_is_a_straight_line_between_its_ends",
        "With l_min = 3 the guides never vanish, against the text: the last update still has six"
        " around each lone keyframe.",
    ),
    projflow(
        15,
        "Trust in the guides of a frame",
        r"\tilde\pi_n = \tau(t)\, \frac{c_0}{1 + \lambda_s (s_n / s_{med})^p}",
        "frame_trust",
        "test_pseudo_observations.test_frame_trust_number_by_number",
        "With c0 = 3 it exceeds 1 at the median curvature until t = 0.37; clipped to 1 it makes a"
        " guide as hard as a keyframe. The public code takes the lower median.",
    ),
    projflow(
        16,
        "Trust fades with time",
        r"\tau(t) = \tau_{min} + (1 - \tau_{min})(1 - t)",
        "time_decay",
        "test_pseudo_observations.test_time_decay_is_a_straight_line_between_its_ends",
    ),
    projflow(
        17,
        "Curvature of a predicted motion",
        r"s_n = \lVert x_{n+1} - 2 x_n + x_{n-1} \rVert_R",
        "curvature",
        "test_pseudo_observations.test_curvature_by_an_explicit_loop_over_bones",
        "R has the size of a whole motion; the norm of one frame takes its block of R. The first"
        " and last frame are left undefined; the public code copies their neighbours.",
    ),
    projflow(
        18,
        "Variance from trust",
        r"\sigma_i^2 = r_i \frac{1 - \pi_i}{\pi_i}, \quad r_i = [\mathrm{diag}(R^{-1})]_i",
        "variance_from_trust",
        "test_gains.test_trust_is_the_share_of_the_misfit_that_one_row_corrects",
        "The public code reads the variance of the x axis for all three.",
    ),
    projflow(
        19,
        "Orthographic camera",
        r"y_{n,j} = s\, P\, R_{cam}\, x_{n,j}",
        "orthographic_projection",
        "test_applications.test_projection_measures_along_the_cameras_own_axes",
    ),
    projflow(
        20,
        "Rows of a drawn picture",
        r"A = M A_{full}, \quad A_{full} = I_{NJ} \otimes s P R_{cam}",
        "orthographic_rows",
        "test_applications.test_orthographic_rows_see_what_the_projection_sees",
    ),
]

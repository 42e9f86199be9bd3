"""ProjFlow eq. 21–52, the supplement."""

from .record import projflow

NO_INVERSE = "Hard constraints have Sigma = 0, which has no inverse; only eq. 7 survives the limit."
SINGULAR = "The inverse does not exist where a coordinate is neither observed nor noisy."

RECORDS = [
    projflow(
        21,
        "DDNM: range from the data, null space from the prediction",
        r"\hat{x}_1^* = A^{+} y + (I - A^{+} A)\, \hat{x}_1",
        "ddnm",
        "test_projection.test_ddnm_is_the_nearest_point_by_least_squares",
    ),
    projflow(
        22,
        "Projection step in one line",
        r"\hat{x}_1^* = \hat{x}_1 + R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1}"
        r" (y - A \hat{x}_1)",
        "project",
        "test_projection.test_mixed_hard_and_soft_rows_satisfy_lagranges_conditions",
    ),
    projflow(
        23,
        "Euclidean, noiseless case",
        r"\hat{x}_1^* = \hat{x}_1 + A^\top (A A^\top)^{-1} (y - A \hat{x}_1)",
        "euclidean_projection",
        "test_projection.test_ddnm_is_recovered_symbolically",
        "Assumes full row rank, which a square mask with a gap never has; the result (25) holds"
        " without.",
    ),
    projflow(
        24,
        "The same with the pseudo-inverse",
        r"\hat{x}_1^* = \hat{x}_1 + A^{+} y - A^{+} A\, \hat{x}_1",
        "euclidean_projection_expanded",
        "test_projection.test_ddnm_is_recovered_symbolically",
    ),
    projflow(
        25,
        "DDNM recovered",
        r"\hat{x}_1^* = A^{+} y + (I - A^{+} A)\, \hat{x}_1",
        "ddnm",
        "test_projection.test_ddnm_is_recovered_symbolically",
        "One projection agrees; a whole run does only with eta = 0 and the implied noise as well.",
    ),
    projflow(
        26,
        "Prior around the prediction",
        r"p(x_1) = \mathcal{N}(x_1 \mid \hat{x}_1, R^{-1})",
        "log_prior",
        "test_posterior.test_log_prior_is_scipys_gaussian",
    ),
    projflow(
        27,
        "Measurement of the endpoint",
        r"y = A x_1 + \epsilon, \quad \epsilon \sim \mathcal{N}(0, \Sigma)",
        "observe",
        "test_inverse_problem.test_observations_scatter_as_the_likelihood_says",
    ),
    projflow(
        28,
        "Likelihood of the measurement",
        r"p(y \mid x_1) = \mathcal{N}(y \mid A x_1, \Sigma)",
        "log_likelihood",
        "test_posterior.test_log_likelihood_is_scipys_gaussian",
    ),
    projflow(
        29,
        "Posterior up to a constant",
        r"p(x_1 \mid y) \propto \exp\bigl(-\tfrac12 \lVert x_1 - \hat{x}_1 \rVert_R^2"
        r" - \tfrac12 \lVert y - A x_1 \rVert_{\Sigma^{-1}}^2\bigr)",
        "log_posterior_unnormalised",
        "test_posterior.test_posterior_is_prior_times_likelihood",
    ),
    projflow(
        30,
        "Most probable motion",
        r"\arg\min_{x_1} \lVert x_1 - \hat{x}_1 \rVert_R^2"
        r" + \lVert y - A x_1 \rVert_{\Sigma^{-1}}^2",
        "map_objective",
        "test_posterior.test_map_objective_by_double_sums",
    ),
    projflow(
        31,
        "Normal equations",
        r"(R + A^\top \Sigma^{-1} A)\, x_1 = R \hat{x}_1 + A^\top \Sigma^{-1} y",
        "map_normal_equations",
        "test_posterior.test_normal_equations_are_the_stationary_point_of_eq_30",
        NO_INVERSE,
    ),
    projflow(
        32,
        "Their solution",
        r"x_1^{MAP} = (R + A^\top \Sigma^{-1} A)^{-1} (R \hat{x}_1 + A^\top \Sigma^{-1} y)",
        "map_estimate",
        "test_posterior.test_map_estimate_has_no_slope_left",
        NO_INVERSE,
    ),
    projflow(
        33,
        "The solution as a correction",
        r"x_1^{MAP} = \hat{x}_1 + (R + A^\top \Sigma^{-1} A)^{-1} A^\top \Sigma^{-1}"
        r" (y - A \hat{x}_1)",
        "map_estimate_as_correction",
        "test_posterior.test_woodbury_between_33_and_34_with_correlated_noise_symbolically",
        NO_INVERSE,
    ),
    projflow(
        34,
        "The correction is the projection",
        r"\hat{x}_1^* = \hat{x}_1 + R^{-1} A^\top (A R^{-1} A^\top + \Sigma)^{-1}"
        r" (y - A \hat{x}_1)",
        "project",
        "test_posterior.test_eq_7_and_eq_32_are_one_formula_symbolically",
    ),
    projflow(
        35,
        "Two joints at a fixed offset",
        r"x_{n, j_a} - x_{n, j_b} = d",
        "relative_position",
        "test_applications.test_offset_rows_subtract_two_joints_in_every_frame",
    ),
    projflow(
        36,
        "Rows of a fixed offset",
        r"y_{rel} = A_{rel}\, x, \quad"
        r" A_{rel} = I_N \otimes (e_{j_a} - e_{j_b})^\top \otimes I_3",
        "offset_rows",
        "test_applications.test_offset_rows_subtract_two_joints_in_every_frame",
    ),
    projflow(
        37,
        "First and last pose agree",
        r"x_0 - x_{N-1} = 0",
        "loop_gap",
        "test_applications.test_loop_rows_compare_the_first_and_the_last_frame",
        "Closes the pose, not the velocity. Frames count from 0 here and from 1 in section 3.1;"
        " x_0 is a frame here and noise in eq. 2.",
    ),
    projflow(
        38,
        "Rows of a loop",
        r"0 = A_{loop}\, x, \quad A_{loop} = (e_0 - e_{N-1})^\top \otimes I_{3J}",
        "loop_rows",
        "test_applications.test_loop_rows_compare_the_first_and_the_last_frame",
    ),
    projflow(
        39,
        "Masked step, Euclidean",
        r"\hat{x}_1^* = \hat{x}_1 + M (M + \Sigma)^{-1} (y - M \hat{x}_1)",
        "euclidean_masked_update",
        "test_gains.test_euclidean_gain_symbolically_from_39_to_43",
        SINGULAR,
    ),
    projflow(
        40,
        "The same as shares of prediction and data",
        r"\hat{x}_1^* = \bigl(I - M (M + \Sigma)^{-1} M\bigr) \hat{x}_1 + M (M + \Sigma)^{-1} y",
        "euclidean_masked_average",
        "test_gains.test_euclidean_gain_symbolically_from_39_to_43",
        SINGULAR,
    ),
    projflow(
        41,
        "The same for one observed coordinate",
        r"\hat{x}_i^* = \Bigl(1 - \frac{1}{1 + \sigma_i^2}\Bigr) \hat{x}_i"
        r" + \frac{1}{1 + \sigma_i^2}\, y_i",
        "euclidean_coordinate_update",
        "test_gains.test_one_coordinate_minimises_its_own_price",
    ),
    projflow(
        42,
        "Euclidean weight of the data",
        r"\pi_{i, Euclid} = \frac{1}{1 + \sigma_i^2}",
        "euclidean_gain",
        "test_gains.test_euclidean_gain_symbolically_from_39_to_43",
    ),
    projflow(
        43,
        "The step as a weighted average",
        r"\hat{x}_i^* = (1 - \pi_i)\, \hat{x}_i + \pi_i\, y_i",
        "weighted_average",
        "test_gains.test_euclidean_gain_symbolically_from_39_to_43",
    ),
    projflow(
        44,
        "Masked step in any metric",
        r"\hat{x}_1^* = \hat{x}_1 + R^{-1} M^\top (M R^{-1} M^\top + \Sigma)^{-1}"
        r" (y - M \hat{x}_1)",
        "masked_update",
        "test_gains.test_masked_forms_agree_with_selected_rows",
        SINGULAR,
    ),
    projflow(
        45,
        "The same as shares of prediction and data",
        r"\hat{x}_1^* = (I - K M)\, \hat{x}_1 + K y, \quad"
        r" K = R^{-1} M^\top (M R^{-1} M^\top + \Sigma)^{-1}",
        "masked_average",
        "test_gains.test_eq_44_splits_into_45_symbolically",
        "No formula shows the number 45; it is read as the second half of the display numbered"
        " 44. " + SINGULAR,
    ),
    projflow(
        46,
        "Trust of a single active coordinate",
        r"\pi_i = \frac{r_i}{r_i + \sigma_i^2}",
        "trust_from_variance",
        "test_gains.test_trust_is_the_share_of_the_misfit_that_one_row_corrects",
        "Holds for one active row. Guides on neighbouring joints add up: two of trust 0.5 on one"
        " bone move each other by 0.66.",
    ),
    projflow(
        47,
        "Variance that gives this trust",
        r"\sigma_i^2 = r_i \Bigl(\frac{1}{\pi_i} - 1\Bigr)",
        "variance_from_trust",
        "test_gains.test_trust_and_variance_undo_each_other_symbolically",
        "The remark that 47 reduces to the Euclidean weight for R = I describes 46.",
    ),
    projflow(
        48,
        "Trust in the guides of a frame, again",
        r"\tilde\pi_n = \tau(t)\, \frac{c_0}{1 + \lambda_s (s_n / s_{med})^p}",
        "frame_trust",
        "test_pseudo_observations.test_frame_trust_number_by_number",
        "See 15. A single active joint is said to take this value as it is: above 1, eq. 47 then"
        " returns a negative variance.",
    ),
    projflow(
        49,
        "Metric of the skeleton, again",
        r"R = w_{kin} (I_N \otimes L_{kin} \otimes I_3) + \lambda I_d",
        "kinematic_metric",
        "test_metric.test_printed_kronecker_order_couples_strangers",
        "Printed as I_3 x I_N x L; see 11.",
    ),
    projflow(
        50,
        "Metric of one frame and axis",
        r"R_J = w_{kin} L_{kin} + \lambda I_J",
        "joint_metric",
        "test_metric.test_joint_metric_of_one_bone_symbolically",
    ),
    projflow(
        51,
        "Weight of a joint",
        r"q_j = 1 / \lVert c_j \rVert_2, \quad c_j = \text{column } j \text{ of } R_J^{-1}",
        "influence_weights",
        "test_metric.test_influence_weights_by_explicit_loops",
        "Said to give the pelvis less than the wrists; it gives more (column norms 0.253 and"
        " 0.361). The public code squares the norm.",
    ),
    projflow(
        52,
        "Trust of a joint",
        r"\pi_i = \mathrm{clip}\Bigl(\tilde\pi_n \frac{q_j}{\sum_{k \in H_n} q_k},"
        r" \pi_{min}, \pi_{max}\Bigr)",
        "joint_trust",
        "test_pseudo_observations.test_joint_trust_number_by_number",
        "Shares the raw budget, while section 4.3.1 and the public code clip it first. The sum"
        " over H_n that keeps the budget counts joints, not coordinates.",
    ),
]

//! Names of the columns that tables of motions, sweeps and pieces have besides the names of a scene. None of those may be one
//! of them.

/// The time of a sample.
pub const TIME: &str = "time";

/// What is proved about a pose, before the bound of its redundant equations.
pub const PROOF: [&str; 7] = [
    "closure_error",
    "sigma_min",
    "condition",
    "rank",
    "branch",
    "error_bound",
    "unique_radius",
];

/// Bound of the closure errors of redundant equations.
pub const CLOSES_TO: &str = "closes_to";

/// How a pose was found.
pub const SOLVING: [&str; 2] = ["iterations", "status"];

/// What is proved up to the next sample, before the bound of the redundant equations.
pub const MOTION: [&str; 3] = ["motion_tubes", "motion_radius", "motion_unique"];

/// That bound.
pub const MOTION_CLOSES_TO: &str = "motion_closes_to";

/// Whether the motion up to the next sample is proved.
pub const MOTION_STATUS: &str = "motion_status";

/// Columns of a sweep before its parameters.
pub const DESIGN: [&str; 3] = ["design", "status", "feasible"];

/// Columns of a sweep behind its values.
pub const DESIGN_PROOF: [&str; 3] = ["closure_error", "error_bound", "unproved"];

/// Values of a sweep that checks its designs.
pub const DESIGN_CHECK: [&str; 3] = ["passed", "clearance_margin", "proved_margin"];

/// Number of a random piece.
pub const PIECE: &str = "piece";

/// Whether tables have a column of that name.
pub fn is_column(name: &str) -> bool {
    let single = [TIME, CLOSES_TO, MOTION_CLOSES_TO, MOTION_STATUS, PIECE];
    let lists: [&[&str]; 7] = [
        &single,
        &PROOF,
        &SOLVING,
        &MOTION,
        &DESIGN,
        &DESIGN_PROOF,
        &DESIGN_CHECK,
    ];
    lists.iter().any(|list| list.contains(&name))
}

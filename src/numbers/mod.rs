//! Number types, and the trait over which all formulas are written: constants with their error, Taylor series,
//! hyper-dual numbers, intervals, affine forms, double-doubles, eight designs in SIMD lanes; brackets of zeros; numbers as text
//! (`decimal`).

pub mod affine_form;
pub mod bracket;
pub mod constant;
pub mod decimal;
pub mod double_double;
pub mod exact_sum;
pub mod form_room;
pub mod form_sum;
pub mod hyper_dual;
pub mod interval;
mod lists;
pub mod octet;
mod octet_sin_cos;
pub mod quadratic_form;
pub mod rounding;
pub mod scalar;
pub mod series;
mod series_roots;
pub mod sin_cos;

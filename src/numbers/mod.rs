//! Numbers that carry more than a value: Taylor series, hyper-dual numbers, intervals, double-doubles.

pub mod double_double;
pub mod hyper_dual;
pub mod interval;
pub mod series;
pub mod sin_cos;

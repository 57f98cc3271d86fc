//! Studies of the solver itself and of mechanisms: loops around solving, never a second engine.

pub mod observer;
pub mod precision_report;
pub mod reference;
pub mod routes;
pub mod work_precision;

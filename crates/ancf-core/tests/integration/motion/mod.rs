//! Motion: what methods keep, their orders and errors, how they fail and go on.

mod common;
mod conservation;
mod control;
mod failures;
mod orders;
mod pulses;
mod restart;
mod rigid;

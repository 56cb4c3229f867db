//! Errors of input: what cannot be used, and what is allowed. Errors of a solve are in `nonlinear` and above.

use std::fmt::Display;

/// An argument whose value cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{argument} = {value}: allowed is {allowed}")]
pub struct InputError {
    /// The name of the argument.
    pub argument: String,
    /// The value that was given.
    pub value: String,
    /// What would have been accepted.
    pub allowed: String,
}

impl InputError {
    /// An error for `argument`, which was given as `value`.
    pub fn new(argument: impl Into<String>, value: impl Display, allowed: impl Into<String>) -> Self {
        Self { argument: argument.into(), value: value.to_string(), allowed: allowed.into() }
    }

    /// An error unless `valid`.
    pub(crate) fn check(argument: &str, value: impl Display, valid: bool, allowed: &str) -> Result<(), Self> {
        if valid { Ok(()) } else { Err(Self::new(argument, value, allowed)) }
    }
}

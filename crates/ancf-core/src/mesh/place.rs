//! Places on a body: corners, edges, points.

use std::fmt;
use std::str::FromStr;

use crate::error::InputError;

/// An end of the range of a natural coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// The smallest value.
    Low,
    /// The largest value.
    High,
}

/// An edge of a body: one natural coordinate at an end of its range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Edge {
    /// The coordinate that is constant: 0 for x, 1 for y.
    pub across: usize,
    /// Which end of its range.
    pub end: End,
}

/// A place on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Place {
    /// Where two edges meet: the ends of x and y.
    Corner([End; 2]),
    /// A whole edge.
    Edge(Edge),
    /// A material point, by its natural coordinates.
    Point([f64; 2]),
    /// The whole body.
    All,
}

/// What a place can be called.
const ALLOWED: &str =
    "corner:x0y0, corner:x1y0, corner:x1y1, corner:x0y1, edge:x0, edge:x1, edge:y0, edge:y1, all, or a point [x, y]";

impl Place {
    /// An error that says that this place cannot be used for `argument`.
    pub(crate) fn refuse(self, argument: &str, allowed: &str) -> InputError {
        InputError::new(argument, self, allowed)
    }
}

impl FromStr for Place {
    type Err = InputError;

    fn from_str(text: &str) -> Result<Self, InputError> {
        let end = |letter: &str| match letter {
            "0" => Some(End::Low),
            "1" => Some(End::High),
            _ => None,
        };
        let parsed = if text == "all" {
            Some(Self::All)
        } else if let Some(edge) = text.strip_prefix("edge:x") {
            end(edge).map(|end| Self::Edge(Edge { across: 0, end }))
        } else if let Some(edge) = text.strip_prefix("edge:y") {
            end(edge).map(|end| Self::Edge(Edge { across: 1, end }))
        } else if let Some((x, y)) = text.strip_prefix("corner:x").and_then(|c| c.split_once('y')) {
            end(x).zip(end(y)).map(|(x, y)| Self::Corner([x, y]))
        } else {
            None
        };
        parsed.ok_or_else(|| InputError::new("at", format!("\"{text}\""), ALLOWED))
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let digit = |end: End| u8::from(end == End::High);
        match *self {
            Self::Corner([x, y]) => write!(f, "corner:x{}y{}", digit(x), digit(y)),
            Self::Edge(Edge { across, end }) => write!(f, "edge:{}{}", ["x", "y"][across], digit(end)),
            Self::Point([x, y]) => write!(f, "[{x}, {y}]"),
            Self::All => write!(f, "all"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for name in ["all", "edge:x0", "edge:x1", "edge:y0", "edge:y1", "corner:x0y0", "corner:x1y0", "corner:x0y1"] {
            assert_eq!(name.parse::<Place>().unwrap().to_string(), name);
        }
        for wrong in ["", "edge", "edge:z0", "edge:x2", "corner:x0", "corner:y0x0", "All"] {
            let error = wrong.parse::<Place>().unwrap_err();
            assert_eq!(error.argument, "at");
            assert!(error.value.contains(wrong) && error.allowed.contains("edge:x0"));
        }
    }
}

//! Reference surfaces: smooth maps from two natural coordinates to space.

use crate::error::InputError;

/// The reference shape of a body as a function of its natural coordinates x and y.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    domain: [[f64; 2]; 2],
    map: Map,
}

#[derive(Clone, Debug, PartialEq)]
enum Map {
    Rectangle,
}

impl Surface {
    /// A flat rectangle in the X-Y plane, `x` in `[0, size[0]]`, `y` in `[0, size[1]]`, m.
    ///
    /// # Errors
    ///
    /// Both sides must be positive and finite.
    pub fn rectangle(size: [f64; 2]) -> Result<Self, InputError> {
        for (argument, side) in ["size.0", "size.1"].into_iter().zip(size) {
            InputError::check(argument, side, side > 0.0 && side.is_finite(), "a positive number, m")?;
        }
        Ok(Self { domain: [[0.0, size[0]], [0.0, size[1]]], map: Map::Rectangle })
    }

    /// The ranges of the natural coordinates.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        self.domain
    }

    /// The position, or its derivative of the given orders with respect to x and y.
    pub fn derivative(&self, orders: (i32, i32), [x, y]: [f64; 2]) -> [f64; 3] {
        match self.map {
            Map::Rectangle => match orders {
                (0, 0) => [x, y, 0.0],
                (1, 0) => [1.0, 0.0, 0.0],
                (0, 1) => [0.0, 1.0, 0.0],
                _ => [0.0; 3],
            },
        }
    }
}

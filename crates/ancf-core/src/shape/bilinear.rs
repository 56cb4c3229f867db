//! The bilinear functions of four nodes.

use super::Polynomial;

/// The functions of the nodes A(0,0), B(1,0), C(1,1), D(0,1): each is one at its node and zero at the others.
pub fn bilinear() -> [Polynomial; 4] {
    let (x, y) = (Polynomial::xi(), Polynomial::eta());
    let (rest_x, rest_y) = (-x + 1.0, -y + 1.0);
    [rest_x * rest_y, x * rest_y, x * y, rest_x * y]
}

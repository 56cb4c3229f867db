//! A pair of explicit Runge-Kutta methods of orders 5 and 4.

use super::runge_kutta::Tableau;

/// DOPRI5: fifth order, seven stages of which the last is the first of the next step.
///
/// # Source
///
/// Dormand and Prince (1980); Hairer, Norsett and Wanner (1993), table II.5.2.
pub(super) const DORMAND_PRINCE: Tableau = Tableau {
    order: 5,
    embedded_order: 4,
    a: &[
        &[],
        &[1.0 / 5.0],
        &[3.0 / 40.0, 9.0 / 40.0],
        &[44.0 / 45.0, -56.0 / 15.0, 32.0 / 9.0],
        &[19_372.0 / 6_561.0, -25_360.0 / 2_187.0, 64_448.0 / 6_561.0, -212.0 / 729.0],
        &[9_017.0 / 3_168.0, -355.0 / 33.0, 46_732.0 / 5_247.0, 49.0 / 176.0, -5_103.0 / 18_656.0],
        &[35.0 / 384.0, 0.0, 500.0 / 1_113.0, 125.0 / 192.0, -2_187.0 / 6_784.0, 11.0 / 84.0],
    ],
    embedded: &[
        5_179.0 / 57_600.0,
        0.0,
        7_571.0 / 16_695.0,
        393.0 / 640.0,
        -92_097.0 / 339_200.0,
        187.0 / 2_100.0,
        1.0 / 40.0,
    ],
};

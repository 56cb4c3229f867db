//! The rows of a table that straight lines between them need.

/// The `t` of those rows `[t, value]` that straight lines must pass through so that no other row departs from them by more
/// than `tolerance` times the largest value. The first and the last are among them, unless there is only one.
///
/// # Source
///
/// Bristol, Swinging door trending (ISA, 1990).
pub(super) fn knots(rows: &[[f64; 2]], tolerance: f64) -> Vec<f64> {
    let [first, .., last] = rows else { return Vec::new() };
    let tolerance = tolerance * rows.iter().fold(0.0, |largest: f64, row| largest.max(row[1].abs()));
    let mut knots = vec![first[0]];
    let mut from = first;
    // The lines from there that pass by all rows since then have slopes between these.
    let (mut least, mut most) = (f64::NEG_INFINITY, f64::INFINITY);
    for pair in rows.windows(2) {
        let [before, row] = [&pair[0], &pair[1]];
        let slope = |from: &[f64; 2], shift: f64| (row[1] + shift - from[1]) / (row[0] - from[0]);
        if !(least..=most).contains(&slope(from, 0.0)) {
            knots.push(before[0]);
            (from, least, most) = (before, f64::NEG_INFINITY, f64::INFINITY);
        }
        (least, most) = (least.max(slope(from, -tolerance)), most.min(slope(from, tolerance)));
    }
    knots.push(last[0]);
    knots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_on_a_line_are_no_knots() {
        let rows = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 2.0], [4.0, 0.0], [5.0, 0.0]];
        assert_eq!(knots(&rows, 0.0), [0.0, 1.0, 3.0, 4.0, 5.0]);
        assert_eq!(knots(&rows[..1], 0.0), []);
        assert_eq!(knots(&rows[..2], 0.0), [0.0, 1.0]);
    }

    /// A chord of length h of a sine departs from it by h^2 / 8 where the curvature is 1; chords that may end anywhere in
    /// a band of that half width to both sides are at most twice as long.
    #[test]
    fn lines_through_knots_stay_within_the_tolerance() {
        let rows: Vec<_> = (0..=10_000).map(|k| 1e-3 * f64::from(k)).map(|t| [t, t.sin()]).collect();
        let tolerance = 1e-4;
        let found = knots(&rows, tolerance);
        let chord = (8.0 * tolerance).sqrt();
        assert!((10.0 / (2.0 * chord)..20.0 / chord).contains(&(found.len() as f64)), "{}", found.len());
        for ends in found.windows(2) {
            let line = |t: f64| ends[0].sin() + (t - ends[0]) / (ends[1] - ends[0]) * (ends[1].sin() - ends[0].sin());
            for [t, value] in rows.iter().filter(|row| (ends[0]..=ends[1]).contains(&row[0])) {
                assert!((line(*t) - value).abs() < tolerance * (1.0 + 1e-9), "{t}");
            }
        }
    }

    /// A single pulse in a long record of zeros.
    #[test]
    fn a_pulse_keeps_its_rows() {
        let mut rows: Vec<_> = (0..100_000).map(|k| [1e-4 * f64::from(k), 0.0]).collect();
        rows[5000][1] = 1.0;
        assert_eq!(knots(&rows, 1e-2), [0, 4999, 5000, 5001, 99_999].map(|k| rows[k][0]));
    }
}

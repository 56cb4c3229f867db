//! How a load varies with time, or with the load factor in statics.

use crate::error::InputError;

use super::knots::knots;

/// The factor of a load as a function of time (s) in motion, of the load factor in statics.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum History {
    /// Always 1.
    #[default]
    Constant,
    /// The load factor itself; for statics.
    Ramp,
    /// Linear between given points, constant before the first and after the last.
    Table(Vec<[f64; 2]>),
}

impl History {
    /// A table of `[time or load factor, factor]`.
    ///
    /// # Errors
    ///
    /// At least one row, all finite, the first numbers strictly increasing.
    pub fn table(rows: Vec<[f64; 2]>) -> Result<Self, InputError> {
        let increasing = rows.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        let finite = rows.iter().flatten().all(|x| x.is_finite());
        let allowed = "rows [t, factor] of finite numbers, t strictly increasing";
        InputError::check("history", format!("{rows:?}"), !rows.is_empty() && increasing && finite, allowed)?;
        Ok(Self::Table(rows))
    }

    /// The factor at time (or load factor) `t`.
    pub fn factor(&self, t: f64) -> f64 {
        match self {
            Self::Constant => 1.0,
            Self::Ramp => t,
            Self::Table(rows) => {
                let after = rows.partition_point(|row| row[0] <= t);
                if after == 0 || after == rows.len() {
                    return rows[after.saturating_sub(1)][1];
                }
                let ([t0, f0], [t1, f1]) = (rows[after - 1], rows[after]);
                f0 + (f1 - f0) * (t - t0) / (t1 - t0)
            }
        }
    }

    /// How fast the factor changes with time (or load factor) just after `t`.
    pub fn rate(&self, t: f64) -> f64 {
        match self {
            Self::Constant => 0.0,
            Self::Ramp => 1.0,
            Self::Table(rows) => match rows.partition_point(|row| row[0] <= t) {
                0 => 0.0,
                after if after == rows.len() => 0.0,
                after => (rows[after][1] - rows[after - 1][1]) / (rows[after][0] - rows[after - 1][0]),
            },
        }
    }

    /// Where the factor changes its slope by more than what straight lines smooth out within `tolerance` of the largest.
    pub fn kinks(&self, tolerance: f64) -> Vec<f64> {
        if let Self::Table(rows) = self { knots(rows, tolerance) } else { Vec::new() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_interpolated() {
        let history = History::table(vec![[1.0, 2.0], [3.0, 6.0], [4.0, 0.0]]).unwrap();
        for (t, factor) in [(0.0, 2.0), (1.0, 2.0), (2.0, 4.0), (3.0, 6.0), (3.75, 1.5), (9.0, 0.0)] {
            assert_eq!(history.factor(t), factor, "at {t}");
        }
        for (t, rate) in [(0.0, 0.0), (1.0, 2.0), (2.0, 2.0), (3.0, -6.0), (4.0, 0.0)] {
            assert_eq!(history.rate(t), rate, "at {t}");
        }
        assert!(History::table(vec![[1.0, 2.0], [1.0, 3.0]]).is_err());
        assert!(History::table(vec![]).is_err());
    }
}

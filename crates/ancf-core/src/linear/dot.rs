//! The scalar product.

/// Sums that run side by side: one alone waits for itself.
const SUMS: usize = 8;

/// The scalar product of two vectors of one length.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<SUMS>(), b.as_chunks::<SUMS>());
    let mut sums = [0.0; SUMS];
    for (a, b) in a.iter().zip(b) {
        for i in 0..SUMS {
            sums[i] += a[i] * b[i];
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::dot;

    /// The sum of the first squares is known, and exact here.
    #[test]
    fn every_number_counts_once() {
        for n in 0..40 {
            let x: Vec<f64> = (0..=n).map(f64::from).collect();
            assert_eq!(dot(&x, &x), f64::from(n * (n + 1) * (2 * n + 1) / 6));
        }
    }
}

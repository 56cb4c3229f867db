//! Factorisations beside dense ones, and what they refuse.

use super::*;
use crate::linear::testing::{dense, random_matrix, random_vector};
use crate::linear::{SymmetricMatrix, order};
use nalgebra::{DMatrix, DVector};

fn factorized(matrix: &SymmetricMatrix) -> (Factorization, Inertia) {
    let mut factorization = Factorization::new(Arc::clone(matrix.pattern())).unwrap();
    let inertia = factorization.factorize(matrix.values()).unwrap();
    (factorization, inertia)
}

/// Diagonally dominant, then scaled by up to 1e8 between coordinates as membrane and bending are.
fn definite_badly_scaled(n: usize, seed: u64) -> SymmetricMatrix {
    let mut matrix = random_matrix(n, seed);
    let pattern = Arc::clone(matrix.pattern());
    let sums: Vec<f64> = dense(&matrix).row_iter().map(|row| row.abs().sum()).collect();
    let scales: Vec<f64> = random_vector(n, seed + 1).iter().map(|s| 10.0_f64.powf(4.0 * s)).collect();
    for (column, sum) in sums.iter().enumerate() {
        let start = pattern.col_ptr()[column];
        matrix.values_mut()[start] = 1.01 * sum;
        for (k, &row) in pattern.rows(column).iter().enumerate() {
            matrix.values_mut()[start + k] *= scales[row] * scales[column];
        }
    }
    matrix
}

#[test]
fn definite_systems_agree_with_dense_cholesky() {
    for n in [1, 2, 9, 27, 81, 225] {
        let matrix = definite_badly_scaled(n, n as u64);
        let rhs = DVector::from_vec(random_vector(n, 7));
        let (mut factorization, inertia) = factorized(&matrix);
        assert!(inertia.is_positive_definite());
        let mut x = rhs.clone();
        factorization.solve(x.as_mut_slice());
        let expected = dense(&matrix).cholesky().unwrap().solve(&rhs);
        let error = x.zip_map(&expected, |x, e| (x - e).abs() / e.abs().max(1e-6 * expected.amax())).amax();
        assert!(error < 1e-9, "n = {n}: {error:e}");
        assert!(matrix.residual(x.as_slice(), rhs.as_slice(), &mut vec![0.0; n]) < 1e-14);
    }
}

#[test]
fn inertia_counts_the_negative_eigenvalues_of_indefinite_matrices() {
    for seed in 0..20 {
        let n = 60;
        let matrix = random_matrix(n, seed);
        let (mut factorization, inertia) = factorized(&matrix);
        let negative = dense(&matrix).symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
        assert_eq!(inertia.negative, negative);
        let rhs = random_vector(n, 100 + seed);
        let (mut x, mut correction) = (rhs.clone(), vec![0.0; n]);
        factorization.solve(&mut x);
        matrix.residual(&x, &rhs, &mut correction);
        factorization.solve(&mut correction);
        x.iter_mut().zip(&correction).for_each(|(x, dx)| *x += dx);
        assert!(matrix.residual(&x, &rhs, &mut correction) < 1e-14);
    }
}

#[test]
fn a_matrix_is_negative_in_its_descents() {
    for seed in 0..5 {
        let matrix = random_matrix(60, seed);
        let (mut factorization, inertia) = factorized(&matrix);
        let descents: Vec<f64> = factorization.descents().concat();
        let z = DMatrix::from_vec(60, inertia.negative, descents);
        let product = z.transpose() * dense(&matrix) * z;
        let error = (product + DMatrix::identity(inertia.negative, inertia.negative)).amax();
        assert!(error < 1e-8, "{error:e}");
    }
}

#[test]
fn singular_matrices_are_refused_where_they_fail() {
    // springs in a ring without a support: the last pivot vanishes, up to rounding
    let n = 50;
    let springs: Vec<[usize; 2]> = (0..n).map(|k| [k, (k + 1) % n]).collect();
    let pattern = Arc::new(Pattern::from_groups(n, &springs).unwrap());
    let mut ring = vec![0.0; pattern.nnz()];
    for (&[i, j], stiffness) in springs.iter().zip(random_vector(n, 1)) {
        for (a, b, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0)] {
            ring[pattern.slot(a, b).unwrap()] += sign * (1.1 + stiffness);
        }
    }
    let mut factorization = Factorization::new(Arc::clone(&pattern)).unwrap();
    let refused = factorization.factorize(&ring);
    assert!(matches!(refused, Err(LinearError::Singular { column: 49, .. })), "{refused:?}");
    ring[pattern.slot(20, 20).unwrap()] += 1e-3;
    assert!(factorization.factorize(&ring).unwrap().is_positive_definite());
}

#[test]
fn an_exact_zero_and_a_value_that_is_not_finite_are_reported_with_their_column() {
    let pattern = Arc::new(Pattern::from_groups(200, &(0..199).map(|k| [k, k + 1]).collect::<Vec<_>>()).unwrap());
    let mut values: Vec<f64> = vec![0.0; pattern.nnz()];
    (0..200).for_each(|k| values[pattern.col_ptr()[k]] = 2.0);
    values[pattern.col_ptr()[130]] = 0.0;
    let mut factorization = Factorization::new(Arc::clone(&pattern)).unwrap();
    let expected = LinearError::Singular { column: 130, pivot: 0.0, scale: 0.0 };
    assert_eq!(factorization.factorize(&values), Err(expected));
    values[pattern.slot(131, 130).unwrap()] = f64::INFINITY;
    assert_eq!(factorization.factorize(&values), Err(LinearError::NotFinite { column: 130 }));
}

#[test]
fn a_pivot_that_overflows_is_an_error() {
    let mut factorization = Factorization::new(Arc::new(Pattern::from_groups(2, &[[0, 1]]).unwrap())).unwrap();
    let expected = LinearError::Singular { column: 1, pivot: f64::NEG_INFINITY, scale: 1.0 };
    assert_eq!(factorization.factorize(&[1.0, 1e200, 1.0]), Err(expected));
}

#[test]
#[should_panic(expected = "without a successful factorisation")]
fn no_solution_without_a_factorisation() {
    let mut factorization = Factorization::new(Arc::new(Pattern::from_groups(1, &[[0]]).unwrap())).unwrap();
    assert!(factorization.factorize(&[0.0]).is_err());
    factorization.solve(&mut [1.0]);
}

#[test]
fn interleaved_right_hand_sides_are_solved_each() {
    let n = 81;
    let matrix = definite_badly_scaled(n, 3);
    let (mut factorization, _) = factorized(&matrix);
    let rhs = DMatrix::from_vec(n, 4, random_vector(4 * n, 4));
    let expected = dense(&matrix).cholesky().unwrap().solve(&rhs);
    let mut solution = rhs.transpose(); // column-major, so that memory holds (n, 4) row by row
    factorization.solve_four(solution.as_mut_slice().as_chunks_mut().0);
    assert!((solution.transpose() - &expected).amax() < 1e-10 * expected.amax());
}

#[test]
fn a_factorization_can_be_refilled_and_gives_the_same_bits_again() {
    let (first, second) = (definite_badly_scaled(90, 5), random_matrix(90, 6));
    let solve = |factorization: &mut Factorization| {
        factorization.factorize(first.values()).unwrap();
        let mut x = random_vector(90, 8);
        factorization.solve(&mut x);
        x
    };
    let (mut factorization, _) = factorized(&first);
    let before = solve(&mut factorization);
    factorization.factorize(second.values()).unwrap();
    assert_eq!(solve(&mut factorization), before);
}

/// Plate of side x side nodes with nine coordinates each, in the order of elimination: random, and diagonally
/// dominant with the given signs.
fn plate(side: usize, sign: impl Fn(usize) -> f64) -> SymmetricMatrix {
    let node = |i: usize, j: usize| j * side + i;
    let cells = (0..(side - 1) * (side - 1)).map(|cell| (cell % (side - 1), cell / (side - 1)));
    let cells: Vec<_> = cells.map(|(i, j)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]).collect();
    let positions: Vec<_> = (0..side * side).map(|k| [(k % side) as f64, (k / side) as f64]).collect();
    let order = order(&Pattern::from_groups(side * side, &cells).unwrap(), Some(&positions)).unwrap();
    let mut place = vec![0; order.len()];
    order.iter().enumerate().for_each(|(k, &node)| place[node] = k);
    let groups: Vec<Vec<usize>> =
        cells.iter().map(|cell| cell.iter().flat_map(|&n| 9 * place[n]..9 * place[n] + 9).collect()).collect();
    let pattern = Arc::new(Pattern::from_groups(9 * side * side, &groups).unwrap());
    let values = random_vector(pattern.nnz(), 9);
    let mut sums = vec![0.0; pattern.n()];
    for column in 0..pattern.n() {
        for (&row, value) in pattern.rows(column)[1..].iter().zip(&values[pattern.col_ptr()[column] + 1..]) {
            sums[row] += value.abs();
            sums[column] += value.abs();
        }
    }
    let mut matrix = SymmetricMatrix::new(Arc::clone(&pattern), values);
    for (column, sum) in sums.iter().enumerate() {
        matrix.values_mut()[pattern.col_ptr()[column]] = 1.01 * sign(column) * sum;
    }
    matrix
}

#[test]
fn large_systems_have_the_same_bits_on_any_number_of_threads() {
    // by Gershgorin's theorem there are as many negative eigenvalues as negative diagonal entries
    let matrix = plate(30, |column| if column % 10 == 3 { -1.0 } else { 1.0 });
    let n = matrix.pattern().n();
    let rhs = random_vector(4 * n, 2);
    let solve = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (mut factorization, inertia) = factorized(&matrix);
            assert_eq!(inertia.negative, n / 10);
            let tree = &factorization.tree;
            assert!(tree.subtrees.len() > 4 && tree.fronts[tree.top()].iter().any(|front| front.work() > SHARED));
            let mut x = rhs.clone();
            factorization.solve_four(x.as_chunks_mut().0);
            x
        })
    };
    let one = solve(1);
    for component in 0..4 {
        let part = |x: &[f64]| x.iter().skip(component).step_by(4).copied().collect::<Vec<_>>();
        assert!(matrix.residual(&part(&one), &part(&rhs), &mut vec![0.0; n]) < 1e-14);
    }
    for threads in [2, 3] {
        assert!(solve(threads).iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
    }
}

#[test]
fn a_large_singular_system_is_refused_at_its_last_column() {
    // springs between all nodes of a plate that nothing holds
    let mut matrix = plate(30, |_| 0.0);
    let pattern = Arc::clone(matrix.pattern());
    for column in 0..pattern.n() {
        for place in pattern.col_ptr()[column] + 1..pattern.col_ptr()[column + 1] {
            let stiffness = matrix.values()[place].abs();
            matrix.values_mut()[place] = -stiffness;
            for end in [column, pattern.row_idx()[place]] {
                matrix.values_mut()[pattern.col_ptr()[end]] += stiffness;
            }
        }
    }
    let refused = Factorization::new(Arc::clone(&pattern)).unwrap().factorize(matrix.values());
    assert!(matches!(refused, Err(LinearError::Singular { column, .. }) if column == pattern.n() - 1), "{refused:?}");
}

#[test]
fn long_chains_are_solved_too() {
    // -u'' = 1 in differences: exact at the nodes
    let n = 20_000;
    let pattern = Arc::new(Pattern::from_groups(n, &(0..n - 1).map(|k| [k, k + 1]).collect::<Vec<_>>()).unwrap());
    let values = (0..n).flat_map(|k| [2.0, -1.0].into_iter().take(pattern.rows(k).len())).collect();
    let (mut factorization, _) = factorized(&SymmetricMatrix::new(pattern, values));
    let mut u = vec![1.0; n];
    factorization.solve(&mut u);
    for (k, u) in u.iter().enumerate() {
        let expected = 0.5 * (k + 1) as f64 * (n - k) as f64;
        assert!((u / expected - 1.0).abs() < 1e-8, "{k}: {u} instead of {expected}");
    }
}

#[test]
fn an_empty_system_has_an_empty_solution() {
    let pattern = Arc::new(Pattern::from_groups::<[usize; 1]>(0, &[]).unwrap());
    let mut factorization = Factorization::new(pattern).unwrap();
    assert!(factorization.factorize(&[]).unwrap().is_positive_definite());
    factorization.solve(&mut []);
}

//! Orders of elimination that keep the factor of a mesh's matrix sparse.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::amd;

use super::elimination::Elimination;
use super::{LinearError, Pattern};

/// Order in which to eliminate the nodes of a mesh: entry k is the node that comes k-th.
///
/// `graph` couples the nodes that share an element; `positions` are node positions in two parameters, of any unit, in
/// which neighbours are close. Order nodes, not coordinates: the coordinates of a node follow each other and make dense
/// blocks. Minimum degree is best on strips; nested dissection, which needs `positions`, on large plates. Both are
/// tried, and the one whose factor takes less work is returned.
///
/// # Source
///
/// Amestoy, Davis and Duff (1996), approximate minimum degree; George (1973), nested dissection.
///
/// # Errors
///
/// [`LinearError::TooLarge`] when the memory does not suffice.
///
/// # Panics
///
/// When `positions` has another length than `graph` has nodes.
///
/// # Examples
///
/// ```
/// use ancf_core::linear::{Pattern, order};
///
/// let star = Pattern::from_groups(4, &[[0, 1], [0, 2], [0, 3]])?;
/// let order = order(&star, None)?;
/// assert!(order[..2].iter().all(|&node| node != 0)); // the centre first would couple all others
/// # Ok::<(), ancf_core::linear::LinearError>(())
/// ```
pub fn order(graph: &Pattern, positions: Option<&[[f64; 2]]>) -> Result<Vec<usize>, LinearError> {
    let minimum_degree = minimum_degree(graph)?;
    let Some(positions) = positions else { return Ok(minimum_degree) };
    let dissection = nested_dissection(graph, positions);
    let better = work(graph, &dissection)? < work(graph, &minimum_degree)?;
    Ok(if better { dissection } else { minimum_degree })
}

/// Work of the factorisation when the nodes are eliminated in this order.
fn work(graph: &Pattern, order: &[usize]) -> Result<f64, LinearError> {
    let n = graph.n();
    let mut place = vec![0; n];
    for (k, &node) in order.iter().enumerate() {
        place[node] = k;
    }
    let edges: Vec<_> = (0..n)
        .flat_map(|i| graph.rows(i).iter().map(move |&j| [i, j]))
        .map(|edge| edge.map(|node| place[node]))
        .collect();
    Ok(Elimination::new(&Pattern::from_groups(n, &edges)?).work())
}

fn minimum_degree(graph: &Pattern) -> Result<Vec<usize>, LinearError> {
    let n = graph.n();
    let (mut order, mut place) = (vec![0; n], vec![0; n]);
    let scratch = amd::order_scratch::<usize>(n, graph.nnz());
    let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::TooLarge { n })?;
    amd::order(&mut order, &mut place, graph.lower(), amd::Control::default(), MemStack::new(&mut memory))
        .map_err(|_| LinearError::TooLarge { n })?;
    Ok(order)
}

fn nested_dissection(graph: &Pattern, positions: &[[f64; 2]]) -> Vec<usize> {
    let n = graph.n();
    assert_eq!(positions.len(), n, "one position a node");
    let mut neighbours = vec![Vec::new(); n];
    for i in 0..n {
        for &j in &graph.rows(i)[1..] {
            neighbours[i].push(j);
            neighbours[j].push(i);
        }
    }
    let mut dissection = Dissection { neighbours, positions, marked: vec![false; n], order: Vec::with_capacity(n) };
    dissection.dissect((0..n).collect());
    dissection.order
}

/// A part of the mesh, split in two by a third that separates them.
struct Cut {
    before: Vec<usize>,
    after: Vec<usize>,
    separator: Vec<usize>,
}

struct Dissection<'a> {
    neighbours: Vec<Vec<usize>>,
    positions: &'a [[f64; 2]],
    marked: Vec<bool>,
    order: Vec<usize>,
}

impl Dissection<'_> {
    /// Appends the nodes to the order: both halves first, the nodes that separate them last.
    fn dissect(&mut self, nodes: Vec<usize>) {
        let cuts = [0, 1].map(|axis| self.cut(&nodes, axis));
        match cuts.into_iter().flatten().min_by_key(|cut| cut.separator.len()) {
            Some(cut) => {
                self.dissect(cut.before);
                self.dissect(cut.after);
                self.order.extend(cut.separator);
            }
            None => self.order.extend(nodes),
        }
    }

    /// Cuts at the median of one parameter; `None` when all nodes from the first to the median share its value.
    fn cut(&mut self, nodes: &[usize], axis: usize) -> Option<Cut> {
        let along = |node: usize| self.positions[node][axis];
        let mut sorted: Vec<f64> = nodes.iter().map(|&node| along(node)).collect();
        sorted.sort_unstable_by(f64::total_cmp);
        let median = *sorted.get(nodes.len() / 2)?;
        let (before, after): (Vec<usize>, Vec<usize>) = nodes.iter().partition(|&&node| along(node) < median);
        if before.is_empty() {
            return None;
        }
        before.iter().for_each(|&node| self.marked[node] = true);
        let (separator, after) =
            after.into_iter().partition(|&node| self.neighbours[node].iter().any(|&other| self.marked[other]));
        before.iter().for_each(|&node| self.marked[node] = false);
        Some(Cut { before, after, separator })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Nodes of nx by ny quadrilaterals, numbered row by row.
    fn grid(nx: usize, ny: usize) -> (Pattern, Vec<[f64; 2]>) {
        let node = |i: usize, j: usize| j * (nx + 1) + i;
        let cells: Vec<_> = (0..nx * ny)
            .map(|cell| (cell % nx, cell / nx))
            .map(|(i, j)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)])
            .collect();
        let nodes = (nx + 1) * (ny + 1);
        let positions = (0..nodes).map(|k| [(k % (nx + 1)) as f64, 0.1 * (k / (nx + 1)) as f64]).collect();
        (Pattern::from_groups(nodes, &cells).unwrap(), positions)
    }

    /// Sum of squared column counts, by eliminating the nodes of the graph one by one.
    fn eliminate(graph: &Pattern, order: &[usize]) -> f64 {
        let mut neighbours = vec![BTreeSet::new(); graph.n()];
        for i in 0..graph.n() {
            for &j in &graph.rows(i)[1..] {
                neighbours[i].insert(j);
                neighbours[j].insert(i);
            }
        }
        let mut work = 0.0;
        for &node in order {
            let clique = std::mem::take(&mut neighbours[node]);
            work += ((clique.len() + 1) as f64).powi(2);
            for &other in &clique {
                neighbours[other].remove(&node);
                neighbours[other].extend(clique.iter().filter(|&&third| third != other));
            }
        }
        work
    }

    fn is_permutation(order: &[usize], n: usize) -> bool {
        order.len() == n && order.iter().collect::<BTreeSet<_>>().len() == n && order.iter().all(|&node| node < n)
    }

    #[test]
    fn orders_are_permutations_and_cheaper_than_row_by_row() {
        for (nx, ny) in [(1, 1), (5, 3), (16, 16), (40, 2)] {
            let (graph, positions) = grid(nx, ny);
            let natural: Vec<usize> = (0..graph.n()).collect();
            for order in [order(&graph, None).unwrap(), order(&graph, Some(&positions)).unwrap()] {
                assert!(is_permutation(&order, graph.n()));
                assert!(eliminate(&graph, &order) <= eliminate(&graph, &natural));
            }
        }
    }

    #[test]
    fn work_is_that_of_elimination_node_by_node() {
        let (graph, positions) = grid(6, 5);
        for order in [minimum_degree(&graph).unwrap(), nested_dissection(&graph, &positions)] {
            assert_eq!(work(&graph, &order).unwrap(), eliminate(&graph, &order));
        }
    }

    #[test]
    fn dissection_beats_minimum_degree_on_a_large_plate_and_minimum_degree_on_a_strip() {
        let (plate, positions) = grid(32, 32);
        assert_eq!(order(&plate, Some(&positions)).unwrap(), nested_dissection(&plate, &positions));
        let (strip, positions) = grid(64, 1);
        assert_eq!(order(&strip, Some(&positions)).unwrap(), minimum_degree(&strip).unwrap());
    }

    #[test]
    fn positions_may_coincide_and_graphs_may_fall_apart() {
        let graph = Pattern::from_groups(5, &[[0, 3], [1, 4]]).unwrap();
        assert!(is_permutation(&order(&graph, Some(&[[0.5, 0.5]; 5])).unwrap(), 5));
        assert_eq!(order(&Pattern::from_groups::<[usize; 1]>(0, &[]).unwrap(), Some(&[])).unwrap(), []);
    }
}

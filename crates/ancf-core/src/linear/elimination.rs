//! What elimination fills in: the elimination tree of a pattern and the sizes of its columns.

use std::ops::Range;

use super::Pattern;

/// Elimination tree of a pattern and the number of entries in each column of its factor.
///
/// Columns that follow each other and are coupled with the same others, as the coordinates of a node are, are one group.
///
/// # Source
///
/// Liu (1986, 1990), the tree and the rows of the factor as its subtrees; Davis, Direct Methods for Sparse Linear Systems
/// (2006), chapter 4.
pub(super) struct Elimination {
    /// The first column of each group, and the end of the last one.
    begins: Vec<usize>,
    /// The group whose elimination needs this one's first; `None` at a root.
    pub parent: Vec<Option<usize>>,
    /// Entries of the first column of each group, the diagonal included; each further one has one less.
    pub counts: Vec<usize>,
}

impl Elimination {
    pub fn new(pattern: &Pattern) -> Self {
        // How many earlier columns each is coupled with, and how many of them also with the one before it.
        let (mut before, mut shared) = (vec![0_u32; pattern.n()], vec![0_u32; pattern.n()]);
        for column in 0..pattern.n() {
            for pair in pattern.rows(column).windows(2) {
                before[pair[1]] += 1;
                shared[pair[1]] += u32::from(pair[0] + 1 == pair[1]);
            }
        }
        let same = |&column: &usize| {
            column > 0
                && before[column] == before[column - 1] + 1
                && shared[column] == before[column]
                && pattern.rows(column) == &pattern.rows(column - 1)[1..]
        };
        let mut begins: Vec<usize> = (0..pattern.n()).filter(|column| !same(column)).collect();
        let n = begins.len();
        begins.push(pattern.n());
        let mut group_of = vec![0_u32; pattern.n()];
        for group in 0..n {
            group_of[begins[group]..begins[group + 1]].fill(group as u32);
        }

        // For each group the earlier ones that it is coupled with.
        let later = |group: usize| pattern.rows(begins[group]).chunk_by(|a, b| group_of[*a] == group_of[*b]).skip(1);
        let mut starts = vec![0_usize; n + 1];
        for group in 0..n {
            later(group).for_each(|rows| starts[group_of[rows[0]] as usize + 1] += 1);
        }
        for group in 0..n {
            starts[group + 1] += starts[group];
        }
        let mut next = starts.clone();
        let mut earlier = vec![0_u32; starts[n]];
        for group in 0..n {
            for rows in later(group) {
                let place = &mut next[group_of[rows[0]] as usize];
                earlier[*place] = group as u32;
                *place += 1;
            }
        }
        let earlier = |group: usize| earlier[starts[group]..starts[group + 1]].iter().map(|&other| other as usize);

        let mut parent = vec![None; n];
        // Shortcuts to the highest known ancestor.
        let mut ancestor = vec![None; n];
        let mut counts: Vec<usize> = begins.windows(2).map(|group| group[1] - group[0]).collect();
        let mut seen_in = vec![usize::MAX; n];
        for group in 0..n {
            for mut below in earlier(group) {
                while below != group {
                    let Some(above) = ancestor[below].replace(group) else {
                        parent[below] = Some(group);
                        break;
                    };
                    below = above;
                }
            }
            // The rows of the group are in the columns of all groups on the ways from there up to it.
            seen_in[group] = group;
            for mut below in earlier(group) {
                while seen_in[below] != group {
                    seen_in[below] = group;
                    counts[below] += begins[group + 1] - begins[group];
                    below = parent[below].expect("on the way to the group");
                }
            }
        }
        Self { begins, parent, counts }
    }

    /// The columns of a group.
    pub fn columns(&self, group: usize) -> Range<usize> {
        self.begins[group]..self.begins[group + 1]
    }

    /// Multiplications of the numeric factorisation, up to a constant factor.
    pub fn work(&self) -> f64 {
        let of_group = |(group, count): (usize, &usize)| {
            (0..self.columns(group).len()).map(|k| ((count - k) as f64).powi(2)).sum::<f64>()
        };
        self.counts.iter().enumerate().map(of_group).sum()
    }
}

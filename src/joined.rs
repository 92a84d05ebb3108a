//! What pairs join, directly or through one another.

/// Of each of so many, the least that pairs join to it, over any number of them; itself where none is smaller.
pub(crate) fn least_joined(
    count: usize,
    pairs: impl IntoIterator<Item = [usize; 2]>,
) -> Vec<usize> {
    let mut least: Vec<usize> = (0..count).collect();
    for pair in pairs {
        let [a, b] = pair.map(|at| root(&mut least, at));
        least[a.max(b)] = a.min(b);
    }
    // Each is led to a smaller one, which is led to its least already.
    for at in 0..count {
        least[at] = least[least[at]];
    }
    least
}

/// The least that one is led to so far, halving the way to it.
fn root(least: &mut [usize], mut at: usize) -> usize {
    while least[at] != at {
        least[at] = least[least[at]];
        at = least[at];
    }
    at
}

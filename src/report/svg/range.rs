//! The range of values a picture shows.

/// Smallest and largest of the values; `None` without any.
pub fn range(values: impl IntoIterator<Item = f64>) -> Option<[f64; 2]> {
    values
        .into_iter()
        .filter(|v| v.is_finite())
        .fold(None, |range, v| {
            let [lo, hi] = range.unwrap_or([v, v]);
            Some([v.min(lo), v.max(hi)])
        })
}

/// The smallest range that holds both.
pub fn union(a: Option<[f64; 2]>, b: Option<[f64; 2]>) -> Option<[f64; 2]> {
    match (a, b) {
        (Some(a), Some(b)) => Some([a[0].min(b[0]), a[1].max(b[1])]),
        (a, b) => a.or(b),
    }
}

/// Room on both sides, as a part of the range.
pub fn padded([lo, hi]: [f64; 2], part: f64) -> [f64; 2] {
    let room = part * (hi / 2.0 - lo / 2.0) * 2.0;
    [lo - room, hi + room]
}

/// What the calm runs span, and of the wild ones (growing, diverged) as much as does not push the
/// calm into a corner: each side gives way by at most half the calm span.
pub fn tamed(calm: Option<[f64; 2]>, wild: &[[f64; 2]]) -> Option<[f64; 2]> {
    let span = |r: &[f64; 2]| r[1] - r[0];
    let smallest = wild.iter().min_by(|a, b| span(a).total_cmp(&span(b)));
    let core = calm.or(smallest.copied())?;
    let room = span(&core) / 2.0;
    Some(wild.iter().fold(core, |window, w| {
        [
            window[0].min(w[0].max(core[0] - room)),
            window[1].max(w[1].min(core[1] + room)),
        ]
    }))
}

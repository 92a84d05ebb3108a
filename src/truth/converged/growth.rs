//! How fast neighbouring motions part.

use super::mesh::Mesh;

/// The neighbour starts this far away, relative to the size: its distance keeps eight digits, and
/// eight orders of magnitude are left to grow through.
pub(super) const OFFSET: f64 = 1e-8;

/// The rate at which neighbours part, 1/s: the slope of ln(amplification) over time, where an
/// exponential describes the second half of the growth better than a power of time does and where it
/// has run through at least e³. None otherwise: neighbours of regular motion part linearly.
pub(super) fn growth_rate(amplification: &[f64], mesh: &Mesh) -> Option<f64> {
    // Beyond a thousandth of the size, distances no longer grow as small ones do.
    let small = |factor: &f64| *factor < 1e-3 / OFFSET;
    let end = amplification.iter().take_while(|f| small(f)).count();
    let from = (end / 8).max(1);
    if end < from + 8 {
        return None;
    }
    let points = |time: fn(f64) -> f64| -> Vec<[f64; 2]> {
        let instants = (from..end).map(|k| (time(mesh.time(k)), amplification[k].ln()));
        instants.map(|(t, ln)| [t, ln]).collect()
    };
    let exponential = Line::through(&points(|t| t))?;
    let power = Line::through(&points(f64::ln))?;
    let gained = exponential.slope * (mesh.time(end - 1) - mesh.time(from));
    (gained > 3.0 && exponential.misfit < power.misfit).then_some(exponential.slope)
}

/// A least-squares line.
struct Line {
    slope: f64,
    /// Sum of squared residuals.
    misfit: f64,
}

impl Line {
    fn through(points: &[[f64; 2]]) -> Option<Self> {
        let n = points.len() as f64;
        let mean = |c: usize| points.iter().map(|p| p[c]).sum::<f64>() / n;
        let (x_mean, y_mean) = (mean(0), mean(1));
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for [x, y] in points {
            let (dx, dy) = (x - x_mean, y - y_mean);
            xx += dx * dx;
            xy += dx * dy;
            yy += dy * dy;
        }
        (xx > 0.0).then(|| Self {
            slope: xy / xx,
            misfit: yy - xy * xy / xx,
        })
    }
}

//! A linearised scene on its rods: what is left of forces along the motions that rods allow.
//!
//! Near a rest x* with tensions T, M d'' = -(K + K_T) d + Gᵀ μ and G d = 0, where K_T is what T does to a rod that turns:
//! T (1 - n nᵀ)/l of each. With Z an orthonormal basis of what G M^(-1/2) takes to 0, d = M^(-1/2) Z q leaves
//! q'' = -Zᵀ M^(-1/2) (K + K_T) M^(-1/2) Z q. Away from a rest it is the Hessian of the potential on the rods' surface,
//! with the tensions that hold the state where it is: those of the velocities turn with the motion, and are left out.
//! (Hairer, Lubich, Wanner, Geometric Numerical Integration, VII.1; Golub, Van Loan, Matrix Computations, 6.2.2.)

use super::part::{Matrix, Part};
use crate::physics::constraints::Rods;
use crate::physics::{System, Triplets};
use crate::scene::Stabilisation;
use faer::Mat;

/// A rod's row of G M^(-1/2): coordinates and entries, without what is only rounding of the others.
pub(super) type Row = Vec<(usize, f64)>;

/// The rods' rows, and what their tensions do.
pub(super) struct OnRods {
    pub rows: Vec<Row>,
    /// ∂f/∂x of the tensions held constant, N/m.
    pub turning: Triplets,
}

/// None where tensions are not determined.
pub(super) fn on_rods<S: System + ?Sized>(
    system: &S,
    rods: &Rods,
    t: f64,
    x: &[f64],
) -> Option<OnRods> {
    let (mut x, mut v) = (x.to_vec(), vec![0.0; x.len()]);
    system.place(t, &mut x, &mut v);
    let mut at = rods.at(&x).ok()?;
    // As still as what is driven allows.
    at.still(&mut v);
    let [mut pulled, mut held] = [vec![0.0; x.len()], vec![0.0; x.len()]];
    system.free_acceleration(t, &x, &v, &mut pulled);
    system.acceleration(t, &x, &v, &mut held);
    for (pulled, held) in pulled.iter_mut().zip(held) {
        *pulled -= held;
    }
    let mut tensions = at.still(&mut pulled);
    let ends = || rods.ends().iter().zip(&at.lengths);
    let mut turned: Vec<f64> = ends()
        .map(|([i, j], length)| {
            let apart = (0..3).map(|c| v[3 * j + c] - v[3 * i + c]);
            apart.map(|u| u * u).sum::<f64>() / length
        })
        .collect();
    at.solve(&mut turned);
    for (tension, turned) in tensions.iter_mut().zip(turned) {
        *tension -= turned;
    }
    let weights = system.inverse_mass();
    let mut on = OnRods {
        rows: Vec::new(),
        turning: Vec::new(),
    };
    let directions = at.directions.iter().zip(&at.lengths);
    for (([i, j], tension), (n, length)) in rods.ends().iter().zip(&tensions).zip(directions) {
        let mut row = Vec::new();
        for a in 0..3 {
            for (end, sign) in [(*i, -1.0), (*j, 1.0)] {
                let entry = sign * n[a] * weights[3 * end].sqrt();
                if entry != 0.0 && n[a].abs() > f64::EPSILON {
                    row.push((3 * end + a, entry));
                }
            }
            for b in 0..3 {
                let across = f64::from(u8::from(a == b)) - n[a] * n[b];
                let slope = tension * across / length;
                for (from, to, sign) in
                    [(*i, *i, -1.0), (*j, *j, -1.0), (*i, *j, 1.0), (*j, *i, 1.0)]
                {
                    on.turning.push((3 * from + a, 3 * to + b, sign * slope));
                }
            }
        }
        on.rows.push(row);
    }
    Some(on)
}

/// A part over a basis of the motions along rods, whose rows over the part's coordinates these are. None where they
/// leave no motion.
pub(super) fn along(part: &Part, rows: &[Row]) -> Option<Part> {
    let (n, held) = (part.n(), rows.len());
    if held >= n {
        return None;
    }
    let mut columns = Mat::<f64>::zeros(n, held);
    for (rod, row) in rows.iter().enumerate() {
        for &(at, entry) in row {
            columns[(at, rod)] = entry;
        }
    }
    let q = columns.qr().compute_Q();
    let free = q.subcols(held, n - held);
    let restricted = |matrix: &Matrix| {
        let dense = free.transpose() * matrix.dense() * free;
        let each = (0..n - held).flat_map(|i| (0..n - held).map(move |j| (i, j)));
        let left = Matrix::new(n - held, each.map(|(i, j)| (i, j, dense[(i, j)])));
        // A product with the basis rounds all of it.
        if matrix.skewness() == 0.0 {
            left.symmetric_part()
        } else {
            left
        }
    };
    let matrices = [&part.stiffness, &part.damping, &part.material].map(restricted);
    Some(Part::new(matrices, 0.5 * part.zero(), part.copies))
}

/// What Baumgarte's forces make of an error of a rod, once for each: it decays critically at their rate.
pub(super) fn stabilised(rods: &Rods) -> Option<Part> {
    let rate = rods.rate();
    let of = |value: f64| Matrix::new(1, [(0, 0, value)]);
    (rods.stabilisation() == Stabilisation::Baumgarte && rate > 0.0).then(|| {
        let matrices = [of(rate * rate), of(2.0 * rate), of(0.0)];
        Part::new(matrices, 0.0, rods.len())
    })
}

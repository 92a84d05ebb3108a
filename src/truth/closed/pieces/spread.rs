//! How rounding spreads from piece to piece.
//!
//! To first order an error (dx, dv) goes through a piece by the motion's own linear map, and through an event by its
//! saltation matrix (Aizerman and Gantmacher 1958; Leine and Nijmeijer 2004, section 7), since it moves the event by dt. All
//! roundings so far are held as one sum of squares P: by Cauchy and Schwarz n of them move a position by no more than
//! √n √(tr P_x).

use super::walls::Wall;
use super::{Mode, Phase, Piece};
use nalgebra::{Matrix6, Vector3, Vector6};

/// Roundings of each step of a formula.
const EACH: f64 = 8.0 * f64::EPSILON;

/// What roundings so far may have done to a particle's position, m, and velocity, m/s.
#[derive(Debug)]
pub(super) struct Spread {
    squares: Matrix6<f64>,
    /// Roundings that went in.
    number: f64,
    /// The largest bound so far, m.
    bar: f64,
    /// The rounding of a place, m.
    place: f64,
}

impl Spread {
    pub fn new(place: f64) -> Self {
        Self {
            squares: Matrix6::zeros(),
            number: 0.0,
            bar: 0.0,
            place,
        }
    }

    /// Through a piece of so many seconds, and adds what it rounds.
    pub fn fly(&mut self, piece: &Piece, lasts: f64) {
        let Mode { w, g } = piece.mode;
        let root = |of: f64| of.max(0.0).sqrt();
        let trace =
            |of: &Matrix6<f64>, from: usize| (from..from + 3).map(|k| of[(k, k)]).sum::<f64>();
        let [x, v] = [0, 3].map(|from| root(trace(&self.squares, from)));
        // Within the piece: no impulse response is larger.
        let within = x + v * piece.mode.impulse_bound(lasts);
        let response = piece.mode.response(lasts);
        self.apply(|x, v| {
            let back = w * w;
            let moved = x * (1.0 - back * response.step) + v * response.impulse;
            (
                moved,
                v * (1.0 + response.slowing) - x * (back * response.impulse),
            )
        });
        let speed = piece.v.norm() + piece.pull.norm() * piece.mode.impulse_bound(lasts);
        let way = speed * lasts.min(1.0 / piece.mode.fastest());
        let turned = 1.0 + w * lasts.min(1.0 / g.max(f64::MIN_POSITIVE));
        let place = EACH * way * turned;
        let fast = EACH * speed * turned;
        for k in 0..3 {
            self.squares[(k, k)] += place * place;
            self.squares[(k + 3, k + 3)] += fast * fast;
        }
        self.number += 6.0;
        let end = trace(&self.squares, 0);
        let bound = self.number.sqrt() * (within + place).max(root(end));
        // Places are rounded once a piece, and move no event: gaps are summed by themselves.
        let bound = bound + self.number * self.place;
        let bound = if bound.is_nan() { f64::INFINITY } else { bound };
        self.bar = self.bar.max(bound);
    }

    /// Through an impact on a plane that was `gap` metres away when the piece began, from these velocities to those, with
    /// these accelerations before and after it.
    pub fn strike(&mut self, wall: &Wall, gap: f64, v: [Vector3<f64>; 2], a: [Vector3<f64>; 2]) {
        let n = Vector6::from_fn(|k, _| wall.normal.get(k).copied().unwrap_or(0.0));
        self.squares += n * n.transpose() * (EACH * gap).powi(2);
        self.number += 1.0;
        let speed = wall.parting(v[0]);
        self.apply(|dx, dv| {
            let late = -wall.normal.dot(&dx) / speed;
            let before = dv + a[0] * late;
            let after = wall.struck_change(v[0], before) - a[1] * late;
            (dx + (v[0] - v[1]) * late, after)
        });
    }

    /// Through the instant at which sliding along this direction ends.
    pub fn turn(&mut self, along: Vector3<f64>, a: [Vector3<f64>; 2]) {
        let slowing = along.dot(&a[0]);
        self.apply(|dx, dv| {
            let late = -along.dot(&dv) / slowing;
            (dx, dv + (a[0] - a[1]) * late)
        });
    }

    /// Onto a plane that holds the particle.
    pub fn press(&mut self, normal: Vector3<f64>) {
        let on = |d: Vector3<f64>| d - normal * normal.dot(&d);
        self.apply(|dx, dv| (on(dx), on(dv)));
    }

    /// Onto what sticks: its velocity is that of the plane.
    pub fn stop(&mut self, then: Phase) {
        if let Phase::Stuck(_) = then {
            self.apply(|dx, _| (dx, Vector3::zeros()));
        }
    }

    /// The largest distance so far of a position from the true one, m.
    pub fn bar(&self) -> f64 {
        self.bar
    }

    fn apply(&mut self, map: impl Fn(Vector3<f64>, Vector3<f64>) -> (Vector3<f64>, Vector3<f64>)) {
        let columns = [0, 1, 2, 3, 4, 5].map(|k| {
            let one = Vector6::ith(k, 1.0);
            let (dx, dv) = map(one.fixed_rows::<3>(0).into(), one.fixed_rows::<3>(3).into());
            Vector6::new(dx[0], dx[1], dx[2], dv[0], dv[1], dv[2])
        });
        let matrix = Matrix6::from_columns(&columns);
        self.squares = matrix * self.squares * matrix.transpose();
    }
}

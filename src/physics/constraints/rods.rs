//! Rods: distances that forces along them keep, by Lagrange multipliers.
//!
//! With n the direction of a rod from its first end to its second, l their distance and u their relative velocity, the
//! rod keeps (l² - L²)/2, so that n·a + |u|²/l = 0 for the relative acceleration a. The tensions T that this takes solve
//! (G M⁻¹ Gᵀ) T = n·a₀ + |u|²/l, a₀ without them: one sparse Cholesky factor a position. (Hairer, Lubich, Wanner,
//! Geometric Numerical Integration, VII.1; Baraff 1996, SIGGRAPH.)

use super::ConstraintRow;
use crate::gram::{Factor, Gram, NoFactor};
use crate::scene::{Constraints, Drive, Scene, Stabilisation};
use crate::space::{dot, minus, three};
use std::ops::{Deref, DerefMut};
use std::sync::{Arc, Mutex, PoisonError};

mod rounding;

pub(super) const ROW: ConstraintRow = ConstraintRow {
    id: "rods",
    summary: "keep the distance of two particles exactly, by forces along it",
    source: "(G M⁻¹ Gᵀ) T = n·a + |u|²/l, each T pulling on both ends; Hairer, Lubich, Wanner, Geometric Numerical \
             Integration, VII.1",
};

/// Why rods cannot be kept.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RodError {
    #[error("rod {rod} has no direction any more: its ends met")]
    NoDirection { rod: usize },
    #[error(
        "rod {rod} came to depend on other rods, so that their tensions are not determined: a chain between fixed ends \
         is straight, or two rods are parallel"
    )]
    Dependent { rod: usize },
    #[error(
        "the tension of rod {rod} has no digits left: the masses of particles that rods join differ by a factor of \
         {ratio:.0e}, and from about 1e14 on the inertia of the light ones is below the rounding of that of the heavy"
    )]
    Masses { rod: usize, ratio: f64 },
    #[error(
        "the step left rod {rod} at a length that it cannot be brought back from: rods are drawn into one line, or the \
         timestep is too long"
    )]
    NotConverged { rod: usize },
}

impl From<NoFactor> for RodError {
    fn from(why: NoFactor) -> Self {
        match why {
            NoFactor::NoDirection(rod) => Self::NoDirection { rod },
            NoFactor::Dependent(rod) => Self::Dependent { rod },
        }
    }
}

/// How far a state is off the rod that is worst.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residual {
    /// The largest error of a distance, m.
    pub position: f64,
    /// The rod that has it.
    pub longest: usize,
    /// The largest velocity along a rod, m/s.
    pub velocity: f64,
}

/// The rods of a scene, and 1/m of its particles.
pub struct Rods {
    gram: Arc<Gram>,
    lengths: Vec<f64>,
    /// 1/m of each particle, 1/kg; 0 where it is fixed.
    weights: Vec<f64>,
    stabilisation: Stabilisation,
    /// The rate of Baumgarte's forces, 1/s.
    rate: f64,
    /// Whether tensions have their part |u|²/l, which turns the rod.
    turns: bool,
    /// Memory that is free; which of it is used changes no number.
    pool: Mutex<Vec<Factor>>,
}

/// Newton's iterations after which a projection has failed. It takes two to four; a chord method twice to ten times
/// that.
const ITERATIONS: u32 = 100;

/// Pivots below this part of their entry leave no digit that counts.
const LOST: f64 = 1e-14;

/// Directions and factor of rods at one position.
pub(crate) struct At<'a> {
    rods: &'a Rods,
    /// None after it went back to the pool.
    factor: Option<Factor>,
}

impl Drop for At<'_> {
    fn drop(&mut self) {
        let free = self.rods.pool.lock();
        let mut free = free.unwrap_or_else(PoisonError::into_inner);
        free.extend(self.factor.take());
    }
}

impl Deref for At<'_> {
    type Target = Factor;
    fn deref(&self) -> &Factor {
        self.factor.as_ref().expect("kept until the end")
    }
}

impl DerefMut for At<'_> {
    fn deref_mut(&mut self) -> &mut Factor {
        self.factor.as_mut().expect("kept until the end")
    }
}

impl Rods {
    /// None where the scene has none.
    pub fn new(scene: &Scene) -> Option<Self> {
        if scene.rods.is_empty() {
            return None;
        }
        let weight = |p: &crate::scene::Particle| if p.fixed { 0.0 } else { 1.0 / p.mass };
        let weights: Vec<f64> = scene.particles.iter().map(weight).collect();
        let ends = scene.rods.iter().map(|rod| rod.ends).collect();
        let constraints = scene.constraints.clone().unwrap_or_default();
        Some(Self {
            gram: Gram::new(ends, weights.len(), |particle| weights[particle] > 0.0).into(),
            lengths: scene.rods.iter().map(|rod| rod.length).collect(),
            weights,
            stabilisation: constraints.stabilisation,
            rate: constraints.rate,
            turns: true,
            pool: Mutex::default(),
        })
    }

    /// The same rods with these 1/m, 1/kg, of the same free particles.
    fn weighted(&self, weights: Vec<f64>) -> Self {
        Self {
            gram: Arc::clone(&self.gram),
            lengths: self.lengths.clone(),
            weights,
            pool: Mutex::default(),
            ..*self
        }
    }

    /// The same rods where every free mass is 1.
    pub fn with_unit_masses(&self) -> Self {
        self.weighted(self.weights.iter().map(|w| f64::from(*w > 0.0)).collect())
    }

    /// The same rods, stabilised otherwise.
    pub fn stabilised(&self, by: &Constraints) -> Self {
        Self {
            stabilisation: by.stabilisation,
            rate: by.rate,
            ..self.weighted(self.weights.clone())
        }
    }

    /// The same rods without the part |u|²/l of their tensions. A program that forgets it computes this.
    pub fn without_turning(&self) -> Self {
        Self {
            turns: false,
            ..self.weighted(self.weights.clone())
        }
    }

    /// The number of rods.
    pub fn len(&self) -> usize {
        self.lengths.len()
    }

    /// Never: without rods there is no such thing.
    pub fn is_empty(&self) -> bool {
        self.lengths.is_empty()
    }

    pub fn stabilisation(&self) -> Stabilisation {
        self.stabilisation
    }

    /// The rate of Baumgarte's forces, 1/s; 0 where there are none.
    pub fn rate(&self) -> f64 {
        match self.stabilisation {
            Stabilisation::Baumgarte => self.rate,
            _ => 0.0,
        }
    }

    /// The length of each rod, m.
    pub fn lengths(&self) -> &[f64] {
        &self.lengths
    }

    /// 1/m of each particle, 1/kg; 0 where it is fixed.
    pub fn weights(&self) -> &[f64] {
        &self.weights
    }

    /// The two particles of each rod.
    pub fn ends(&self) -> &[[usize; 2]] {
        &self.gram.ends
    }

    /// Directions and factor at `x`, m.
    ///
    /// # Errors
    /// [`RodError`] where a rod has no direction, depends on others there, or joins masses that are too far apart.
    pub(crate) fn at(&self, x: &[f64]) -> Result<At<'_>, RodError> {
        let mut at = self.room();
        let weight = |particle: usize| self.weights[particle];
        match self.gram.factorise(x, weight, LOST, &mut at) {
            Ok(()) => Ok(at),
            Err(NoFactor::Dependent(rod)) => {
                // Directions alone tell whether rods depend on each other.
                let unit = |particle: usize| f64::from(self.weights[particle] > 0.0);
                match self.gram.factorise(x, unit, LOST, &mut at) {
                    Ok(()) => {
                        let ratio = self.mass_ratio(rod);
                        Err(RodError::Masses { rod, ratio })
                    }
                    Err(why) => Err(why.into()),
                }
            }
            Err(why) => Err(why.into()),
        }
    }

    /// The largest over the smallest mass of the free particles that rods join to this one.
    fn mass_ratio(&self, rod: usize) -> f64 {
        let ends = self.ends();
        let free = |end: &usize| self.weights[*end] > 0.0;
        let mut joined = vec![false; self.weights.len()];
        let mut next: Vec<usize> = ends[rod].to_vec();
        while let Some(end) = next.pop() {
            if free(&end) && !std::mem::replace(&mut joined[end], true) {
                next.extend(ends.iter().filter(|ends| ends.contains(&end)).flatten());
            }
        }
        let weights = self.weights.iter().zip(joined);
        let weights = weights.filter_map(|(weight, joined)| joined.then_some(*weight));
        let (least, most) = weights.fold((f64::INFINITY, 0.0_f64), |(least, most), weight| {
            (least.min(weight), most.max(weight))
        });
        most / least
    }

    fn room(&self) -> At<'_> {
        let free = self.pool.lock();
        let kept = free.unwrap_or_else(PoisonError::into_inner).pop();
        At {
            rods: self,
            factor: Some(kept.unwrap_or_else(|| self.gram.room())),
        }
    }

    /// The tensions, N, positive where a rod pulls, at a state with accelerations `a`, m/s², that forces other than
    /// those of rods give; driven particles accelerate as their drives say.
    ///
    /// # Errors
    /// [`RodError`] where they are not determined.
    pub fn tensions(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        a: &[f64],
        drives: &[Drive],
    ) -> Result<Vec<f64>, RodError> {
        let mut at = self.at(x)?;
        let mut tensions = self.pulls(&at, t, v, a, drives);
        at.solve(&mut tensions);
        Ok(tensions)
    }

    /// *Adds* the forces of rods, N, to the others, on fixed particles too.
    ///
    /// # Errors
    /// [`RodError`] where they are not determined; `f` is then as it was.
    pub fn add_forces(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        f: &mut [f64],
        drives: &[Drive],
    ) -> Result<(), RodError> {
        let mut at = self.at(x)?;
        let a = f.chunks_exact(3).zip(&self.weights);
        let a: Vec<f64> = a.flat_map(|(f, w)| f.iter().map(move |f| f * w)).collect();
        let mut tensions = self.pulls(&at, t, v, &a, drives);
        at.solve(&mut tensions);
        at.pull(&tensions, |particle, axis, pull| {
            f[3 * particle + axis] += pull
        });
        Ok(())
    }

    /// The right-hand side: how the ends would accelerate apart without rods.
    fn pulls(&self, at: &Factor, t: f64, v: &[f64], a: &[f64], drives: &[Drive]) -> Vec<f64> {
        let acceleration = |particle: usize| -> [f64; 3] {
            let drive = drives.iter().find(|drive| drive.particle == particle);
            drive.map_or_else(|| three(a, particle), |drive| drive.at(t)[2])
        };
        let each = self.gram.ends.iter().zip(&self.lengths).enumerate();
        each.map(|(rod, ([i, j], length))| {
            let (n, l) = (at.directions[rod], at.lengths[rod]);
            let u = minus(three(v, *j), three(v, *i));
            let mut pull = dot(n, minus(acceleration(*j), acceleration(*i)));
            if self.turns {
                pull += dot(u, u) / l;
            }
            if self.stabilisation == Stabilisation::Baumgarte {
                // g'' + 2 α g' + α² g = 0 with g = (l² - L²)/2 (Baumgarte 1972), over l.
                let off = (l - length) * (l + length) / (2.0 * l);
                pull += self.rate * (2.0 * dot(n, u) + self.rate * off);
            }
            pull
        })
        .collect()
    }

    /// How far a state is off; velocities may be missing.
    pub fn residual(&self, x: &[f64], v: &[f64]) -> Residual {
        let mut at = self.room();
        self.gram.look(x, &mut at);
        let mut worst = Residual::default();
        for (rod, length) in self.lengths.iter().enumerate() {
            let off = (at.lengths[rod] - length).abs();
            // Not finite counts as worst.
            if off > worst.position || off.is_nan() {
                (worst.position, worst.longest) = (off, rod);
            }
            if !v.is_empty() {
                worst.velocity = worst.velocity.max(self.parting(&at, rod, v).abs());
            }
        }
        worst
    }

    /// The kinetic energy of the velocity along rods, J, which they do not allow; 0 where it is not determined. With what
    /// it does on driven ends it is all that [`still`](Self::still) takes out.
    pub fn energy_along(&self, x: &[f64], v: &[f64]) -> f64 {
        let Ok(mut at) = self.at(x) else {
            return 0.0;
        };
        let parting: Vec<f64> = (0..self.len())
            .map(|rod| self.parting(&at, rod, v))
            .collect();
        let mut impulses = parting.clone();
        at.solve(&mut impulses);
        // w = M⁻¹ Gᵀ p has G w = u, so that ½ w·M w = ½ p·u.
        0.5 * impulses
            .iter()
            .zip(parting)
            .map(|(p, u)| p * u)
            .sum::<f64>()
    }

    /// How fast the ends of a rod part, m/s.
    fn parting(&self, at: &Factor, rod: usize, v: &[f64]) -> f64 {
        let [i, j] = self.gram.ends[rod];
        dot(at.directions[rod], minus(three(v, j), three(v, i)))
    }

    /// Moves positions and velocities onto the rods, each particle by its 1/m, to rounding: Newton's method, and one
    /// solve for the velocities (Eich 1993, SIAM J. Numer. Anal. 30). Returns the work, J, that driven ends did by it.
    ///
    /// # Errors
    /// [`RodError`] where they depend on each other, or are too far off.
    pub fn project(&self, x: &mut [f64], v: &mut [f64]) -> Result<f64, RodError> {
        let mut at = self.at(x)?;
        let mut before = f64::INFINITY;
        for iterations in 0.. {
            let (mut off, worst) = self.off(&at, x);
            if let Some(rod) = self.far(&off) {
                return Err(RodError::NotConverged { rod });
            }
            if worst.arrived(before, iterations)? {
                break;
            }
            before = worst.roundings;
            at.solve(&mut off);
            at.apply(&off, x);
            drop(at);
            at = self.at(x)?;
        }
        let impulses = at.still(v);
        Ok(-at.on_driven(&impulses, v))
    }

    /// Takes the velocity along rods out of `v`, each particle by its 1/m.
    ///
    /// # Errors
    /// [`RodError`] where they depend on each other.
    pub fn still(&self, x: &[f64], v: &mut [f64]) -> Result<(), RodError> {
        self.at(x)?.still(v);
        Ok(())
    }

    /// Distances minus lengths, and the worst.
    fn off(&self, at: &Factor, x: &[f64]) -> (Vec<f64>, Worst) {
        let mut worst = Worst::default();
        let off = self.lengths.iter().enumerate().map(|(rod, length)| {
            let off = at.lengths[rod] - length;
            let far = self.gram.ends[rod].iter().flat_map(|end| three(x, *end));
            let largest = far.fold(*length, |most, c| most.max(c.abs()));
            let roundings = off.abs() / (2.0 * f64::EPSILON * largest);
            // Not finite counts as worst.
            if roundings > worst.roundings || roundings.is_nan() {
                worst = Worst { rod, roundings };
            }
            off
        });
        (off.collect(), worst)
    }

    /// A rod that is off by more than its length, since no correction of that is a small one.
    fn far(&self, off: &[f64]) -> Option<usize> {
        let mut each = off.iter().zip(&self.lengths);
        each.position(|(off, length)| off.abs() > *length)
    }

    /// Moves particles from `x` by h v, and by impulses along the rods at their old directions so that they arrive on
    /// the rods; `v` has the impulses afterwards, and moves `x` to `end`. `placed` puts what is driven in its place at
    /// the end. Returns the impulses, N s (Ryckaert, Ciccotti, Berendsen 1977, J. Comput. Phys. 23; Barth, Kuczera,
    /// Leimkuhler, Skeel 1995, J. Comput. Chem. 16: the matrix at the old directions).
    ///
    /// # Errors
    /// [`RodError::NotConverged`] where no such impulses were found.
    pub(crate) fn drift(
        &self,
        old: &mut At,
        h: f64,
        x: &mut [f64],
        v: &mut [f64],
        placed: impl FnOnce(&mut [f64]),
    ) -> Result<Vec<f64>, RodError> {
        for (x, v) in x.iter_mut().zip(&*v) {
            *x += h * v;
        }
        placed(x);
        let mut impulses = vec![0.0; self.len()];
        self.bring(old, x, |off| {
            for (impulse, off) in impulses.iter_mut().zip(off) {
                *impulse += off / h;
            }
        })?;
        old.apply(&impulses, v);
        Ok(impulses)
    }

    /// Moves positions onto the rods along these directions, to rounding, however far they are along them; `see` is told
    /// each iteration's steps along them, kg m. A rod that has turned by θ is 1 - cos θ times as far off after each: of
    /// one rod a root is found up to 70°, and there is none beyond 90°.
    fn bring(
        &self,
        along: &mut At,
        x: &mut [f64],
        mut see: impl FnMut(&[f64]),
    ) -> Result<(), RodError> {
        let mut now = self.room();
        let mut before = f64::INFINITY;
        for iterations in 0.. {
            self.gram.look(x, &mut now);
            let (mut off, worst) = self.off(&now, x);
            if worst.arrived(before, iterations)? {
                break;
            }
            before = worst.roundings;
            along.solve(&mut off);
            along.apply(&off, x);
            see(&off);
        }
        Ok(())
    }

    /// Moves positions onto the rods along the directions that these have there, each particle by its 1/m, to rounding.
    ///
    /// # Errors
    /// [`RodError`] where they depend on each other, or are too far off.
    pub fn straighten(&self, x: &mut [f64]) -> Result<(), RodError> {
        let mut along = self.at(x)?;
        self.bring(&mut along, x, |_| {})
    }
}

/// The rod that is worst off its length, and by how many roundings of its ends.
#[derive(Debug, Clone, Copy, Default)]
struct Worst {
    rod: usize,
    roundings: f64,
}

/// Residuals of so many roundings are as good as converged where they fall no more.
const CLOSE: f64 = 64.0;

impl Worst {
    /// Whether an iteration is over, which had so many roundings `before`.
    fn arrived(self, before: f64, iterations: u32) -> Result<bool, RodError> {
        let Self { rod, roundings } = self;
        if roundings <= 1.0 || (roundings >= 0.5 * before && before < CLOSE) {
            return Ok(true);
        }
        if iterations == ITERATIONS || !roundings.is_finite() {
            return Err(RodError::NotConverged { rod });
        }
        Ok(false)
    }
}

impl At<'_> {
    /// Overwrites `y` with the solution of (G M⁻¹ Gᵀ) z = y.
    pub fn solve(&mut self, y: &mut [f64]) {
        let gram = &self.rods.gram;
        gram.solve(self, y);
    }

    /// Calls `with` for each end and axis of each rod: particle, axis, and its part of a pull along the rod.
    fn pull(&self, pulls: &[f64], mut with: impl FnMut(usize, usize, f64)) {
        let each = self.rods.gram.ends.iter().zip(pulls).zip(&self.directions);
        for (([i, j], pull), n) in each {
            for axis in 0..3 {
                with(*i, axis, pull * n[axis]);
                with(*j, axis, -pull * n[axis]);
            }
        }
    }

    /// Adds to each particle its 1/m times the pulls of its rods.
    fn apply(&self, pulls: &[f64], y: &mut [f64]) {
        let weights = &self.rods.weights;
        self.pull(pulls, |particle, axis, pull| {
            y[3 * particle + axis] += weights[particle] * pull;
        });
    }

    /// Takes the velocity along rods out of `v`, each particle by its 1/m. Returns the impulses, N s.
    pub fn still(&mut self, v: &mut [f64]) -> Vec<f64> {
        let rods = self.rods;
        let mut impulses: Vec<f64> = (0..rods.len())
            .map(|rod| rods.parting(self, rod, v))
            .collect();
        self.solve(&mut impulses);
        self.apply(&impulses, v);
        impulses
    }

    /// The work that impulses along the rods, N s, do on fixed particles that move with `v`.
    pub fn on_driven(&self, impulses: &[f64], v: &[f64]) -> f64 {
        let weights = &self.rods.weights;
        let mut work = 0.0;
        self.pull(impulses, |particle, axis, pull| {
            if weights[particle] == 0.0 {
                work += pull * v[3 * particle + axis];
            }
        });
        work
    }
}

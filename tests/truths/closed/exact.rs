//! The linear motion of a scene in double-double arithmetic (about 31 digits), by the exponential of
//! its first-order matrix: no modes, no regimes, nothing shared with the forms under test.

use springcheck::scene::Scene;
use std::ops::{Add, Mul, Neg, Sub};

/// An unevaluated sum of two doubles (Dekker 1971).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Dd(pub f64, pub f64);

fn two_sum(a: f64, b: f64) -> Dd {
    let s = a + b;
    let bb = s - a;
    Dd(s, (a - (s - bb)) + (b - bb))
}

impl Dd {
    pub fn of(x: f64) -> Self {
        Self(x, 0.0)
    }

    pub fn over(self, b: Self) -> Self {
        let first = self.0 / b.0;
        let rest = self - b * Self::of(first);
        let second = rest.0 / b.0;
        let rest = rest - b * Self::of(second);
        two_sum(first, second) + Self::of(rest.0 / b.0)
    }

    pub fn sqrt(self) -> Self {
        if self.0 == 0.0 {
            return self;
        }
        let first = self.0.sqrt();
        let rest = self - Self::of(first) * Self::of(first);
        two_sum(first, rest.0 / (2.0 * first))
    }

    /// This less a double, as a double.
    pub fn minus(self, x: f64) -> f64 {
        (self.0 - x) + self.1
    }
}

impl Add for Dd {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let s = two_sum(self.0, b.0);
        let e = two_sum(self.1, b.1);
        let s = two_sum(s.0, s.1 + e.0);
        two_sum(s.0, s.1 + e.1)
    }
}

impl Neg for Dd {
    type Output = Self;
    fn neg(self) -> Self {
        Self(-self.0, -self.1)
    }
}

impl Sub for Dd {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Dd {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let p = self.0 * b.0;
        let e = self.0.mul_add(b.0, -p) + (self.0 * b.1 + self.1 * b.0);
        two_sum(p, e)
    }
}

/// A square matrix, row by row.
#[derive(Clone)]
pub struct Matrix {
    n: usize,
    entries: Vec<Dd>,
}

impl Matrix {
    fn zero(n: usize) -> Self {
        Self {
            n,
            entries: vec![Dd::default(); n * n],
        }
    }

    fn times(&self, b: &Self) -> Self {
        let n = self.n;
        let mut product = Self::zero(n);
        for i in 0..n {
            for k in 0..n {
                let a = self.entries[i * n + k];
                if a != Dd::default() {
                    for j in 0..n {
                        let entry = &mut product.entries[i * n + j];
                        *entry = *entry + a * b.entries[k * n + j];
                    }
                }
            }
        }
        product
    }

    /// exp(t self) by scaling, 26 terms, squaring.
    fn exp(&self, t: f64) -> Self {
        let n = self.n;
        let row = |i: usize| {
            self.entries[i * n..(i + 1) * n]
                .iter()
                .map(|e| e.0.abs())
                .sum::<f64>()
        };
        let norm = (0..n).map(row).fold(0.0, f64::max) * t;
        let squarings = (norm.max(0.5) / 0.5).log2().ceil() as i32;
        let scale = Dd::of(t) * Dd::of(2f64.powi(-squarings));
        let mut scaled = self.clone();
        scaled.entries.iter_mut().for_each(|e| *e = *e * scale);
        let mut sum = Self::zero(n);
        (0..n).for_each(|i| sum.entries[i * n + i] = Dd::of(1.0));
        let mut term = sum.clone();
        for k in 1..=26 {
            term = term.times(&scaled);
            for (sum, term) in sum.entries.iter_mut().zip(&mut term.entries) {
                *term = term.over(Dd::of(f64::from(k)));
                *sum = *sum + *term;
            }
        }
        for _ in 0..squarings {
            sum = sum.times(&sum);
        }
        sum
    }
}

/// Positions and velocities of all coordinates at `t`, where the forces are linear in each axis: rest
/// length 0 and isotropic dampers, or one line. All free particles at once, groups or not.
pub fn states(scene: &Scene, t: f64) -> (Vec<Dd>, Vec<Dd>) {
    if scene.magnetic.is_some() {
        return charged(scene, t);
    }
    let mut motion = Motion::new(scene);
    motion.advance(&flow(scene, t));
    motion.states()
}

/// The same of a scene of one particle in a magnetic field, which couples the axes: over position, velocity and 1.
fn charged(scene: &Scene, t: f64) -> (Vec<Dd>, Vec<Dd>) {
    let [p] = &scene.particles[..] else {
        panic!("one particle alone");
    };
    let field = scene.magnetic.as_ref().expect("a field").field;
    let mass = Dd::of(p.mass);
    let mut a = Matrix::zero(7);
    for c in 0..3 {
        a.entries[c * 7 + 3 + c] = Dd::of(1.0);
        let row = (3 + c) * 7;
        a.entries[row + 3 + c] = -Dd::of(p.drag).over(mass);
        // (v x B)_c = v_next B_last - v_last B_next.
        let (next, last) = ((c + 1) % 3, (c + 2) % 3);
        let turn = |b: f64| (Dd::of(p.charge) * Dd::of(b)).over(mass);
        a.entries[row + 3 + next] = turn(field[last]);
        a.entries[row + 3 + last] = -turn(field[next]);
        let wind = scene.wind.as_ref().map_or(Dd::default(), |wind| {
            Dd::of(wind.strength) * Dd::of(wind.direction[c])
        });
        a.entries[row + 6] = wind.over(mass);
    }
    let weight = &mut a.entries[(3 + scene.up.index()) * 7 + 6];
    *weight = *weight + Dd::of(scene.solver.gravity);
    let flow = a.exp(t);
    // As elsewhere the motion is that of the displacement, which starts at 0.
    let start = [0.0; 3].into_iter().chain(p.velocity).chain([1.0]);
    let start: Vec<Dd> = start.map(Dd::of).collect();
    let at = |row: usize| {
        let terms = flow.entries[row * 7..][..7].iter().zip(&start);
        terms.fold(Dd::default(), |sum, (a, b)| sum + *a * *b)
    };
    let x = (0..3).map(|c| at(c) + Dd::of(p.position[c])).collect();
    (x, (3..6).map(at).collect())
}

/// The numbers of the free particles among themselves.
fn places(scene: &Scene) -> Vec<Option<usize>> {
    let mut free = 0;
    let count = |p: &springcheck::scene::Particle| {
        free += usize::from(!p.fixed);
        (!p.fixed).then(|| free - 1)
    };
    scene.particles.iter().map(count).collect()
}

/// A motion as the flow of some time carries it on: for each axis the displacements and velocities of
/// the free particles, and which axis it is.
pub struct Motion<'a> {
    scene: &'a Scene,
    axes: [Vec<Dd>; 3],
}

impl<'a> Motion<'a> {
    pub fn new(scene: &'a Scene) -> Self {
        let free = scene.particles.iter().filter(|p| !p.fixed);
        let axes = [0, 1, 2].map(|axis| {
            let rest = free.clone().map(|_| Dd::default());
            let moving = free.clone().map(|p| Dd::of(p.velocity[axis]));
            let marks = (0..3).map(|other| Dd::of(f64::from(u8::from(other == axis))));
            rest.chain(moving).chain(marks).collect()
        });
        Self { scene, axes }
    }

    pub fn advance(&mut self, flow: &Matrix) {
        for axis in &mut self.axes {
            let product = flow.entries.chunks_exact(flow.n).map(|row| {
                let terms = row.iter().zip(&*axis).map(|(a, b)| *a * *b);
                terms.fold(Dd::default(), Add::add)
            });
            *axis = product.collect();
        }
    }

    /// Positions and velocities of all coordinates.
    pub fn states(&self) -> (Vec<Dd>, Vec<Dd>) {
        let n = (self.axes[0].len() - 3) / 2;
        let (mut x, mut v) = (Vec::new(), Vec::new());
        for (p, at) in self.scene.particles.iter().zip(places(self.scene)) {
            for axis in 0..3 {
                let of = |first: usize| at.map_or(Dd::default(), |at| self.axes[axis][first + at]);
                x.push(of(0) + Dd::of(p.position[axis]));
                v.push(of(n));
            }
        }
        (x, v)
    }
}

/// What `t` does to a [`Motion`]: the exponential of the first-order matrix, whose last three columns
/// are the constant accelerations along each axis.
pub fn flow(scene: &Scene, t: f64) -> Matrix {
    let place = places(scene);
    let n = place.iter().flatten().count();
    let size = 2 * n + 3;
    let mut a = Matrix::zero(size);
    let mut pull = vec![[Dd::default(); 3]; n];
    let free = |i: &usize| place[*i].is_some();
    for i in (0..scene.particles.len()).filter(free) {
        let (p, at) = (&scene.particles[i], place[i].expect("free"));
        a.entries[at * size + n + at] = Dd::of(1.0);
        a.entries[(n + at) * size + n + at] = -Dd::of(p.drag).over(Dd::of(p.mass));
        pull[at][scene.up.index()] = Dd::of(scene.solver.gravity);
        if let Some(wind) = &scene.wind {
            for c in 0..3 {
                let force = Dd::of(wind.strength) * Dd::of(wind.direction[c]);
                pull[at][c] = pull[at][c] + force.over(Dd::of(p.mass));
            }
        }
    }
    for spring in &scene.springs {
        let [from, to] = spring.ends.map(|end| scene.particles[end].position);
        let d = [0, 1, 2].map(|c| Dd::of(to[c]) - Dd::of(from[c]));
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        for (end, other) in [(0, 1), (1, 0)].map(|(i, j)| (spring.ends[i], spring.ends[j])) {
            let Some(at) = place[end] else { continue };
            let mass = Dd::of(scene.particles[end].mass);
            let towards = if end == spring.ends[0] { 1.0 } else { -1.0 };
            for c in 0..3 {
                let rest = match spring.rest_length {
                    0.0 => Dd::default(),
                    l => Dd::of(l) * d[c].over(length),
                };
                let force = Dd::of(towards * spring.stiffness) * (d[c] - rest);
                pull[at][c] = pull[at][c] + force.over(mass);
            }
            for (by, first) in [(spring.stiffness, 0), (spring.damping, n)] {
                let by = Dd::of(by).over(mass);
                let row = (n + at) * size + first;
                a.entries[row + at] = a.entries[row + at] - by;
                if let Some(other) = place[other] {
                    a.entries[row + other] = a.entries[row + other] + by;
                }
            }
        }
    }
    for at in 0..n {
        a.entries[(n + at) * size + 2 * n..][..3].copy_from_slice(&pull[at]);
    }
    a.exp(t)
}

/// The arithmetic and the exponential against 32 digits from elsewhere:
/// python3 -c "from mpmath import *; mp.dps=40; g,w,t=mpf(0.25),mpf(3),mpf(5); s=sqrt(w*w-g*g);
/// print(exp(-g*t)*(cos(s*t)+g/s*sin(s*t)), exp(-g*t)*-w*w/s*sin(s*t))"
#[test]
fn the_reference_has_thirty_digits() {
    let mut scene = super::families::isotropic(&mut crate::testkit::Random(1), 3.0, 0.0);
    scene.solver.gravity = 0.0;
    scene.particles[0].position = [0.0; 3];
    scene.particles[1].position = [1.0, 0.0, 0.0];
    scene.particles[1].velocity = [0.0; 3];
    scene.particles[1].mass = 1.0;
    scene.springs[0].stiffness = 9.0;
    scene.springs[0].damping = 0.5;
    let (x, v) = states(&scene, 5.0);
    for (found, high, low) in [
        (x[3], GOLDEN[0].0, GOLDEN[0].1),
        (v[3], GOLDEN[1].0, GOLDEN[1].1),
    ] {
        // Seven squarings double the 1e-31 of the series each.
        let off = (found - Dd(high, low)).0.abs();
        assert!(off < 1e-29, "{off:e}");
    }
}

/// Position and velocity at t = 5 of x'' = -9 x - x' / 2 from 1 at rest.
const GOLDEN: [(f64, f64); 2] = [
    (-0.19113381312377792, 6.7081497459767444e-18),
    (-0.5942905575226576, 3.84554028166044e-17),
];

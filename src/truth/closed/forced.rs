//! Modes whose springs end at driven particles: the response to a swinging or a steadily moving end.

use super::group::{Group, Link};
use super::mode::{Mode, Response};
use crate::physics::phi2;
use crate::scene::Drive;
use nalgebra::{Complex, Vector3};

/// The displacement of a driven end from its start along one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum End {
    /// Im[a (e^(iWt) - 1)], a in m and W above 0 in rad/s.
    Wave { a: Complex<f64>, rate: f64 },
    /// u t, u in m/s.
    Ramp { velocity: f64 },
}

impl End {
    /// None for a motion without a closed form.
    pub fn new(drive: &Drive, direction: Vector3<f64>) -> Option<Self> {
        if let Some(velocity) = drive.steady() {
            let velocity = Vector3::from(velocity).dot(&direction);
            return Some(Self::Ramp { velocity });
        }
        let sine = drive.sine()?;
        let swing = Vector3::from(sine.amplitude).dot(&direction);
        // A sine that runs backwards is one of the other sign that runs forwards.
        let sign = if sine.omega < 0.0 { -1.0 } else { 1.0 };
        Some(Self::Wave {
            a: Complex::from_polar(1.0, sign * sine.phase) * (sign * swing),
            rate: sine.omega.abs(),
        })
    }

    /// Displacement, m, and velocity, m/s.
    pub fn at(&self, t: f64) -> [f64; 2] {
        match *self {
            Self::Wave { a, rate } => {
                let turn = Complex::from_polar(1.0, rate * t);
                [(a * (turn - 1.0)).im, rate * (a * turn).re]
            }
            Self::Ramp { velocity } => [velocity * t, velocity],
        }
    }

    /// No displacement, m, speed, m/s, or acceleration, m/s², up to t is larger.
    pub fn bounds(&self, t: f64) -> [f64; 3] {
        match *self {
            Self::Wave { a, rate } => {
                let size = a.norm();
                [size * (rate * t).min(2.0), size * rate, size * rate * rate]
            }
            Self::Ramp { velocity } => [velocity.abs() * t, velocity.abs(), 0.0],
        }
    }
}

/// What the driven ends do to one mode along one direction: q'' + 2 g q' + w² q = f + r t + Im[F e^(iWt)] + ...
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Forcing {
    /// f, an acceleration.
    pub constant: f64,
    /// r.
    ramp: f64,
    /// F and W of each end that swings.
    waves: Vec<(Complex<f64>, f64)>,
}

impl Forcing {
    /// `push` is the force on the mode per unit of force between the ends of the link, with its sign at the driven end.
    pub fn add(&mut self, mode: &Mode, link: &Link, end: End, push: f64) {
        let [k, c] = [link.spring.stiffness, link.spring.damping];
        match end {
            End::Wave { a, rate } if rate > 0.0 => {
                self.constant -= push * k * a.im;
                self.waves
                    .push((a * Complex::new(push * k, push * c * rate), rate));
            }
            End::Wave { .. } => {}
            End::Ramp { velocity } => {
                self.constant += push * c * velocity;
                // A mode without a frequency stretches no spring.
                self.ramp += if mode.w > 0.0 {
                    push * k * velocity
                } else {
                    0.0
                };
            }
        }
    }

    /// Position and velocity that the ramp and the waves give to a mode at rest.
    pub fn moved(&self, mode: &Mode, response: &Response, t: f64) -> [f64; 2] {
        let mut moved = [0.0, self.ramp * response.step];
        if self.ramp != 0.0 {
            moved[0] += self.ramp * ramp(mode, response, t);
        }
        for (force, rate) in &self.waves {
            let [position, velocity] = wave(mode, response, *rate, t);
            moved[0] += (force * position).im;
            moved[1] += (force * velocity).im;
        }
        moved
    }

    /// No position, velocity or acceleration up to t is larger.
    pub fn bounds(&self, mode: &Mode, t: f64) -> [f64; 3] {
        let (step, impulse) = (mode.step_bound(t), mode.impulse_bound(t));
        // The step response is never negative, so that of a ramp grows.
        let r = self.ramp.abs();
        let mut bounds = [r * (t * step).min(t * t * t / 6.0), r * step, r * impulse];
        for (force, rate) in &self.waves {
            let [near, far] = roots(mode);
            let along = Complex::new(0.0, *rate);
            let [near, far] = [near, far].map(|root| (along - root).norm());
            let one = t.min(2.0 / near);
            let position = (t * impulse).min((one + impulse) / far);
            let velocity = t.min(rate * position + impulse);
            let acceleration = 1.0 + 2.0 * mode.g * velocity + mode.w * mode.w * position;
            for (bound, own) in bounds.iter_mut().zip([position, velocity, acceleration]) {
                *bound += force.norm() * own;
            }
        }
        bounds
    }

    /// The fastest drive, rad/s.
    pub fn fastest(&self) -> f64 {
        self.waves.iter().map(|w| w.1).fold(0.0, f64::max)
    }
}

/// The forcing of every mode along a direction, and the motion of each link's driven ends there; None where one has no
/// closed form. `sign` says on which side of its first end a link's second end lies.
pub(super) fn forcing(
    group: &Group,
    modes: &[Mode],
    stretches: impl Fn(&Link) -> Vec<f64>,
    direction: Vector3<f64>,
) -> Option<Vec<Forcing>> {
    let mut forcings = vec![Forcing::default(); modes.len()];
    for link in &group.links {
        for (drive, sign) in link.drives.iter().zip([1.0, -1.0]) {
            let Some(drive) = drive else { continue };
            let end = End::new(drive, direction)?;
            for ((forcing, mode), stretch) in forcings.iter_mut().zip(modes).zip(stretches(link)) {
                forcing.add(mode, link, end, sign * stretch);
            }
        }
    }
    Some(forcings)
}

/// The roots of s² + 2 g s + w²: the one nearer to a positive imaginary number first.
fn roots(mode: &Mode) -> [Complex<f64>; 2] {
    let Mode { w, g } = *mode;
    let split = (g - w) * (g + w);
    if split >= 0.0 {
        let fast = mode.fastest();
        let slow = if fast > 0.0 { w / fast * w } else { 0.0 };
        [-slow, -fast].map(|root| Complex::new(root, 0.0))
    } else {
        let turn = (-split).sqrt();
        [turn, -turn].map(|turn| Complex::new(-g, turn))
    }
}

/// Position and velocity of a mode at rest under e^(iWt) since t = 0: t² times the second divided difference of the
/// exponential at iWt and the mode's own roots, which has no pole at resonance.
fn wave(mode: &Mode, response: &Response, rate: f64, t: f64) -> [Complex<f64>; 2] {
    let along = Complex::new(0.0, rate);
    let [near, far] = roots(mode);
    let position = if rate.max(mode.fastest()) * t < 1.0 {
        wave_series(mode, along, t)
    } else {
        // The roots are real or conjugate, so the farther one is at least as far as anything here is large.
        (first_difference(along, near, t) - response.impulse) / (along - far)
    };
    [position, along * position + response.impulse]
}

/// (e^(at) - e^(bt)) / (a - b).
fn first_difference(a: Complex<f64>, b: Complex<f64>, t: f64) -> Complex<f64> {
    let half = (a - b) * (0.5 * t);
    if half.norm() > 1.0 {
        return ((a * t).exp() - (b * t).exp()) / (a - b);
    }
    let sinh = Complex::new(
        half.re.sinh() * half.im.cos(),
        half.re.cosh() * half.im.sin(),
    );
    let mean = if half == Complex::new(0.0, 0.0) {
        Complex::new(1.0, 0.0)
    } else {
        sinh / half
    };
    ((a + b) * (0.5 * t)).exp() * mean * t
}

/// The same position as its Taylor series, where all rates times t are below 1.
fn wave_series(mode: &Mode, along: Complex<f64>, t: f64) -> Complex<f64> {
    // z'' = e^(iWt) - 2 g z' - w² z, term by term.
    let (a, b) = (2.0 * mode.g * t, (mode.w * t) * (mode.w * t));
    let zero = Complex::new(0.0, 0.0);
    let (mut before, mut term, mut sum) = (zero, zero, zero);
    let mut push = Complex::new(t * t, 0.0);
    for n in 2..30_u32 {
        let n = f64::from(n);
        let next = (push - term * (a * (n - 1.0)) - before * b) / (n * (n - 1.0));
        (before, term) = (term, next);
        sum += term;
        push *= along * t / (n - 1.0);
    }
    sum
}

/// The position of a mode at rest under an acceleration of t since t = 0: the integral of the step response.
fn ramp(mode: &Mode, response: &Response, t: f64) -> f64 {
    let Mode { w, g } = *mode;
    let fast = mode.fastest();
    if fast * t < 1.0 {
        // As the step response's series, one power higher.
        let (a, b) = (2.0 * g * t, (w * t) * (w * t));
        let (mut before, mut term) = (0.0, t * t * t / 6.0);
        let mut sum = term;
        for n in 3..30_u32 {
            let n = f64::from(n);
            let next = -(a * n * term + b * before) / (n * (n + 1.0));
            (before, term) = (term, next);
            sum += term;
        }
        sum
    } else if g >= w {
        let slow = w / fast * w;
        (t * t * phi2(-slow * t) - response.step) / fast
    } else {
        (t - response.impulse - 2.0 * g * response.step) / (w * w)
    }
}

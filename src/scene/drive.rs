//! The motion of a driven particle as a function of time.

use super::limits::{DRIVEN_ACCELERATION, DRIVEN_SPEED};
use super::model::{self, Driven, Knots, Scene, Sine, Table};
use super::place::Problem;

/// Where a driven particle is at any time, and how fast.
///
/// Not to be confused with a force that drives: the motion is given, whatever it takes.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Its id.
    pub particle: usize,
    /// Its `pos`, m, to which the motion is added.
    origin: [f64; 3],
    motion: Motion,
    how: How,
    /// How much later it moves than its motion says, s: 0 where it is right.
    late: f64,
}

/// What is made of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
enum How {
    Itself,
    /// Straight from each multiple of these seconds to the next.
    Straight(f64),
    /// At the same places, with velocity 0.
    Still,
}

#[derive(Debug, Clone, PartialEq)]
enum Motion {
    Sine(Sine),
    /// m/s.
    Steady([f64; 3]),
    Spline(Spline),
}

impl Scene {
    /// The motions of driven particles.
    pub fn drives(&self) -> Vec<Drive> {
        self.driven
            .iter()
            .filter_map(|driven| Drive::new(self, driven))
            .collect()
    }

    /// Where each particle is at t = 0, m: a driven one has its motion added.
    pub fn starts(&self) -> Vec<[f64; 3]> {
        let mut starts: Vec<_> = self.particles.iter().map(|p| p.position).collect();
        for drive in self.drives() {
            starts[drive.particle] = drive.at(0.0)[0];
        }
        starts
    }
}

impl Driven {
    /// Its motion, whatever it moves.
    pub(super) fn motion(&self) -> model::Motion {
        model::Motion {
            sine: self.sine.clone(),
            velocity: self.velocity,
            table: self.table.clone(),
        }
    }
}

impl Drive {
    /// None where the entry says no motion, or of no particle.
    pub(super) fn new(scene: &Scene, driven: &Driven) -> Option<Self> {
        Some(Self {
            particle: driven.particle,
            origin: scene.particles.get(driven.particle)?.position,
            ..Self::displacement(&driven.motion())?
        })
    }

    /// The displacement of an obstacle, m: it is of no particle. None where it says no motion.
    pub(super) fn displacement(motion: &model::Motion) -> Option<Self> {
        let sine = motion.sine.clone().map(Motion::Sine);
        let steady = motion.velocity.map(Motion::Steady);
        let spline = motion.table.as_ref().and_then(Spline::new);
        Some(Self {
            particle: usize::MAX,
            origin: [0.0; 3],
            motion: sine.or(steady).or(spline.map(Motion::Spline))?,
            how: How::Itself,
            late: 0.0,
        })
    }

    /// The same motion, so many times as far.
    pub fn times(&self, factor: f64) -> Self {
        let times = |all: &[f64; 3]| all.map(|part| factor * part);
        let motion = match &self.motion {
            Motion::Sine(sine) => Motion::Sine(Sine {
                amplitude: times(&sine.amplitude),
                ..sine.clone()
            }),
            Motion::Steady(velocity) => Motion::Steady(times(velocity)),
            Motion::Spline(Spline { knots }) => Motion::Spline(Spline {
                knots: knots
                    .iter()
                    .map(|knot| Knot {
                        t: knot.t,
                        x: times(&knot.x),
                        bend: times(&knot.bend),
                    })
                    .collect(),
            }),
        };
        Self {
            motion,
            ..self.clone()
        }
    }

    /// The same at every multiple of `step`, s, and straight at constant velocity in between: what a body does that an
    /// engine moves from step to step. Between two steps it has the velocity of the one that begins.
    pub fn straight(&self, step: f64) -> Self {
        Self {
            how: How::Straight(step),
            ..self.clone()
        }
    }

    /// The same motion, so many seconds later.
    pub fn late(&self, seconds: f64) -> Self {
        Self {
            late: self.late + seconds,
            ..self.clone()
        }
    }

    /// Straight from row to row of its table; any other motion as it is.
    pub fn unbent(&self) -> Self {
        let mut straight = self.clone();
        if let Motion::Spline(spline) = &mut straight.motion {
            for knot in &mut spline.knots {
                knot.bend = [0.0; 3];
            }
        }
        straight
    }

    /// The same places with velocity 0: what dampers see in a program that forgets the velocity of what it moves.
    pub fn still(&self) -> Self {
        Self {
            how: How::Still,
            ..self.clone()
        }
    }

    /// Position, m, velocity, m/s, and acceleration, m/s², at a time, s.
    pub fn at(&self, t: f64) -> [[f64; 3]; 3] {
        let t = t - self.late;
        let step = match self.how {
            How::Itself => return self.smooth(t),
            How::Still => return [self.smooth(t)[0], [0.0; 3], [0.0; 3]],
            How::Straight(step) => step,
        };
        // A time that is a step but for its rounding is that step.
        let k = (t / step + 1e-9).floor();
        let [from, to] = [k, k + 1.0].map(|k| self.smooth(k * step)[0]);
        let velocity = [0, 1, 2].map(|axis| (to[axis] - from[axis]) / step);
        let position = [0, 1, 2].map(|axis| from[axis] + (t - k * step) * velocity[axis]);
        [position, velocity, [0.0; 3]]
    }

    fn smooth(&self, t: f64) -> [[f64; 3]; 3] {
        let [moved, velocity, acceleration] = match &self.motion {
            Motion::Sine(Sine {
                amplitude,
                omega,
                phase,
            }) => {
                let (sin, cos) = (omega * t + phase).sin_cos();
                [sin, omega * cos, -omega * omega * sin].map(|part| amplitude.map(|a| a * part))
            }
            Motion::Steady(velocity) => [velocity.map(|v| v * t), *velocity, [0.0; 3]],
            Motion::Spline(spline) => spline.at(t),
        };
        let position = [0, 1, 2].map(|axis| self.origin[axis] + moved[axis]);
        [position, velocity, acceleration]
    }

    /// How far off rounding may put it along each axis after `n` steps, m, where a number is rounded by the part `eps`:
    /// the time is a running sum, as may be the place that moves on and on; and each term of the motion is rounded.
    pub fn rounding(&self, t: f64, n: u64, eps: f64) -> [f64; 3] {
        let [position, velocity, _] = self.at(t);
        // A cosine of a phase less π/2 is a sine too.
        let quarter = std::f64::consts::FRAC_PI_2;
        let terms = match &self.motion {
            Motion::Sine(sine) => {
                let phase = (sine.omega * t).abs() + sine.phase.abs() + quarter;
                sine.amplitude.map(|a| a.abs() * (1.0 + phase))
            }
            Motion::Steady(velocity) => velocity.map(|v| (v * t).abs()),
            // Rows that cancel in the slopes and their differences, each as large as the largest.
            Motion::Spline(Spline { knots }) => [0, 1, 2].map(|axis| {
                let sizes = knots.iter().map(|knot| knot.x[axis].abs());
                4.0 * sizes.fold(0.0, f64::max)
            }),
        };
        let sums = match self.motion {
            Motion::Steady(_) => 1.0 + 0.25 * n as f64,
            _ => 1.0,
        };
        [0, 1, 2].map(|axis| {
            let place = sums * (self.origin[axis].abs() + position[axis].abs());
            // Half a rounding a step, which may all go one way.
            let late = 0.25 * n as f64 * t.abs() * velocity[axis].abs();
            eps * (place + terms[axis] + late)
        })
    }

    /// The farthest it gets from its start along each axis within about one period, or from one row of a table to
    /// another: 0 on the axes that it never moves on, m, or m/s of a constant velocity.
    pub fn reach(&self) -> [f64; 3] {
        match &self.motion {
            Motion::Sine(sine) => sine.amplitude.map(f64::abs),
            Motion::Steady(velocity) => velocity.map(f64::abs),
            Motion::Spline(Spline { knots }) => [0, 1, 2].map(|axis| {
                let moved = knots.iter().map(|knot| knot.x[axis] - knots[0].x[axis]);
                moved.fold(0.0, |most: f64, moved| most.max(moved.abs()))
            }),
        }
    }

    /// No speed up to `t` is larger, m/s.
    pub fn speed_bound(&self, t: f64) -> f64 {
        let norm = |v: [f64; 3]| v[0].hypot(v[1]).hypot(v[2]);
        match &self.motion {
            Motion::Sine(sine) => norm(sine.amplitude) * sine.omega.abs(),
            Motion::Steady(velocity) => norm(*velocity),
            // Between rows the velocity is a parabola: it turns where the acceleration, a line, is 0.
            Motion::Spline(spline) => {
                spline
                    .turns(t)
                    .map(|at| norm(spline.at(at)[1]))
                    .fold(0.0, f64::max)
                    * 3.0_f64.sqrt()
            }
        }
    }

    /// The first row of a table on the way to which a component of the velocity, m/s, or of the acceleration, m/s², is
    /// larger than these, or not a number.
    pub(super) fn wild(&self, fastest: f64, steepest: f64) -> Option<usize> {
        let Motion::Spline(Spline { knots }) = &self.motion else {
            return None;
        };
        let pieces = knots.windows(2).position(|pair| {
            let [from, to] = [&pair[0], &pair[1]];
            let h = to.t - from.t;
            let tame = |axis: usize| {
                let [low, high] = [from.bend[axis], to.bend[axis]];
                // Within a piece the velocity is that of the chord and at most h/2 times the accelerations.
                let slope = ((to.x[axis] - from.x[axis]) / h).abs();
                let bent = low.abs().max(high.abs());
                slope + 0.5 * h * bent <= fastest && bent <= steepest
            };
            !(0..3).all(tame)
        });
        pieces.map(|piece| piece + 1)
    }

    /// Times, s, ascending, at which a derivative of the motion jumps: the third, at a table's rows.
    pub fn knots(&self) -> impl Iterator<Item = f64> + '_ {
        let knots = match &self.motion {
            Motion::Spline(spline) => &spline.knots[..],
            _ => &[],
        };
        knots.iter().map(|knot| knot.t)
    }

    /// The sine it moves by, if it does.
    pub fn sine(&self) -> Option<&Sine> {
        match &self.motion {
            Motion::Sine(sine) => Some(sine),
            _ => None,
        }
    }

    /// The constant velocity it moves at, m/s, if it does.
    pub fn steady(&self) -> Option<[f64; 3]> {
        match self.motion {
            Motion::Steady(velocity) => Some(velocity),
            _ => None,
        }
    }
}

/// Checks that there is one motion, and a table that can be followed.
pub(super) fn motion(of: &str, motion: &model::Motion) -> Result<(), Problem> {
    let motions = [
        ("sine", motion.sine.is_some()),
        ("velocity", motion.velocity.is_some()),
        ("table", motion.table.is_some()),
    ];
    let given: Vec<&str> = motions.iter().filter(|m| m.1).map(|m| m.0).collect();
    if given.len() != 1 {
        let found = if given.is_empty() {
            "none".to_owned()
        } else {
            given.join(" and ")
        };
        let message = format!("expected one of `sine`, `velocity` and `table`, found {found}");
        let help = "a motion is one of `sine: {amplitude, omega}`, `velocity: [x, y, z]`, or `table` with two rows \
                    [t, x, y, z] or more";
        return Problem::because(of, message, help);
    }
    let rows = motion.table.iter().flat_map(|table| &table.0);
    let times: Vec<f64> = rows.map(|row| row[0]).collect();
    if let Some(row) = (1..times.len()).find(|&row| times[row] <= times[row - 1]) {
        let [before, found] = [times[row - 1], times[row]];
        let message = format!("expected a time after {before:?} s, found {found:?}");
        let help = "rows are in the order of their times, and no two have the same";
        return Problem::because(format!("{of}.table[{row}]"), message, help);
    }
    let wild = |drive: Drive| drive.wild(DRIVEN_SPEED, DRIVEN_ACCELERATION);
    if let Some(row) = Drive::displacement(motion).and_then(wild) {
        let message = format!(
            "expected a motion of at most {DRIVEN_SPEED:e} m/s and {DRIVEN_ACCELERATION:e} m/s² up to this row, found \
             a faster one"
        );
        let help = "its rows are too near in time for how far apart their places are";
        return Problem::because(format!("{of}.table[{row}]"), message, help);
    }
    Ok(())
}

/// The natural cubic spline through some rows: twice continuously differentiable, without curvature at both ends, and
/// straight beyond them (de Boor, A Practical Guide to Splines, IV).
#[derive(Debug, Clone, PartialEq)]
struct Spline {
    knots: Vec<Knot>,
}

#[derive(Debug, Clone, PartialEq)]
struct Knot {
    /// s.
    t: f64,
    /// m.
    x: [f64; 3],
    /// The second derivative, m/s²; 0 at both ends.
    bend: [f64; 3],
}

impl Spline {
    /// None of fewer than two rows. Times ascend.
    fn new(Table(rows): &Knots) -> Option<Self> {
        let mut knots: Vec<Knot> = rows
            .iter()
            .map(|&[t, x, y, z]| Knot {
                t,
                x: [x, y, z],
                bend: [0.0; 3],
            })
            .collect();
        let last = knots.len().checked_sub(1).filter(|last| *last > 0)?;
        for axis in 0..3 {
            // h₀ M₋ + 2 (h₀ + h₁) M + h₁ M₊ = 6 (slope₁ - slope₀) at each knot inside, by elimination down and back.
            let (mut upper, mut right) = (vec![0.0; last], vec![0.0; last]);
            let slope = |i: usize| {
                (knots[i + 1].x[axis] - knots[i].x[axis]) / (knots[i + 1].t - knots[i].t)
            };
            for i in 1..last {
                let [h0, h1] = [i - 1, i].map(|i| knots[i + 1].t - knots[i].t);
                let pivot = 2.0 * (h0 + h1) - h0 * upper[i - 1];
                upper[i] = h1 / pivot;
                right[i] = (6.0 * (slope(i) - slope(i - 1)) - h0 * right[i - 1]) / pivot;
            }
            for i in (1..last).rev() {
                knots[i].bend[axis] = right[i] - upper[i] * knots[i + 1].bend[axis];
            }
        }
        Some(Self { knots })
    }

    /// Times up to `t` between which its speed along each axis rises or falls, ends included.
    fn turns(&self, t: f64) -> impl Iterator<Item = f64> + '_ {
        let pieces = self.knots.windows(2).flat_map(|pair| {
            let (from, to) = (&pair[0], &pair[1]);
            let still = (0..3).map(move |axis| {
                let [low, high] = [from.bend[axis], to.bend[axis]];
                let part = if low * high < 0.0 {
                    low / (low - high)
                } else {
                    0.0
                };
                from.t + part * (to.t - from.t)
            });
            still.chain([to.t])
        });
        pieces.filter(move |turn| *turn < t).chain([0.0, t])
    }

    /// Displacement, m, velocity, m/s, and acceleration, m/s².
    fn at(&self, t: f64) -> [[f64; 3]; 3] {
        let last = self.knots.len() - 2;
        let after = self.knots.partition_point(|knot| knot.t <= t);
        let piece = after.saturating_sub(1).min(last);
        let (from, to) = (&self.knots[piece], &self.knots[piece + 1]);
        let h = to.t - from.t;
        let inside = t.clamp(from.t, to.t);
        let beyond = t - inside;
        let (a, b) = (inside - from.t, to.t - inside);
        let [mut x, mut v, mut bent] = [[0.0; 3]; 3];
        for axis in 0..3 {
            let [low, high] = [from.bend[axis], to.bend[axis]];
            let [start, end] = [from.x[axis], to.x[axis]];
            v[axis] = (end - start) / h
                + (high * (3.0 * a * a - h * h) - low * (3.0 * b * b - h * h)) / (6.0 * h);
            // From the nearer end, so that a row is met to the last bit.
            let chord = if a <= b {
                start + a / h * (end - start)
            } else {
                end - b / h * (end - start)
            };
            bent[axis] = (low * b + high * a) / h;
            x[axis] =
                chord - a * b * (low * (h + b) + high * (h + a)) / (6.0 * h) + v[axis] * beyond;
        }
        [x, v, bent]
    }
}

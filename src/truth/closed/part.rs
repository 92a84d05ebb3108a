//! One group's motion, where its forces are linear all along: its modes along one axis or three, and
//! its error bar.

use super::forced::{End, Forcing, forcing};
use super::group::{Body, Group, Link};
use super::lengths::{Length, Moved, bounds};
use super::line::{Drift, Line, Sideways};
use super::mode::{Response, Start};
use super::modes::Modes;
use super::vector::norm;
use super::words;
use nalgebra::Vector3;

/// A length has to stay above this fraction of the scene's size.
const CLOSEST: f64 = 1e-9;

/// Rounding may push particles off their line by this fraction of the scene's size.
const ASIDE: f64 = 1e-9;

/// The motion of the modes along one axis.
#[derive(Debug, Clone)]
struct Axis {
    /// Unit vector.
    direction: Vector3<f64>,
    /// The start of each mode.
    starts: Vec<Start>,
    /// What driven ends do to each mode.
    forcings: Vec<Forcing>,
}

/// x(t) = x(0) + axes times modes + drift.
#[derive(Debug, Clone)]
pub(super) struct GroupMotion {
    /// Scene ids of the free particles.
    particles: Vec<usize>,
    modes: Modes,
    axes: Vec<Axis>,
    drift: Drift,
    /// Growth of what rounding leaves across a line, if it leaves anything.
    sideways: Option<Sideways>,
    /// The scene's size, m.
    size: f64,
    pub method: String,
    pub reason: String,
}

impl GroupMotion {
    /// The group's motion, if it has a closed form.
    pub fn of(group: &Group) -> Option<Self> {
        if group.is_linear() {
            Self::in_space(group)
        } else {
            Self::on_line(group)
        }
    }

    /// The motion along three axes, which are alike and independent.
    fn in_space(group: &Group) -> Option<Self> {
        let modes = Modes::new(group)?;
        let axes = (0..3).map(|c| {
            let tension = |link: &Link| link.spring.stiffness * link.between()[c];
            Axis::new(group, &modes, Vector3::ith(c, 1.0), tension)
        });
        let axes = axes.collect::<Option<_>>()?;
        let words = words::in_space(group, &modes.modes);
        Some(Self::new(group, modes, axes, Drift::default(), words))
    }

    /// The motion along one axis: a line that may move sideways as a whole.
    fn on_line(group: &Group) -> Option<Self> {
        let line = Line::of(group)?;
        let modes = Modes::new(group)?;
        // On which side of its first end a spring's second end lies; 0 where they coincide.
        let side = |link: &Link| link.between().dot(&line.direction);
        let bound = || group.links.iter().filter(|link| link.has_rest_length());
        if bound().any(|link| side(link) == 0.0) {
            return None;
        }
        let sign = |link: &Link| if side(link) < 0.0 { -1.0 } else { 1.0 };
        let tension = |link: &Link| {
            let stretch = norm(link.between()) - link.spring.rest_length;
            link.spring.stiffness * stretch * sign(link)
        };
        let along = Axis::new(group, &modes, line.direction, tension)?;
        // Springs are linear only while their ends do not pass each other.
        let lengths: Vec<Length> = bound()
            .map(|link| Length {
                start: norm(link.between()),
                stretch: modes
                    .stretches(link)
                    .iter()
                    .map(|s| sign(link) * s)
                    .collect(),
                ends: ends(link, line.direction, sign(link)),
            })
            .collect();
        let starts = modes.modes.iter().zip(&along.starts);
        let moved: Vec<Moved> = starts
            .zip(&along.forcings)
            .map(|((mode, start), forcing)| Moved {
                mode: *mode,
                start: *start,
                forcing: forcing.clone(),
            })
            .collect();
        let mut part = Self::new(group, modes, vec![along], line.drift, Default::default());
        let closest = (CLOSEST * part.size).max(4.0 * part.error_bar(group.until));
        let lengths = bounds(&moved, &lengths, group.until, closest)?;
        if !line.offset.is_none() {
            let sideways = Sideways::new(group, line.offset, &lengths)?;
            let stays = sideways.bound(group.until) <= ASIDE * part.size;
            if !stays {
                return None;
            }
            part.sideways = Some(sideways);
        }
        let shortest = lengths.iter().map(|b| b.shortest).reduce(f64::min);
        (part.method, part.reason) = words::on_line(group, &part.modes.modes, shortest);
        Some(part)
    }

    fn new(
        group: &Group,
        modes: Modes,
        axes: Vec<Axis>,
        drift: Drift,
        (method, reason): (String, String),
    ) -> Self {
        Self {
            particles: group.bodies.iter().map(|b| b.id).collect(),
            modes,
            axes,
            drift,
            sideways: None,
            size: group.size,
            method,
            reason,
        }
    }

    /// Adds displacements and gained velocities at `t` to flat vectors of the scene.
    pub fn add(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        let n = self.particles.len();
        let responses: Vec<Response> = self.modes.modes.iter().map(|m| m.response(t)).collect();
        let (mut moved, mut gained) = (vec![0.0; n], vec![0.0; n]);
        for axis in &self.axes {
            moved.fill(0.0);
            gained.fill(0.0);
            for (j, (response, &start)) in responses.iter().zip(&axis.starts).enumerate() {
                let [forced, faster] = axis.forcings[j].moved(&self.modes.modes[j], response, t);
                let position = response.position(start) + forced;
                let speed = response.gained(start) + faster;
                for (i, shape) in self.modes.shape(j).iter().enumerate() {
                    moved[i] += shape * position;
                    gained[i] += shape * speed;
                }
            }
            for (i, particle) in self.particles.iter().enumerate() {
                for (c, along) in axis.direction.iter().enumerate() {
                    x[3 * particle + c] += along * moved[i];
                    v[3 * particle + c] += along * gained[i];
                }
            }
        }
        if !self.drift.is_still() {
            let response = self.drift.mode.response(t);
            for particle in &self.particles {
                for c in 0..3 {
                    let start = Start {
                        velocity: self.drift.velocity[c],
                        pull: self.drift.pull[c],
                    };
                    x[3 * particle + c] += response.position(start);
                    v[3 * particle + c] += response.gained(start);
                }
            }
        }
    }

    /// Bounds on the distance of any particle from its start in [0, t], m: of all motion, and of
    /// what swings or creeps back alone.
    fn reach(&self, t: f64) -> (f64, f64) {
        let n = self.particles.len();
        let Drift {
            mode,
            velocity,
            pull,
        } = &self.drift;
        let drifted = norm(velocity * mode.impulse_bound(t)) + norm(*pull) * mode.step_bound(t);
        let (mut all, mut swing) = (vec![drifted; n], vec![0.0_f64; n]);
        for axis in &self.axes {
            let (mut each, mut swinging) = (vec![0.0; n], vec![0.0; n]);
            for (j, (mode, start)) in self.modes.modes.iter().zip(&axis.starts).enumerate() {
                let bound = mode.travel_bound(*start, t) + axis.forcings[j].bounds(mode, t)[0];
                for (i, shape) in self.modes.shape(j).iter().enumerate() {
                    each[i] += shape.abs() * bound;
                    if mode.w > 0.0 {
                        swinging[i] += shape.abs() * bound;
                    }
                }
            }
            for i in 0..n {
                all[i] = all[i].hypot(each[i]);
                swing[i] = swing[i].hypot(swinging[i]);
            }
        }
        let most = |values: Vec<f64>| values.into_iter().fold(0.0, f64::max);
        (most(all), most(swing))
    }

    /// Bound on the distance of any computed position in [0, t] from the exact one, m.
    ///
    /// 16 eps (1 + w t) times the scene's size or the distance travelled, where that is larger. The
    /// 1 covers each sum; w t covers the phase, which a rounded frequency moves at eps of the
    /// fastest w. Phase counts for what swings, and as long as it does: damped modes forget it.
    pub fn error_bar(&self, t: f64) -> f64 {
        let (all, swing) = self.reach(t);
        let modes = || self.modes.modes.iter();
        let slowest = modes().map(|m| m.fastest()).fold(f64::INFINITY, f64::min);
        let fastest = modes().map(|m| m.w).fold(0.0, f64::max);
        let swinging = modes().filter(|m| m.w > 0.0);
        let phase = swinging
            .map(|m| t.min(1.0 / m.g.min(m.w)))
            .fold(0.0, f64::max);
        let starts = self.axes.iter().flat_map(|axis| {
            let starts = modes().zip(&axis.starts);
            starts.zip(&axis.forcings)
        });
        let speeds = starts.map(|((mode, start), forcing)| {
            mode.speed_bound(*start, t) + forcing.bounds(mode, t)[1]
        });
        let speed = speeds.fold(0.0, f64::hypot);
        // Damping left between the modes pushes like leak times speed.
        let pushed =
            self.modes.leak * speed / self.modes.lightest.sqrt() * t * t.min(1.0 / slowest);
        // The rounding of stiff springs under tension may push a slow mode farther than it swings;
        // one mode alone stays within its swing.
        let swinging = if self.particles.len() == 1 {
            swing
        } else {
            self.size.max(swing)
        };
        let rate = 16.0 * f64::EPSILON * fastest + self.modes.spread;
        let sideways = self.sideways.as_ref().map_or(0.0, |s| s.bound(t));
        // A drive goes on however damped the modes are.
        let forcings = self.axes.iter().flat_map(|axis| &axis.forcings);
        let drive = forcings.map(Forcing::fastest).fold(0.0, f64::max);
        16.0 * f64::EPSILON * (self.size.max(all) + drive * t * swing)
            + rate * phase * swinging
            + pushed
            + sideways
    }
}

/// The motions of a link's driven ends, as they change its length.
fn ends(link: &Link, direction: Vector3<f64>, sign: f64) -> Vec<(f64, End)> {
    let drives = link.drives.iter().zip([-sign, sign]);
    drives
        .filter_map(|(drive, sign)| Some((sign, End::new(drive.as_ref()?, direction)?)))
        .collect()
}

impl Axis {
    /// The modes' start along `direction`. `tension` is the force on a spring's first end there, N.
    fn new(
        group: &Group,
        modes: &Modes,
        direction: Vector3<f64>,
        tension: impl Fn(&Link) -> f64,
    ) -> Option<Self> {
        let along = |of: fn(&Body) -> Vector3<f64>| -> Vec<f64> {
            let bodies = group.bodies.iter();
            bodies.map(|b| b.mass * of(b).dot(&direction)).collect()
        };
        let velocities = modes.of_forces(&along(|b| b.velocity));
        let mut pulls = modes.of_forces(&along(|b| b.constant));
        for link in &group.links {
            let force = tension(link);
            for (pull, stretch) in pulls.iter_mut().zip(modes.stretches(link)) {
                // Both ends are taken at once: on a mode that hardly stretches the spring they cancel here.
                *pull -= force * stretch;
            }
        }
        let forcings = forcing(group, &modes.modes, |link| modes.stretches(link), direction)?;
        for (pull, forcing) in pulls.iter_mut().zip(&forcings) {
            *pull += forcing.constant;
        }
        let starts = velocities.into_iter().zip(pulls);
        Some(Self {
            direction,
            starts: starts
                .map(|(velocity, pull)| Start { velocity, pull })
                .collect(),
            forcings,
        })
    }
}

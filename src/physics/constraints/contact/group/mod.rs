//! Particles that stay in contact with each other, or that rods join while something stays in contact: one set of
//! coordinates for all, of which those along contacts and rods are given.
//!
//! Coordinates are scaled by the roots of the masses, so that axes at right angles leave the kinetic energy a sum of
//! squares. Contacts are planes while a step lasts: what turns with the surfaces is moved back onto them after it along the
//! directions from before, positions and velocities alike, as RATTLE does (Andersen 1983). So the motion is of second
//! order.

mod links;
mod pressing;
mod sets;

pub(super) use sets::grouped;
pub use sets::{MOST, TooManyTouch};

use super::member::{Contact, unit};
use super::{Against, Beside, Obstacles};
use crate::physics::State;
use crate::physics::constraints::Rods;
use crate::space::{dot, minus, norm, three};
use links::{DEPENDENT, Kept, Link, Row, Rows, Rubs, inverse, plain, pressed, rod_now};
use nalgebra::{DMatrix, DVector};
use pressing::pressing;

/// What is left of a sliding velocity, in parts of what it was, where a contact has stopped.
const TURNED: f64 = 1e-3;
/// Newton's steps onto surfaces and rods.
const ITERATIONS: usize = 50;

/// Particles whose motions depend on each other through contacts and rods.
pub(super) struct Group {
    /// Ascending.
    particles: Vec<usize>,
    /// The root of each one's mass over that of the first.
    scales: Vec<f64>,
    /// The mass of the first, kg.
    mass: f64,
    links: Vec<Link>,
    rows: Rows,
    /// Rows at right angles, the given ones first.
    axes: DMatrix<f64>,
    /// The number of given coordinates.
    given: usize,
    /// The rows that gave an axis each, and what they are made of: lower triangular.
    independent: Vec<usize>,
    lower: DMatrix<f64>,
    /// The given coordinates at the beginning.
    start: DVector<f64>,
}

impl Group {
    /// The particles that stay in contact among those that contacts and rods join: `resting` has their contacts. `a` are the
    /// accelerations of all without contacts and rods, m/s².
    pub fn new(
        obstacles: &Obstacles,
        rods: Option<&Rods>,
        particles: Vec<usize>,
        resting: &[Beside],
        state: &State,
        a: &[f64],
    ) -> Self {
        let weight = |particle: &usize| obstacles.weights[*particle];
        let mass = 1.0 / weight(&particles[0]);
        let scales: Vec<f64> = particles
            .iter()
            .map(|particle| (1.0 / (mass * weight(particle))).sqrt())
            .collect();
        let place = |particle: usize| particles.binary_search(&particle).ok();
        let mut links = Vec::new();
        for beside in resting {
            let contact = Contact::new(obstacles, *beside);
            let other = match beside.against {
                Against::Particle(other) => place(other),
                Against::Obstacle(_) => None,
            };
            let sliding = beside.sliding();
            let rubs = match unit(sliding).filter(|_| norm(sliding) > beside.slow) {
                Some(forward) if contact.friction[0] > 0.0 => Rubs::Slides(forward),
                None if contact.friction[1] > 0.0 => Rubs::Sticks,
                _ => Rubs::Not,
            };
            links.push(Link {
                ends: [place(beside.particle), other],
                normal: beside.normal,
                turning: contact.turning,
                kept: Kept::Contact(contact, rubs),
            });
        }
        let all = rods.map_or(0, Rods::len);
        for rod in 0..all {
            let ends = rods.map_or([0; 2], |rods| rods.ends()[rod]).map(place);
            if ends.iter().any(Option::is_some) {
                links.extend(rods.and_then(|rods| rod_now(rods, rod, ends, state)));
            }
        }
        let scaled = DVector::from_iterator(
            3 * particles.len(),
            particles
                .iter()
                .zip(&scales)
                .flat_map(|(particle, scale)| three(a, *particle).map(|c| scale * c)),
        );
        let (links, rows) = pressing(obstacles, links, &scales, state.t, &scaled);
        let mut group = Self {
            axes: DMatrix::zeros(0, 0),
            given: 0,
            independent: Vec::new(),
            lower: DMatrix::zeros(0, 0),
            start: DVector::zeros(0),
            particles,
            scales,
            mass,
            links,
            rows,
        };
        group.orient();
        group.start = &group.axes * group.gather(&state.x);
        group
    }

    /// The contacts that press.
    pub fn contacts(&self) -> impl Iterator<Item = &Beside> {
        self.links.iter().filter_map(|link| match &link.kept {
            Kept::Contact(contact, _) => Some(&contact.beside),
            Kept::Rod(_) => None,
        })
    }

    pub fn has_rods(&self) -> bool {
        self.links
            .iter()
            .any(|link| matches!(link.kept, Kept::Rod(_)))
    }

    pub fn particles(&self) -> &[usize] {
        &self.particles
    }

    /// The mass of all own coordinates, kg.
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// Axes from the rows, by Gram and Schmidt's method, and more until there are enough.
    fn orient(&mut self) {
        let size = 3 * self.particles.len();
        let mut axes: Vec<DVector<f64>> = Vec::new();
        let mut made: Vec<Vec<f64>> = Vec::new();
        for row in 0..self.rows.of.len() {
            let own = self.rows.kept.row(row).transpose();
            let (left, parts) = across(&axes, &own);
            let length = left.norm();
            if length > DEPENDENT * own.norm() && axes.len() < size {
                axes.push(left / length);
                made.push(parts.into_iter().chain([length]).collect());
                self.independent.push(row);
            }
        }
        self.given = axes.len();
        self.lower = DMatrix::from_fn(self.given, self.given, |row, column| {
            made[row].get(column).copied().unwrap_or(0.0)
        });
        for at in 0..size {
            let mut own = DVector::zeros(size);
            own[at] = 1.0;
            let (left, _) = across(&axes, &own);
            let length = left.norm();
            // The largest of those left is at least 1/√size.
            if axes.len() < size && length > 1e-3 {
                axes.push(left / length);
            }
        }
        self.axes = DMatrix::from_fn(size, size, |row, column| {
            axes.get(row).map_or(0.0, |axis| axis[column])
        });
    }

    /// A vector of all particles, scaled, of those of the group.
    fn gather(&self, all: &[f64]) -> DVector<f64> {
        let each = self.particles.iter().zip(&self.scales);
        let own = each.flat_map(|(particle, scale)| three(all, *particle).map(|c| scale * c));
        DVector::from_iterator(3 * self.particles.len(), own)
    }

    fn scatter(&self, own: &DVector<f64>, all: &mut [f64], by: impl Fn(f64) -> f64) {
        for (at, (particle, scale)) in self.particles.iter().zip(&self.scales).enumerate() {
            for axis in 0..3 {
                all[3 * particle + axis] = own[3 * at + axis] * by(*scale);
            }
        }
    }

    /// Into its own coordinates.
    pub fn turn(&self, all: &mut [f64]) {
        let own = &self.axes * self.gather(all);
        self.scatter(&own, all, |_| 1.0);
    }

    /// Back into the axes of space.
    pub fn turn_back(&self, all: &mut [f64]) {
        let out = self.axes.tr_mul(&self.taken(all));
        self.scatter(&out, all, |scale| 1.0 / scale);
    }

    /// Its own coordinates as they are.
    fn taken(&self, all: &[f64]) -> DVector<f64> {
        let own = self
            .particles
            .iter()
            .flat_map(|particle| three(all, *particle));
        DVector::from_iterator(3 * self.particles.len(), own)
    }

    /// Places of its given coordinates among all.
    pub fn given(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.given).map(|at| 3 * self.particles[at / 3] + at % 3)
    }

    /// Given coordinates, and their velocities, at a time.
    pub fn placed(&self, obstacles: &Obstacles, since: f64, t: f64) -> [DVector<f64>; 2] {
        let start = self.start.rows(0, self.given).into_owned();
        if !obstacles.any_moves() {
            return [start, DVector::zeros(self.given)];
        }
        let moved = |which: usize| {
            let each = self.independent.iter().map(|row| {
                let Row {
                    link, direction, ..
                } = self.rows.of[*row];
                let Kept::Contact(contact, _) = self.links[link].kept else {
                    return 0.0;
                };
                let against = contact.beside.against;
                let now = obstacles.moved(against, t)[which];
                let before = obstacles.moved(against, since)[0];
                dot(direction, if which == 0 { minus(now, before) } else { now })
            });
            let right = DVector::from_iterator(self.given, each);
            let solved = self.lower.solve_lower_triangular(&right);
            solved.unwrap_or_else(|| DVector::zeros(self.given))
        };
        [start + moved(0), moved(1)]
    }

    /// Adds friction to an acceleration in its own coordinates, and sets given ones to 0; `whole`: with what moving
    /// obstacles and turning add, else only what is linear in the acceleration.
    pub fn constrain(&self, obstacles: &Obstacles, t: f64, a: &mut [f64], whole: bool) {
        let mut own = self.taken(a);
        let out = self.axes.tr_mul(&own);
        let multipliers = if whole {
            self.rows.multipliers(obstacles, &self.links, t, &out)
        } else {
            -(&self.rows.inverse * (&self.rows.kept * &out))
        };
        own += &self.axes * self.rows.rubs.tr_mul(&multipliers);
        own.rows_mut(0, self.given).fill(0.0);
        self.scatter(&own, a, |_| 1.0);
    }

    /// The coordinates of its own that a coordinate of all goes into, each with its factor; `exact`: with friction.
    pub fn rows(&self, row: usize, exact: bool) -> Vec<(usize, f64)> {
        let Ok(at) = self.particles.binary_search(&(row / 3)) else {
            return Vec::new();
        };
        let mut unit = DVector::zeros(3 * self.particles.len());
        unit[3 * at + row % 3] = 1.0 / self.scales[at];
        if exact {
            let multipliers = -(&self.rows.inverse * (&self.rows.kept * &unit));
            unit += self.rows.rubs.tr_mul(&multipliers);
        }
        self.numbered(&(&self.axes * unit))
    }

    pub fn columns(&self, column: usize) -> Vec<(usize, f64)> {
        self.rows(column, false)
    }

    fn numbered(&self, own: &DVector<f64>) -> Vec<(usize, f64)> {
        let each = own.iter().enumerate();
        each.map(|(at, value)| (3 * self.particles[at / 3] + at % 3, *value))
            .collect()
    }

    /// The links at another state.
    fn now(&self, obstacles: &Obstacles, rods: Option<&Rods>, state: &State) -> Vec<Link> {
        let each = self.links.iter().map(|link| match link.kept {
            Kept::Contact(contact, rubs) => {
                let contact = contact.now(obstacles, state);
                Link {
                    normal: contact.beside.normal,
                    turning: contact.turning,
                    kept: Kept::Contact(contact, rubs),
                    ..*link
                }
            }
            Kept::Rod(rod) => rods
                .and_then(|rods| rod_now(rods, rod, link.ends, state))
                .unwrap_or(*link),
        });
        each.collect()
    }

    /// The links at a state with these accelerations without them, their rows and multipliers.
    fn forces(
        &self,
        obstacles: &Obstacles,
        rods: Option<&Rods>,
        state: &State,
        a: &[f64],
    ) -> (Vec<Link>, Rows, DVector<f64>) {
        let links = self.now(obstacles, rods, state);
        let mut rows = Rows::new(&links, &self.scales);
        rows.about.copy_from(&self.rows.about);
        let multipliers = rows.multipliers(obstacles, &links, state.t, &self.gather(a));
        (links, rows, multipliers)
    }

    /// What has changed at a state in the axes of space, by how much, as
    /// [`Held::changes`](super::Held::changes).
    pub fn changes(
        &self,
        obstacles: &Obstacles,
        rods: Option<&Rods>,
        state: &State,
        a: &[f64],
    ) -> Vec<(usize, super::Change, f64)> {
        let (links, rows, multipliers) = self.forces(obstacles, rods, state, a);
        let mut found = Vec::new();
        for (at, link) in links.iter().enumerate() {
            let Kept::Contact(contact, rubs) = link.kept else {
                continue;
            };
            let (pressed, across) = pressed(&rows, &multipliers, at);
            let particle = contact.beside.particle;
            found.push((particle, super::Change::Leaves, -pressed));
            match rubs {
                Rubs::Not => {}
                Rubs::Slides(forward) => {
                    let along = dot(forward, contact.beside.sliding());
                    found.push((particle, super::Change::Stops, -along));
                }
                Rubs::Sticks => {
                    let most = contact.friction[1] * pressed.max(0.0);
                    found.push((particle, super::Change::Slips, across - most));
                }
            }
        }
        found
    }

    /// Takes the sliding velocity away where a contact of this particle has come to rest, and what that moves in other
    /// contacts and rods.
    pub fn stop(
        &self,
        obstacles: &Obstacles,
        rods: Option<&Rods>,
        particle: usize,
        state: &mut State,
    ) {
        let mut stops = false;
        let mut links = self.now(obstacles, rods, state);
        for (link, before) in links.iter_mut().zip(&self.links) {
            let (Kept::Contact(now, rubs), Kept::Contact(begun, _)) = (&mut link.kept, before.kept)
            else {
                continue;
            };
            let Rubs::Slides(forward) = *rubs else {
                continue;
            };
            let sliding = now.beside.sliding();
            // What has turned meanwhile slides on, aside.
            let aside = norm(sliding) > now.beside.slow + TURNED * norm(begun.beside.sliding());
            let own = now.beside.particle == particle;
            if own && !aside && dot(forward, sliding) <= now.beside.slow {
                (*rubs, stops) = (Rubs::Sticks, true);
            } else {
                *rubs = Rubs::Not;
            }
        }
        if stops {
            self.follow(obstacles, &links, state);
        }
    }

    /// The power lost to friction, and that of the obstacles' motions, W.
    pub fn powers(
        &self,
        obstacles: &Obstacles,
        rods: Option<&Rods>,
        state: &State,
        a: &[f64],
    ) -> [f64; 2] {
        let (links, rows, multipliers) = self.forces(obstacles, rods, state, a);
        let mut sums = [0.0; 2];
        for (row, multiplier) in rows.of.iter().zip(&multipliers) {
            let Kept::Contact(contact, rubs) = links[row.link].kept else {
                continue;
            };
            let along = obstacles.moved(contact.beside.against, state.t)[1];
            let force = self.mass * multiplier;
            sums[1] += force * dot(row.direction, along);
            if let Rubs::Slides(forward) = rubs {
                let rubbed = contact.friction[0] * force;
                sums[0] += rubbed * dot(forward, contact.beside.sliding());
                sums[1] -= rubbed * dot(forward, along);
            }
        }
        sums
    }

    /// Moves a state back onto surfaces and rods along the directions from before, `h` seconds ago, and its velocities
    /// along them. `begins` are the accelerations then without contacts and rods, m/s²: half a step of what these held back
    /// belongs to the directions of now, as in RATTLE.
    pub fn project(
        &self,
        obstacles: &Obstacles,
        rods: Option<&Rods>,
        (h, begins): (f64, &[f64]),
        state: &mut State,
    ) {
        let normals: Vec<usize> = (0..self.rows.of.len())
            .filter(|row| self.rows.of[*row].normal)
            .collect();
        if normals.is_empty() {
            return;
        }
        let old = self.rows.kept.select_rows(&normals);
        let mut moved = DVector::zeros(old.ncols());
        for _ in 0..ITERATIONS {
            let links = self.now(obstacles, rods, state);
            let off = DVector::from_iterator(
                links.len(),
                links.iter().map(|link| self.off(rods, link, state)),
            );
            let close = obstacles.close([off.amax(), 0.0, 0.0]);
            if off.amax() <= close {
                break;
            }
            let now = Rows::new(&plain(&links), &self.scales);
            let step = -old.tr_mul(&(inverse(&now.kept * old.transpose()) * off));
            self.add(&step, 1.0, &mut state.x);
            moved += step;
        }
        if h > 0.0 {
            self.add(&moved, 1.0 / h, &mut state.v);
            let given = self.axes.rows(0, self.given);
            let held = given.tr_mul(&(given * self.gather(begins)));
            self.add(&held, 0.5 * h, &mut state.v);
        }
        let links = plain(&self.now(obstacles, rods, state));
        self.follow(obstacles, &links, state);
    }

    /// Takes the velocities away that links do not leave.
    fn follow(&self, obstacles: &Obstacles, links: &[Link], state: &mut State) {
        let rows = Rows::new(links, &self.scales);
        let each = rows.of.iter().map(|row| match links[row.link].kept {
            Kept::Contact(contact, _) => {
                let against = contact.beside.against;
                dot(row.direction, obstacles.moved(against, state.t)[1])
            }
            Kept::Rod(_) => 0.0,
        });
        let along = DVector::from_iterator(rows.of.len(), each);
        let parting = along - &rows.kept * self.gather(&state.v);
        let change = rows.kept.tr_mul(&(&rows.inverse * parting));
        self.add(&change, 1.0, &mut state.v);
    }

    fn add(&self, own: &DVector<f64>, by: f64, all: &mut [f64]) {
        for (at, (particle, scale)) in self.particles.iter().zip(&self.scales).enumerate() {
            for axis in 0..3 {
                all[3 * particle + axis] += by * own[3 * at + axis] / scale;
            }
        }
    }

    /// How far a link is off, m.
    fn off(&self, rods: Option<&Rods>, link: &Link, state: &State) -> f64 {
        match (link.kept, rods) {
            (Kept::Contact(contact, _), _) => contact.beside.gap,
            (Kept::Rod(rod), Some(rods)) => {
                let [i, j] = rods.ends()[rod];
                norm(minus(three(&state.x, i), three(&state.x, j))) - rods.lengths()[rod]
            }
            (Kept::Rod(_), None) => 0.0,
        }
    }
}

/// What is left of a vector across axes at right angles, and its parts along them.
fn across(axes: &[DVector<f64>], own: &DVector<f64>) -> (DVector<f64>, Vec<f64>) {
    let mut left = own.clone();
    let mut parts = vec![0.0; axes.len()];
    // Twice is enough (Kahan; Parlett, The Symmetric Eigenvalue Problem, 6.9).
    for _ in 0..2 {
        for (axis, part) in axes.iter().zip(&mut parts) {
            let along = axis.dot(&left);
            left -= along * axis;
            *part += along;
        }
    }
    (left, parts)
}

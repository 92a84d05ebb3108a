//! What objects make of a scene: particles, springs, hinges and triangles.
//!
//! [`expand`] adds them behind the members that are written out, in the order of the file.
//! What comes after sees plain members alone; [`Body`] keeps their names.

mod grid;
mod line;

use super::error::Refusal;
use super::limits::{self, Bounds};
use super::model::{Particle, Rod, Scene, Spring};
use super::object::{self, Body, Link, Links, Object, Options, Pin, Scaling};
use super::place::Problem;
use super::values::Number;

/// The most particles that objects make.
pub const PARTICLES: u64 = 4_000_000;
/// The longest name of an object, in characters.
const NAME_CHARS: usize = 64;

impl Scene {
    /// The name of a particle that an object made, such as `sheet[3,4]`.
    pub fn particle_name(&self, id: usize) -> Option<String> {
        object::particle_name(&self.bodies, id)
    }

    /// The id of a particle by its [name](Self::particle_name).
    ///
    /// # Errors
    /// [`Refusal`] where there is no such object, or it ends before.
    pub fn particle_named(&self, name: &str) -> Result<usize, Refusal> {
        let parts = name
            .trim()
            .strip_suffix(']')
            .and_then(|text| text.split_once('['));
        let Some((object, place)) = parts else {
            let message = format!(
                "expected a particle, found the text `{}`",
                super::words::shorten(name)
            );
            return Refusal::because(message, "an id such as 3, or a name such as \"sheet[3,4]\"");
        };
        let known: Vec<&str> = self.bodies.iter().map(|body| body.name.as_str()).collect();
        let Some(body) = self.bodies.iter().find(|body| body.name == object.trim()) else {
            let help = super::words::did_you_mean(object, &known)
                .unwrap_or_else(|| format!("the objects here are {}", list(&known)));
            let object = super::words::shorten(object);
            return Refusal::because(format!("no object has the name `{object}`"), help);
        };
        let place: Option<Vec<usize>> = place.split(',').map(|at| at.trim().parse().ok()).collect();
        place.and_then(|place| body.id(&place)).ok_or_else(|| {
            let name = super::words::shorten(name);
            Refusal::new(
                format!("expected one of {}, found `{name}`", body.range()),
                "places count from 0",
            )
        })
    }

    /// Adds what [`objects`](Self::objects) make to the scene, and leaves none.
    ///
    /// # Errors
    /// [`Refusal`] with the key of what cannot be made.
    pub fn expand(&mut self) -> Result<(), Refusal> {
        expand(self).map(|_| ()).map_err(Problem::refusal)
    }
}

fn list(names: &[&str]) -> String {
    match names {
        [] => "none".to_owned(),
        names => names.join(", "),
    }
}

/// See [`Scene::expand`].
///
/// Returns the path of each object that made rods, and where its first is in the list of all.
pub(super) fn expand(scene: &mut Scene) -> Result<Vec<(usize, String)>, Problem> {
    let mut with_rods = Vec::new();
    for (at, object) in std::mem::take(&mut scene.objects).into_iter().enumerate() {
        let path = format!("objects[{at}]");
        let Object {
            string,
            chain,
            hair,
            cloth,
            net,
            lattice,
        } = object;
        let kinds: [(&str, Option<Box<dyn Generator>>); 6] = [
            ("string", string.map(boxed)),
            ("chain", chain.map(boxed)),
            ("hair", hair.map(boxed)),
            ("cloth", cloth.map(boxed)),
            ("net", net.map(boxed)),
            ("lattice", lattice.map(boxed)),
        ];
        let words = kinds
            .iter()
            .map(|(word, _)| *word)
            .collect::<Vec<_>>()
            .join(", ");
        let mut given = kinds
            .into_iter()
            .filter_map(|(word, kind)| Some((word, kind?)));
        let (Some((word, kind)), None) = (given.next(), given.next()) else {
            let message = format!("expected one of {words}");
            return Problem::because(
                path,
                message,
                "such as `- string: {from: [0, 0, 1], to: [1, 0, 1], particles: 20, mass: 1, stiffness: 100}`",
            );
        };
        let path = format!("{path}.{word}");
        let options = kind.options();
        let name = options.name.clone().unwrap_or_else(|| word.to_owned());
        let key = match options.name {
            Some(_) => format!("{path}.name"),
            None => path.clone(),
        };
        named(&name, scene).map_err(|refusal| Problem::new(key, refusal))?;
        let first = scene.rods.len();
        let mut maker = Maker { scene, path, name };
        kind.make(&mut maker)?;
        let Maker { scene, path, .. } = maker;
        if scene.rods.len() > first {
            with_rods.push((first, path));
        }
    }
    Ok(with_rods)
}

fn boxed<'a>(kind: impl Generator + 'a) -> Box<dyn Generator + 'a> {
    Box::new(kind)
}

/// Checks an object's name.
fn named(name: &str, scene: &Scene) -> Result<(), Refusal> {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let starts = name.starts_with(|c: char| c.is_ascii_alphabetic());
    if !starts || !name.chars().all(plain) || name.len() > NAME_CHARS {
        let found = super::words::shorten(name);
        let message = format!(
            "expected a name of letters, digits, `_` and `-` that begins with a letter, found `{found}`"
        );
        return Refusal::because(
            message,
            "brackets and numbers name the particles of an object: `sheet[3,4]`",
        );
    }
    if scene.bodies.iter().any(|body| body.name == name) {
        let message = format!("two objects have the name `{name}`");
        return Refusal::because(message, "give each a name of its own: `name: ...`");
    }
    Ok(())
}

/// A kind of object.
trait Generator {
    fn options(&self) -> Options;

    /// Adds its members to the scene.
    fn make(&self, maker: &mut Maker) -> Result<(), Problem>;
}

/// The scene that an object is added to.
struct Maker<'s> {
    scene: &'s mut Scene,
    /// `objects[2].cloth`
    path: String,
    name: String,
}

/// The directions of an object: links and vectors along each, and its first particle.
struct Frame {
    origin: [f64; 3],
    /// From the first particle to the last along each direction, m.
    edges: Vec<[f64; 3]>,
    /// Links along each direction, once refined.
    links: Vec<u64>,
    /// How many links each link of the file became.
    refine: u64,
}

impl Frame {
    /// How many particles it has along each direction.
    fn shape(&self) -> Vec<usize> {
        self.links.iter().map(|links| *links as usize + 1).collect()
    }

    fn position(&self, place: &[usize]) -> [f64; 3] {
        let mut position = self.origin;
        for ((edge, links), at) in self.edges.iter().zip(&self.links).zip(place) {
            let part = *at as f64 / *links as f64;
            for (x, edge) in position.iter_mut().zip(edge) {
                *x += part * edge;
            }
        }
        position
    }
}

/// Visits every place of such a shape, the last direction fastest.
fn each_place(shape: &[usize], mut visit: impl FnMut(&[usize])) {
    let mut place = vec![0; shape.len()];
    for _ in 0..shape.iter().product() {
        visit(&place);
        for (at, count) in place.iter_mut().zip(shape).rev() {
            *at += 1;
            if *at < *count {
                break;
            }
            *at = 0;
        }
    }
}

impl Maker<'_> {
    fn problem<T>(&self, key: &str, message: impl Into<String>, help: &str) -> Result<T, Problem> {
        Problem::because(format!("{}.{key}", self.path), message, help)
    }

    /// A number of the file, or what scaling makes of it, within its bounds.
    fn judge(&self, key: &str, x: f64, bounds: Bounds) -> Result<f64, Problem> {
        let of = |refusal| Problem::new(format!("{}.{key}", self.path), refusal);
        bounds.judge(Number::Real(x)).map_err(of)
    }

    fn point(&self, key: &str, point: [f64; 3]) -> Result<[f64; 3], Problem> {
        for x in point {
            self.judge(key, x, limits::POSITION)?;
        }
        Ok(point)
    }

    /// The frame of an object of so many particles along each edge.
    fn frame(
        &self,
        options: &Options,
        origin: [f64; 3],
        edges: Vec<[f64; 3]>,
        particles: &[u64],
    ) -> Result<Frame, Problem> {
        if let Some(count) = particles.iter().find(|count| **count < 2) {
            let message =
                format!("expected two particles or more along each direction, found {count}");
            return self.problem(
                "particles",
                message,
                "a single particle stands under `particles` of the scene",
            );
        }
        let refine = options.refine.unwrap_or(1);
        if refine == 0 {
            return self.problem(
                "refine",
                "expected 1 or more, found 0",
                "1 leaves the object as it is, 2 makes two links of each",
            );
        }
        let links = particles
            .iter()
            .map(|count| (count - 1).checked_mul(refine));
        let links: Option<Vec<u64>> = links.collect();
        let count = |links: &Vec<u64>| {
            links
                .iter()
                .try_fold(1_u64, |all, links| all.checked_mul(links.checked_add(1)?))
        };
        let fits = links
            .as_ref()
            .and_then(count)
            .is_some_and(|count| count <= PARTICLES);
        let Some(links) = links.filter(|_| fits) else {
            let key = if refine > 1 { "refine" } else { "particles" };
            return self.problem(
                key,
                format!("expected at most {PARTICLES} particles in an object"),
                "",
            );
        };
        Ok(Frame {
            origin,
            edges,
            links,
            refine,
        })
    }

    /// Adds the particles of a frame, those of these places fixed. Returns the body.
    fn particles(
        &mut self,
        options: &Options,
        frame: &Frame,
        pins: &[Pinned],
    ) -> Result<Body, Problem> {
        let directions = frame.links.len() as i32;
        let refined = (frame.refine as f64).powi(directions);
        let scaled = if options.scaling == Scaling::Continuum {
            refined
        } else {
            1.0
        };
        let mass = Bounds::from(1e-40, 1e30, "kg");
        let (inner, lumped) = match (options.mass, options.particle_mass) {
            (Some(total), None) => {
                self.judge("mass", total, mass)?;
                let links: f64 = frame.links.iter().map(|links| *links as f64).product();
                (total * refined / (links * scaled), true)
            }
            (None, Some(each)) => (self.judge("particle_mass", each, mass)? / scaled, false),
            (given, _) => {
                let found = if given.is_some() { "both" } else { "none" };
                let message = format!("expected one of `mass` and `particle_mass`, found {found}");
                return Problem::because(
                    self.path.clone(),
                    message,
                    "`mass` is that of the whole object, kg, half as dense at its ends",
                );
            }
        };
        let key = if lumped { "mass" } else { "particle_mass" };
        let radius = options.radius.unwrap_or(Particle::default().radius);
        self.judge("radius", radius, Bounds::not_negative(1e12, "m"))?;
        let drag = options.drag.unwrap_or(0.0) / scaled;
        self.judge("drag", drag, Bounds::not_negative(1e18, "N s/m"))?;
        let velocity = options.velocity.unwrap_or_default();
        for x in velocity {
            self.judge("vel", x, Bounds::signed(1e12, "m/s"))?;
        }
        let body = Body {
            name: self.name.clone(),
            first: self.scene.particles.len(),
            shape: frame.shape(),
        };
        // The lightest, at a corner.
        let least = if lumped {
            0.5_f64.powi(directions)
        } else {
            1.0
        };
        self.judge(key, inner, mass)?;
        self.judge(key, inner * least, mass)?;
        let particles = &mut self.scene.particles;
        each_place(&body.shape, |place| {
            let ends = place.iter().zip(&frame.links);
            let ends = ends.filter(|(at, links)| **at == 0 || **at as u64 == **links);
            let part = if lumped {
                0.5_f64.powi(ends.count() as i32)
            } else {
                1.0
            };
            let fixed = pins.iter().any(|pin| pin.holds(place, &frame.links));
            particles.push(Particle {
                position: frame.position(place),
                velocity: if fixed { [0.0; 3] } else { velocity },
                fixed,
                mass: inner * part,
                radius,
                drag: drag * part,
                ..Particle::default()
            });
        });
        self.scene.bodies.push(body.clone());
        Ok(body)
    }

    /// Joins two particles by a spring, at rest at this part of their distance, or by a rod, unless nothing could move
    /// there.
    fn join(&mut self, ends: [usize; 2], links: Links, rest_ratio: f64) {
        let Links::Springs(link) = links else {
            if !ends.iter().all(|end| self.scene.particles[*end].fixed) {
                // The length is taken from the start.
                self.scene.rods.push(Rod {
                    ends,
                    length: f64::NAN,
                });
            }
            return;
        };
        let [from, to] = ends.map(|end| self.scene.particles[end].position);
        let apart = from
            .iter()
            .zip(to)
            .fold(0.0_f64, |length, (a, b)| length.hypot(b - a));
        self.scene.springs.push(Spring {
            ends,
            stiffness: link.stiffness,
            damping: link.damping,
            rest_length: rest_ratio * apart,
            ..Spring::default()
        });
    }

    /// A link of the file with its numbers scaled and within their bounds.
    fn link(&self, key: &str, link: Link, scale: f64) -> Result<Link, Problem> {
        let within = |inner: &str, x: f64, bounds| {
            let key = if key.is_empty() {
                inner.to_owned()
            } else {
                format!("{key}.{inner}")
            };
            self.judge(&key, x, bounds)?;
            self.judge(&key, x * scale, bounds)
        };
        Ok(Link {
            stiffness: within("stiffness", link.stiffness, limits::STIFFNESS)?,
            damping: within("damping", link.damping, Bounds::not_negative(1e18, "N s/m"))?,
        })
    }

    /// The same, of what may also be rods.
    fn links(&self, key: &str, links: Links, scale: f64) -> Result<Links, Problem> {
        match links {
            Links::Springs(link) => self.link(key, link, scale).map(Links::Springs),
            Links::Rods => Ok(links),
        }
    }

    /// The ratio of rest lengths of these links: rods have none but 1.
    fn rest_ratio(&self, ratio: Option<f64>, links: Links) -> Result<f64, Problem> {
        if let (Some(_), Links::Rods) = (ratio, links) {
            let message =
                "expected no `rest_ratio` beside rods: they have the lengths of the start";
            return self.problem(
                "rest_ratio",
                message,
                "remove it, or give springs: `{stiffness: 1000}`",
            );
        }
        self.judge("rest_ratio", ratio.unwrap_or(1.0), limits::REST_RATIO)
    }

    /// What the pins of an object hold, by these words and by places of the file.
    fn pins(
        &self,
        options: &Options,
        frame: &Frame,
        words: &[(&str, Pinned)],
    ) -> Result<Vec<Pinned>, Problem> {
        let mut pinned = Vec::new();
        for (at, pin) in options.pins.iter().enumerate() {
            let key = format!("pins[{at}]");
            pinned.push(match pin {
                Pin::Word(word) => match words.iter().find(|(known, _)| known == word) {
                    Some((_, pin)) => pin.clone(),
                    None => {
                        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
                        let found = super::words::shorten(word);
                        let help = super::words::did_you_mean(word, &known).unwrap_or_default();
                        let message = format!(
                            "expected a place or one of {}, found `{found}`",
                            known.join(", ")
                        );
                        return self.problem(&key, message, &help);
                    }
                },
                Pin::Place(place) => {
                    let given = frame.links.iter().map(|links| links / frame.refine);
                    let fits = place.len() == frame.links.len()
                        && place
                            .iter()
                            .zip(given.clone())
                            .all(|(at, links)| *at <= links);
                    if !fits {
                        let ranges: Vec<String> =
                            given.map(|links| format!("0..{links}")).collect();
                        let message = format!(
                            "expected a place in [{}], found {place:?}",
                            ranges.join(", ")
                        );
                        return self.problem(
                            &key,
                            message,
                            "places count the particles of the file, before `refine`",
                        );
                    }
                    Pinned(
                        place
                            .iter()
                            .map(|at| Some(Along::At(at * frame.refine)))
                            .collect(),
                    )
                }
            });
        }
        Ok(pinned)
    }
}

/// Fixed places: along each direction one, an end, or (None) all.
#[derive(Debug, Clone, PartialEq)]
struct Pinned(Vec<Option<Along>>);

#[derive(Debug, Clone, Copy, PartialEq)]
enum Along {
    At(u64),
    Last,
}

impl Pinned {
    fn holds(&self, place: &[usize], links: &[u64]) -> bool {
        let along = self.0.iter().zip(place).zip(links);
        along.into_iter().all(|((pin, at), links)| match pin {
            None => true,
            Some(Along::At(there)) => *at as u64 == *there,
            Some(Along::Last) => *at as u64 == *links,
        })
    }
}

/// A length of 0 has no direction.
fn length([x, y, z]: [f64; 3]) -> f64 {
    x.hypot(y).hypot(z)
}

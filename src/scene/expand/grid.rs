//! Particles in rows and columns: cloth, nets, and blocks of them.

use super::{Along, Frame, Generator, Maker, Pinned, each_place, length};
use crate::scene::limits::Bounds;
use crate::scene::model::Triangle;
use crate::scene::object::{Body, Cloth, Lattice, Links, Net, Options, Pin, Scaling};
use crate::scene::place::Problem;
use nalgebra::Vector3;

/// The two edges of a sheet.
fn sides(
    maker: &Maker,
    edges: [Option<[f64; 3]>; 2],
    plane: Option<&str>,
    size: Option<[f64; 2]>,
) -> Result<Vec<[f64; 3]>, Problem> {
    let (axes, [width, height]) = match (edges, plane, size) {
        ([Some(u), Some(v)], None, None) => {
            let (u, v) = (maker.point("u", u)?, maker.point("v", v)?);
            let [a, b] = [u, v].map(Vector3::from);
            if a.cross(&b).norm() <= 1e-12 * a.norm() * b.norm() {
                return maker.problem(
                    "v",
                    "expected two directions, found `u` and `v` along one line",
                    "",
                );
            }
            return Ok(vec![u, v]);
        }
        ([None, None], Some(plane), Some(size)) => match plane {
            "xy" => ([0, 1], size),
            "xz" => ([0, 2], size),
            "yz" => ([1, 2], size),
            other => {
                let found = crate::scene::words::shorten(other);
                let message = format!("unknown plane `{found}`: expected one of xy, xz, yz");
                return maker.problem("plane", message, "`u` and `v` give any other");
            }
        },
        _ => {
            let message = "expected two sides: `u` and `v`, or `plane` and `size`";
            return Problem::because(
                maker.path.clone(),
                message,
                "such as `u: [1, 0, 0], v: [0, 1, 0]`",
            );
        }
    };
    let along = |axis: usize, length: f64| {
        let mut edge = [0.0; 3];
        edge[axis] = maker.judge("size", length, Bounds::from(1e-12, 1e12, "m"))?;
        Ok(edge)
    };
    Ok(vec![along(axes[0], width)?, along(axes[1], height)?])
}

/// Words for pins: each corner by its ends along the directions, each side by its direction and end.
fn words(directions: usize) -> Vec<(&'static str, Pinned)> {
    const ENDS: [Option<Along>; 2] = [Some(Along::At(0)), Some(Along::Last)];
    let corner = |ends: &[usize]| Pinned(ends.iter().map(|end| ENDS[*end]).collect());
    let side = |direction: usize, end: usize| {
        let mut all = vec![None; directions];
        all[direction] = ENDS[end];
        Pinned(all)
    };
    match directions {
        2 => vec![
            ("corner00", corner(&[0, 0])),
            ("corner10", corner(&[1, 0])),
            ("corner01", corner(&[0, 1])),
            ("corner11", corner(&[1, 1])),
            ("edge_u0", side(0, 0)),
            ("edge_u1", side(0, 1)),
            ("edge_v0", side(1, 0)),
            ("edge_v1", side(1, 1)),
        ],
        _ => vec![
            ("corner000", corner(&[0, 0, 0])),
            ("corner100", corner(&[1, 0, 0])),
            ("corner010", corner(&[0, 1, 0])),
            ("corner110", corner(&[1, 1, 0])),
            ("corner001", corner(&[0, 0, 1])),
            ("corner101", corner(&[1, 0, 1])),
            ("corner011", corner(&[0, 1, 1])),
            ("corner111", corner(&[1, 1, 1])),
            ("face_u0", side(0, 0)),
            ("face_u1", side(0, 1)),
            ("face_v0", side(1, 0)),
            ("face_v1", side(1, 1)),
            ("face_w0", side(2, 0)),
            ("face_w1", side(2, 1)),
        ],
    }
}

/// The pins of a sheet or block. `rim` holds every side.
fn pins(maker: &Maker, options: &Options, frame: &Frame) -> Result<Vec<Pinned>, Problem> {
    let words = words(frame.links.len());
    let sides = words.iter().filter(|(word, _)| word.starts_with("edge_"));
    let rim: Vec<Pin> = sides
        .map(|(word, _)| Pin::Word((*word).to_owned()))
        .collect();
    let named = options.pins.iter().flat_map(|pin| match pin {
        Pin::Word(word) if word == "rim" && !rim.is_empty() => rim.clone(),
        pin => vec![pin.clone()],
    });
    let options = Options {
        pins: named.collect(),
        ..options.clone()
    };
    maker.pins(&options, frame, &words)
}

/// Joins every particle to those at these steps that are there.
fn join(maker: &mut Maker, body: &Body, steps: &[&[isize]], links: Links, ratio: f64) {
    for step in steps {
        // Ids differ by as much wherever both particles are.
        let apart = step.iter().zip(&body.shape);
        let apart = apart.fold(0, |sum, (by, count)| sum * *count as isize + by);
        let mut id = body.first;
        each_place(&body.shape, |place| {
            let mut along = place.iter().zip(*step).zip(&body.shape);
            let inside = along.all(|((at, by), count)| {
                at.checked_add_signed(*by)
                    .is_some_and(|there| there < *count)
            });
            if let (true, Some(end)) = (inside, id.checked_add_signed(apart)) {
                maker.join([id, end], links, ratio);
            }
            id += 1;
        });
    }
}

/// Links of one kind: their key, what the file says of them, and the steps to their other ends.
type Kind<'k> = (&'static str, Option<Links>, &'k [&'k [isize]]);

/// A sheet or a block: what its directions, particles and springs are.
struct Grid<'g> {
    origin: [f64; 3],
    edges: Vec<[f64; 3]>,
    particles: &'g [u64],
    kinds: &'g [Kind<'g>],
    /// What refining multiplies stiffness and damping by.
    scale: f64,
    rest_ratio: Option<f64>,
}

impl Grid<'_> {
    /// Adds its particles and springs.
    fn make(self, maker: &mut Maker, options: &Options) -> Result<Body, Problem> {
        let origin = maker.point("origin", self.origin)?;
        let frame = maker.frame(options, origin, self.edges, self.particles)?;
        let pins = pins(maker, options, &frame)?;
        let mut links = Vec::new();
        let mut ratio = 1.0;
        for &(key, kind, steps) in self.kinds {
            if let Some(kind) = kind {
                ratio = maker.rest_ratio(self.rest_ratio, kind)?;
                links.push((maker.links(key, kind, self.scale)?, steps));
            }
        }
        let body = maker.particles(options, &frame, &pins)?;
        for (kind, steps) in links {
            join(maker, &body, steps, kind, ratio);
        }
        Ok(body)
    }
}

const NEIGHBOURS: &[&[isize]] = &[&[1, 0], &[0, 1]];
const ACROSS: &[&[isize]] = &[&[1, 1], &[1, -1]];
const SECOND: &[&[isize]] = &[&[2, 0], &[0, 2]];

impl Generator for Cloth {
    fn options(&self) -> Options {
        self.common()
    }

    fn make(&self, maker: &mut Maker) -> Result<(), Problem> {
        let grid = Grid {
            edges: sides(maker, [self.u, self.v], self.plane.as_deref(), self.size)?,
            origin: self.origin,
            particles: &self.particles,
            kinds: &[
                ("structural", Some(self.structural), NEIGHBOURS),
                ("shear", self.shear.map(Links::Springs), ACROSS),
                ("flexion", self.flexion.map(Links::Springs), SECOND),
            ],
            scale: 1.0,
            rest_ratio: self.rest_ratio,
        };
        let body = grid.make(maker, &self.common())?;
        let air_drag = self.air_drag.unwrap_or_default();
        maker.judge(
            "air_drag",
            air_drag,
            Bounds::not_negative(1e12, "a pure number"),
        )?;
        if air_drag > 0.0 {
            let [along, across] = [body.shape[0], body.shape[1]];
            for i in 1..along {
                for j in 1..across {
                    let [a, b, c, d] = [[i - 1, j - 1], [i, j - 1], [i, j], [i - 1, j]]
                        .map(|[i, j]| body.first + i * across + j);
                    for corners in [[a, b, c], [a, c, d]] {
                        maker.scene.triangles.push(Triangle { corners, air_drag });
                    }
                }
            }
        }
        Ok(())
    }
}

impl Generator for Net {
    fn options(&self) -> Options {
        self.common()
    }

    fn make(&self, maker: &mut Maker) -> Result<(), Problem> {
        let grid = Grid {
            edges: sides(maker, [self.u, self.v], self.plane.as_deref(), self.size)?,
            origin: self.origin,
            particles: &self.particles,
            kinds: &[(
                "structural",
                Some(Links::Springs(self.structural)),
                NEIGHBOURS,
            )],
            scale: 1.0,
            rest_ratio: self.rest_ratio,
        };
        grid.make(maker, &self.common()).map(|_| ())
    }
}

impl Generator for Lattice {
    fn options(&self) -> Options {
        self.common()
    }

    fn make(&self, maker: &mut Maker) -> Result<(), Problem> {
        const AXES: &[&[isize]] = &[&[1, 0, 0], &[0, 1, 0], &[0, 0, 1]];
        const FACES: &[&[isize]] = &[
            &[1, 1, 0],
            &[1, -1, 0],
            &[1, 0, 1],
            &[1, 0, -1],
            &[0, 1, 1],
            &[0, 1, -1],
        ];
        const THROUGH: &[&[isize]] = &[&[1, 1, 1], &[1, 1, -1], &[1, -1, 1], &[1, -1, -1]];
        let options = self.common();
        let edges = [("u", self.u), ("v", self.v), ("w", self.w)];
        for (key, edge) in edges {
            maker.point(key, edge)?;
        }
        let [u, v, w] = edges.map(|(_, edge)| Vector3::from(edge));
        let size = u.norm() * v.norm() * w.norm();
        if u.cross(&v).dot(&w).abs() <= 1e-12 * size
            || edges.iter().any(|(_, edge)| length(*edge) == 0.0)
        {
            return maker.problem(
                "w",
                "expected three directions, found them in one plane",
                "",
            );
        }
        let grid = Grid {
            edges: edges.map(|(_, edge)| edge).to_vec(),
            origin: self.origin,
            particles: &self.particles,
            kinds: &[
                ("structural", Some(Links::Springs(self.structural)), AXES),
                ("shear", self.shear.map(Links::Springs), FACES),
                ("diagonal", self.diagonal.map(Links::Springs), THROUGH),
            ],
            scale: match options.scaling {
                Scaling::Continuum => 1.0 / options.refine.unwrap_or(1) as f64,
                Scaling::None => 1.0,
            },
            rest_ratio: self.rest_ratio,
        };
        grid.make(maker, &options).map(|_| ())
    }
}

//! Particles in a row: strings, chains, hair.

use super::{Along, Frame, Generator, Maker, Pinned, length};
use crate::scene::limits::Bounds;
use crate::scene::model::{Bending, Particle};
use crate::scene::object::{Hair, Hinge, Link, Links, Options, Scaling, Strand};
use crate::scene::place::Problem;

/// The words for pins of a row.
fn words() -> [(&'static str, Pinned); 2] {
    [
        ("start", Pinned(vec![Some(Along::At(0))])),
        ("end", Pinned(vec![Some(Along::Last)])),
    ]
}

/// The frame from one end to the other.
fn frame(
    maker: &Maker,
    options: &Options,
    from: [f64; 3],
    to: [f64; 3],
    particles: u64,
) -> Result<Frame, Problem> {
    let (from, to) = (maker.point("from", from)?, maker.point("to", to)?);
    let edge = [0, 1, 2].map(|axis| to[axis] - from[axis]);
    if length(edge) == 0.0 {
        return maker.problem("to", "expected two ends apart, found both in one place", "");
    }
    maker.frame(options, from, vec![edge], &[particles])
}

/// What refining multiplies stiffness and damping by.
fn scale(options: &Options, frame: &Frame) -> f64 {
    match options.scaling {
        Scaling::Continuum => frame.refine as f64,
        Scaling::None => 1.0,
    }
}

impl Generator for Strand {
    fn options(&self) -> Options {
        self.common()
    }

    fn make(&self, maker: &mut Maker) -> Result<(), Problem> {
        let options = self.common();
        let frame = frame(maker, &options, self.from, self.to, self.particles)?;
        let pins = maker.pins(&options, &frame, &words())?;
        let (key, links) = self.links(maker)?;
        let links = maker.links(key, links, scale(&options, &frame))?;
        let ratio = maker.rest_ratio(self.rest_ratio, links)?;
        let body = maker.particles(&options, &frame, &pins)?;
        for at in 1..body.shape[0] {
            maker.join([body.first + at - 1, body.first + at], links, ratio);
        }
        Ok(())
    }
}

impl Strand {
    /// What joins its particles, and the key that says so.
    fn links(&self, maker: &Maker) -> Result<(&'static str, Links), Problem> {
        match (self.stiffness, self.damping, self.structural) {
            (Some(stiffness), damping, None) => {
                let damping = damping.unwrap_or_default();
                Ok(("", Links::Springs(Link { stiffness, damping })))
            }
            (None, None, Some(links)) => Ok(("structural", links)),
            (stiffness, damping, _) => {
                let found = match (stiffness, damping) {
                    (None, None) => "neither",
                    (None, Some(_)) => "`damping` alone",
                    _ => "both",
                };
                let message =
                    format!("expected one of `stiffness` and `structural`, found {found}");
                let help = "`stiffness: 1000` for springs, in N/m; `structural: rods` for a string that does not stretch";
                Problem::because(maker.path.clone(), message, help)
            }
        }
    }
}

impl Generator for Hair {
    fn options(&self) -> Options {
        self.common()
    }

    fn make(&self, maker: &mut Maker) -> Result<(), Problem> {
        let options = self.common();
        let frame = frame(maker, &options, self.from, self.to, self.particles)?;
        let mut pins = maker.pins(&options, &frame, &words())?;
        let scale = scale(&options, &frame);
        let links = maker.links("structural", self.structural, scale)?;
        let hinge = self.hinge(maker, scale)?;
        let ratio = maker.rest_ratio(self.rest_ratio, links)?;
        let clamp = match self.clamp {
            Some(clamp) if length(maker.point("clamp", clamp)?) == 0.0 => {
                return maker.problem(
                    "clamp",
                    "expected a direction, found a vector of length 0",
                    "",
                );
            }
            clamp => clamp,
        };
        if clamp.is_some() {
            pins.push(Pinned(vec![Some(Along::At(0))]));
        }
        let body = maker.particles(&options, &frame, &pins)?;
        let (root, count) = (body.first, body.shape[0]);
        for at in 1..count {
            maker.join([root + at - 1, root + at], links, ratio);
        }
        for at in 1..count.saturating_sub(1) {
            maker.scene.bending.push(Bending {
                particles: [root + at - 1, root + at, root + at + 1],
                ..hinge.clone()
            });
        }
        if let Some(clamp) = clamp {
            let link = length(frame.edges[0]) / frame.links[0] as f64;
            let back = link / length(clamp);
            let ghost = maker.scene.particles.len();
            maker.scene.particles.push(Particle {
                position: [0, 1, 2].map(|axis| frame.origin[axis] - back * clamp[axis]),
                fixed: true,
                ..maker.scene.particles[root].clone()
            });
            maker.scene.bending.push(Bending {
                particles: [ghost, root, root + 1],
                stiffness: 2.0 * hinge.stiffness,
                damping: 2.0 * hinge.damping,
                rest_angle: 0.0,
            });
        }
        Ok(())
    }
}

impl Hair {
    /// A hinge with its numbers scaled and within their bounds.
    fn hinge(&self, maker: &Maker, scale: f64) -> Result<Bending, Problem> {
        let Hinge {
            stiffness,
            damping,
            rest_angle,
        } = self.bending;
        let within = |key: &str, x: f64, unit| {
            // The one at the root has twice as much.
            let bounds = Bounds::not_negative(0.5e18, unit);
            maker.judge(key, x, bounds)?;
            maker.judge(key, x * scale, bounds)
        };
        let angle = Bounds::not_negative(std::f64::consts::PI, "rad");
        let most = match self.common().scaling {
            // The angle of a curve is shared by its links.
            Scaling::Continuum => rest_angle / scale,
            Scaling::None => rest_angle,
        };
        maker.judge("bending.rest_angle", rest_angle, angle)?;
        Ok(Bending {
            stiffness: within("bending.stiffness", stiffness, "N m/rad")?,
            damping: within("bending.damping", damping, "N m s/rad")?,
            rest_angle: most,
            ..Bending::default()
        })
    }
}

//! A picture of where the particles of a scene are, and of what joins them.

mod drawn;
mod view;

pub use view::{AXIS_TITLES, plane};

use crate::report::svg::palette::{ATTRACTION, BELOW, HINGE, ROD, SPRING, TRIANGLES};
use crate::report::svg::{
    Chart, ChartAxis, FAINT, INK, LegendEntry, Look, Mark, Panel, Stroke, Symbol, SymbolShape,
    WHITE, range, shortened,
};
use crate::scene::Scene;
use drawn::{Drawn, Kind};
use view::View;

/// The height of the picture, pixels.
const HEIGHT: f64 = 460.0;
/// The room around the shapes, and that of names on their right, as parts of their largest extent.
const ROOM: [f64; 2] = [0.1, 0.18];
/// The most particles that have their names beside them.
const NAMED: usize = 12;
/// The springs of a picture from which on they are thin lines.
const MANY: usize = 1_000;

/// The looks of particles by their kind, and what the legend calls them.
const LOOKS: [(Kind, &str, Symbol); 4] = [
    (Kind::Free, "free", disc(INK, INK)),
    (Kind::Fixed, "fixed", square(INK)),
    (
        Kind::Driven,
        "driven",
        Symbol::new(SymbolShape::Diamond, INK, INK),
    ),
    (Kind::Clamp, "fixed, for a clamp alone", square(WHITE)),
];

const fn disc(fill: &'static str, outline: &'static str) -> Symbol {
    Symbol::new(SymbolShape::Disc, fill, outline)
}

const fn square(fill: &'static str) -> Symbol {
    Symbol::new(SymbolShape::Square, fill, INK)
}

/// The picture of a scene with its particles at one or more places: of each a label, and 3n coordinates in m, x, y and
/// z of one particle after the other. The last is drawn in full, over the pale springs of those before. What has
/// coordinates that are missing or not finite is left out.
///
/// Two axes are true to scale. A scene that extends along the third as well is drawn on a slant, and one with too many
/// members for a picture with near particles as one; the picture says so. Not to be confused with the figure
/// `trajectories.svg` of `run`, which shows motion.
pub fn shape(scene: &Scene, places: &[(&str, &[f64])]) -> Chart {
    let all = places.iter().flat_map(|(_, x)| x.as_chunks().0).copied();
    let view = View::new(scene.up, all.clone());
    let flat = |x: &[f64]| -> Vec<[f64; 2]> {
        let seen = x.as_chunks().0.iter().map(|point| view.place(*point));
        let missing = std::iter::repeat([f64::NAN; 2]);
        seen.chain(missing).take(scene.particles.len()).collect()
    };
    let ranges = [0, 1].map(|along| range(all.clone().map(|point| view.place(point)[along])));
    let ranges = ranges.map(Option::unwrap_or_default);
    let extents = ranges.map(|[low, high]| high - low);
    let size = f64::max(extents[0], extents[1]);
    let [room, names_room] = ROOM.map(|part| part * size);
    let [x, y] = ranges;
    let axes = [
        ChartAxis::linear([x[0] - room, x[1] + names_room]),
        ChartAxis::linear([y[0] - room, y[1] + room]),
    ];

    let (mut marks, mut legend, mut note) = (Vec::new(), Vec::new(), String::new());
    if let Some(((label, top), below)) = places.split_last() {
        let top = flat(top);
        let drawn = Drawn::new(scene, &top, ranges, places.len());
        let width = if drawn.springs.len() > MANY { 0.6 } else { 1.2 };
        let dot = diameter(extents, drawn.particles.len());
        for (label, x) in below {
            marks.extend(pale(&drawn, &flat(x), [width, dot]));
            let look = Look::Symbol(disc(BELOW, BELOW));
            legend.push(LegendEntry::new(*label, look));
        }
        let free = (!below.is_empty()).then_some(*label);
        legend.extend(entries(&drawn, width, free));
        marks.extend(full(scene, &drawn, &top, [width, dot]));
        note = drawn.note(scene.particles.len());
    }
    if let Some(ends) = view.edge(all) {
        marks.insert(0, Mark::line(ends, Stroke::new(FAINT, "1.5 2", 1.0)));
    }
    Chart {
        title: shortened(&scene.name, 90),
        legend,
        titles: view.plane.map(|axis| AXIS_TITLES[axis].to_owned()),
        panels: vec![Panel {
            equal_scales: true,
            ..Panel::new(view.sentences(), HEIGHT, axes, marks)
        }],
        note,
        ..Chart::default()
    }
}

/// The marks of a shape below another; its springs and particles are so many pixels wide.
fn pale(drawn: &Drawn, at: &[[f64; 2]], [width, dot]: [f64; 2]) -> [Mark; 3] {
    let particles = drawn.particles.iter().map(|(id, _)| [at[*id]]);
    [
        segments(Stroke::new(BELOW, "", 2.0 * width), &drawn.rods, at),
        segments(Stroke::new(BELOW, "", width), &drawn.springs, at),
        Mark::Dots(Stroke::new(BELOW, "", dot), finite(particles).concat()),
    ]
}

/// The marks of a shape that nothing lies over.
fn full(scene: &Scene, drawn: &Drawn, at: &[[f64; 2]], [width, dot]: [f64; 2]) -> Vec<Mark> {
    let triangles = drawn.triangles.iter();
    let triangles = triangles.map(|corners| corners.map(|id| at[id]));
    let hinges = finite(drawn.hinges.iter().map(|id| [at[*id]])).concat();
    let ring = Stroke::new(HINGE, "", dot + 4.0);
    let mut marks = vec![
        Mark::Triangles(TRIANGLES, finite(triangles)),
        segments(ATTRACTION, &drawn.attractions, at),
        segments(Stroke { width, ..SPRING }, &drawn.springs, at),
        segments(rod(width), &drawn.rods, at),
    ];
    // The white rim of a name covers springs, but no particle.
    let named = names(scene, drawn).into_iter();
    marks.extend(named.map(|(id, name)| Mark::Text(at[id], name)));
    marks.push(Mark::Dots(ring, hinges));
    marks.extend(LOOKS.iter().map(|(kind, _, symbol)| {
        let points = finite(drawn.of_kind(*kind).map(|id| [at[id]])).concat();
        match kind {
            Kind::Free => Mark::Dots(Stroke::new(INK, "", dot), points),
            _ => Mark::Symbols(*symbol, points),
        }
    }));
    marks
}

/// The line of a rod, beside springs of this width.
fn rod(width: f64) -> Stroke {
    Stroke {
        width: 2.0 * width,
        ..ROD
    }
}

/// The legend of a shape; `free` is what free particles are called where there is more than one shape.
fn entries(drawn: &Drawn, width: f64, free: Option<&str>) -> Vec<LegendEntry> {
    let kinds = LOOKS.into_iter();
    let kinds = kinds.filter(|(kind, ..)| drawn.of_kind(*kind).next().is_some());
    let kinds = kinds.map(|(kind, name, symbol)| {
        let name = free.filter(|_| kind == Kind::Free).unwrap_or(name);
        LegendEntry::new(name, Look::Symbol(symbol))
    });
    let hinges = (!drawn.hinges.is_empty())
        .then(|| LegendEntry::new("hinge", Look::Symbol(disc(INK, HINGE))));
    // The chart leaves out what has no mark.
    let others = [
        LegendEntry::new("spring", Look::Line(Stroke { width, ..SPRING })),
        LegendEntry::new("rod", Look::Line(rod(width))),
        LegendEntry::new("attraction", Look::Line(ATTRACTION)),
        LegendEntry::new("triangle", Look::Fill(TRIANGLES)),
    ];
    kinds.chain(hinges).chain(others).collect()
}

/// The names to show: those of all particles where there are few, else of the corners of objects.
fn names(scene: &Scene, drawn: &Drawn) -> Vec<(usize, String)> {
    let at_corner = |id: usize| {
        let bodies = scene.bodies.iter();
        let mut places = bodies.filter_map(|body| Some((body, body.place(id)?)));
        places.any(|(body, place)| {
            let mut along = place.iter().zip(&body.shape);
            along.all(|(at, count)| *at == 0 || at + 1 == *count)
        })
    };
    let few = scene.particles.len() <= NAMED;
    let ids = drawn.particles.iter().map(|(id, _)| *id);
    let named = ids.filter(|id| few || at_corner(*id)).take(NAMED);
    let name = |id: usize| scene.particle_name(id).unwrap_or_else(|| id.to_string());
    named.map(|id| (id, name(id))).collect()
}

/// The diameter of so many particles' dots, pixels: small beside the distance of neighbours.
fn diameter(extents: [f64; 2], particles: usize) -> f64 {
    let size = f64::max(extents[0], extents[1]).max(f64::MIN_POSITIVE);
    let [width, height] = extents.map(|extent| HEIGHT * extent / size);
    let count = particles.max(1) as f64;
    let apart = f64::max((width * height / count).sqrt(), HEIGHT / count);
    (0.25 * apart).clamp(2.0, 7.0)
}

fn segments(stroke: Stroke, pairs: &[[usize; 2]], at: &[[f64; 2]]) -> Mark {
    Mark::Segments(
        stroke,
        finite(pairs.iter().map(|ends| ends.map(|id| at[id]))),
    )
}

/// Those of which all coordinates are finite.
fn finite<const N: usize>(members: impl Iterator<Item = [[f64; 2]; N]>) -> Vec<[[f64; 2]; N]> {
    let finite = |member: &[[f64; 2]; N]| member.as_flattened().iter().all(|x| x.is_finite());
    members.filter(finite).collect()
}

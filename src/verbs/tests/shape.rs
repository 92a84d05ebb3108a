//! Pictures of scenes: what is drawn of them, and where.

use crate::scene::object::Object;
use crate::scene::{self, Scene};
use crate::verbs;
use crate::verbs::shape::shape;
use roxmltree::{Document, Node};
use std::path::{Path, PathBuf};

/// What is drawn at rounded pixels, and true to scale, in metres.
struct Picture {
    svg: String,
    /// Pixels of x = 0 and y = 0, and pixels of a metre to the right and down.
    scale: [[f64; 2]; 2],
}

impl Picture {
    fn of(scene: &Scene, places: &[(&str, &[f64])]) -> Self {
        let svg = shape(scene, places).draw();
        let document = Document::parse(&svg).expect("well-formed");
        // The tick labels along x are centred, those along y end at the axis, 4 pixels below their tick.
        let scale = [("middle", "x", 0.0), ("end", "y", 4.0)].map(|(anchor, along, below)| {
            let ticks = elements(&document, "text").filter(|text| {
                text.attribute("font-size") == Some("11")
                    && text.attribute("text-anchor") == Some(anchor)
            });
            let ticks: Vec<[f64; 2]> = ticks
                .map(|text| {
                    let value = text.text().expect("a label").replace('−', "-");
                    let pixel: f64 = text
                        .attribute(along)
                        .expect("a place")
                        .parse()
                        .expect("a number");
                    [value.parse().expect("a number"), pixel - below]
                })
                .collect();
            let [first, last] = [ticks[0], ticks[ticks.len() - 1]];
            let metre = (last[1] - first[1]) / (last[0] - first[0]);
            [first[1] - metre * first[0], metre]
        });
        Self { svg, scale }
    }

    fn start(scene: &Scene) -> Self {
        Self::of(scene, &[("start", &scene.starts().concat())])
    }

    /// The pixels of dots of this colour.
    fn dots(&self, colour: &str) -> Vec<[f64; 2]> {
        let document = Document::parse(&self.svg).expect("well-formed");
        let paths =
            elements(&document, "path").filter(|path| path.attribute("stroke") == Some(colour));
        let data: String = paths.filter_map(|path| path.attribute("d")).collect();
        let dots = data.split('M').filter_map(|part| part.strip_suffix("h0"));
        let pixel = |dot: &str| {
            let (x, y) = dot.split_once(' ').expect("two coordinates");
            [x, y].map(|along| along.parse().expect("a number"))
        };
        dots.map(pixel).collect()
    }

    /// Where they are on the axes, m.
    fn metres(&self, dots: &[[f64; 2]]) -> Vec<[f64; 2]> {
        let metre =
            |pixel: &[f64; 2]| [0, 1].map(|i| (pixel[i] - self.scale[i][0]) / self.scale[i][1]);
        dots.iter().map(metre).collect()
    }

    /// How many symbols with this filling and outline it has, without the one of the legend.
    fn symbols(&self, fill: &str, outline: &str) -> usize {
        let document = Document::parse(&self.svg).expect("well-formed");
        let filled = elements(&document, "path").filter(|path| {
            path.attribute("fill") == Some(fill) && path.attribute("stroke") == Some(outline)
        });
        filled.count().saturating_sub(1)
    }

    /// How many segments the springs have.
    fn springs(&self) -> usize {
        let document = Document::parse(&self.svg).expect("well-formed");
        let springs =
            elements(&document, "path").filter(|path| path.attribute("stroke") == Some("#0072b2"));
        let data = springs.filter_map(|path| path.attribute("d"));
        data.map(|data| data.matches('L').count()).sum()
    }
}

fn elements<'d>(document: &'d Document, name: &'static str) -> impl Iterator<Item = Node<'d, 'd>> {
    document
        .descendants()
        .filter(move |node| node.has_tag_name(name))
}

fn read(text: &str) -> Scene {
    let text = format!("solver: {{type: rk4, timestep: 0.001}}\n{text}");
    scene::parse(text.as_bytes(), "scene.yml", verbs::names()).expect("a scene")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All scene files below a folder of the project.
fn scenes(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a name").path()).collect();
    paths.sort();
    let below = paths
        .iter()
        .filter(|path| path.is_dir())
        .flat_map(|path| scenes(path));
    let here = paths
        .iter()
        .filter(|path| path.extension().is_some_and(|e| e == "yml"));
    here.cloned().chain(below).collect()
}

/// A particle is where the axes say it is, and a metre is as long to the right as upward.
#[test]
fn particles_are_where_the_axes_say() {
    let scene = read(
        "particles:
- {pos: [0.2, 0, 1], mass: 1}
- {pos: [1.2, 0, 1.5], mass: 1}
- {pos: [0.7, 0, 1.2], fixed: true}
springs: [{particle_ids: [0, 1], stiffness: 1}, {particle_ids: [1, 2], stiffness: 1}]
",
    );
    let picture = Picture::start(&scene);
    let [right, down] = picture.scale.map(|[_, metre]| metre);
    // Places are rounded to 0.1 pixels, and the two ticks are at least 300 pixels apart.
    assert!((right + down).abs() < 1e-3 * right, "{right} {down}");
    let dots = picture.metres(&picture.dots("#222222"));
    for (dot, [x, z]) in dots.iter().zip([[0.2, 1.0], [1.2, 1.5]]) {
        // Two roundings of half a tenth, and that of the ticks.
        assert!((dot[0] - x).hypot(dot[1] - z) < 0.3 / right, "{dot:?}");
    }
    assert_eq!(
        (
            dots.len(),
            picture.symbols("#222222", "#222222"),
            picture.springs()
        ),
        (2, 1, 2)
    );
}

/// Each object has the springs and the particles that its kind is made of, in closed form.
#[test]
fn pictures_have_all_members() {
    let sheet = |a: usize, b: usize| a * (b - 1) + b * (a - 1);
    // File, free particles, fixed, springs, hinges.
    let wanted = [
        ("string", 8, 1, 8, 0),
        ("hair", 8, 1, 8, 8),
        // Structural, two across each cell, flexion.
        ("cloth", 38, 2, sheet(8, 5) + 2 * 7 * 4 + 6 * 5 + 8 * 3, 0),
        ("net", 49, 32, sheet(9, 9), 0),
        // Along u and along v and w, two across each face in each of the three planes.
        (
            "lattice",
            12,
            4,
            3 * 4 + 4 * sheet(2, 2) + 2 * (2 * (3 * 2) + 4),
            0,
        ),
    ];
    for (name, free, fixed, springs, hinges) in wanted {
        let path = root().join(format!("docs/objects/{name}.yml"));
        let scene = scene::read(&path, verbs::names()).expect("a scene");
        let picture = Picture::start(&scene);
        let found = (
            picture.dots("#222222").len(),
            picture.symbols("#222222", "#222222"),
            picture.springs(),
            picture.dots("#e69f00").len(),
        );
        assert_eq!(found, (free, fixed, springs, hinges), "{name}");
        assert!(!picture.svg.contains("are drawn"), "{name}");
        // The particle behind a hair's root.
        assert_eq!(
            picture.symbols("#ffffff", "#222222"),
            usize::from(name == "hair"),
            "{name}"
        );
    }
}

#[test]
fn every_scene_has_a_small_picture() {
    for path in scenes(&root().join("scenes")) {
        let scene = scene::read(&path, verbs::names()).expect("a scene");
        let svg = Picture::start(&scene).svg;
        let path = path.display();
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{path}");
        assert!(svg.len() < 300_000, "{path}: {} bytes", svg.len());
    }
}

/// What is too much for a picture is drawn with near particles as one: as many as there is room for, all over it.
#[test]
fn a_large_cloth_is_drawn_all_over() {
    let scene = read(
        "objects:
- cloth: {origin: [0, 0, 0], u: [1, 0, 0], v: [0, 1, 0], particles: [316, 316], mass: 1, air_drag: 1,
    structural: {stiffness: 1}, shear: {stiffness: 1}, flexion: {stiffness: 1}, pins: [[150, 170]]}
",
    );
    let picture = Picture::start(&scene);
    assert!(picture.svg.len() < 300_000, "{} bytes", picture.svg.len());
    let dots = picture.metres(&picture.dots("#222222"));
    // Of n particles in a square 4 n springs and 2 n triangles are left, of 15, 25 and 40 bytes: 280,000 are enough for
    // 1,435. One step fewer cells, of a tenth, leaves 0.81 of them.
    assert!((1_160..=1_450).contains(&dots.len()), "{}", dots.len());
    assert!(picture.svg.contains("of 99,856 particles are drawn"));
    assert_eq!(picture.symbols("#222222", "#222222"), 1);
    // The drawn one and any other of its node are at most half a diagonal of a cell off it.
    let cell = 1.0 / ((dots.len() as f64).sqrt() - 1.0);
    for particle in scene.particles.iter().step_by(37) {
        let [x, y, _] = particle.position;
        let off = dots.iter().map(|dot| (dot[0] - x).hypot(dot[1] - y));
        let nearest = off.fold(f64::INFINITY, f64::min);
        assert!(nearest < 1.5 * cell, "{nearest} m from {x}, {y}");
    }
    for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]] {
        let at = |dot: &[f64; 2]| (dot[0] - corner[0]).hypot(dot[1] - corner[1]) < 2e-3;
        assert!(dots.iter().any(at), "{corner:?}");
    }
}

/// The last shape is drawn in full over the pale one before, on the same axes; what is not finite is left out.
#[test]
fn a_shape_lies_over_another() {
    let scene = read(
        "objects:
- string: {from: [0, 0, 0], to: [1, 0, 0], particles: 5, mass: 1, stiffness: 1, pins: [start]}
",
    );
    let start = scene.starts().concat();
    let mut hanging = start.clone();
    for at in 0..5 {
        (hanging[3 * at], hanging[3 * at + 2]) = (0.0, -0.25 * at as f64);
    }
    let picture = Picture::of(&scene, &[("start", &start), ("at rest", &hanging)]);
    assert!(picture.svg.contains(">start<") && picture.svg.contains(">at rest<"));
    let below = picture.metres(&picture.dots("#b4b4b4"));
    let above = picture.metres(&picture.dots("#222222"));
    assert_eq!((below.len(), above.len(), picture.springs()), (5, 4, 4));
    for (at, dot) in above.iter().enumerate() {
        assert!(
            dot[0].hypot(dot[1] + 0.25 * (at + 1) as f64) < 2e-3,
            "{dot:?}"
        );
    }
    for (at, dot) in below.iter().enumerate() {
        assert!((dot[0] - 0.25 * at as f64).hypot(dot[1]) < 2e-3, "{dot:?}");
    }

    hanging[3] = f64::NAN;
    let torn = Picture::of(&scene, &[("torn", &hanging)]);
    assert_eq!((torn.dots("#222222").len(), torn.springs()), (3, 2));
    // Two whole particles, of which the first is fixed.
    let short = Picture::of(&scene, &[("short", &start[..7])]);
    assert_eq!((short.dots("#222222").len(), short.springs()), (1, 1));
    assert!(!torn.svg.contains("NaN"));
    let nothing = shape(&scene, &[]).draw();
    Document::parse(&nothing).expect("well-formed");
}

/// The pictures of `docs/objects.md` are those of the scenes beside them, and each kind of object has one.
#[test]
fn the_pictures_of_the_docs_are_made_by_the_program() {
    let page = std::fs::read_to_string(root().join("docs/objects.md")).expect("a page");
    let schema = schemars::schema_for!(Object);
    let kinds = schema
        .get("properties")
        .and_then(|of| of.as_object())
        .expect("kinds");
    for kind in kinds.keys().filter(|kind| *kind != "chain") {
        let place = |extension| format!("docs/objects/{kind}.{extension}");
        let stored =
            |extension| std::fs::read_to_string(root().join(place(extension))).expect("a file");
        let (text, picture) = (stored("yml"), stored("svg"));
        assert!(text.lines().count() <= 10, "{kind}");
        assert!(text.contains(&format!("- {kind}: ")), "{kind}");
        let scene = scene::parse(text.as_bytes(), &place("yml"), verbs::names()).expect("a scene");
        let command = format!(
            "springcheck expand {} --format svg > {}\n",
            place("yml"),
            place("svg")
        );
        assert!(
            Picture::start(&scene).svg == picture,
            "make it again: {command}"
        );
        for part in [
            format!("```yaml\n{text}```"),
            format!("](objects/{kind}.svg)"),
            command,
        ] {
            assert!(page.contains(&part), "{part}");
        }
    }
}

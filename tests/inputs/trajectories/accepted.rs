//! Odd but right: the forms text may have, and what is filled in.

use super::{CHAIN, HANGING, accepted, scene};
use springcheck::trajectory::{FreeAxis, Layout, free_axis};

/// Two instants of the chain, as plainly as can be.
const PLAIN: &str = "t,id,x,y,z\n0,0,0,0,2\n0,1,0.5,0,1\n0,2,1,0,1\n\
    0.75,0,0,0,2\n0.75,1,0.5,0,0.75\n0.75,2,1,0.125,1\n";

const X: [f64; 18] = [
    0.0, 0.0, 2.0, 0.5, 0.0, 1.0, 1.0, 0.0, 1.0, //
    0.0, 0.0, 2.0, 0.5, 0.0, 0.75, 1.0, 0.125, 1.0,
];

#[test]
fn every_form_of_text_says_the_same() {
    let lines: Vec<&str> = PLAIN.lines().collect();
    let reordered = [0, 3, 1, 2, 5, 4, 6].map(|at| lines[at]).join("\n");
    let columns = |line: &&str| line.split(',').rev().collect::<Vec<_>>().join(",");
    let reversed: Vec<String> = lines.iter().map(columns).collect();
    let forms = [
        ("plain", PLAIN.to_owned()),
        ("CRLF", PLAIN.replace('\n', "\r\n")),
        ("CR", PLAIN.replace('\n', "\r")),
        ("byte order mark", format!("\u{feff}{PLAIN}")),
        ("no last line end", PLAIN.trim_end().to_owned()),
        ("blank lines", PLAIN.replace('\n', "\n\n \n")),
        ("blanks", PLAIN.replace(',', " ,\t")),
        ("comments", PLAIN.replace('\n', "\n# \"so, so\n #,\n")),
        ("a comment above", format!("# by a program, 2\n{PLAIN}")),
        ("a header in a comment", format!("# {PLAIN}")),
        ("capitals", PLAIN.replace("t,id,x,y,z", "T,ID,X,Y,Z")),
        (
            "quotes",
            PLAIN
                .replace("t,id,x,y,z", "\"t\",\"id\",'x',\"y\",\"z\"")
                .replace("0.125", "\"0.125\""),
        ),
        ("ids in any order", reordered),
        ("columns in any order", reversed.join("\n")),
        ("ids as floats", PLAIN.replace(",2,1", ",2.000e+00,1")),
        (
            "numbers in any form",
            PLAIN
                .replace("0.75", "+7.5E-1")
                .replace(",1\n", ",1.\n")
                .replace("0.5", ".5"),
        ),
        (
            "fixed ones left out",
            lines
                .iter()
                .filter(|l| !l.ends_with(",2"))
                .copied()
                .collect::<Vec<_>>()
                .join("\n"),
        ),
    ];
    for (title, text) in forms {
        let rows = accepted(title, &text, CHAIN);
        assert_eq!(rows.steps, [0, 3], "{title}");
        assert_eq!(rows.x, X, "{title}");
        assert_eq!(
            (rows.dim, rows.timestep, &rows.v),
            (9, 0.25, &None),
            "{title}"
        );
    }
}

#[test]
fn velocities_are_read_beside_positions() {
    let text = "t,vx,vy,vz,id,x,y,z\n0.25,1,2,3,1,4,5,6\n0.25,0,0,0,0,0,0,2\n";
    let rows = accepted("velocities", text, HANGING);
    assert_eq!(rows.x, [0.0, 0.0, 2.0, 4.0, 5.0, 6.0]);
    assert_eq!(rows.v, Some(vec![0.0, 0.0, 0.0, 1.0, 2.0, 3.0]));
    assert_eq!(rows.steps, [1]);
    let without = "t,x,y,z,vx,vy,vz\n0.25,4,5,6,1,2,3\n";
    assert_eq!(accepted("no id", without, HANGING), rows);
}

#[test]
fn one_coordinate_is_enough_where_only_one_moves() {
    let rows = accepted("t,x", "t,x\n0,1\n0.25,0.875\n", HANGING);
    assert_eq!(
        rows.x,
        [0.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.875]
    );
    assert_eq!(rows.v, None);
    let rows = accepted("t,x,v", "t,x,v\n0.25,0.875,-3\n", HANGING);
    assert_eq!(rows.v, Some(vec![0.0, 0.0, 0.0, 0.0, 0.0, -3.0]));
}

#[test]
fn the_free_axis_is_where_everything_points() {
    let axis = |particle, axis| Some(FreeAxis { particle, axis });
    let particle = |more: &str| {
        format!(
            "solver: {{type: midpoint, timestep: 1, gravity: 0}}\n\
             particles: [{{pos: [3, 1, 2], fixed: true}}, {{pos: [3, 0, 2], mass: 1{more}}}]\n"
        )
    };
    let still = particle("");
    let moving = particle(", vel: [0, 0, 1]");
    let spring = "springs: [{particle_ids: [1, 0], stiffness: 1}]\n";
    let rows = [
        ("gravity and spring", HANGING.to_owned(), axis(1, 2)),
        ("two free particles", CHAIN.to_owned(), None),
        ("nothing moves it", still.clone(), None),
        ("a velocity", moving.clone(), axis(1, 2)),
        ("a spring", format!("{still}{spring}"), axis(1, 1)),
        (
            "a spring across the velocity",
            format!("{moving}{spring}"),
            None,
        ),
        (
            "a spring without stiffness",
            format!("{moving}{}", spring.replace("ss: 1", "ss: 0")),
            axis(1, 2),
        ),
        (
            "only a damper",
            format!("{still}{}", spring.replace("ss: 1", "ss: 0, damping: 1")),
            axis(1, 1),
        ),
        (
            "wind",
            format!("{still}wind: {{direction: [-1, 0, 0], strength: 1}}"),
            axis(1, 0),
        ),
        (
            "no wind",
            format!("{still}wind: {{direction: [1, 0, 0], strength: 0}}"),
            None,
        ),
        (
            "slanted wind",
            format!("{still}wind: {{direction: [1, 1, 0], strength: 1}}"),
            None,
        ),
        (
            "a charge that turns",
            moving.replace("mass: 1", "mass: 1, charge: 1") + "magnetic: {field: [0, 2, 0]}",
            None,
        ),
        (
            "a charge along the field",
            moving.replace("mass: 1", "mass: 1, charge: 1") + "magnetic: {field: [0, 0, 2]}",
            axis(1, 2),
        ),
        (
            "no charge",
            format!("{moving}magnetic: {{field: [0, 2, 0]}}"),
            axis(1, 2),
        ),
        (
            "up",
            still
                .replace("gravity: 0", "gravity: -1")
                .replacen("solver", "up: x\nsolver", 1),
            axis(1, 0),
        ),
        (
            "attraction",
            format!(
                "{}gravitational: [{{particle_ids: [0, 1], G: 1}}]",
                still.replace("fixed: true", "fixed: true, mass: 1")
            ),
            axis(1, 1),
        ),
    ];
    for (title, yaml, axis) in rows {
        assert_eq!(free_axis(&scene(&yaml)), axis, "{title}");
    }
}

#[test]
fn content_tells_the_layout_and_the_name_where_it_does_not() {
    for (name, bytes, layout) in [
        ("a.csv", &b"PK\x03\x04"[..], Layout::Npz),
        ("a.npy", b"PK\x05\x06", Layout::Npz),
        ("a.npz", b"\x93NUMPY", Layout::Npy),
        ("a.NPZ", b"", Layout::Npz),
        ("a.b.npy", b"t,id", Layout::Npy),
        ("a.csv", b"t,id", Layout::Csv),
        ("npz", b"t,id", Layout::Csv),
        ("-", b"", Layout::Csv),
    ] {
        assert_eq!(Layout::guess(name, bytes), layout, "{name} {bytes:?}");
    }
}

//! Data of a plane, and wide text.

use super::{CHAIN, accepted, archive, doubles, read, scene};
use springcheck::trajectory::{self, Expected, Plane, Rows};

/// As the chain, but nothing acts along y.
fn in_plane(bytes: impl AsRef<[u8]>, plane: Plane) -> Result<Rows, String> {
    let scene = scene(CHAIN);
    let expected = Expected::new(&scene, 0.25);
    let expected = expected.in_plane(plane).map_err(str::to_owned)?;
    trajectory::read(bytes.as_ref(), "mine", None, &expected).map_err(|error| error.to_string())
}

const X: [f64; 18] = [
    0.0, 0.0, 2.0, 0.5, 0.0, 1.0, 1.0, 0.0, 1.0, //
    0.0, 0.0, 2.0, 0.5, 0.0, 0.75, 1.125, 0.0, 1.0,
];
const V: [f64; 18] = [
    0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, //
    0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.5, 0.0, 0.0,
];

/// Without every third coordinate.
fn flat(states: &[f64]) -> Vec<f64> {
    states.chunks_exact(3).flat_map(|x| [x[0], x[2]]).collect()
}

#[test]
fn every_form_of_a_plane_is_the_whole_state() {
    let t = doubles(&[2], &[0.0, 0.25]);
    let array = |x: &[f64]| doubles(&[2, 3, 2], &flat(x));
    let free: Vec<f64> = X.chunks_exact(9).flat_map(|x| flat(&x[3..])).collect();
    let long = "t,id,x,z,vx,vz\n0,0,0,2,0,0\n0,1,0.5,1,0,0\n0,2,1,1,0,0\n\
                0.25,0,0,2,0,0\n0.25,1,0.5,0.75,0,-1\n0.25,2,1.125,1,0.5,0\n";
    let wide =
        "t,x1,z1,x2,z2,vx1,vz1,vx2,vz2\n0,0.5,1,1,1,0,0,0,0\n0.25,0.5,0.75,1.125,1,0,-1,0.5,0\n";
    let forms: Vec<(&str, Vec<u8>, bool)> = vec![
        (
            "an archive",
            archive(&[("t.npy", &t), ("x.npy", &array(&X)), ("v.npy", &array(&V))]),
            true,
        ),
        ("an array", array(&X), false),
        ("free ones", doubles(&[2, 2, 2], &free), false),
        ("text", long.into(), true),
        (
            "its own names",
            long.replace("x,z,vx,vz", "x,y,vx,vy").into(),
            true,
        ),
        ("wide text", wide.into(), true),
        ("its own names, wide", wide.replace('z', "y").into(), true),
    ];
    for (title, bytes, velocities) in forms {
        let rows = in_plane(bytes, Plane::Xz).unwrap_or_else(|error| panic!("{title}: {error}"));
        assert_eq!(rows.x, X, "{title}");
        assert_eq!(rows.v, velocities.then(|| V.to_vec()), "{title}");
    }
}

/// Gravity acts along z, and the springs lie in the plane of x and z.
#[test]
fn a_plane_has_room_for_all_that_moves() {
    let bytes = doubles(&[2, 3, 2], &flat(&X));
    assert_eq!(in_plane(&bytes, Plane::Xy), Err("z".to_owned()));
    assert_eq!(in_plane(&bytes, Plane::Yz), Err("x".to_owned()));
    for (title, bytes) in [
        ("arrays", doubles(&[2, 3, 3], &X)),
        ("text", b"t,id,x,y,z\n0,1,0,0,0\n".to_vec()),
        (
            "wide text",
            b"t,x1,y1,z1,x2,y2,z2\n0,0,0,0,0,0,0\n".to_vec(),
        ),
    ] {
        let shown = in_plane(bytes, Plane::Xz).unwrap_err();
        assert!(shown.ends_with("leave --axes out"), "{title}: {shown}");
    }
    for (title, bytes) in [
        ("arrays", bytes),
        ("text", b"t,id,x,y\n0,1,0,0\n".to_vec()),
        ("wide text", b"t,x1,y1,x2,y2\n0,0,0,0,0\n".to_vec()),
    ] {
        let shown = read(bytes, CHAIN).unwrap_err().to_string();
        assert!(shown.contains("--axes xy"), "{title}: {shown}");
    }
}

#[test]
fn wide_text_is_the_same_as_long_text() {
    let long = "t,id,x,y,z,vx,vy,vz\n0,0,0,0,2,0,0,0\n0,1,.5,0,1,0,0,0\n0,2,1,0,1,0,0,0\n\
                0.5,0,0,0,2,0,0,0\n0.5,1,1,2,3,4,5,6\n0.5,2,7,8,9,10,11,12\n";
    let rows = accepted("long", long, CHAIN);
    let wide = "t,x0,y0,z0,x1,y1,z1,x2,y2,z2,vx0,vy0,vz0,vx1,vy1,vz1,vx2,vy2,vz2\n\
                0,0,0,2,.5,0,1,1,0,1,0,0,0,0,0,0,0,0,0\n0.5,0,0,2,1,2,3,7,8,9,0,0,0,4,5,6,10,11,12\n";
    let by_particle = "# t,x_1,y_1,z_1,vx_1,vy_1,vz_1,x_2,y_2,z_2,vx_2,vy_2,vz_2\n\
                       0,.5,0,1,0,0,0,1,0,1,0,0,0\n0.5,1,2,3,4,5,6,7,8,9,10,11,12\n";
    assert_eq!(accepted("wide", wide, CHAIN), rows);
    assert_eq!(accepted("by particle", by_particle, CHAIN), rows);
}

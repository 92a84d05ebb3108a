//! Trajectories from other programs: what is read, what is refused and where, how exactly it is
//! given, and that nothing upsets the reader.

mod accepted;
mod arrays;
mod cut;
mod planes;
mod precision;
mod refused;
mod times;
mod upset;
mod written;

use springcheck::scene::{self, Names, Scene};
use springcheck::trajectory::{self, Expected, ReadError, Rows};
use std::io::Write;
use zip::write::SimpleFileOptions;

/// A free particle hangs below a fixed one: it moves on the z axis.
const HANGING: &str = "solver: {type: midpoint, timestep: 0.25}\n\
    particles: [{pos: [0, 0, 2], fixed: true}, {pos: [0, 0, 1], mass: 2}]\n\
    springs: [{particle_ids: [0, 1], stiffness: 20}]";

/// Two free particles on a fixed one.
const CHAIN: &str = "solver: {type: midpoint, timestep: 0.25}\n\
    particles: [{pos: [0, 0, 2], fixed: true}, {pos: [0.5, 0, 1], mass: 2}, {pos: [1, 0, 1], mass: 2}]\n\
    springs: [{particle_ids: [0, 1], stiffness: 20}, {particle_ids: [1, 2], stiffness: 20}]";

fn scene(yaml: &str) -> Scene {
    let names = Names {
        methods: vec!["midpoint"],
        ..Names::default()
    };
    scene::parse(yaml.as_bytes(), "scene.yml", &names).expect("a scene")
}

fn expected(yaml: &str) -> Expected {
    let scene = scene(yaml);
    Expected::new(&scene, scene.solver.timestep)
}

/// By its content, under a name that says nothing.
fn read(bytes: impl AsRef<[u8]>, scene: &str) -> Result<Rows, ReadError> {
    trajectory::read(bytes.as_ref(), "mine", None, &expected(scene))
}

fn accepted(title: &str, bytes: impl AsRef<[u8]>, scene: &str) -> Rows {
    read(bytes, scene).unwrap_or_else(|error| panic!("{title}: {error}"))
}

/// An NPY file: description of one number, order, shape and stored numbers, version 1.
fn npy(descr: &str, fortran: bool, shape: &[usize], numbers: &[u8]) -> Vec<u8> {
    let order = if fortran { "True" } else { "False" };
    let sizes: String = shape.iter().map(|size| format!("{size}, ")).collect();
    let header =
        format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': ({sizes}), }}\n");
    let length = u16::try_from(header.len()).expect("a short header");
    let start = [&b"\x93NUMPY\x01\x00"[..], &length.to_le_bytes()].concat();
    [&start, header.as_bytes(), numbers].concat()
}

/// Doubles, little-endian, in C order.
fn doubles(shape: &[usize], numbers: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    npy("<f8", false, shape, &bytes)
}

/// An archive of files.
fn archive(files: &[(&str, &[u8])]) -> Vec<u8> {
    let mut out = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for (name, bytes) in files {
        let options =
            SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
        out.start_file(*name, options).expect("a place in memory");
        out.write_all(bytes).expect("a place in memory");
    }
    out.finish().expect("an archive").into_inner()
}

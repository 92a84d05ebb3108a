//! Bad scenes, each with the exact place of its error. `»` marks the place and is taken out before
//! parsing; the last column is what the message must say.

use super::{NAMES, Row, colliders, complete, parse, rods};
use springcheck::scene::{self, SceneError, limits};
use std::time::{Duration, Instant};

/// Completed with a solver and two particles, 0 fixed and 1 free, where the row has none.
#[rustfmt::skip]
const PARTS: &[Row] = &[
    // Keys.
    ("misspelt", "springs: [{particle_ids: [0, 1], »stifness: 20}]", &["springs[0]", "unknown key `stifness`", "did you mean `stiffness`?"]),
    ("unknown", "»colour: red", &["unknown key `colour`", "the keys here are name, description"]),
    ("another format's", "springs: [{particle_ids: [0, 1], »k: 20}]", &["did you mean `stiffness`?"]),
    ("misplaced", "»gravity: -9.81", &["`gravity` stands under `solver`"]),
    ("case", "»Springs: []", &["did you mean `springs`?"]),
    ("duplicate", "duration: 5\nname: a\n»duration: 6", &["duration", "given twice"]),
    ("duplicate inside", "springs:\n- particle_ids: [0, 1]\n  stiffness: 1\n  »stiffness: 2", &["springs[0].stiffness", "given twice"]),
    ("merge", "plot:\n  »<<: {dof: 1}\n  particle_id: 0", &["plot", "merge keys", "alias a whole value"]),
    ("moving air under wind", "wind: {direction: [1, 0, 0], »density: 3}", &["wind", "unknown key `density`", "`density` stands under `air`"]),
    ("later, profile", "wind: {direction: [1, 0, 0], »profile: log}", &["wind.profile", "not supported yet"]),
    ("list as key", "»[1, 2]: 3", &["expected a key, found a list"]),
    ("empty key", "»'': 3", &["unknown key ``"]),
    ("number as key", "»1: 3", &["unknown key `1`"]),
    // Objects.
    ("object, no list", "objects: »3", &["objects", "expected a list, found the number `3`"]),
    ("object, no object", "objects: [»3]", &["objects[0]", "expected a mapping, found the number `3`"]),
    ("object, unknown kind", "objects: [{»rope: {}}]", &["objects[0]", "unknown key `rope`", "string, chain, hair, cloth, net, lattice"]),
    ("object, of no kind", "objects: [»{}]", &["objects[0]", "expected one of string, chain, hair"]),
    ("object, of two kinds", "objects:\n- »string:\n    {from: [0, 0, 0], to: [1, 0, 0], particles: 3, mass: 1, stiffness: 3}\n  chain: {from: [0, 0, 0], to: [1, 0, 0], particles: 3, mass: 1, stiffness: 3}", &["objects[0]", "expected one of string, chain, hair"]),
    ("object, a key missing", "objects:\n- string:\n    »from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1", &["objects[0].string", "expected one of `stiffness` and `structural`, found neither"]),
    ("object, a key misspelt", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    »stifness: 3", &["objects[0].string", "unknown key `stifness`", "did you mean `stiffness`?"]),
    ("object, a word misspelt", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\n    scaling: »contin", &["objects[0].string.scaling", "expected one of continuum, none, found `contin`"]),
    ("object, a text for a number", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: »\"1\"\n    stiffness: 3", &["objects[0].string.mass", "expected a number"]),
    ("object, half a particle", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: »3.5\n    mass: 1\n    stiffness: 3", &["objects[0].string.particles", "expected a whole number from 0"]),
    ("object, too many particles", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: »3000000000\n    mass: 1\n    stiffness: 3", &["objects[0].string.particles", "at most 4000000"]),
    ("object, one particle", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: »1\n    mass: 1\n    stiffness: 3", &["objects[0].string.particles", "two particles or more"]),
    ("object, cloth of one row", "objects:\n- cloth:\n    origin: [0, 0, 0]\n    u: [1, 0, 0]\n    v: [0, 1, 0]\n    particles: »[1, 5]\n    mass: 1\n    structural: {stiffness: 3}", &["objects[0].cloth.particles", "two particles or more along each direction, found 1"]),
    ("object, refined to nothing", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\n    refine: »0", &["objects[0].string.refine", "expected 1 or more"]),
    ("object, refined too far", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\n    refine: »3000000", &["objects[0].string.refine", "at most 4000000"]),
    ("object, negative stiffness", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: »-3", &["objects[0].string.stiffness", "at least 0 (N/m)"]),
    ("object, scaled beyond the bound", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: »1e18\n    refine: 2", &["objects[0].string.stiffness", "at most 1e18 (N/m)"]),
    ("object, no place", "objects:\n- string:\n    from: »[0, 0, .nan]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3", &["objects[0].string.from", "finite number (m)"]),
    ("object, no length", "objects:\n- string:\n    from: [0, 0, 0]\n    to: »[0, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3", &["objects[0].string.to", "found both in one place"]),
    ("object, no mass", "objects:\n- string:\n    »from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    stiffness: 3", &["objects[0].string", "expected one of `mass` and `particle_mass`, found none"]),
    ("object, two masses", "objects:\n- string:\n    »from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\n    particle_mass: 1", &["objects[0].string", "found both"]),
    ("object, pin outside", "objects:\n- cloth:\n    origin: [0, 0, 0]\n    u: [1, 0, 0]\n    v: [0, 1, 0]\n    particles: [2, 5]\n    mass: 1\n    structural: {stiffness: 3}\n    pins: [»[2, 0]]", &["objects[0].cloth.pins[0]", "expected a place in [0..1, 0..4], found [2, 0]"]),
    ("object, pin of no word", "objects:\n- cloth:\n    origin: [0, 0, 0]\n    u: [1, 0, 0]\n    v: [0, 1, 0]\n    particles: [2, 5]\n    mass: 1\n    structural: {stiffness: 3}\n    pins: [»corner0]", &["objects[0].cloth.pins[0]", "found `corner0`", "did you mean `corner00`?"]),
    ("object, pin below 0", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\n    pins: [»-1]", &["objects[0].string.pins[0]", "a place such as 3"]),
    ("object, name twice", "objects:\n- string: {from: [0, 0, 0], to: [1, 0, 0], particles: 3, mass: 1, stiffness: 3}\n- string: »{from: [0, 0, 0], to: [1, 0, 0], particles: 3, mass: 1, stiffness: 3}", &["objects[1].string", "two objects have the name `string`"]),
    ("object, name of an index", "objects:\n- string:\n    name: »\"3\"\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3", &["objects[0].string.name", "begins with a letter"]),
    ("object, name of a particle", "objects:\n- string:\n    name: »\"a[3]\"\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3", &["objects[0].string.name", "brackets and numbers name the particles"]),
    ("object, unknown plane", "objects:\n- cloth:\n    origin: [0, 0, 0]\n    plane: »xw\n    size: [1, 1]\n    particles: [2, 5]\n    mass: 1\n    structural: {stiffness: 3}", &["objects[0].cloth.plane", "unknown plane `xw`"]),
    ("object, no plane", "objects:\n- cloth:\n    »origin: [0, 0, 0]\n    u: [1, 0, 0]\n    particles: [2, 5]\n    mass: 1\n    structural: {stiffness: 3}", &["objects[0].cloth", "expected two sides"]),
    ("object, sides on one line", "objects:\n- cloth:\n    origin: [0, 0, 0]\n    u: [1, 0, 0]\n    v: »[2, 0, 0]\n    particles: [2, 5]\n    mass: 1\n    structural: {stiffness: 3}", &["objects[0].cloth.v", "along one line"]),
    ("object, flat block", "objects:\n- lattice:\n    origin: [0, 0, 0]\n    u: [1, 0, 0]\n    v: [0, 1, 0]\n    w: »[1, 1, 0]\n    particles: [2, 2, 2]\n    mass: 1\n    structural: {stiffness: 3}", &["objects[0].lattice.w", "in one plane"]),
    ("object, clamp without direction", "objects:\n- hair:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    structural: {stiffness: 3}\n    bending: {stiffness: 1}\n    clamp: »[0, 0, 0]", &["objects[0].hair.clamp", "found a vector of length 0"]),
    ("object, named, no such object", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\nplot: {particle_id: »\"strin[1]\", dof: 0}", &["plot.particle_id", "no object has the name `strin`", "did you mean `string`?"]),
    ("object, named, beyond", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\nsprings: [{particle_ids: [0, »\"string[3]\"], stiffness: 1}]", &["springs[0].particle_ids[1]", "expected one of string[0..2]"]),
    ("object, named, no particle", "objects:\n- string:\n    from: [0, 0, 0]\n    to: [1, 0, 0]\n    particles: 3\n    mass: 1\n    stiffness: 3\nsprings: [{particle_ids: [»\"string\", 1], stiffness: 1}]", &["springs[0].particle_ids[0]", "expected a particle, found the text `string`"]),
    // Driven particles.
    ("driven, none", "driven: [»1]", &["driven[0]", "expected a motion: a mapping with `particle_id` and one of"]),
    ("driven, no particle", "driven: [»{velocity: [1, 0, 0]}]", &["driven[0].particle_id", "missing", "say which particle it moves"]),
    ("driven, no motion", "driven: [»{particle_id: 0}]", &["driven[0]", "expected one of `sine`, `velocity` and `table`, found none"]),
    ("driven, two motions", "driven: [»{particle_id: 0, velocity: [1, 0, 0], table: [[0,0,0,0],[1,0,0,0]]}]", &["driven[0]", "found velocity and table"]),
    ("driven twice", "driven: [{particle_id: 0, velocity: [1, 0, 0]}, {particle_id: »0, velocity: [0, 1, 0]}]", &["driven[1].particle_id", "particle 0 has two motions", "keep one"]),
    ("driven but free", "driven: [{particle_id: »1, velocity: [1, 0, 0]}]", &["driven[0].particle_id", "expected a fixed particle, found that 1 is free", "add `fixed: true`"]),
    ("driven, unknown", "driven: [{particle_id: »2, velocity: [1, 0, 0]}]", &["driven[0].particle_id", "expected a particle from 0 to 1, found 2"]),
    ("driven, half an id", "driven: [{particle_id: »0.5, velocity: [1, 0, 0]}]", &["driven[0].particle_id", "found 0.5", "whole numbers"]),
    ("driven, two numbers", "driven: [{particle_id: 0, velocity: »[1, 0]}]", &["driven[0].velocity", "expected a list of 3 numbers, found 2"]),
    ("driven, infinite", "driven: [{particle_id: 0, velocity: [1, 0, ».inf]}]", &["driven[0].velocity[2]", "a finite number (m/s)"]),
    ("sine without omega", "driven: [{particle_id: 0, sine: »{amplitude: [1, 0, 0]}}]", &["driven[0].sine.omega", "missing", "rad/s"]),
    ("sine with a frequency", "driven: [{particle_id: 0, sine: {amplitude: [1, 0, 0], »frequency: 1}}]", &["driven[0].sine", "unknown key `frequency`", "amplitude, omega, phase"]),
    ("sine, too fast", "driven: [{particle_id: 0, sine: {amplitude: [1, 0, 0], omega: »1e13}}]", &["driven[0].sine.omega", "at most 1e12 (rad/s)"]),
    ("table of one row", "driven: [{particle_id: 0, table: »[[0, 0, 0, 0]]}]", &["driven[0].table", "expected two rows or more, found 1"]),
    ("table, empty", "driven: [{particle_id: 0, table: »[]}]", &["driven[0].table", "expected two rows or more, found 0", "a list of 4 numbers"]),
    ("table, rows nearer than any speed", "driven: [{particle_id: 0, table: [[0, 0, 0, 0], »[1e-320, 1, 0, 0]]}]", &["driven[0].table[1]", "at most 1e12 m/s and 1e36 m/s²", "too near in time"]),
    ("table, rows of no finite acceleration", "driven: [{particle_id: 0, table: [[0, 0, 0, 0], »[1e-30, 0, 1e-20, 0], [2e-30, 0, 0, 0]]}]", &["driven[0].table[1]", "at most 1e12 m/s and 1e36 m/s²"]),
    ("table, too fast", "driven: [{particle_id: 0, table: [[0, 0, 0, 0], »[0.5, 0, 0, -1e12]]}]", &["driven[0].table[1]", "at most 1e12 m/s"]),
    ("electron's thousandth of a billionth", "particles: [{pos: [0, 0, 0], mass: »9.1e-43}]", &["particles[0].mass", "at least 1e-40 (kg)"]),
    ("table, short row", "driven: [{particle_id: 0, table: [[0, 0, 0, 0], »[1, 0, 0]]}]", &["driven[0].table[1]", "expected a list of 4 numbers, found 3"]),
    ("table of numbers", "driven: [{particle_id: 0, table: [»0, 1, 2, 3]}]", &["driven[0].table[0]", "expected a list of 4 numbers"]),
    ("table that does not ascend", "driven: [{particle_id: 0, table: [[0, 0, 0, 0], [1, 0, 0, 0], »[1, 1, 0, 0]]}]", &["driven[0].table[2]", "expected a time after 1.0 s, found 1.0", "in the order of their times"]),
    // Solver.
    ("no type", "solver: »{timestep: 0.1}", &["solver.type", "missing", "symplectic_euler"]),
    ("no timestep", "solver: »{type: rk4}", &["solver.timestep", "missing"]),
    ("unknown integrator", "solver: {type: »rk5, timestep: 0.1}", &["solver.type", "unknown integrator `rk5`", "explicit_euler, symplectic_euler, midpoint, rk4", "did you mean `rk4`?"]),
    ("far from any integrator", "solver: {type: »magic, timestep: 0.1}", &["unknown integrator `magic`", "expected one of"]),
    ("type is a list", "solver: {type: »[rk4], timestep: 0.1}", &["solver.type", "expected text", "found a list"]),
    ("type is a number", "solver: {type: »4, timestep: 0.1}", &["expected text", "found the number `4`"]),
    ("timestep 0", "solver: {type: rk4, timestep: »0}", &["expected a positive number (s), found 0"]),
    ("timestep negative", "solver: {type: rk4, timestep: »-0.1}", &["expected a positive number (s), found -0.1"]),
    ("timestep .nan", "solver: {type: rk4, timestep: ».nan}", &["expected a finite number (s), found NaN"]),
    ("timestep above the duration", "duration: 2\nsolver: {type: rk4, timestep: »2.5}", &["expected at most the duration (2.0 s), found 2.5"]),
    ("timestep above the default duration", "solver: {type: rk4, timestep: »6}", &["expected at most the duration (5.0 s)"]),
    ("too many steps", "duration: 100\nsolver: {type: rk4, timestep: »1e-8}", &["at most 1e9 steps", "larger steps"]),
    ("underflowing timestep", "solver: {type: rk4, timestep: »1e-400}", &["expected a positive number"]),
    ("tiny timestep", "solver: {type: rk4, timestep: »1e-40}", &["at least 1e-30"]),
    ("gravity infinite", "solver: {type: rk4, timestep: 0.1, gravity: »-.inf}", &["solver.gravity", "finite"]),
    ("gravity of two numbers", "solver: {type: rk4, timestep: 0.1, gravity: »[0, -9.81]}", &["solver.gravity", "expected [x, y, z] or a list of such vectors, found 2 numbers"]),
    ("gravity of nothing", "solver: {type: rk4, timestep: 0.1, gravity: »[]}", &["solver.gravity", "found an empty list"]),
    ("gravity of both", "solver: {type: rk4, timestep: 0.1, gravity: »[[0, 0, 1], 2]}", &["solver.gravity", "found numbers beside vectors"]),
    ("gravity too large in one vector", "solver: {type: rk4, timestep: 0.1, gravity: [[0, 0, 1], [0, »1e13, 0]]}", &["solver.gravity[1][1]", "at most 1e12 (m/s²)"]),
    ("gravity of a short vector", "solver: {type: rk4, timestep: 0.1, gravity: [»[0, 1]]}", &["solver.gravity[0]", "a list of 3 numbers, found 2"]),
    ("gravity with text", "solver: {type: rk4, timestep: 0.1, gravity: [0, 0, »g]}", &["solver.gravity[2]", "expected a number, found the text `g`"]),
    ("gravity is a mapping", "solver: {type: rk4, timestep: 0.1, gravity: »{z: -9.81}}", &["expected a number, [x, y, z] or a list of vectors, found a mapping"]),
    ("tolerance 0", "solver: {type: rk4, timestep: 0.1, tolerance: »0}", &["solver.tolerance", "positive"]),
    ("solver is a list", "solver: »[rk4]", &["solver", "expected a mapping with `type` and `timestep`, found a list"]),
    ("solver is text", "solver: »rk4", &["found the text \"rk4\""]),
    // The scene as a whole.
    ("duration 0", "duration: »0", &["duration", "positive"]),
    ("duration infinite", "duration: ».inf", &["finite"]),
    ("up", "up: »w", &["unknown choice `w`", "expected one of z, x, y"]),
    ("damping model", "damping_model: »isotropc", &["did you mean `isotropic`?"]),
    ("empty name", "name: »''", &["name", "expected a name"]),
    ("escape sequence in a message", "duration: »\"\\e[2J\"", &["the text `\u{fffd}[2J`"]),
    ("name with control characters", "name: »\"a\\e[2J\"", &["name", "control"]),
    ("name is a number", "name: »12", &["in quotes"]),
    ("description with control characters", "description: »\"a\\e[2J\"", &["description", "control"]),
    // Particles.
    ("no particles", "particles: »[]", &["particles", "at least one particle"]),
    ("all fixed", "particles: »[{pos: [0, 0, 0], fixed: true}]", &["at least one free particle"]),
    ("all fixed, block", "particles:\n»- {pos: [0, 0, 0], fixed: true}\n- {pos: [0, 0, 0], fixed: true}", &["at least one free particle"]),
    ("particles is a mapping", "particles: »{pos: [0, 0, 0]}", &["expected a list, found a mapping"]),
    ("particle is null", "particles: [»~]", &["particles[0]", "found nothing"]),
    ("particle is a list", "particles: [»[0, 0, 0]]", &["expected a particle", "found a list"]),
    ("no pos", "particles: [»{mass: 1}]", &["particles[0].pos", "missing"]),
    ("pos of two", "particles: [{pos: »[0, 1], mass: 1}]", &["particles[0].pos", "a list of 3 numbers, found 2"]),
    ("pos of four", "particles: [{pos: »[0, 1, 2, 3], mass: 1}]", &["a list of 3 numbers, found 4"]),
    ("pos is a number", "particles: [{pos: »7, mass: 1}]", &["expected a list of 3 numbers, found the number `7`"]),
    ("pos with a hole", "particles: [{pos: [0, »~, 2], mass: 1}]", &["particles[0].pos[1]", "expected a number, found nothing"]),
    ("pos with text", "particles: [{pos: [0, »x, 2], mass: 1}]", &["expected a number, found the text `x`", "such as 2, 2.5 or 1e-3"]),
    ("pos infinite", "particles: [{pos: [0, 1, ».inf], mass: 1}]", &["particles[0].pos[2]", "finite"]),
    ("pos far away", "particles: [{pos: [0, »1e150, 2], mass: 1}]", &["at most 1e12"]),
    ("vel NaN", "particles: [{pos: [0, 1, 2], vel: [».nan, 0, 0], mass: 1}]", &["particles[0].vel[0]", "finite"]),
    ("moving but fixed", "particles: [{pos: [0, 1, 2], vel: »[1, 0, 0], fixed: true}]", &["no velocity on a fixed particle", "remove `vel`"]),
    ("fixed in quotes", "particles: [{pos: [0, 1, 2], mass: 1, fixed: »'true'}]", &["expected true or false, found the text `true`", "without quotes"]),
    ("fixed is yes", "particles: [{pos: [0, 1, 2], mass: 1, fixed: »yes}]", &["write true or false"]),
    ("fixed is 1", "particles: [{pos: [0, 1, 2], mass: 1, fixed: »1}]", &["expected true or false, found the number `1`"]),
    ("no mass", "particles: [»{pos: [0, 1, 2]}]", &["particles[0].mass", "missing", "free particle"]),
    ("mass 0", "particles: [{pos: [0, 1, 2], mass: »0}]", &["particles[0].mass", "expected a positive number (kg), found 0"]),
    ("mass 0 on a fixed one", "particles: [{pos: [0, 1, 2], fixed: true, mass: »0.}]", &["positive number (kg), found 0.0"]),
    ("mass negative", "particles:\n  - pos: [0, 1, 2]\n    mass: »-2", &["positive number (kg), found -2"]),
    ("mass NaN", "particles: [{pos: [0, 1, 2], mass: ».nan}]", &["finite number (kg), found NaN"]),
    ("mass infinite", "particles: [{pos: [0, 1, 2], mass: ».inf}]", &["finite number (kg), found inf"]),
    ("mass huge", "particles: [{pos: [0, 1, 2], mass: »1e200}]", &["at most 1e30"]),
    ("mass beyond a double", "particles: [{pos: [0, 1, 2], mass: »1e400}]", &["too large for a double"]),
    ("mass in quotes", "particles: [{pos: [0, 1, 2], mass: »\"2\"}]", &["expected a number, found the text `2`", "remove the quotes"]),
    ("mass octal or not", "particles: [{pos: [0, 1, 2], mass: »010}]", &["the text `010`", "a leading zero can mean octal: write 10, or 0o10"]),
    ("mass with a comma", "particles:\n- pos: [0, 1, 2]\n  mass: »0,5", &["a point, not a comma"]),
    ("mass with a unit", "particles: [{pos: [0, 1, 2], mass: »2 kg}]", &["the text `2 kg`"]),
    ("mass is true", "particles: [{pos: [0, 1, 2], mass: »true}]", &["expected a number, found boolean `true`"]),
    ("mass is a list", "particles: [{pos: [0, 1, 2], mass: »[1]}]", &["expected a number, found a list"]),
    ("mass with a tag", "particles: [{pos: [0, 1, 2], mass: »!kg 2}]", &["found a value with a YAML tag"]),
    ("radius negative", "particles: [{pos: [0, 1, 2], mass: 1, radius: »-1}]", &["particles[0].radius", "at least 0 (m), found -1"]),
    ("drag negative", "particles: [{pos: [0, 1, 2], mass: 1, drag: »-1}]", &["particles[0].drag", "at least 0 (N s/m), found -1"]),
    ("the alias's definition", "particles:\n- {pos: [0, 0, 0], mass: »&m -1}\n- {pos: [0, 0, 0], mass: *m}", &["particles[0].mass"]),
    ("unknown anchor", "particles: [»*nobody]", &["not valid YAML: unknown anchor"]),
    // Springs.
    ("no ends", "springs: [»{stiffness: 1}]", &["springs[0].particle_ids", "missing"]),
    ("three ends", "springs: [{particle_ids: »[0, 1, 2], stiffness: 1}]", &["a list of 2 numbers, found 3"]),
    ("missing particle", "springs: [{particle_ids: [0, »7], stiffness: 1}]", &["springs[0].particle_ids[1]", "a particle from 0 to 1, found 7", "count from 0"]),
    ("id negative", "springs: [{particle_ids: [»-1, 0], stiffness: 1}]", &["particle_ids[0]", "found -1"]),
    ("id with a fraction", "springs: [{particle_ids: [0, »0.5], stiffness: 1}]", &["found 0.5", "whole numbers"]),
    ("id as a float", "springs: [{particle_ids: [0, »1.0], stiffness: 1}]", &["found 1.0", "whole numbers"]),
    ("id beyond any", "springs: [{particle_ids: [0, »99999999999999999999], stiffness: 1}]", &["a particle from 0 to 1"]),
    ("onto itself", "springs: [{particle_ids: »[1, 1], stiffness: 1}]", &["two different particles, found 1 twice"]),
    ("no stiffness", "springs: [»{particle_ids: [0, 1]}]", &["springs[0].stiffness", "missing"]),
    ("stiffness without value", "springs:\n- particle_ids: [0, 1]\n  stiffness:»", &["springs[0].stiffness", "missing"]),
    ("stiffness negative", "springs: [{particle_ids: [0, 1], stiffness: »-5}]", &["springs[0].stiffness", "at least 0 (N/m), found -5"]),
    ("cubic negative", "springs: [{particle_ids: [0, 1], stiffness: 1, cubic: »-2}]", &["springs[0].cubic", "at least 0 (N/m³), found -2"]),
    ("cubic infinite", "springs: [{particle_ids: [0, 1], stiffness: 1, cubic: ».inf}]", &["springs[0].cubic", "finite number (N/m³)"]),
    ("cubic alone", "springs: [»{particle_ids: [0, 1], cubic: 2}]", &["springs[0].stiffness", "missing"]),
    ("damping negative", "springs: [{particle_ids: [0, 1], stiffness: 1, damping: »-1e-9}]", &["springs[0].damping", "found -1e-9"]),
    ("rest length negative", "springs: [{particle_ids: [0, 1], stiffness: 1, rest_length: »-0.1}]", &["springs[0].rest_length", "at least 0 (m)"]),
    ("the eighth", "springs:\n- &s {particle_ids: [0, 1], stiffness: 1}\n- *s\n- *s\n- {particle_ids: [0, 1], stiffness: ».inf}", &["springs[3].stiffness"]),
    // Hinges.
    ("hinge of two", "bending: [{particle_ids: »[0, 1], stiffness: 1}]", &["bending[0].particle_ids", "a list of 3 numbers, found 2"]),
    ("hinge of nobody", "bending: [{particle_ids: [0, 1, »2], stiffness: 1}]", &["bending[0].particle_ids[2]", "a particle from 0 to 1, found 2"]),
    ("hinge of one twice", "bending: [{particle_ids: »[0, 1, 0], stiffness: 1}]", &["bending[0].particle_ids", "three different particles, found 0 twice"]),
    ("hinge without stiffness", "bending: [»{particle_ids: [0, 1, 2]}]", &["bending[0].stiffness", "missing", "N m/rad"]),
    ("hinge of negative stiffness", "bending: [{particle_ids: [0, 1, 2], stiffness: »-1}]", &["bending[0].stiffness", "at least 0 (N m/rad), found -1"]),
    ("hinge bent beyond a half turn", "bending: [{particle_ids: [0, 1, 2], stiffness: 1, rest_angle: »3.2}]", &["bending[0].rest_angle", "rad", "found 3.2"]),
    ("hinge bent the other way", "bending: [{particle_ids: [0, 1, 2], stiffness: 1, rest_angle: »-0.1}]", &["bending[0].rest_angle", "at least 0 (rad)"]),
    ("hinge that feeds", "bending: [{particle_ids: [0, 1, 2], stiffness: 1, damping: »-1}]", &["bending[0].damping", "at least 0 (N m s/rad)"]),
    ("hinge with a link of no length", "particles: [{pos: [0, 0, 0], mass: 1}, {pos: [1, 0, 0], mass: 1}, {pos: [1, 0, 0], mass: 1}]\nbending: [{particle_ids: »[0, 1, 2], stiffness: 1}]", &["bending[0].particle_ids", "1 and 2 in one place", "two directions"]),
    ("hinge of three in one place", "particles: [{pos: [1, 0, 0], mass: 1}, {pos: [1, 0, 0], mass: 1}, {pos: [1, 0, 0], mass: 1}]\nbending: [{particle_ids: »[0, 1, 2], stiffness: 1}]", &["bending[0].particle_ids", "0 and 1 in one place"]),
    // Pairs, wind, plot.
    ("G infinite", "gravitational: [{particle_ids: [0, 1], G: ».inf}]", &["gravitational[0].G", "finite"]),
    ("no G", "gravitational: [»{particle_ids: [0, 1]}]", &["gravitational[0].G", "missing"]),
    ("g in small", "gravitational: [{particle_ids: [0, 1], »g: 1}]", &["did you mean `G`?"]),
    ("attraction by no mass", "gravitational: [{particle_ids: »[1, 0], G: 1}]", &["gravitational[0].particle_ids", "0 states none", "add `mass`"]),
    ("attraction at no distance", "particles: [{pos: [0, 0, 1], mass: 1}, {pos: [0, 0, 1], mass: 1}]\ngravitational: [{particle_ids: »[0, 1], G: 1}]", &["two particles apart", "infinite at distance 0"]),
    ("wind without length", "wind: {direction: »[0, 0, 0], strength: 1}", &["wind.direction", "length 0"]),
    ("wind without strength", "wind: »{direction: [0, 0, 1]}", &["wind.strength", "missing"]),
    ("wind of NaN", "wind: {direction: [0, 0, 1], strength: ».NaN}", &["wind.strength", "finite"]),
    // Air and triangles.
    ("quadratic drag negative", "particles: [{pos: [0, 1, 2], mass: 1, quadratic_drag: »-1}]", &["particles[0].quadratic_drag", "at least 0 (N s²/m²), found -1"]),
    ("density negative", "air: {density: »-1.2}", &["air.density", "at least 0 (kg/m³), found -1.2"]),
    ("velocity of the air of NaN", "air: {velocity: [0, ».nan, 0]}", &["air.velocity[1]", "finite number (m/s)"]),
    ("velocity of the air in one number", "air: {velocity: »3}", &["air.velocity", "a list of 3 numbers"]),
    ("air with an unknown key", "air: {»speed: 3}", &["air", "unknown key `speed`"]),
    ("air drag negative", "particles: [{pos: [0, 0, 0], mass: 1}, {pos: [1, 0, 0], mass: 1}, {pos: [0, 1, 0], mass: 1}]\ntriangles: [{particle_ids: [0, 1, 2], air_drag: »-1}]", &["triangles[0].air_drag", "at least 0 (a pure number), found -1"]),
    ("triangle without drag", "triangles: [»{particle_ids: [0, 1, 2]}]", &["triangles[0].air_drag", "missing", "as 1.0"]),
    ("triangle without corners", "triangles: [»{air_drag: 1}]", &["triangles[0].particle_ids", "missing"]),
    ("triangle of two corners", "triangles: [{particle_ids: »[0, 1], air_drag: 1}]", &["a list of 3 numbers, found 2"]),
    ("triangle of nobody", "triangles: [{particle_ids: [0, 1, »7], air_drag: 1}]", &["triangles[0].particle_ids[2]", "a particle from 0 to 1, found 7"]),
    ("triangle with a corner twice", "triangles: [{particle_ids: »[0, 1, 0], air_drag: 1}]", &["triangles[0].particle_ids", "three different particles, found 0 twice"]),
    ("triangle without an area", "particles: [{pos: [0, 0, 0], mass: 1}, {pos: [0.1, 0.2, 0.3], mass: 1}, {pos: [0.3, 0.6, 0.9], mass: 1}]\ntriangles: [{particle_ids: »[0, 1, 2], air_drag: 1}]", &["triangles[0].particle_ids", "three corners apart, found them on one line", "needs an area"]),
    ("triangle with two corners in one place", "particles: [{pos: [0, 0, 0], mass: 1}, {pos: [1, 0, 0], mass: 1}, {pos: [0, 0, 0], mass: 1}]\ntriangles: [{particle_ids: »[0, 1, 2], air_drag: 1}]", &["triangles[0].particle_ids", "three corners apart, found 0 and 2 in one place", "needs an area"]),
    ("strain limit as a number", "strain_limit: »0.1", &["strain_limit", "expected a mapping such as {ratio: 0.1}"]),
    ("strain limit negative", "strain_limit: {ratio: »-0.1}", &["strain_limit.ratio", "at least 0 (a part of the rest length), found -0.1"]),
    ("strain limit of NaN", "strain_limit: {ratio: ».nan}", &["strain_limit.ratio", "finite number (a part of the rest length)"]),
    ("strain limit without sweeps", "strain_limit: {iterations: »0}", &["strain_limit.iterations", "a positive number (sweeps), found 0"]),
    ("strain limit of half a sweep", "strain_limit: {iterations: »2.5}", &["strain_limit.iterations", "expected a whole number, found 2.5"]),
    ("strain limit of too many sweeps", "strain_limit: {iterations: »2000000}", &["strain_limit.iterations", "at most 1e6 (sweeps)"]),
    ("compression as a number", "strain_limit: {also_compression: »1}", &["strain_limit.also_compression", "expected true or false"]),
    ("strain limit without springs", "strain_limit: »{ratio: 0.1}", &["strain_limit", "expected a spring to limit, with a rest length and a free end, found none"]),
    ("strain limit of springs without rest length", "springs: [{particle_ids: [0, 1], stiffness: 1, rest_length: 0}]\nstrain_limit: »{}", &["strain_limit", "expected a spring to limit"]),
    ("strain limit with an unknown key", "strain_limit: {»limit: 0.1}", &["strain_limit", "unknown key `limit`"]),
    ("field without numbers", "magnetic: »{}", &["magnetic.field", "missing", "in tesla"]),
    ("field of two", "magnetic: {field: »[0, 1]}", &["magnetic.field", "a list of 3 numbers, found 2"]),
    ("field as a number", "magnetic: {field: »3}", &["magnetic.field", "a list of 3 numbers"]),
    ("field of NaN", "magnetic: {field: [0, 0, ».nan]}", &["magnetic.field", "finite number (T)"]),
    ("field of another name", "magnetic: {»B: [0, 0, 1]}", &["magnetic", "unknown key `B`"]),
    ("charge infinite", "particles: [{pos: [0, 0, 1], mass: 1, charge: ».inf}]", &["particles[0].charge", "finite number (C)"]),
    ("plot of nobody", "plot: {particle_id: »2, dof: 0}", &["plot.particle_id", "a particle from 0 to 1"]),
    ("plot of a fourth dimension", "plot: {particle_id: 0, dof: »3}", &["plot.dof", "0, 1 or 2, found 3"]),
    ("plot upside down", "plot: {particle_id: 0, dof: 0, y_range: »[1, -1]}", &["plot.y_range", "[lower, upper]"]),
    // Expectations.
    ("expect is a list", "expect: »[rk4]", &["expect", "expected a mapping such as {status: completed}, found a list"]),
    ("unknown engine", "expect:\n  rk4: {status: completed}\n  »rapeir: {status: completed}", &["expect: unknown engine `rapeir`", "did you mean `rapier`?"]),
    ("unknown engine, far from any", "expect: {»bullet: {status: completed}}", &["unknown engine `bullet`", "the engines here are all, rest, explicit_euler", "rapier-converged"]),
    ("engine twice", "expect:\n  rk4: {status: completed}\n  »rk4: {energy.class: bounded}", &["expect.rk4", "given twice"]),
    ("nothing of an engine", "expect: {rk4: »{}}", &["expect.rk4", "at least one key", "{status: completed}"]),
    ("no value of an engine", "expect: {rk4: »~}", &["expect.rk4", "expected a mapping such as {status: completed}, found nothing"]),
    ("a word for an engine", "expect: {rk4: »completed}", &["expect.rk4", "expected a mapping"]),
    ("unknown expected key", "expect: {rk4: {status: completed, »energy.clas: bounded}}", &["expect.rk4: unknown key `energy.clas`", "did you mean `energy.class`?"]),
    ("half a key", "expect: {rk4: {»energy: bounded}}", &["expect.rk4: unknown key `energy`", "the keys here are status, stopped_at_s, reason"]),
    ("nested instead of dotted", "expect: {rk4: {energy: {»class: bounded}}}", &["expect.rk4.energy", "unknown key `class`"]),
    ("expected key twice", "expect: {all: {status: completed, »status: failed}}", &["expect.all.status", "given twice"]),
    ("deviation from no reference", "expect: {rk4: {»deviation_m.rk4.max: {below: 1}}}", &["unknown key `deviation_m.rk4.max`"]),
    ("expected wall time", "expect: {rk4: {»work.wall_s.min: {below: 1}}}", &["unknown key `work.wall_s.min`"]),
    ("unknown status", "expect: {rk4: {status: »complete}}", &["expect.rk4.status", "unknown word `complete`", "completed, diverged, failed, unsupported", "did you mean `completed`?"]),
    ("unknown class in a list", "expect: {rk4: {energy.class: [bounded, »shrinking]}}", &["expect.rk4.energy.class[1]", "unknown word `shrinking`"]),
    ("word twice", "expect: {rk4: {energy.class: [bounded, »bounded]}}", &["expect.rk4.energy.class[1]", "given twice"]),
    ("no words", "expect: {rk4: {status: »[]}}", &["expect.rk4.status", "at least one word"]),
    ("unknown scheme", "expect: {rk4: {identified.method: »rk44}}", &["unknown word `rk44`", "did you mean `rk4`?"]),
    ("bounds of a word", "expect: {rk4: {status: »{below: 3}}}", &["expect.rk4.status", "expected completed or diverged", "found bounds"]),
    ("a word for a number", "expect: {rk4: {energy.drift_per_s: »small}}", &["expect.rk4.energy.drift_per_s", "expected `below` or `above`"]),
    ("a number for bounds", "expect: {rk4: {work.steps: »100}}", &["expect.rk4.work.steps", "bounds such as {below: 1e-3}, found the number `100`"]),
    ("no value of a key", "expect: {rk4: {status: »~}}", &["expect.rk4.status", "expected a word", "found nothing"]),
    ("no bounds", "expect: {rk4: {work.steps: »{}}}", &["expect.rk4.work.steps", "found neither"]),
    ("unknown bound", "expect: {rk4: {work.steps: {»blow: 3}}}", &["expect.rk4.work.steps", "unknown key `blow`", "did you mean `below`?"]),
    ("bound twice", "expect: {rk4: {work.steps: {below: 3, »below: 4}}}", &["expect.rk4.work.steps.below", "given twice"]),
    ("bound of NaN", "expect: {rk4: {energy.drift_per_s: {below: ».nan}}}", &["expect.rk4.energy.drift_per_s.below", "finite", "found NaN"]),
    ("bound infinite", "expect: {rest: {energy.drift_per_s: {above: »-.inf}}}", &["expect.rest.energy.drift_per_s.above", "finite"]),
    ("bound in quotes", "expect: {rk4: {energy.drift_per_s: {below: »'3'}}}", &["expected a number", "remove the quotes"]),
    ("bounds that leave nothing", "expect: {rk4: {work.steps: »{above: 3, below: 3}}}", &["expect.rk4.work.steps", "no number is above 3.0 and below 3.0"]),
    ("contains on a number", "expect: {rk4: {work.steps: {below: 3, »contains: a}}}", &["expect.rk4.work.steps", "`contains` is for text"]),
    ("below on a text", "expect: {rk4: {reason: {contains: a, »below: 3}}}", &["expect.rk4.reason", "`below` is for numbers"]),
    ("a word for a text", "expect: {rk4: {reason: »exploded}}", &["expect.rk4.reason", "expected `contains`"]),
    ("contains nothing", "expect: {rk4: {reason: {contains: »' '}}}", &["expect.rk4.reason.contains", "expected some text"]),
    ("text of no bounds", "expect: {rk4: {reason: »{}}}", &["expect.rk4.reason", "expected `contains`"]),
    ("merge in expect", "expect: {»<<: {rk4: {status: completed}}}", &["expect", "merge keys"]),
    ("plot without height", "plot: {particle_id: 0, dof: 0, y_range: »[1, 1]}", &["plot.y_range"]),
];

/// As they stand.
#[rustfmt::skip]
const WHOLES: &[Row] = &[
    ("empty", "»", &["no scene", "solver", "particles"]),
    ("only a comment", "»# nothing\n", &["no scene"]),
    ("null", "»~\n", &["no scene"]),
    ("missing solver", "# a scene\n»particles: [{pos: [0, 0, 0], mass: 1}]", &["solver", "missing", "add `solver:"]),
    ("missing particles", "»solver: {type: rk4, timestep: 0.1}", &["particles", "missing"]),
    ("a list", "»- a\n- b", &["expected a scene", "found a list"]),
    ("text", "»hello world", &["expected a scene", "found the text \"hello world\""]),
    ("not YAML", "solver: {type: rk4\nparticles»: []", &["not valid YAML"]),
    ("a colon in text", "description: one»: two", &["not valid YAML", "needs quotes"]),
    ("a tab", "solver:\n»\ttype: rk4", &["not valid YAML", "spaces, not with tabs"]),
    ("control character", "name: a»\u{1}b", &["U+0001"]),
    ("second BOM", "name: »\u{feff}b", &["U+FEFF"]),
    ("second document", "solver: {type: rk4, timestep: 0.1}\nparticles: [{pos: [0, 0, 0], mass: 1}]\n---\n»solver: {}", &["second YAML document", "one scene"]),
    ("rubbish after the document", "solver: {type: rk4, timestep: 0.1}\nparticles: [{pos: [0, 0, 0], mass: 1}]\n»}", &["not valid YAML"]),
    ("alias bomb", "»a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\n", &["unknown key `a`"]),
    ("alias to itself", "particles: »&p [*p, *p]", &["found a list"]),
    ("CRLF", "name: a\r\n»colour: red\r\n", &["unknown key `colour`"]),
    ("past an umlaut", "{name: äöü, »colour: red}", &["unknown key `colour`"]),
];

fn refused(text: &str) -> SceneError {
    match parse(text) {
        Err(error) => error,
        Ok(scene) => panic!("accepted: {scene:?}\n{text}"),
    }
}

/// Line and column of the mark, from 1, and the text without it.
fn unmark(text: &str) -> (u32, u32, String) {
    let at = text.find('»').expect("a mark");
    let line = text[..at].matches('\n').count() + 1;
    let column = text[..at].rsplit('\n').next().unwrap().chars().count() + 1;
    (line as u32, column as u32, text.replace('»', ""))
}

fn judge(rows: &[Row], prepare: impl Fn(&str) -> String) {
    for (title, marked, expected) in rows {
        let (line, column, text) = unmark(marked);
        let error = refused(&prepare(&text));
        let shown = error.to_string();
        let place = (error.line, error.column);
        assert_eq!(place, (Some(line), Some(column)), "{title}\n{shown}");
        let start = format!("scenes/test.yml:{line}:{column}: ");
        assert!(
            shown.starts_with(&start),
            "{title}: should begin with {start}\n{shown}"
        );
        for part in *expected {
            assert!(
                shown.contains(part),
                "{title}: should say {part:?}\n{shown}"
            );
        }
        let source = text.split('\n').nth(line as usize - 1).unwrap().trim();
        let source = source.replace(char::is_control, "\u{fffd}");
        assert!(
            shown.contains(&source),
            "{title}: should show {source:?}\n{shown}"
        );
    }
}

#[test]
fn bad_parts_are_refused_at_their_place() {
    judge(PARTS, complete);
    judge(rods::REFUSED, complete);
    judge(colliders::REFUSED, complete);
}

#[test]
fn bad_files_are_refused_at_their_place() {
    judge(WHOLES, str::to_owned);
}

#[test]
fn a_caret_stands_under_the_value() {
    let error = refused(&complete(
        "springs:\n  - {particle_ids: [0, 1], stiffness: -5}",
    ));
    let expected = "\
scenes/test.yml:2:39: springs[0].stiffness: expected a number of at least 0 (N/m), found -5
  |
2 |   - {particle_ids: [0, 1], stiffness: -5}
  |                                       ^^";
    assert_eq!(error.to_string(), expected);
}

#[test]
fn long_lines_are_cut_around_the_place() {
    let text = format!(
        "particles: [{}{{pos: [0, 0, 0], mass: -1}}]",
        "{pos: [0, 0, 0], mass: 1}, ".repeat(5000)
    );
    let error = refused(&complete(&text));
    assert_eq!(error.column, Some(135_036));
    let shown = error.to_string();
    assert!(shown.contains("mass: -1}"), "{shown}");
    assert!(shown.len() < 500, "{shown}");
}

#[test]
fn bytes_that_are_not_utf8_have_a_place() {
    let error = scene::parse(b"name: a\nup: \xff", "x.yml", &NAMES).unwrap_err();
    assert_eq!((error.line, error.column), (Some(2), Some(5)));
    assert!(error.to_string().contains("UTF-8"), "{error}");
}

/// Attacks answer within a second; the machine may be slow and the build unoptimised, so ten.
#[test]
fn hostile_files_are_refused_soon() {
    const DEEP: usize = 100_000;
    let attacks = [
        "{a: ".repeat(DEEP),
        "[".repeat(DEEP),
        "- ".repeat(DEEP),
        "? ".repeat(DEEP),
        ": ".repeat(DEEP),
        "!a ".repeat(DEEP),
        format!("name: {}", "{a: ".repeat(DEEP)),
        format!("description: |\n  \"\nname: {}", "{a: ".repeat(DEEP)),
        format!("# [\nname: \"[\" # [\n{}", "[".repeat(DEEP)),
        (0..500).map(|i| format!("{}a:\n", " ".repeat(i))).collect(),
        format!(
            "particles:\n- &p {{pos: [0, 0, 0], mass: 1}}\n{}",
            "- *p\n".repeat(20_000)
        ),
        // Entries of aliased keys, engines and words would multiply.
        format!(
            "expect:\n  all: &a {{{}}}\n{}",
            (0..DEEP).map(|i| format!("a{i}: b, ")).collect::<String>(),
            (0..DEEP)
                .map(|i| format!("  b{i}: *a\n"))
                .collect::<String>()
        ),
        format!(
            "description: &n \"{}\"\nexpect: {{rk4: {{status: [{}]}}}}",
            "x".repeat(DEEP),
            "*n, ".repeat(DEEP)
        ),
        format!("expect: {{{}: {{}}}}", "x".repeat(DEEP)),
        format!(
            "expect: {{rk4: {{status: [{}]}}}}",
            "completed, ".repeat(DEEP)
        ),
        format!(
            "name: &n \"{}\"\nparticles: [{}]",
            "x".repeat(DEEP),
            "*n, ".repeat(10_000)
        ),
    ];
    for attack in attacks {
        let start = Instant::now();
        let error = refused(&attack);
        assert!(
            start.elapsed() < Duration::from_secs(10),
            "{:?}: {error}",
            start.elapsed()
        );
        assert!(error.to_string().len() < 1000, "{error}");
    }
}

#[test]
fn files_that_cannot_be_read_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| scene::read(&folder.path().join(name), &NAMES).unwrap_err();
    assert!(read("").to_string().contains("this is a directory"));
    assert!(
        read("nowhere.yml")
            .to_string()
            .contains("nowhere.yml: there is no such file")
    );

    let big = std::fs::File::create(folder.path().join("big.yml")).unwrap();
    big.set_len(limits::FILE_BYTES as u64 + 1).unwrap();
    let error = read("big.yml");
    assert!(error.to_string().contains("at most 64 MiB"), "{error}");
    assert_eq!((error.line, error.column), (None, None));
}

//! Hinges between three particles: vibrations and shapes that are published, what happens where the angle has no
//! direction, and springs between every second particle, which are another thing.

use crate::testkit::scenes::{empty, fixed, free, spring};
use crate::testkit::{Build, Random, advance, built, distance, force, method, own, sample};
use springcheck::integrators::fixed as methods;
use springcheck::measure::stability::{Effort, Limit, Linearised};
use springcheck::physics::effects::{BendingForce, Effect, Springs};
use springcheck::physics::{Dampers, Jacobian, Linearization, System};
use springcheck::scene::{Bending, Scene};

fn hinge(particles: [usize; 3], stiffness: f64, rest_angle: f64) -> Bending {
    Bending {
        particles,
        stiffness,
        rest_angle,
        ..Bending::default()
    }
}

/// A bent molecule of two masses m on springs k of length l to a mass M in the middle.
struct Molecule {
    m: f64,
    middle: f64,
    k: f64,
    kb: f64,
    length: f64,
    turn: f64,
}

const MOLECULE: Molecule = Molecule {
    m: 0.2,
    middle: 0.5,
    k: 200.0,
    kb: 1.5,
    length: 0.4,
    turn: 1.1,
};

impl Molecule {
    fn scene(&self) -> Scene {
        let (sin, cos) = (0.5 * self.turn).sin_cos();
        let (x, z) = (self.length * cos, -self.length * sin);
        Scene {
            particles: vec![
                free([-x, 0.3, z], self.m),
                free([0.0, 0.3, 0.0], self.middle),
                free([x, 0.3, z], self.m),
            ],
            springs: [[0, 1], [1, 2]]
                .map(|ends| spring(ends, self.k, self.length))
                .to_vec(),
            bending: vec![hinge([0, 1, 2], self.kb, self.turn)],
            ..empty()
        }
    }

    /// The squares of its three frequencies, (rad/s)², ascending: Herzberg 1945, Infrared and Raman Spectra, II.4, of a
    /// molecule XY2 in valence forces. The angle between the bonds is π less the turning angle.
    fn frequencies(&self) -> [f64; 3] {
        let alpha = 0.5 * (std::f64::consts::PI - self.turn);
        let (sin, cos) = (alpha.sin().powi(2), alpha.cos().powi(2));
        let (ratio, stretch) = (2.0 * self.m / self.middle, self.k / self.m);
        let bend = 2.0 * self.kb / (self.length * self.length * self.m);
        let sum = (1.0 + ratio * cos) * stretch + (1.0 + ratio * sin) * bend;
        let root = (0.25 * sum * sum - (1.0 + ratio) * stretch * bend).sqrt();
        [
            0.5 * sum - root,
            0.5 * sum + root,
            (1.0 + ratio * sin) * stretch,
        ]
    }
}

#[test]
fn a_molecule_vibrates_as_published() {
    let (system, state) = built(&MOLECULE.scene());
    let mut jacobian = Jacobian::default();
    system.jacobian(0.0, &state.x, &state.v, Linearization::Exact, &mut jacobian);
    let weights = system.inverse_mass();
    let mut stiffness = nalgebra::DMatrix::<f64>::zeros(9, 9);
    for (row, column, value) in jacobian.position {
        stiffness[(row, column)] -= value * (weights[row] * weights[column]).sqrt();
    }
    let mut found = stiffness.symmetric_eigenvalues().as_slice().to_vec();
    found.sort_by(f64::total_cmp);
    // Six motions of the whole, of no frequency: rounding of entries up to 2,000.
    assert!(found[..6].iter().all(|w| w.abs() < 2e-11), "{found:?}");
    let published = MOLECULE.frequencies();
    // The eigenvalues of a matrix with entries of 2,000, a few eps of it: measured 4e-12.
    assert!(
        distance(&found[6..], &published) < 1e-11,
        "{found:?} {published:?}"
    );
    // The fastest enters the predicted limit.
    let about = Linearised::new(&system, &state, Effort::FULL);
    let fastest = about.omega_max().expect("it vibrates");
    assert!((fastest / published[2].sqrt() - 1.0).abs() < 1e-12);
    // Of a stiff hinge it is the bending that is the fastest.
    let stiff = Molecule {
        kb: 60.0,
        ..MOLECULE
    };
    let (system, state) = built(&stiff.scene());
    let about = Linearised::new(&system, &state, Effort::FULL);
    let Limit::At(limit) = about.predict(method("velocity_verlet"), 1e-3).limit else {
        panic!("it has a limit");
    };
    let bending = stiff.frequencies()[1].sqrt();
    assert!((0.5 * limit * bending - 1.0).abs() < 1e-12, "{limit}");
}

/// The turning force of each link of a clamped row of rigid links, N m, under a load at the tip across it: the
/// virtual work of the hinges and of the load, where only one angle changes.
fn moments(scene: &Scene, angles: &[f64], load: f64) -> Vec<f64> {
    let effect = BendingForce::new(scene).expect("hinges");
    let x = shape(angles);
    let (mut f, _) = force(&effect, &x, &vec![0.0; x.len()]);
    let n = f.len();
    f[n - 1] -= load;
    let length = 1.0 / angles.len() as f64;
    (0..angles.len())
        .map(|link| {
            // All particles beyond the link move alike.
            let (sin, cos) = angles[link].sin_cos();
            let beyond = (link + 2..angles.len() + 2)
                .map(|p| length * (f[3 * p] * sin + f[3 * p + 2] * cos));
            beyond.sum()
        })
        .collect()
}

/// Positions of a row of links that hang down by these angles from the x axis, behind one link that is clamped.
fn shape(angles: &[f64]) -> Vec<f64> {
    let length = 1.0 / angles.len() as f64;
    let mut x = vec![-length, 0.0, 0.0, 0.0, 0.0, 0.0];
    for angle in angles {
        let at = x.len() - 3;
        let (sin, cos) = angle.sin_cos();
        x.extend([x[at] + length * cos, 0.0, x[at + 2] - length * sin]);
    }
    x
}

/// How far the tip of n links hangs, of length 1 together with EI = 1, under a tip load of 1: Newton's method on the
/// angles, by differences.
fn drop(n: usize, at_clamp: f64) -> f64 {
    let kb = n as f64;
    let particles = (0..n + 2).map(|i| {
        let at = [(i as f64 - 1.0) / n as f64, 0.0, 0.0];
        if i < 2 { fixed(at) } else { free(at, 0.1) }
    });
    let hinges = (0..n).map(|i| {
        hinge(
            [i, i + 1, i + 2],
            if i == 0 { at_clamp * kb } else { kb },
            0.0,
        )
    });
    let scene = Scene {
        particles: particles.collect(),
        bending: hinges.collect(),
        ..empty()
    };
    let mut angles = vec![0.0; n];
    for _ in 0..30 {
        let off = moments(&scene, &angles, 1.0);
        let mut slopes = nalgebra::DMatrix::<f64>::zeros(n, n);
        for column in 0..n {
            let mut moved = angles.clone();
            moved[column] += 1e-7;
            for (row, there) in moments(&scene, &moved, 1.0).iter().enumerate() {
                slopes[(row, column)] = (there - off[row]) / 1e-7;
            }
        }
        let step = slopes
            .lu()
            .solve(&nalgebra::DVector::from_vec(off))
            .expect("stiff");
        for (angle, step) in angles.iter_mut().zip(step.iter()) {
            *angle -= step;
        }
    }
    -shape(&angles)[3 * (n + 1) + 2]
}

/// Published to twelve digits: hinges EI/l between links, and one of the clamp that is as stiff or twice as stiff.
#[test]
fn a_clamped_hair_hangs_as_published() {
    for (n, at_clamp, published) in [
        (8, 1.0, 0.352_204_355_308),
        (16, 1.0, 0.326_850_627_675),
        (8, 2.0, 0.303_931_679_124),
        (16, 2.0, 0.302_273_620_254),
    ] {
        // Newton's last step leaves the rounding of moments of order 1.
        let found = drop(n, at_clamp);
        assert!((found - published).abs() < 1e-12, "{n} {at_clamp}: {found}");
    }
    // Twice as stiff at the clamp it comes to the elastica's .30172077 with the square of 1/n.
    assert!((drop(16, 3.0) - 0.302_273_620_254).abs() > 1e-3);
}

/// Three particles in a plane, turning by this angle, the second link of half the length.
fn turned(angle: f64) -> Vec<f64> {
    let (sin, cos) = angle.sin_cos();
    vec![-1.0, 0.2, 0.0, 0.0, 0.2, 0.0, 0.5 * cos, 0.2, 0.5 * sin]
}

fn of_one(rest_angle: f64, damping: f64) -> BendingForce {
    let particles = [[-1.0, 0.2, 0.0], [0.0, 0.2, 0.0], [0.5, 0.2, 0.0]].map(|at| free(at, 0.5));
    let bending = vec![Bending {
        damping,
        ..hinge([0, 1, 2], 2.0, rest_angle)
    }];
    let scene = Scene {
        particles: particles.to_vec(),
        bending,
        ..empty()
    };
    BendingForce::new(&scene).expect("a hinge")
}

/// Straight with a rest angle of 0 the force is smooth: kb θ/l on the ends, to the last bits, however small the angle.
#[test]
fn the_straight_hinge_is_smooth() {
    let effect = of_one(0.0, 0.0);
    for angle in [1e-3, 1e-9, 1e-15, 1e-30, 1e-150] {
        let (f, _) = force(&effect, &turned(angle), &[0.0; 9]);
        let wanted = -2.0 * angle / 0.5;
        // sin θ for θ is below the rounding but at the first angle.
        let off = (f[8] / wanted - angle.cos()).abs();
        assert!(off < 8.0 * f64::EPSILON, "{angle:e}: {f:?}");
        assert!(
            (f[2] / (-2.0 * angle) - 1.0).abs() < 8.0 * f64::EPSILON,
            "{angle:e}: {f:?}"
        );
    }
    // Its stiffness is the same to every side: kb/l² of each end, also where it is straight to the last bit.
    for angle in [0.0, 1e-12] {
        let mut out = Jacobian::default();
        effect.add_jacobian(
            0.0,
            &turned(angle),
            &[0.0; 9],
            Linearization::Exact,
            &mut out,
        );
        for (axis, wanted) in [(0, 0.0), (1, -2.0 / 0.25), (2, -2.0 / 0.25)] {
            let of = |(row, column, value): &(usize, usize, f64)| {
                if (*row, *column) == (6 + axis, 6 + axis) {
                    *value
                } else {
                    0.0
                }
            };
            let found: f64 = out.position.iter().map(of).sum();
            assert!((found - wanted).abs() < 1e-11, "{angle:e} {axis}: {found}");
        }
    }
}

/// Where the angle has no direction there is no force, and no NaN anywhere.
#[test]
fn without_a_direction_there_is_no_force() {
    let folded = [-1.0, 0.2, 0.0, 0.0, 0.2, 0.0, -0.5, 0.2, 0.0];
    let coincident = [0.0, 0.2, 0.0, 0.0, 0.2, 0.0, 0.5, 0.2, 0.0];
    let one_place = [0.1; 9];
    let v = [0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.2, 0.6, 0.9];
    for (x, rest_angle) in [
        (turned(0.0), 0.7),
        (folded.to_vec(), 0.0),
        (folded.to_vec(), 0.7),
        (coincident.to_vec(), 0.0),
        (one_place.to_vec(), 0.7),
    ] {
        let (elastic, _) = force(&of_one(rest_angle, 0.0), &x, &v);
        assert!(elastic.iter().all(|f| *f == 0.0), "{x:?}: {elastic:?}");
        let effect = of_one(rest_angle, 0.4);
        let (f, power) = force(&effect, &x, &v);
        let mut rounding = vec![0.0; 9];
        effect.add_rounding(0.0, &x, &v, &mut rounding);
        assert!(f.iter().chain(&rounding).all(|f| f.is_finite()), "{x:?}");
        assert!(power.dissipated >= 0.0 && effect.potential(0.0, &x).is_finite());
        for kept in [
            Linearization::Exact,
            Linearization::Material,
            Linearization::Definite,
        ] {
            let mut out = Jacobian::default();
            effect.add_jacobian(0.0, &x, &v, kept, &mut out);
            assert!(
                out.position
                    .iter()
                    .chain(&out.velocity)
                    .all(|entry| entry.2.is_finite())
            );
            assert_eq!(
                (out.position.len(), out.velocity.len()),
                (81, 81),
                "the same places always"
            );
        }
    }
    // The damper of a straight hinge resists turning to any side: c v/l² at the end, with the others at rest.
    let effect = of_one(0.7, 0.4);
    for side in [1, 2] {
        let mut v = [0.0; 9];
        v[6 + side] = 0.3;
        let (f, power) = force(&effect, &turned(0.0), &v);
        assert!((f[6 + side] + 0.4 * 0.3 / 0.25).abs() < 1e-15, "{f:?}");
        assert!((power.dissipated - 0.4 * 0.36).abs() < 1e-15);
    }
}

/// Both momenta are kept, with dampers too: forces and torques add up to nothing.
#[test]
fn hinges_keep_both_momenta() {
    let mut scene = MOLECULE.scene();
    scene.bending[0].damping = 0.3;
    let effect = BendingForce::new(&scene).expect("a hinge");
    let mut random = Random(3);
    for _ in 0..5 {
        let (x, v) = sample(&scene, &mut random);
        let (f, _) = force(&effect, &x, &v);
        for axis in 0..3 {
            let sum: f64 = f.iter().skip(axis).step_by(3).sum();
            let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
            let torque: f64 = (0..3)
                .map(|p| x[3 * p + next] * f[3 * p + last] - x[3 * p + last] * f[3 * p + next])
                .sum();
            // Forces up to 10 N: a few roundings.
            assert!(
                sum.abs() < 1e-14 && torque.abs() < 1e-14,
                "{sum:e} {torque:e}"
            );
        }
    }
}

/// Of several hinges each decays by its own exponential: a sweep of one is the exact flow.
#[test]
fn a_hinges_damper_is_swept_exactly() {
    use springcheck::integrators::{DampingTreatment, Splitting, Stage};
    const KICK: &[Stage] = &[Stage::Kick(1.0)];
    for turn in [1.1, 0.0] {
        let mut scene = Molecule { turn, ..MOLECULE }.scene();
        scene
            .springs
            .iter_mut()
            .for_each(|spring| spring.rest_length *= 0.9);
        scene.bending[0].damping = 0.3;
        for (p, v) in
            scene
                .particles
                .iter_mut()
                .zip([[0.1, 0.5, -0.7], [0.4, 0.2, 0.1], [-0.3, 0.8, 0.6]])
        {
            p.velocity = v;
        }
        let (system, start) = built(&scene);
        assert_eq!(system.dampers(), Dampers::Apart);
        let kicked = |damping| {
            let mut state = start.clone();
            advance(
                &mut Splitting::new(KICK, damping),
                &system,
                0.1,
                1,
                &mut state,
            );
            state
        };
        let (whole, swept) = (
            kicked(DampingTreatment::ExactFlow),
            kicked(DampingTreatment::Sweeps),
        );
        // The exponential by a Krylov space, of velocities of order 1: measured 6e-16.
        assert!(distance(&whole.v, &swept.v) < 4e-15, "{turn}");
        assert!(
            (whole.work.dissipated - swept.work.dissipated).abs() < 4e-15,
            "{turn}"
        );
        assert!(distance(&kicked(DampingTreatment::Explicit).v, &swept.v) > 1e-2);
    }
}

/// The order of every method on a damped molecule that bends by a third and flies, against RK4 at steps a sixteenth.
#[test]
fn every_method_keeps_its_order_on_hinges() {
    let mut scene = MOLECULE.scene();
    scene.bending[0].rest_angle = 0.8;
    scene.bending[0].damping = 0.02;
    scene.particles[0].velocity = [0.1, 0.4, -0.3];
    scene.particles[2].velocity = [0.0, -0.5, 0.2];
    let end = |build: Build, n: usize| {
        let (system, mut state) = built(&scene);
        advance(build().as_mut(), &system, 0.4 / n as f64, n, &mut state);
        state
    };
    let truth = end(&own(method("rk4")), 8192);
    for row in methods() {
        let off = |n: usize| distance(&end(&own(row), n).x, &truth.x);
        // The next order adds up to z = 40 h of the error: 0.03 at these steps; first-order methods of a stiff motion
        // more.
        let steps = if row.order_damped == 1 { 2048 } else { 512 };
        let found = (off(steps / 2) / off(steps)).log2();
        assert!(
            (found - f64::from(row.order_damped)).abs() < 0.2,
            "{}: {found}",
            row.id
        );
    }
}

/// Springs between every second particle of an inextensible row have no linear stiffness against bending: their energy
/// is k L² θ⁴/32. A hinge's is kb θ²/2.
#[test]
fn straightening_springs_resist_with_the_fourth_power() {
    let (k, length) = (30.0, 0.5);
    let mut scene = empty();
    scene.particles = [0.0, 1.0, 2.0]
        .map(|i| free([i * length, 0.0, 0.0], 0.1))
        .to_vec();
    scene.springs = vec![spring([0, 2], k, 2.0 * length)];
    scene.bending = vec![hinge([0, 1, 2], 0.2, 0.0)];
    let straightening = Springs::new(&scene).expect("a spring");
    let bending = BendingForce::new(&scene).expect("a hinge");
    let energy = |effect: &dyn Effect, angle: f64| {
        let (sin, cos) = angle.sin_cos();
        let x = [
            0.0,
            0.0,
            0.0,
            length,
            0.0,
            0.0,
            length * (1.0 + cos),
            0.0,
            length * sin,
        ];
        effect.potential(0.0, &x)
    };
    for angle in [0.02, 0.04, 0.08] {
        let of_springs =
            energy(&straightening, angle) / (k * length * length * angle.powi(4) / 32.0);
        // 2 L (1 - cos(θ/2)) is L θ²/4 less a part θ²/48, twice in the energy; and 1e-16 of 1 m in L θ²/4.
        assert!(
            (of_springs - 1.0 + angle * angle / 24.0).abs() < angle.powi(4) + 1e-11,
            "{of_springs}"
        );
        let of_hinge = energy(&bending, angle) / (0.1 * angle * angle);
        assert!((of_hinge - 1.0).abs() < 1e-13, "{of_hinge}");
    }
}

/// The stiffness that is left for search directions is positive semidefinite at any state.
#[test]
fn definite_stiffness_is_so_everywhere() {
    let mut random = Random(9);
    for rest_angle in [0.0, 0.8, 3.0] {
        let mut scene = MOLECULE.scene();
        scene.bending[0].rest_angle = rest_angle;
        let effect = BendingForce::new(&scene).expect("a hinge");
        let least = |kept, x: &[f64], v: &[f64]| {
            let mut out = Jacobian::default();
            effect.add_jacobian(0.0, x, v, kept, &mut out);
            let mut matrix = nalgebra::DMatrix::<f64>::zeros(9, 9);
            out.position
                .iter()
                .for_each(|&(i, j, slope)| matrix[(i, j)] -= slope);
            (
                matrix.symmetric_eigenvalues().min() / matrix.amax().max(1.0),
                matrix,
            )
        };
        let mut indefinite = 0;
        for _ in 0..20 {
            let (x, v) = sample(&scene, &mut random);
            let (found, matrix) = least(Linearization::Definite, &x, &v);
            assert!(found > -1e-13, "{rest_angle}: {found:e}");
            assert_eq!(matrix, matrix.transpose());
            indefinite += usize::from(least(Linearization::Exact, &x, &v).0 < -1e-6);
        }
        assert!(indefinite > 10);
    }
}

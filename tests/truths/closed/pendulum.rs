//! The plane pendulum on a rod, against numbers from elsewhere and its own equation.

use super::{form, gauss};
use crate::testkit::Conservative;
use crate::testkit::scenes::parsed;
use springcheck::physics::State;
use springcheck::truth::Motion;
use springcheck::truth::closed::Pendulum;

/// Golden: q = 2 asin(k sn(t, k)) at t = 10, which starts at the bottom at q' = 2 k.
const SN: [(f64, f64); 2] = [(0.5, 0.1142522550176043), (0.999, -1.741077718175539)];

/// Length, gravity, angle, rate, time; angle and rate then. Swings, turns both ways, a small swing,
/// and one from 0.04 rad beside the top. From mpmath at 40 digits:
/// odefun(lambda s, y: [y[1], -mpf(g)/mpf(l)*sin(y[0])], 0, [a, r], tol=mpf(10)**-32)(t)
#[rustfmt::skip]
const MOVES: [[f64; 7]; 8] = [
    [1.0, 9.81, 0.3, 0.0, 10.0, 0.28908164239874656, 0.24937387524984733],
    [1.0, 9.81, -1.2, 2.0, 7.5, 0.9805385455438678, 2.794735476961853],
    [0.7, 9.81, 3.0, 0.5, 6.0, 3.0946817513382876, -0.018401548568419756],
    [2.0, 1.62, 0.5, -4.0, 9.0, -2.430901274242788, -3.6538336552913777],
    [1.0, 9.81, 0.1, 9.0, 3.0, -2.1394366790117005, 7.135328027122248],
    [1.0, 9.81, 1.0, -5.4, 4.0, 1.473798760460465, -4.523204416982002],
    [0.25, 24.8, 0.0, 1e-3, 20.0, -9.613097135120236e-05, -0.00028857679452051895],
    [1.0, 9.81, 3.1, 0.0, 8.0, 2.016796753518679, -3.3376242281012454],
];

/// The bar of an angle: that of the position, over the length.
fn bar(pendulum: &Pendulum, length: f64, t: f64) -> f64 {
    pendulum.error_bar(t) / length
}

#[test]
fn golden_angles() {
    for (k, angle) in SN {
        let pendulum = Pendulum::new(1.0, 1.0, 0.0, 2.0 * k).expect("a pendulum");
        let off = (pendulum.angle(10.0) - angle).abs() / bar(&pendulum, 1.0, 10.0);
        assert!(off < 1.0, "k = {k}: {off}");
        // The numbers tell a modulus a billionth off.
        let other = Pendulum::new(1.0, 1.0, 0.0, 2.0 * k * (1.0 + 1e-9)).expect("a pendulum");
        assert!((other.angle(10.0) - angle).abs() > bar(&other, 1.0, 10.0));
    }
}

#[test]
fn golden_release() {
    let start = ([-1.0, 0.0, 0.0], [0.0; 3]);
    let pendulum = Pendulum::hung([0.0; 3], start.0, start.1, [0.0, -9.81, 0.0]).expect("one");
    // 16 digits were published.
    assert!((pendulum.period() - 2.367841947576237).abs() < 4e-16 * 2.4);
    let states = pendulum.states(&[0.0, 10.0]);
    let (x, bar) = (states.x(1), pendulum.error_bar(10.0));
    let off = (x[0] + 0.2750874625761169).hypot(x[1] + 0.9614192050991251) / bar;
    assert!(off < 1.0, "{off}");
    assert_eq!(x[2], 0.0);
    // Released at rest, up to the cosine of a right angle.
    assert!(states.x(0)[0] + 1.0 <= f64::EPSILON && states.x(0)[1].abs() <= f64::EPSILON);
    assert!(states.v(0).iter().all(|v| v.abs() <= 16.0 * f64::EPSILON));
}

#[test]
fn swings_and_turns() {
    for [length, gravity, angle, rate, t, then, speed] in MOVES {
        let pendulum = Pendulum::new(length, gravity, angle, rate).expect("a pendulum");
        let bar = bar(&pendulum, length, t);
        let off = (pendulum.angle(t) - then).abs() / bar;
        // Measured 1/11 to 1/290 of the bar, less where the swing is small against the rod.
        assert!(off < 1.0, "{angle}, {rate}: {off}");
        // A rate is an angle's error times w, and a little more beside the top.
        let w = (gravity / length).sqrt();
        let slow = (pendulum.rate(t) - speed).abs() / (2.0 * w * bar);
        assert!(slow < 1.0, "{angle}, {rate}: rate {slow}");
        let wrong = Pendulum::new(length, gravity, angle, rate + 1e-8 * w).expect("a pendulum");
        assert!((wrong.angle(t) - then).abs() > bar);
    }
}

/// Its velocity is the derivative of its position, and it obeys q'' = -(g / l) sin q from any start:
/// Gauss's method follows it.
#[test]
fn obeys_its_equation() {
    let system = |w2: f64| Conservative {
        inverse_mass: vec![1.0],
        acceleration: move |x: &[f64], a: &mut [f64]| a[0] = -w2 * x[0].sin(),
        potential: move |x: &[f64]| -w2 * x[0].cos(),
    };
    for [length, gravity, angle, rate, ..] in MOVES {
        let pendulum = Pendulum::new(length, gravity, angle, rate).expect("a pendulum");
        let follow = |gravity: f64| {
            let mut state = State::new(vec![angle], vec![rate]);
            gauss::advance(&system(gravity / length), &mut state, 2.0, 4000);
            let states = pendulum.states(&[2.0]);
            let (sin, cos) = state.x[0].sin_cos();
            let x = [length * sin, 0.0, -length * cos];
            let v = [length * cos, 0.0, length * sin].map(|c| c * state.v[0]);
            let apart = |a: &[f64], b: &[f64]| crate::testkit::distance(a, b);
            apart(states.x(0), &x).max(apart(states.v(0), &v) / 10.0) / length
        };
        // 4,000 steps whose roundings of a few radians add up like a walk, to 64, and grow tenfold
        // beside the top. Measured 600.
        assert!(follow(gravity) < 1000.0 * f64::EPSILON, "{angle}, {rate}");
        assert!(
            follow(gravity * (1.0 + 1e-6)) > 1000.0 * f64::EPSILON,
            "{angle}, {rate}"
        );
    }
}

#[test]
fn any_plane_and_the_edges() {
    // Tilted plane of motion: the same swing turned about the vertical.
    let (sin, cos) = 0.7_f64.sin_cos();
    let turn = |x: f64, z: f64| [cos * x, sin * x, z];
    let pivot = [1.0, -2.0, 3.0];
    let at = |d: [f64; 3]| [0, 1, 2].map(|c| pivot[c] + d[c]);
    let (s, c) = 0.8_f64.sin_cos();
    let flat = Pendulum::new(1.5, 9.81, 0.8, 1.1).expect("one");
    let (position, velocity) = (at(turn(1.5 * s, -1.5 * c)), turn(1.65 * c, 1.65 * s));
    let turned = Pendulum::hung(pivot, position, velocity, [0.0, 0.0, -9.81]).expect("one");
    let (a, b) = (flat.states(&[4.0]), turned.states(&[4.0]));
    let (x, v) = (at(turn(a.x(0)[0], a.x(0)[2])), turn(a.v(0)[0], a.v(0)[2]));
    // Positions near 3 give the angle to two eps or so, and both have bars.
    let bound = 2.0 * flat.error_bar(4.0) + 8.0 * f64::EPSILON;
    assert!(crate::testkit::distance(b.x(0), &x) < bound);
    assert!(crate::testkit::distance(b.v(0), &v) < 5.0 * bound);

    // Out of the plane: a spherical pendulum, or a rod that grows.
    let aside = [
        velocity[0] - 0.1 * sin,
        velocity[1] + 0.1 * cos,
        velocity[2],
    ];
    assert!(Pendulum::hung(pivot, position, aside, [0.0, 0.0, -9.81]).is_none());
    let outward = turn(s, -c);
    assert!(Pendulum::hung(pivot, position, outward, [0.0, 0.0, -9.81]).is_none());
    for (length, gravity) in [(0.0, 9.81), (1.0, 0.0), (1.0, -1.0), (f64::NAN, 1.0)] {
        assert!(Pendulum::new(length, gravity, 0.1, 0.0).is_none());
    }

    // At rest below, near the top, and exactly fast enough to reach the top: all finite.
    let w2 = 2.0 * (9.81_f64).sqrt();
    for (angle, rate) in [
        (0.0, 0.0),
        (std::f64::consts::PI, 0.0),
        (0.0, w2),
        (0.0, -w2),
    ] {
        let pendulum = Pendulum::new(1.0, 9.81, angle, rate).expect("one");
        let states = pendulum.states(&[0.0, 1.0, 100.0]);
        assert!(states.x.iter().chain(&states.v).all(|c| c.is_finite()));
        assert!(pendulum.error_bar(100.0).is_finite());
        for k in 0..3 {
            let radius = states.x(k)[0].hypot(states.x(k)[2]);
            assert!(
                (radius - 1.0).abs() < 4.0 * f64::EPSILON,
                "{angle}, {rate}: {radius}"
            );
        }
    }
}

/// Position (x, z) and velocity along x at the start, time; position then. Near the top, and at the energy that only just
/// reaches it. By power series of 40 terms at 60 digits (mpmath), the same with 16 and with 20 steps a second.
#[rustfmt::skip]
const BESIDE_THE_TOP: [[f64; 6]; 9] = [
    [1e-3, 1.0, 0.0, 20.0, -0.5062049590017814, -0.8624137866952295],
    [1e-10, 1.0, 0.0, 8.0, 0.09692316492806774, -0.9952918667910065],
    [1e-12, 1.0, 0.0, 12.0, -0.0015210614778564395, 0.9999988431853205],
    [1e-9, 1.0, -2e-9, 9.0, -0.05065722013245415, 0.9987160988231101],
    [0.0, 1.0, 1e-7, 9.0, -0.0005737625369060634, 0.9999998353982621],
    [0.0, -1.0, 6.264183905346333, 2.0, 0.007612981387440572, 0.9999710208373013],
    [0.0, -1.0, 6.264183905346333, 5.0, 6.307174970300224e-7, 0.999999999999801],
    [0.0, -1.0, 6.2641839, 5.0, 0.0027009317686841785, 0.9999963524771383],
    [0.0, -1.0, 6.264184, 10.0, -0.0005184944941201209, 0.9999998655817207],
];

#[test]
fn beside_the_top_digits_are_kept() {
    let w = 9.81_f64.sqrt();
    for [x, z, speed, t, side, up] in BESIDE_THE_TOP {
        // The same in a tilted frame, whose start has a rounding of its own.
        let (sin, cos) = 0.6_f64.sin_cos();
        for (turn, exact) in [([0.0, 1.0], true), ([sin, cos], false)] {
            let [sin, cos] = turn;
            let at = |x: f64, z: f64| [cos * x + sin * z, 0.0, cos * z - sin * x];
            let gravity = at(0.0, -9.81);
            // Across the rod.
            let velocity = at(speed, -speed * x / z);
            let one = Pendulum::hung([0.0; 3], at(x, z), velocity, gravity);
            let Some(one) = one else {
                // Rounding took the velocity out of the plane: no closed form is no wrong one.
                assert!(!exact);
                continue;
            };
            let (states, bar) = (one.states(&[t]), one.error_bar(t));
            let off = crate::testkit::distance(states.x(0), &at(side, up));
            assert!(off < bar, "{x}, {speed}: {off:e} of {bar:e}");
            // From the start's own digits nothing is lost but where 1 - k² has lost them; what that leaves
            // grows as exp(w t), at 5 s and 10 s to 6e6 and 4e13 roundings.
            let most = if speed > 1.0 {
                20.0 * f64::EPSILON * (w * t).exp()
            } else {
                1e-12
            };
            assert!(!exact || bar < most, "{x}, {speed}: {bar:e}");
        }
    }
    // So little that its square is no number: 1e-200 cosh(w t), 1e-200 m times 8.3e26.
    let little = Pendulum::hung([0.0; 3], [1e-200, 0.0, 1.0], [0.0; 3], [0.0, 0.0, -9.81]);
    let side = little.expect("one").states(&[20.0]).x(0)[0];
    let grown = 1e-200 * (w * 20.0).cosh();
    assert!((side / grown - 1.0).abs() < 1e-12, "{side:e}");
}

/// A pendulum at rest upright stays there, to the last bit, for ever.
#[test]
fn upright_stays_upright() {
    let upright = Pendulum::hung([0.0; 3], [0.0, 0.0, 1.0], [0.0; 3], [0.0, 0.0, -9.81]);
    let upright = upright.expect("one");
    let states = upright.states(&[0.0, 20.0, 1e6]);
    for k in 0..3 {
        assert_eq!(
            (states.x(k), states.v(k)),
            (&[0.0, 0.0, 1.0][..], &[0.0; 3][..])
        );
    }
    assert!(upright.error_bar(20.0) < 1e-12);
}

/// Where a rounding of the start has grown to the size of the motion the truth ends before.
#[test]
fn a_bar_as_large_as_the_motion_is_beyond_the_horizon() {
    let scene = parsed(
        "solver: {type: rattle, timestep: 0.01}\nparticles:\n- {pos: [0, 0, 0], fixed: true}\n\
         - {pos: [0, 0, -1], vel: [6.264183905346333, 0, 0], mass: 1}\nrods: [{particle_ids: [0, 1]}]\n",
    );
    let near = form(&scene, 5.0).expect("a form");
    assert_eq!(near.horizon, 5.0);
    let far = form(&scene, 20.0).expect("a form");
    // 16 eps exp(w t) is 1e-6 of the size, 2 m or so, at 6.5 s.
    assert!((5.0..8.0).contains(&far.horizon), "{}", far.horizon);
    assert!(
        far.error_bound <= 1e-6 * scene.size(),
        "{}",
        far.error_bound
    );
}

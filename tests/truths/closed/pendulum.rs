//! The plane pendulum on a rod, against numbers from elsewhere and its own equation.

use super::gauss;
use crate::testkit::Conservative;
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

    // At rest below, at rest above, and exactly fast enough to reach the top: all finite.
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

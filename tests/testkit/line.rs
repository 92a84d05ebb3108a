//! Motions along a line, as formulas.

use springcheck::scene::Scene;
use springcheck::truth::{Motion, States};

/// x(t) along one axis, of the particle that is free.
pub struct Line {
    /// Coordinates in all, and which one moves.
    pub dim: usize,
    pub at: usize,
    /// Where everything else stays.
    pub rest: Vec<f64>,
    /// Position and velocity at a time.
    pub x: Box<dyn Fn(f64) -> (f64, f64) + Send + Sync>,
    /// What the error bar grows by, m/s.
    pub bar: f64,
}

impl Motion for Line {
    fn states(&self, times: &[f64]) -> States {
        let mut states = States {
            dim: self.dim,
            ..States::default()
        };
        for (x, v) in times.iter().map(|t| (self.x)(*t)) {
            let mut state = self.rest.clone();
            state[self.at] = x;
            states.x.extend(state);
            let mut speeds = vec![0.0; self.dim];
            speeds[self.at] = v;
            states.v.extend(speeds);
        }
        states
    }

    fn error_bar(&self, t: f64) -> f64 {
        self.bar * t
    }
}

/// A free particle `1` on a spring at the origin, from rest at A: A cos(w t) and its damped kin.
pub fn released(scene: &Scene) -> Line {
    let spring = &scene.springs[0];
    let (start, v0) = (
        scene.particles[1].position[0],
        scene.particles[1].velocity[0],
    );
    assert!(v0 == 0.0 && spring.rest_length == 0.0 && scene.particles[1].mass == 1.0);
    let w = spring.stiffness.sqrt();
    let decay = 0.5 * spring.damping;
    let x = move |t: f64| {
        let envelope = start * (-decay * t).exp();
        let square = w * w - decay * decay;
        let u = square.abs().sqrt();
        // Of cos + (decay/u) sin, or their hyperbolic kin, or the limit between them.
        let (c, s) = if u < 1e-6 * w {
            (1.0, t)
        } else if square > 0.0 {
            ((u * t).cos(), (u * t).sin() / u)
        } else {
            ((u * t).cosh(), (u * t).sinh() / u)
        };
        (envelope * (c + decay * s), -envelope * w * w * s)
    };
    Line {
        dim: 6,
        at: 3,
        rest: vec![0.0; 6],
        x: Box::new(x),
        // 16 eps A (1 + w t).
        bar: 16.0 * f64::EPSILON * start * (0.2 + w),
    }
}

//! Where a system really is: a high-order method that shares nothing with those under test.

use super::subject::{distance, largest};
use crate::physics::{State, System};
use crate::truth::converged::{Gragg, Precise, Stepper};

/// States at equidistant instants, and how far they may be off.
pub(super) struct Reference {
    /// The first instant is after the start.
    pub states: Vec<State>,
    /// The error bar of positions (m) and velocities (m/s).
    pub bar: f64,
}

/// Steps of order 12 from one instant to the next: twice as many change the states by rounding only.
const STEPS: usize = 8;

impl Reference {
    /// At `span / n`, 2 `span / n`, ..., `span` seconds.
    pub fn new(system: &dyn System, start: &State, span: f64, n: usize) -> Self {
        let [coarse, states] = [STEPS, 2 * STEPS].map(|steps| run(system, start, span, n, steps));
        let off = apart(&coarse, &states);
        // Never better than the doubles it is told in.
        let size = states.iter().map(largest).fold(0.0, f64::max);
        Self {
            states,
            bar: off.max(f64::EPSILON * size),
        }
    }
}

/// The largest distance of states at the same instants.
fn apart(a: &[State], b: &[State]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| distance(a, b));
    distances.fold(0.0, f64::max)
}

fn run(system: &dyn System, start: &State, span: f64, n: usize, steps: usize) -> Vec<State> {
    let mut stepper = Gragg::default();
    let mut precise = Precise::from(start);
    let h = span / (n * steps) as f64;
    (0..n * steps)
        .filter_map(|step| {
            stepper.step(system, start.t + step as f64 * h, h, &mut precise);
            let done = step + 1;
            (done % steps == 0).then(|| {
                let mut state = State::new(precise.x.clone(), precise.v.clone());
                state.t = start.t + done as f64 * h;
                state
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::order::{HORIZON, INSTANTS};
    use super::super::systems::{Driven, swinging_triangle};
    use super::*;
    use crate::physics::ParticleSystem;
    use crate::scene::DampingModel;

    #[test]
    fn the_reference_is_right_to_its_bar() {
        let start = Driven::start();
        let reference = Reference::new(&Driven, &start, HORIZON, INSTANTS);
        let exact: Vec<State> = reference
            .states
            .iter()
            .map(|s| Driven::exact(s.t))
            .collect();
        // Measured 4.4e-16 of 5.6e-16; a single step is off by 3.3e-13.
        assert!(apart(&reference.states, &exact) <= reference.bar);
        assert!(apart(&run(&Driven, &start, HORIZON, INSTANTS, 1), &exact) > 100.0 * reference.bar);
    }

    #[test]
    fn on_the_networks_its_bar_is_rounding() {
        for model in [DampingModel::Axial, DampingModel::Isotropic] {
            let scene = swinging_triangle(0.8, model);
            let (system, start) = (
                ParticleSystem::new(&scene),
                ParticleSystem::initial_state(&scene),
            );
            let reference = Reference::new(&system, &start, HORIZON, INSTANTS);
            // Values up to 3.4, half a last bit of which is 2.2e-16: measured 1.8e-15. Two steps
            // are off by 2.4e-10, one by 2.8e-7.
            assert!(reference.bar < 4e-15, "{:e}", reference.bar);
            let off = [1, 2].map(|steps| {
                let states = run(&system, &start, HORIZON, INSTANTS, steps);
                apart(&states, &reference.states)
            });
            assert!(off[1] > 1e-10 && off[0] > 500.0 * off[1], "{off:?}");
        }
    }
}

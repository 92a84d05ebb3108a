//! The exact flow of a damper on the rate of an angle between three particles.

use super::Sweep;

impl Sweep<'_> {
    /// A damper c, N m s/rad, on the rate at which velocities of three particles change an angle, by its gradients in
    /// 1/m: one number relaxes, as between two ends.
    pub fn bend(&mut self, particles: [usize; 3], c: f64, gradients: [[f64; 3]; 3]) {
        let places = particles.map(|particle| 3 * particle);
        if places.iter().any(|place| place + 2 >= self.v.len()) {
            return;
        }
        if let Some(bound) = self.bound(&places) {
            let [a, b, d] = [0, 1, 2].map(|at| (places[at], gradients[at]));
            return self.rate(bound, c, [a, b, d]);
        }
        let inverse_mass = self.inverse_mass;
        let rows = || places.into_iter().zip(gradients);
        let weight = |(at, g): (usize, [f64; 3])| inverse_mass[at] * dot(&g, &g);
        if !self.relaxes(c, rows().map(weight).sum()) {
            return;
        }
        let rate = |of: &[f64]| rows().map(|(at, g)| dot(&g, &of[at..at + 3])).sum::<f64>();
        let (before, alpha) = (rate(self.v), self.a.map_or(0.0, rate));
        let (after, moved) = self.relaxed(before, alpha, 1.0);
        let w = self.decay.w;
        for (at, g) in rows() {
            for axis in 0..3 {
                let reach = inverse_mass[at] * g[axis] / w;
                self.v[at + axis] += reach * (after - before);
                if let Some(by) = &mut self.moved {
                    by[at + axis] += reach * moved;
                }
            }
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

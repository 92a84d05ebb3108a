//! One mode, q'' + 2 g q' + w² q = r: the scalar solution every closed form here is made of.

/// Undamped angular frequency w and decay rate g, both 1/s and not negative.
///
/// g below w swings, at w is critical, above it creeps; w = 0 is drag alone and both 0 free fall.
/// Not to be confused with a damping ratio, which is g / w.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Mode {
    pub w: f64,
    pub g: f64,
}

/// The start of a mode, at position 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
    pub velocity: f64,
    /// The constant acceleration r.
    pub pull: f64,
}

impl Start {
    pub fn times(self, factor: f64) -> Self {
        Self {
            velocity: factor * self.velocity,
            pull: factor * self.pull,
        }
    }
}

/// The responses of a mode at rest, at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Response {
    /// Position after a unit of velocity at t = 0, s.
    pub impulse: f64,
    /// Position under a unit of acceleration since t = 0, s².
    pub step: f64,
    /// Velocity after a unit of velocity at t = 0, less that unit.
    pub slowing: f64,
}

impl Response {
    /// The position of a mode with this start.
    pub fn position(&self, start: Start) -> f64 {
        start.velocity * self.impulse + start.pull * self.step
    }

    /// Its velocity minus the one at the start.
    pub fn gained(&self, start: Start) -> f64 {
        start.velocity * self.slowing + start.pull * self.impulse
    }
}

impl Mode {
    /// Accurate to rounding of the largest value up to `t`, in all regimes.
    ///
    /// Over-damped rates are s_1,2 = g ∓ sqrt(g² - w²); the slow one is taken as w² / s_2, which
    /// neither cancels nor overflows. Where `t` is short against every rate the step response is
    /// its Taylor series, since 1 - cos and its kin cancel there.
    pub fn response(&self, t: f64) -> Response {
        let Mode { w, g } = *self;
        // g² - w², with the relative accuracy of g - w.
        let split = (g - w) * (g + w);
        let fast = self.fastest();
        let (impulse, late) = if split >= 0.0 {
            let gap = 2.0 * split.sqrt();
            let slow = if fast > 0.0 { w / fast * w } else { 0.0 };
            let decay = (-slow * t).exp();
            let lag = decay * mean_decay(gap * t);
            (t * lag, t / fast * (mean_decay(slow * t) - lag))
        } else {
            let turn = (-split).sqrt();
            let (sin, cos) = (turn * t).sin_cos();
            let decay = (-g * t).exp();
            let impulse = decay * sin / turn;
            (impulse, (1.0 - decay * cos - g * impulse) / (w * w))
        };
        let step = if fast * t < 1.0 { self.series(t) } else { late };
        Response {
            impulse,
            step,
            slowing: -(w * w * step + 2.0 * g * impulse),
        }
    }

    /// The step response as its Taylor series, for `fastest * t` below 1.
    fn series(&self, t: f64) -> f64 {
        // P'' = 1 - 2 g P' - w² P, term by term; with |2 g t| < 2 and (w t)² < 1 the terms fall
        // faster than 2^n / n!, below eps after 24.
        let (a, b) = (2.0 * self.g * t, (self.w * t) * (self.w * t));
        let (mut before, mut term) = (0.0, 0.5 * t * t);
        let mut sum = term;
        for n in 2..26_u32 {
            let n = f64::from(n);
            let next = -(a * n * term + b * before) / (n * (n + 1.0));
            (before, term) = (term, next);
            sum += term;
        }
        sum
    }

    /// The fastest rate, 1/s: of swinging, or of the faster decay.
    pub fn fastest(&self) -> f64 {
        let split = (self.g - self.w) * (self.g + self.w);
        if split >= 0.0 {
            self.g + split.sqrt()
        } else {
            self.w
        }
    }

    /// No impulse response in [0, t] is larger, s.
    pub fn impulse_bound(&self, t: f64) -> f64 {
        t.min(1.0 / self.fastest())
    }

    /// No step response in [0, t] is larger, s²; none is negative.
    pub fn step_bound(&self, t: f64) -> f64 {
        let settled = if self.g >= self.w { 1.0 } else { 2.0 };
        (0.5 * t * t)
            .min(t * self.impulse_bound(t))
            .min(settled / self.w / self.w)
    }

    /// No speed in [0, t] is larger.
    ///
    /// The mode's energy never grows, which bounds it at once; the other bound serves w = 0.
    pub fn speed_bound(&self, start: Start, t: f64) -> f64 {
        let Start { velocity, pull } = start;
        let growing = velocity.abs() + pull.abs() * self.impulse_bound(t);
        growing.min(velocity.hypot(pull / self.w))
    }

    /// No acceleration in [0, t] is larger; it obeys the mode's equation itself.
    pub fn acceleration_bound(&self, start: Start, t: f64) -> f64 {
        let Start { velocity, pull } = start;
        let first = pull - 2.0 * self.g * velocity;
        let restoring = self.w * self.w * velocity;
        let growing = first.abs() + restoring.abs() * self.impulse_bound(t);
        growing.min(first.hypot(self.w * velocity))
    }

    /// No position in [0, t] is farther from the start.
    pub fn travel_bound(&self, start: Start, t: f64) -> f64 {
        let Start { velocity, pull } = start;
        let apart = velocity.abs() * self.impulse_bound(t) + pull.abs() * self.step_bound(t);
        let rest = pull / self.w / self.w;
        apart.min(rest.abs() + rest.hypot(velocity / self.w))
    }

    /// No position in [0, t] is lower than this, with the start at 0.
    pub fn lowest(&self, start: Start, t: f64) -> f64 {
        let Start { velocity, pull } = start;
        let apart = -velocity.abs() * self.impulse_bound(t) + pull.min(0.0) * self.step_bound(t);
        let rest = pull / self.w / self.w;
        apart.max(rest - rest.hypot(velocity / self.w))
    }
}

/// (1 - exp(-x)) / x, 1 at 0: the mean of exp(-s) over [0, x].
fn mean_decay(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// w, g, t; impulse, step, slowing: free, swinging, nearly and just critical, creeping, dragged.
    /// From mpmath at 80 digits, with s = sqrt(g^2 - w^2): impulse exp(-g t) sinh(s t) / s, step
    /// (1 - exp(-g t) cosh(s t) - g impulse) / w^2, slowing -(w^2 step + 2 g impulse).
    #[rustfmt::skip]
    const GOLDEN: [[f64; 6]; 18] = [
        [0.0, 0.0, 3.0, 3.0, 4.5, 0.0],
        [2.0, 0.0, 0.7, 0.49272486499423007, 0.20750821427493973, -0.8300328570997589],
        [2.0, 0.0, 1e-05, 9.999999999333333e-06, 4.999999999833334e-11, -1.9999999999333337e-10],
        [2.0, 0.0, 400.0, 0.4469848240985107, 0.36203187830437306, -1.4481275132174922],
        [1e-07, 0.0, 5.0, 4.999999999999791, 12.499999999999739, -1.2499999999999737e-13],
        [3.0, 0.25, 5.0, 0.06603228416918418, 0.13234820145819753, -1.2241499552083699],
        [3.0, 2.9999999, 1.5, 0.016663493557601293, 0.10432228114305848, -1.0388814883004354],
        [3.0, 3.0, 1.5, 0.016663494807363458, 0.10432227989329637, -1.0388814878838482],
        [3.0, 3.0000001, 1.5, 0.01666349605712551, 0.10432227864353427, -1.0388814874672607],
        [3.0, 3.0, 0.0001, 9.997000449955004e-05, 4.999000112491001e-09, -0.0005998650179983127],
        [2.0, 7.0, 0.01, 0.009330932726291938, 4.7744522479673854e-05, -0.13082403625800584],
        [2.0, 7.0, 3.0, 0.03105900091882007, 0.1435592203662823, -1.0090628943286102],
        [2.0, 1000000000.0, 5.0, 4.99999995e-10, 2.4999999872500002e-09, -1.0],
        [0.001, 50.0, 5.0, 0.009999999502000012, 0.04989999875997002, -1.0000000001],
        [0.0, 0.3, 2.0, 1.1646763134796632, 1.3922061442005613, -0.6988057880877979],
        [0.0, 1e-12, 2.0, 1.999999999996, 1.9999999999973332, -3.9999999999919995e-12],
        [0.0, 1000000.0, 2.0, 5e-07, 9.9999975e-07, -1.0],
        [1e-200, 1e-200, 1000.0, 1000.0, 500000.0, -2e-197],
    ];

    /// The largest relative error over the golden numbers, in eps.
    fn worst(respond: impl Fn(Mode, f64) -> Response) -> f64 {
        let of = |[w, g, t, impulse, step, slowing]: [f64; 6]| {
            let found = respond(Mode { w, g }, t);
            [
                (found.impulse, impulse),
                (found.step, step),
                (found.slowing, slowing),
            ]
            .map(|(found, golden)| (found - golden).abs() / golden.abs().max(f64::MIN_POSITIVE))
            .into_iter()
            .fold(0.0, f64::max)
        };
        GOLDEN.into_iter().map(of).fold(0.0, f64::max) / f64::EPSILON
    }

    /// Every regime is right to a few roundings, which the formulas it replaces are not.
    #[test]
    fn responses_in_every_regime() {
        let found = worst(|mode, t| mode.response(t));
        assert!(found < 8.0, "{found}");
        // Over-damped rates by subtraction; step responses by 1 - cos where t is short.
        let naive = worst(|mode, t| {
            let Mode { w, g } = mode;
            let root = (g * g - w * w).abs().sqrt();
            let mut response = mode.response(t);
            if g > w {
                let (slow, fast) = ((-(g - root) * t).exp(), (-(g + root) * t).exp());
                response.impulse = (slow - fast) / (2.0 * root);
            }
            response
        });
        assert!(naive > 1e6, "{naive}");
        let naive = worst(|mode, t| {
            let mut response = mode.response(t);
            if mode.w > 0.0 && mode.g == 0.0 {
                response.step = (1.0 - (mode.w * t).cos()) / (mode.w * mode.w);
            }
            response
        });
        assert!(naive > 1e6, "{naive}");
    }

    /// No sampled motion leaves its bounds, and each bound is nearly met by some.
    #[test]
    fn bounds_hold_and_are_met() {
        let rates = [0.0, 0.3, 1.0, 2.5];
        let starts = [(0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (-0.7, 2.0), (1.0, 3.0)];
        let mut met = [0.0_f64; 4];
        for (w, g) in rates.iter().flat_map(|&w| rates.map(|g| (w, g))) {
            let mode = Mode { w, g };
            for ((v, r), until) in starts
                .iter()
                .flat_map(|&s| [0.3, 2.0, 20.0].map(|t| (s, t)))
            {
                let start = Start {
                    velocity: v,
                    pull: r,
                };
                let (mut speed, mut change, mut travel, mut low) =
                    (0.0_f64, 0.0_f64, 0.0_f64, 0.0_f64);
                for k in 0..=2000 {
                    let response = mode.response(until * f64::from(k) / 2000.0);
                    let x = response.position(start);
                    let now = v + response.gained(start);
                    speed = speed.max(now.abs());
                    change = change.max((r - w * w * x - 2.0 * g * now).abs());
                    travel = travel.max(x.abs());
                    low = low.min(x);
                }
                let bounds = [
                    (speed, mode.speed_bound(start, until)),
                    (change, mode.acceleration_bound(start, until)),
                    (travel, mode.travel_bound(start, until)),
                    (-low, -mode.lowest(start, until)),
                ];
                for (met, (found, bound)) in met.iter_mut().zip(bounds) {
                    // Rounding of values up to 1e3.
                    assert!(
                        found <= bound + 1e-12,
                        "{mode:?} {v} {r} {until}: {found} {bound}"
                    );
                    if found > 0.0 {
                        *met = met.max(found / bound);
                    }
                }
            }
        }
        assert!(met.iter().all(|met| *met > 0.999), "{met:?}");
    }
}

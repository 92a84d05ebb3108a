//! On the oscillator theory knows every error: slopes are orders, and who needs how many steps for a
//! target follows from each method's leading error term.

use super::{all, choice, cost, of};
use crate::testkit::scenes::shipped;
use springcheck::integrators::{self, Coefficients, Method, PerStep, Tableau};
use springcheck::verbs::cost::CostChoice;
use springcheck::verbs::cost::{Cost, CostCurve, CostPoint};
use std::f64::consts::PI;
use std::sync::LazyLock;

/// Slope of ln(error) over ln(evaluations), its sign turned, through the points the curve's own slope
/// was taken from.
fn over_evaluations(curve: &CostCurve) -> f64 {
    let used: Vec<&CostPoint> = curve
        .slope_points
        .iter()
        .map(|&at| &curve.points[at])
        .collect();
    let logs = used.iter().map(|p| {
        let evaluations = p.force_evaluations.expect("counted") as f64;
        (evaluations.ln(), p.error_m.expect("an error").ln())
    });
    let logs: Vec<(f64, f64)> = logs.collect();
    let n = logs.len() as f64;
    let (x, y) = logs
        .iter()
        .fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let over: f64 = logs.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let under: f64 = logs.iter().map(|p| (p.0 - x) * (p.0 - x)).sum();
    -over / under
}

/// All methods over one budget.
static OSCILLATOR: LazyLock<Cost> = LazyLock::new(|| {
    let scene = shipped("oscillator/oscillator.yml");
    // Wide enough that methods of order 4 have a line above rounding.
    let choice = CostChoice {
        budget_s: 4.0,
        ..choice(all())
    };
    cost(&scene, &choice)
});

/// Lines are as steep as the methods' orders. The next order's term changes a slope by its share of the
/// error, below 0.1 where that is below a tenth of the amplitude; implicit Euler, whose error saturates, is
/// the farthest off.
fn slopes(cost: &Cost, method: &'static Method) -> Result<(), String> {
    let curve = of(cost, method.id);
    let observed = curve.observed_order.ok_or("no slope")?;
    let stated = f64::from(method.order);
    if (observed - stated).abs() > 0.1 {
        return Err(format!("slope {observed:.3}, order {stated}"));
    }
    // One evaluation more at the start changes counts by less than a percent.
    if matches!(method.evaluations, PerStep::Exactly(_)) {
        let counted = over_evaluations(curve);
        if (counted - stated).abs() > 0.1 {
            return Err(format!(
                "slope over evaluations {counted:.3}, order {stated}"
            ));
        }
    }
    Ok(())
}

#[test]
fn slopes_are_orders() {
    for method in integrators::fixed().iter() {
        if let Err(wrong) = slopes(&OSCILLATOR, method) {
            panic!("{}: {wrong}", method.id);
        }
    }
}

/// rk4 with two of its weights exchanged, under its own name and with its claim of order 4.
static SWAPPED: LazyLock<Method> = LazyLock::new(|| Method {
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
        b: &[1.0 / 3.0, 1.0 / 6.0, 1.0 / 6.0, 1.0 / 3.0],
        c: &[0.0, 0.5, 0.5, 1.0],
    }),
    ..*integrators::find("rk4").expect("a method")
});

#[test]
fn a_swapped_weight_shows_in_the_slope() {
    assert_eq!(SWAPPED.id, "rk4");
    let scene = shipped("oscillator/oscillator.yml");
    let mut choice = choice(vec![&SWAPPED]);
    choice.budget_s = 0.3;
    let wrong = slopes(&cost(&scene, &choice), &SWAPPED).expect_err("a slope that is not 4");
    assert!(wrong.contains("slope"), "{wrong}");
}

/// Largest position error over T of x'' = -w² x from rest at amplitude A, by leading terms, in units of
/// A: with z = h w, a phase off by c z^p w t or an amplitude by the same, or a shift of half a step.
/// Hairer, Lubich, Wanner, Geometric Numerical Integration, I.1 and IX; the constants are those of the
/// methods' R(i z) = exp(i z + e(z)).
struct Term {
    id: &'static str,
    power: i32,
    constant: f64,
    /// Grows with w T; a shift does not.
    grows: bool,
}

const fn growing(id: &'static str, power: i32, constant: f64) -> Term {
    Term {
        id,
        power,
        constant,
        grows: true,
    }
}

const TERMS: &[Term] = &[
    // 1 + i z = exp(i z + z²/2 + ...)
    growing("explicit_euler", 1, 1.0 / 2.0),
    growing("implicit_euler", 1, 1.0 / 2.0),
    // x_n = A cos(w t + z/2) / cos(z/2) from rest: off by z/2 at the zeros.
    Term {
        id: "symplectic_euler",
        power: 1,
        constant: 1.0 / 2.0,
        grows: false,
    },
    // 1 + i z - z²/2 = exp(i z + i z³/6 + ...)
    growing("midpoint", 2, 1.0 / 6.0),
    growing("heun", 2, 1.0 / 6.0),
    growing("ralston", 2, 1.0 / 6.0),
    // 2 asin(z/2) = z + z³/24 + ...
    growing("velocity_verlet", 2, 1.0 / 24.0),
    // 2 atan(z/2) = z - z³/12 + ...
    growing("implicit_midpoint", 2, 1.0 / 12.0),
    growing("trapezoidal", 2, 1.0 / 12.0),
    // The fourth term of exp.
    growing("rk3", 3, 1.0 / 24.0),
    growing("ssprk3", 3, 1.0 / 24.0),
    // The fifth term of exp.
    growing("rk4", 4, 1.0 / 120.0),
];

impl Term {
    /// Force evaluations at which the error is `share` of the amplitude, with w T = `turn`.
    fn evaluations(&self, share: f64, turn: f64) -> f64 {
        let growth = if self.grows { turn } else { 1.0 };
        let z = (share / (self.constant * growth)).powf(1.0 / f64::from(self.power));
        let method = integrators::find(self.id).expect("a method");
        let each = match method.evaluations {
            PerStep::Exactly(stages) => f64::from(stages),
            // Linear forces: one iteration.
            PerStep::PerIteration { plus } => 1.0 + f64::from(plus),
        };
        turn / z * each
    }
}

#[test]
fn integrators_come_in_the_order_of_theory() {
    let scene = shipped("oscillator/oscillator.yml");
    let (amplitude, omega) = (0.5, 50.0_f64.sqrt());
    let turn = omega * scene.duration;
    assert!(turn > 10.0 * PI, "long enough for the sine to reach 1");
    for target in &OSCILLATOR.targets {
        let share = target.error_m / amplitude;
        let mut known: Vec<(f64, u64, &str)> = Vec::new();
        for term in TERMS {
            let rank = target.ranking.iter().find(|rank| rank.engine == term.id);
            let Some(reached) = rank.and_then(|rank| rank.reached.as_ref()) else {
                continue;
            };
            let counted = reached.force_evaluations.expect("counted");
            let theory = term.evaluations(share, turn);
            let ratio = counted as f64 / theory;
            // Settings lie within 15 % of the target in error, a little more in steps of first order; the
            // leading term is met to the next one's share, a tenth of the amplitude at 1e-2 m.
            assert!(
                (0.87..1.35).contains(&ratio),
                "{}: {ratio} at {}",
                term.id,
                target.error_m
            );
            known.push((theory, counted, term.id));
        }
        assert!(known.len() >= 7, "{}: {known:?}", target.error_m);
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
        for pair in known.windows(2) {
            // Those that theory puts apart by more than the tolerance above are in its order.
            if pair[1].0 > 1.6 * pair[0].0 {
                assert!(pair[0].1 < pair[1].1, "{}: {pair:?}", target.error_m);
            }
        }
    }
    // At the finest target: no method of a lower order needs fewer evaluations than one of a higher.
    let finest = OSCILLATOR.targets.last().expect("a target");
    let reached =
        |rank: &springcheck::verbs::cost::CostRank| rank.reached.as_ref()?.force_evaluations;
    for a in &finest.ranking {
        for b in &finest.ranking {
            let orders = [a, b].map(|r| integrators::find(&r.engine).expect("a method").order);
            if let (Some(of_a), Some(of_b)) = (reached(a), reached(b))
                && orders[0] > orders[1]
            {
                assert!(of_a < of_b, "{} {of_a}, {} {of_b}", a.engine, b.engine);
            }
        }
    }
}

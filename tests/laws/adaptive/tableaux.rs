//! Every order condition of every formula, and published values.

use super::{pair, pairs};
use springcheck::integrators::Tableau;
use springcheck::integrators::adaptive::{ErrorEstimate, Pair};

fn less(b: &[f64], e: &[f64]) -> Vec<f64> {
    b.iter().zip(e).map(|(b, e)| b - e).collect()
}

fn published(id: &str) -> u32 {
    match id {
        "dormand_prince54" => 5,
        _ => 8,
    }
}

/// Rows sum to nodes, the formula is of the order stated, those beside it of theirs, and a last stage
/// that is the next step's first is the step's end.
fn law(id: &str, pair: &Pair) -> Result<(), String> {
    let Tableau { a, b, c } = pair.tableau;
    for (row, c) in a.iter().zip(c) {
        let off = (row.iter().sum::<f64>() - c).abs();
        // Entries up to 44: measured 6.2e-15.
        if off > 1.5e-14 {
            return Err(format!("row of node {c}: off by {off:.1e}"));
        }
    }
    let beside = match pair.estimate {
        ErrorEstimate::Embedded { order, weights } => vec![(order, weights)],
        ErrorEstimate::Mixed53 { fifth, third } => vec![(5, fifth), (3, third)],
    };
    let embedded = beside.into_iter().map(|(order, e)| (order, less(b, e)));
    for (stated, weights) in [(published(id), b.to_vec())].into_iter().chain(embedded) {
        let found = pair.tableau.order(&weights);
        if found != stated {
            return Err(format!("order {found} instead of {stated}"));
        }
    }
    let end = a
        .last()
        .is_some_and(|row| b.strip_prefix(*row) == Some(&[0.0]));
    if end != pair.first_same_as_last {
        return Err("the last stage".into());
    }
    Ok(())
}

#[test]
fn every_order_condition_holds() {
    for (id, pair) in pairs() {
        law(id, pair).unwrap_or_else(|wrong| panic!("{}: {wrong}", id));
    }
}

/// A digit wrong in the eleventh place, and two entries swapped, anywhere.
#[test]
fn wrong_coefficients_break_a_condition() {
    for (id, right) in pairs() {
        let Tableau { a, b, c } = right.tableau;
        let mut mutants = Vec::new();
        let mut with = |a: Vec<Vec<f64>>, b: Vec<f64>, c: Vec<f64>| {
            let rows: Vec<&'static [f64]> = a.into_iter().map(|row| &*row.leak()).collect();
            mutants.push(Tableau {
                a: rows.leak(),
                b: b.leak(),
                c: c.leak(),
            });
        };
        let rows: Vec<Vec<f64>> = a.iter().map(|row| row.to_vec()).collect();
        for stage in 0..b.len() {
            if b[stage] != 0.0 {
                let mut wrong = b.to_vec();
                wrong[stage] += 1e-11;
                with(rows.clone(), wrong, c.to_vec());
            }
            let mut wrong = c.to_vec();
            wrong[stage] += 1e-11;
            with(rows.clone(), b.to_vec(), wrong);
            for entry in 0..rows[stage].len() {
                let mut wrong = rows.clone();
                wrong[stage][entry] += 1e-11;
                with(wrong, b.to_vec(), c.to_vec());
                if entry > 0 && rows[stage][entry - 1] != rows[stage][entry] {
                    let mut wrong = rows.clone();
                    wrong[stage].swap(entry - 1, entry);
                    with(wrong, b.to_vec(), c.to_vec());
                }
            }
        }
        for tableau in mutants {
            law(id, &Pair { tableau, ..*right }).unwrap_err();
        }
    }
}

#[test]
fn wrong_estimates_break_a_condition() {
    let id = "dormand_prince54";
    let right = pair(id);
    let ErrorEstimate::Embedded { order, weights } = right.estimate else {
        panic!("an embedded formula");
    };
    let mut sign = weights.to_vec();
    sign[6] = -sign[6];
    let dropped: Vec<f64> = weights[..6].to_vec();
    // One that estimates nothing is the formula itself, of an order too high.
    for weights in [sign, dropped, vec![0.0; 7]] {
        let weights = weights.leak();
        let estimate = ErrorEstimate::Embedded { order, weights };
        law(id, &Pair { estimate, ..*right }).unwrap_err();
    }
}

/// The fourth-order weights as they are printed (Hairer, Nørsett, Wanner, Solving ODEs I, table II.5.2)
/// and the nodes of DOP853 in closed form (there, II.5: with the square root of 6).
#[test]
fn published_values_are_met() {
    let five = pair("dormand_prince54");
    let ErrorEstimate::Embedded { weights, .. } = five.estimate else {
        panic!("an embedded formula");
    };
    let printed = [
        5179.0 / 57600.0,
        0.0,
        7571.0 / 16695.0,
        393.0 / 640.0,
        -92097.0 / 339_200.0,
        187.0 / 2100.0,
        1.0 / 40.0,
    ];
    for (ours, printed) in less(five.tableau.b, weights).iter().zip(printed) {
        // A rounding or two of numbers below 1.
        assert!((ours - printed).abs() < 2.3e-16, "{ours} {printed}");
    }
    let root = 6_f64.sqrt();
    let c = pair("dop853").tableau.c;
    let closed = [
        2.0 * (6.0 - root) / 135.0,
        (6.0 - root) / 45.0,
        (6.0 - root) / 30.0,
        (6.0 + root) / 30.0,
    ];
    for (ours, closed) in c[1..5].iter().zip(closed) {
        assert!((ours - closed).abs() < 1.2e-16, "{ours} {closed}");
    }
}

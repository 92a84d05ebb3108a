//! What rods do: how far each engine is off them, how that grows, and how much they pull.

use crate::measure::{Constrained, Growth, RodTension};
use crate::report::table::Table;
use crate::report::words;
use crate::verbs::Report;
use crate::verbs::run::Outcome;

/// Off a length by so much, for a cell of the table.
pub fn length_error(outcome: &Outcome) -> Option<String> {
    let rods = outcome.rods.as_ref()?;
    Some(match rods.length_growth {
        Some(Growth::Rounding) => "rounding".to_owned(),
        _ => words::sci(rods.length_error_max_m),
    })
}

/// One engine on its rods, for the terminal: label and text.
pub fn lines(report: &Report) -> Vec<(&'static str, String)> {
    let spoken = super::spoken_of(report, |o| o.rods.is_some());
    let Some((engine, rods)) =
        spoken.and_then(|o| Some((words::one_line(&o.engine), o.rods.as_ref()?)))
    else {
        return Vec::new();
    };
    let mut lines = vec![("rods", format!("{engine}: {}", off(rods)))];
    if let Some((least, most)) = rods.tension_min.as_ref().zip(rods.tension_max.as_ref()) {
        let text = format!(
            "their tension is from {} to {}",
            tension(least),
            tension(most)
        );
        lines.push(("", text));
    }
    lines
}

/// `lengths off by at most 1.2e-5 m (rod 0), which grows as t^1.0; velocity along rods at most 3e-4 m/s, which ...`
fn off(rods: &Constrained) -> String {
    let mut text = match rods.length_growth {
        Some(Growth::Rounding) => "lengths are kept to rounding".to_owned(),
        growth => format!(
            "lengths are off by at most {} m (rod {} at {} s){}",
            words::short(rods.length_error_max_m),
            rods.rod,
            words::short(rods.t_s),
            grows(growth)
        ),
    };
    if let Some(along) = rods.velocity_along_max_m_s {
        text += &match rods.velocity_growth {
            Some(Growth::Rounding) => "; no velocity along them, to rounding".to_owned(),
            growth => format!(
                "; velocity along them at most {} m/s{}",
                words::short(along),
                grows(growth)
            ),
        };
    }
    text
}

fn grows(growth: Option<Growth>) -> String {
    match growth {
        None | Some(Growth::Rounding) => String::new(),
        Some(Growth::Bounded) => ", which does not grow".to_owned(),
        Some(Growth::Power { exponent }) => format!(", which grows as t^{exponent:.1}"),
    }
}

/// The law alone: `t^1.0`.
fn law(growth: Option<Growth>) -> Option<String> {
    Some(match growth? {
        Growth::Rounding => "rounding".to_owned(),
        Growth::Bounded => "bounded".to_owned(),
        Growth::Power { exponent } => format!("t^{exponent:.1}"),
    })
}

/// `29.4 N in rod 0 at 0.5 s`
fn tension(tension: &RodTension) -> String {
    let (newtons, t) = (words::short(tension.tension_n), words::short(tension.t_s));
    format!("{newtons} N in rod {} at {t} s", tension.rod)
}

/// The table of all engines; empty without rods.
pub fn markdown(report: &Report) -> String {
    let rows: Vec<(&Outcome, &Constrained)> = report
        .outcomes()
        .iter()
        .filter_map(|outcome| Some((outcome, outcome.rods.as_ref()?)))
        .collect();
    if rows.is_empty() {
        return String::new();
    }
    let mut table = Table::new(&rows);
    table.engines(|(o, _)| (super::engine(o), report.header.mark(&o.engine)));
    table.markdown("length off by (m)", |(_, rods)| {
        Some(words::short(rods.length_error_max_m))
    });
    table.markdown("length error grows as", |(_, rods)| law(rods.length_growth));
    table.markdown("velocity along (m/s)", |(_, rods)| {
        rods.velocity_along_max_m_s.map(words::short)
    });
    table.markdown("velocity grows as", |(_, rods)| law(rods.velocity_growth));
    table.markdown("projection put in (J)", |(o, _)| {
        o.energy.as_ref()?.projected_j.map(words::short)
    });
    table.markdown("smallest tension", |(_, rods)| {
        rods.tension_min.as_ref().map(tension)
    });
    table.markdown("largest tension", |(_, rods)| {
        rods.tension_max.as_ref().map(tension)
    });
    let intro = "Forces along rods keep accelerations right, so what is left of their lengths is each method's own error, which \
                 grows, unless states are moved back onto the rods. The energy that this puts in is part of the energy error. \
                 A tension is the multiplier that the state asks for: above 0 the rod pulls, below it pushes.";
    format!("{intro}\n\n{}", table.in_markdown())
}

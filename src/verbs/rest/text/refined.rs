//! What refining does, in words.

use crate::report::table::Table;
use crate::report::verdict::Clause;
use crate::report::words::{digits, one_line};
use crate::verbs::rest::{AtRest, Refined, Trend};
use std::f64::consts::TAU;

/// Orders within this of 0 are those of differences that stay.
const FLAT: f64 = 0.05;

pub const REFINED: &str = "\
Each link of the objects becomes so many. *continuum*: stiffness, damping and mass are scaled, so that the object stays the
same. *none*: each link and each particle keeps its own, so that the object becomes another. The order is the power of
1/links with which differences fall, from the three finest. A limit is told where the three before have the same order,
and it is above 1/2.
";

/// What refining the scene as it is does to the first quantity that has a limit.
pub fn tendency(rest: &AtRest) -> Option<Clause> {
    let told = |scaling: &'static str| {
        let mut trends = rest.trends.iter();
        trends.find(move |trend| trend.scaling == scaling && trend.order.is_some())
    };
    let trend = told("continuum")?;
    let (limit, order) = (trend.limit?, trend.order?);
    Some(vec![
        format!(
            "refined, {} tends to {} at order {order:.1}",
            quantity(&trend.quantity),
            amount(&trend.quantity, limit)
        ),
        String::new(),
    ])
}

/// What a quantity is called.
pub fn quantity(key: &str) -> String {
    let place = key
        .strip_prefix("omega_rad_s[")
        .and_then(|rest| rest.strip_suffix(']'));
    match place.and_then(|place| place.parse::<usize>().ok()) {
        None => "the distance moved".to_owned(),
        Some(0) => "the lowest frequency".to_owned(),
        Some(place) => format!("frequency {}", place + 1),
    }
}

fn amount(key: &str, value: f64) -> String {
    match key {
        _ if value == 0.0 => "0".to_owned(),
        "moved_m" => format!("{} m", digits(value)),
        _ => format!("{} rad/s", digits(value)),
    }
}

/// The table of finer scenes.
pub fn refinement(rest: &AtRest) -> Table<'_, Refined> {
    let mut table = Table::new(&rest.refined);
    table.left("scaling", "scaling", |row| (one_line(&row.scaling), None));
    table.right("links", "links", 0, |row| row.links.to_string());
    table.right("particles", "particles", 3, |row| row.particles.to_string());
    table.right("moved\n(m)", "moved (m)", 0, |row| row.moved_m.map(digits));
    for (at, name) in ["1st", "2nd", "3rd"].into_iter().enumerate() {
        let (terminal, markdown) = (
            format!("{name} freq.\n(rad/s)"),
            format!("{name} frequency (rad/s)"),
        );
        table.right(&terminal, &markdown, at as u8, |row| {
            row.omega_rad_s.get(at).map(|w| digits(*w))
        });
    }
    table.right("period\n(s)", "period (s)", 1, |row| {
        row.omega_rad_s.first().map(|w| digits(TAU / w))
    });
    table
}

/// The table of what quantities tend to.
pub fn trends(rows: &[Trend]) -> Table<'_, Trend> {
    let mut table = Table::new(rows);
    table.markdown("scaling", |row| one_line(&row.scaling));
    table.markdown("quantity", |row| quantity(&row.quantity));
    table.markdown("order", |row| row.order.map(|order| format!("{order:.2}")));
    table.markdown("tends to", |row| {
        row.limit.map(|limit| amount(&row.quantity, limit))
    });
    table
}

/// What a quantity tends to.
pub fn sentence(trend: &Trend) -> Option<String> {
    let (what, scaling) = (quantity(&trend.quantity), one_line(&trend.scaling));
    Some(match (trend.limit, trend.order?) {
        (Some(limit), order) => format!(
            "{scaling}: {what} tends to {} at order {order:.2}",
            amount(&trend.quantity, limit)
        ),
        (None, order) if order < -FLAT => format!(
            "{scaling}: {what} does not settle, differences grow as links^{:.2}",
            -order
        ),
        (None, order) => format!("{scaling}: no limit of {what} can be told (order {order:.2})"),
    })
}

//! The work-precision diagram in characters: one letter a setting, both axes logarithmic.

use super::{answer, is_timed};
use crate::outcome::{Cost, CostPoint, Report};
use crate::report::terminal::WIDTH;
use crate::report::terminal::fit::{clip, wrap};
use crate::report::terminal::paint::{Tone, mark};
use crate::report::words;

/// Characters of the field.
const COLUMNS: usize = 80;
const LINES: usize = 22;
/// Before the field: a label and the axis.
const LABEL: usize = 7;
/// Characters from one label below the axis to the next, at least.
const APART: f64 = 10.0;

/// One engine's letter and its settings as logarithms of cost and error.
struct Engine {
    letter: char,
    name: String,
    tone: Option<Tone>,
    points: Vec<[f64; 2]>,
}

/// What stands in one place of the field.
#[derive(Clone, Copy)]
struct Place {
    symbol: char,
    tone: Option<Tone>,
}

/// Decades shown along one axis.
#[derive(Clone, Copy)]
struct Decades {
    first: i32,
    last: i32,
}

impl Decades {
    /// Whole ones around the logarithms.
    fn around(values: impl Iterator<Item = f64>) -> Option<Decades> {
        let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| {
            (lo.min(v), hi.max(v))
        });
        (lo <= hi).then(|| {
            let first = lo.floor() as i32;
            Decades {
                first,
                last: (hi.ceil() as i32).max(first + 1),
            }
        })
    }

    /// The place of a logarithm among `count`; None outside.
    fn place(self, value: f64, count: usize) -> Option<usize> {
        let part = (value - f64::from(self.first)) / f64::from(self.last - self.first);
        (0.0..=1.0)
            .contains(&part)
            .then(|| (part * (count - 1) as f64).round() as usize)
    }

    /// Every n-th, so that they stand at least `apart` of `count` characters from each other.
    fn labelled(self, count: usize, apart: f64) -> impl Iterator<Item = i32> {
        let each = (count - 1) as f64 / f64::from(self.last - self.first);
        let every = (apart / each).ceil().max(1.0) as i32;
        (self.first..=self.last).filter(move |decade| decade.rem_euclid(every) == 0)
    }
}

/// The diagram with its legend; nothing where no setting has both an error and a cost.
pub fn plot(report: &Report, cost: &Cost) -> Vec<String> {
    let points = || cost.curves.iter().flat_map(|curve| &curve.points);
    let judged = points().any(|point| point.error_m.is_some());
    let error: fn(&CostPoint) -> Option<f64> = if judged {
        |point| point.error_m
    } else {
        |point| point.energy_error
    };
    let timed = is_timed(cost);
    let paid: fn(&CostPoint) -> Option<f64> = if timed {
        |point| point.wall_s.as_ref().map(|wall| wall.median)
    } else {
        |point| point.force_evaluations.map(|count| count as f64)
    };
    let engines = engines(report, cost, |point| {
        let log = |value: f64| (value > 0.0).then(|| value.log10());
        Some([log(paid(point)?)?, log(error(point)?)?])
    });
    let all = || engines.iter().flat_map(|engine| &engine.points);
    let marked: Vec<f64> = if judged {
        let targets = cost.targets.iter().map(|target| target.error_m);
        targets.filter(|e| *e > 0.0).map(f64::log10).collect()
    } else {
        Vec::new()
    };
    let x = Decades::around(all().map(|p| p[0]));
    let y = Decades::around(all().map(|p| p[1]).chain(marked));
    let (Some(x), Some(y)) = (x.filter(|_| all().next().is_some()), y) else {
        return Vec::new();
    };
    let mut field = [[None; COLUMNS]; LINES];
    let mut beside: Vec<(usize, String)> = Vec::new();
    if judged {
        level(&mut field, &mut beside, y, cost);
    }
    for engine in &engines {
        for [column, row] in engine.points.iter().filter_map(|p| {
            let row = y.place(p[1], LINES)?;
            Some([x.place(p[0], COLUMNS)?, LINES - 1 - row])
        }) {
            if let Some(place) = field.get_mut(row).and_then(|line| line.get_mut(column)) {
                let taken = place.is_some_and(|place: Place| place.symbol.is_alphanumeric());
                if !taken {
                    *place = Some(Place {
                        symbol: engine.letter,
                        tone: engine.tone,
                    });
                }
            }
        }
    }
    let what = match (judged, timed) {
        (true, true) => "error (m) over wall time (median)",
        (true, false) => "error (m) over force evaluations",
        (false, true) => "energy error over wall time (median)",
        (false, false) => "energy error over force evaluations",
    };
    let mut lines = vec![String::new(), what.to_owned()];
    lines.extend(drawn(&field, &beside, y));
    lines.extend(axis(x, timed));
    lines.extend(legend(&engines, judged && cost.floor_m.is_some()));
    lines
}

/// Every engine with something to show: the scene's own first, then as listed; integrators have small
/// letters, references capitals.
fn engines(
    report: &Report,
    cost: &Cost,
    place: impl Fn(&CostPoint) -> Option<[f64; 2]>,
) -> Vec<Engine> {
    let own =
        |curve: &&crate::outcome::CostCurve| curve.engine == report.header.scene.own_integrator;
    let first = cost.curves.iter().filter(own);
    let rest = cost.curves.iter().filter(|curve| !own(curve));
    let mut letters = [('a'..='z'), ('A'..='Z')];
    let mut engines = Vec::new();
    for curve in first.chain(rest) {
        let points: Vec<[f64; 2]> = curve.points.iter().filter_map(&place).collect();
        if points.is_empty() {
            continue;
        }
        let [small, capital] = &mut letters;
        let letter = if curve.is_ranked() {
            small.next()
        } else {
            capital.next()
        };
        engines.push(Engine {
            // More than 26 of a kind share the last.
            letter: letter.unwrap_or('0'),
            name: words::one_line(&curve.engine),
            tone: if curve.engine == report.header.scene.own_integrator {
                Some(Tone::Strong)
            } else if curve.is_ranked() {
                None
            } else {
                Some(Tone::Warn)
            },
            points,
        });
    }
    engines
}

/// Lines across the field: the targets and the floor.
fn level(
    field: &mut [[Option<Place>; COLUMNS]; LINES],
    beside: &mut Vec<(usize, String)>,
    y: Decades,
    cost: &Cost,
) {
    let floor = cost.floor_m.map(|floor| (floor, '═', "floor".to_owned()));
    let targets = cost
        .targets
        .iter()
        .map(|target| (target.error_m, '┈', answer::label(target)));
    for (error, symbol, label) in targets.chain(floor).filter(|(error, ..)| *error > 0.0) {
        let Some(row) = y.place(error.log10(), LINES).map(|row| LINES - 1 - row) else {
            continue;
        };
        let place = Place {
            symbol,
            tone: Some(Tone::Dim),
        };
        if let Some(line) = field.get_mut(row) {
            *line = [Some(place); COLUMNS];
        }
        if beside.iter().all(|(taken, _)| *taken != row) {
            beside.push((row, label));
        }
    }
}

fn drawn(
    field: &[[Option<Place>; COLUMNS]; LINES],
    beside: &[(usize, String)],
    y: Decades,
) -> Vec<String> {
    let labels: Vec<(usize, String)> = y
        .labelled(LINES, 2.0)
        .filter_map(|decade| {
            let row = y.place(f64::from(decade), LINES)?;
            Some((LINES - 1 - row, format!("1e{decade}")))
        })
        .collect();
    let find = |list: &[(usize, String)], row: usize| {
        let found = list.iter().find(|(at, _)| *at == row);
        found.map(|(_, label)| label.clone()).unwrap_or_default()
    };
    let lines = field.iter().enumerate().map(|(row, line)| {
        let label = clip(&find(&labels, row), LABEL);
        let tick = if label.is_empty() { '│' } else { '┤' };
        let text = runs(line);
        let right = clip(&find(beside, row), WIDTH - LABEL - 2 - COLUMNS);
        let text = format!("{label:>LABEL$}{tick}{text} {}", mark(Tone::Dim, &right));
        text.trim_end().to_owned()
    });
    lines.collect()
}

/// A line of the field, equal tones in one mark.
fn runs(line: &[Option<Place>]) -> String {
    let tone = |place: &Option<Place>| place.and_then(|place| place.tone);
    let alike = |a: &Option<Place>, b: &Option<Place>| {
        tone(a).map(|tone| tone as u8) == tone(b).map(|tone| tone as u8)
    };
    line.chunk_by(alike)
        .map(|run| {
            let text: String = run.iter().map(|p| p.map_or(' ', |p| p.symbol)).collect();
            let tone = run.first().and_then(tone);
            tone.map_or(text.clone(), |tone| mark(tone, &text))
        })
        .collect()
}

/// The rule below the field and its labels.
fn axis(x: Decades, timed: bool) -> [String; 2] {
    let mut rule = vec!['─'; COLUMNS];
    let mut labels = String::new();
    for decade in x.labelled(COLUMNS, APART) {
        let Some(column) = x.place(f64::from(decade), COLUMNS) else {
            continue;
        };
        if let Some(tick) = rule.get_mut(column) {
            *tick = '┴';
        }
        let label = power(decade, timed);
        // Centred on its tick, as far as the one before leaves room.
        let middle = (LABEL + 1 + column).saturating_sub(label.chars().count() / 2);
        let gap = middle.saturating_sub(labels.chars().count());
        labels += &" ".repeat(gap);
        labels += &label;
    }
    let rule: String = rule.into_iter().collect();
    [format!("{:>LABEL$}└{rule}", ""), clip(&labels, WIDTH)]
}

/// A power of ten of seconds or of evaluations.
fn power(decade: i32, timed: bool) -> String {
    let unit = match decade.div_euclid(3) {
        -3 => "ns",
        -2 => "µs",
        -1 => "ms",
        0 if decade < 3 => "s",
        _ => "",
    };
    match (timed, unit) {
        (false, _) => format!("1e{decade}"),
        (true, "") => format!("1e{decade} s"),
        (true, unit) => format!("{} {unit}", 10_i32.pow(decade.rem_euclid(3) as u32)),
    }
}

fn legend(engines: &[Engine], floor: bool) -> Vec<String> {
    // An entry stays on one line: its spaces are made unbreakable for the wrapping.
    const JOINED: char = '\u{a0}';
    let entry = |engine: &Engine| {
        let name = clip(&engine.name, 34).replace(' ', &JOINED.to_string());
        format!("{}{JOINED}{name}", engine.letter)
    };
    let entries: Vec<String> = engines.iter().map(entry).collect();
    let names = wrap(&entries.join(&format!("{JOINED} ")), WIDTH, "  ");
    let mut lines: Vec<String> = names
        .iter()
        .map(|line| line.replace(JOINED, " ").trim_end().to_owned())
        .collect();
    let mut about = "where several meet, the first of them is shown | ┈ target".to_owned();
    if floor {
        about += " | ═ floor";
    }
    lines.push(mark(Tone::Dim, &about));
    lines
}

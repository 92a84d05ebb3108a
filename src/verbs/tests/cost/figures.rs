//! Each claim of the figures against the data.

use super::super::samples::Reach;
use super::samples::*;
use crate::verbs::tests::data::*;

fn figure(report: &Report, wanted: &str) -> String {
    let mut figures = report.svg().into_iter();
    figures.find(|(file, _)| *file == wanted).unwrap().1
}

fn attribute(node: roxmltree::Node, name: &str) -> f64 {
    node.attribute(name).unwrap().parse().unwrap()
}

/// Circles of one colour inside the panel: centre and whether they are filled.
fn circles(svg: &str, colour: &str) -> Vec<([f64; 2], bool)> {
    let document = roxmltree::Document::parse(svg).unwrap();
    document
        .descendants()
        .filter(|node| node.has_tag_name("circle") && node.attribute("stroke") == Some(colour))
        .map(|node| {
            let centre = ["cx", "cy"].map(|name| attribute(node, name));
            (centre, node.attribute("fill") == Some(colour))
        })
        .collect()
}

/// Both axes are logarithmic and the line is the data's: three points fix each axis, the others follow.
/// On a linear axis they would be off by tens of pixels.
#[test]
fn points_lie_where_their_numbers_are() {
    let report = priced();
    let curve = &report.cost().unwrap().curves[3];
    assert_eq!(curve.engine, "rk4");
    let completed = curve.points.iter().filter(|p| p.error_m.is_some());
    let values: Vec<[f64; 2]> = completed
        .map(|p| [p.force_evaluations.unwrap() as f64, p.error_m.unwrap()])
        .collect();
    // The colour of rk4, the fifth of the usual methods; its label has one circle more.
    let points = circles(&figure(&report, "cost_evaluations.svg"), "#e69f00");
    assert_eq!(points.len(), values.len() + 1);
    for axis in 0..2 {
        let log = |at: usize| values[at][axis].log10();
        let pixel = |at: usize| points[at].0[axis];
        // The ends farthest apart along both axes: the first, and the one of the smallest error.
        let last = 8;
        let scale = (pixel(last) - pixel(0)) / (log(last) - log(0));
        for at in 0..values.len() {
            let expected = pixel(0) + scale * (log(at) - log(0));
            // Each pixel is rounded to 0.05, the scale's two with it.
            assert!((pixel(at) - expected).abs() < 0.2, "{axis} {at}");
        }
    }
}

/// Filled points are the front's; what diverged is a cross at the top.
#[test]
fn fronts_are_filled_and_divergence_is_crossed() {
    let mut report = priced();
    let cost = report.cost_mut();
    cost.curves[3].pareto = vec![2, 5];
    let svg = figure(&report, "cost_time.svg");
    let points = circles(&svg, "#e69f00");
    // Point 0 diverged, so that index 2 is the second circle. The last is the label's.
    let filled: Vec<usize> = (0..points.len()).filter(|at| points[*at].1).collect();
    assert_eq!(filled, [1, 4, points.len() - 1]);
    let document = roxmltree::Document::parse(&svg).unwrap();
    let strokes = |colour: &str| {
        let paths = document.descendants().filter(|node| {
            node.attribute("stroke") == Some(colour) && node.attribute("stroke-width") == Some("2")
        });
        paths.count()
    };
    // explicit_euler diverged at three steps, rk4 at one; a cross is two strokes.
    assert_eq!([strokes("#0072b2"), strokes("#e69f00")], [6, 2]);
}

#[test]
fn targets_are_dashed_lines_and_the_floor_is_grey() {
    let count =
        |report: &Report, text: &str| figure(report, "cost_energy.svg").matches(text).count();
    let svg = figure(&priced(), "cost_time.svg");
    assert_eq!(svg.matches(r#"stroke-dasharray="5 4""#).count(), 3);
    for label in [">1e-2 m<", ">1e-6 m<", ">1e-15 m<"] {
        assert_eq!(svg.matches(label).count(), 1, "{label}");
    }
    // The area, and its entry in the legend.
    assert_eq!(svg.matches(r##"fill="#efefef""##).count(), 2);
    assert_eq!(svg.matches("below the truth’s own error").count(), 1);
    // Neither is about energy.
    assert_eq!(count(&priced(), r#"stroke-dasharray="5 4""#), 0);
    assert_eq!(count(&priced(), "#efefef"), 0);
}

#[test]
fn rapier_is_dashed_and_left_out_where_it_does_not_count() {
    let report = priced();
    let dashed = r##"stroke="#000000" stroke-width="1.6" stroke-linejoin="round" stroke-linecap="butt" stroke-dasharray="7 4""##;
    // The line and its label's.
    assert_eq!(figure(&report, "cost_time.svg").matches(dashed).count(), 2);
    let evaluations = figure(&report, "cost_evaluations.svg");
    assert_eq!(evaluations.matches(dashed).count(), 0);
    assert!(evaluations.contains("without numbers for this: rapier, rapier-forces"));
}

/// From the minimum to the median and the deviation, where that is wider than the point.
#[test]
fn wide_spreads_have_whiskers() {
    let mut report = priced();
    let whiskers = |report: &Report, file: &str| {
        let look = r##"fill="none" stroke="#e69f00" stroke-width="0.9" "##;
        figure(report, file).matches(look).count()
    };
    assert_eq!(whiskers(&report, "cost_time.svg"), 0);
    assert!(!figure(&report, "cost_time.svg").contains("bars: from"));
    let point = &mut report.cost_mut().curves[3].points[4];
    let wall = point.wall_s.as_mut().unwrap();
    (wall.min, wall.mad) = (0.5 * wall.median, Some(wall.median));
    assert_eq!(whiskers(&report, "cost_time.svg"), 1);
    assert!(figure(&report, "cost_time.svg").contains("bars: from the shortest run"));
    assert_eq!(whiskers(&report, "cost_evaluations.svg"), 0);
}

/// Each panel has every step twice, as a curve and as a difference, and the truth once.
#[test]
fn panels_hold_every_step_and_the_truth() {
    let report = classic();
    let panels = report.panels().unwrap();
    let count = panels.panels.len();
    let svg = figure(&report, "cost_panels.svg");
    let lines = |colour: &str, width: &str| {
        let look = format!(r#"stroke="{colour}" stroke-width="{width}" stroke-linejoin"#);
        svg.matches(&look).count()
    };
    // One more each in the legend.
    assert_eq!(lines("#000000", "2.6"), count + 1);
    for colour in ["#0072b2", "#d55e00", "#009e73"] {
        assert_eq!(lines(colour, "1.5"), 2 * count + 1, "{colour}");
    }
    for h in ["h = 0.15 s", "h = 0.05 s", "h = 0.01 s"] {
        assert_eq!(svg.matches(h).count(), 1);
    }
}

/// What grows without bound does not decide the axis: the truth still fills a third of it.
#[test]
fn panels_are_not_scaled_to_what_explodes() {
    let mut report = classic();
    let height = |report: &Report| {
        let svg = figure(report, "cost_panels.svg");
        let truth = r##"stroke="#000000" stroke-width="2.6""##;
        let line = svg.lines().filter(|line| line.contains(truth)).nth(1);
        let data = line.unwrap().split('"').nth(1).unwrap().to_owned();
        let heights = data.split(['M', 'L']).filter(|pair| !pair.is_empty());
        let heights: Vec<f64> = heights
            .map(|pair| pair.split(' ').nth(1).unwrap().parse().unwrap())
            .collect();
        let fold = |f: fn(f64, f64) -> f64| heights.iter().copied().reduce(f).unwrap();
        fold(f64::max) - fold(f64::min)
    };
    // 1 m, on each side half of that for what leaves it and a twentieth of all as margin, on 110 pixels:
    // 50, each end rounded to 0.05. What explodes reaches thousands of metres.
    let expected = |height: f64| (height - 110.0 / 2.2).abs() < 0.2;
    assert!(expected(height(&report)), "{}", height(&report));
    let panels = report.panels_mut();
    for [_, x] in &mut panels.panels[1].lines[1].curve {
        *x *= 1e6;
    }
    assert!(expected(height(&report)), "{}", height(&report));
}

/// Differences a million times smaller look the same: each panel's have an axis of their own.
#[test]
fn differences_have_an_axis_of_their_own() {
    let lines = |report: &Report| -> Vec<String> {
        let svg = figure(report, "cost_panels.svg");
        let lines = svg.lines().filter(|line| line.contains("stroke-linejoin"));
        lines.map(str::to_owned).collect()
    };
    let mut report = classic();
    let before = lines(&report);
    let panels = report.panels_mut();
    for line in &mut panels.panels[2].lines {
        for [_, difference] in &mut line.difference {
            *difference *= 1e-6;
        }
    }
    assert_eq!(lines(&report), before);
    let panels = report.panels_mut();
    for [_, difference] in &mut panels.panels[2].lines[0].difference {
        *difference *= 0.5;
    }
    assert_ne!(lines(&report), before);
}

//! What laws judge: the runs of a plan, and what is known of each.

use crate::integrators::{Coefficients, Method, Settings};
use crate::measure::stability::{Limit, Linearised, Prediction};
use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use crate::solvers::{SolverKind, Status};
use crate::trajectory::{Precision, Trajectory};
use crate::verbs::Report;
use crate::verbs::check::Gate;
use crate::verbs::run::{Case, Outcome, Plan, Record};
use std::sync::OnceLock;

/// A plan that ran.
pub(in crate::verbs::check) struct Ran<'a> {
    pub gate: &'a Gate<'a>,
    pub report: &'a Report,
    pub records: &'a [Record],
    /// The scene linearised about its start; None where that takes longer than the runs.
    pub linearised: Option<Linearised>,
    /// See [`sizes`](Self::sizes), by case.
    sizes: Vec<OnceLock<Vec<f64>>>,
}

/// One run that left a trajectory or the reason why not.
#[derive(Clone, Copy)]
pub(in crate::verbs::check) struct Subject<'a> {
    /// The place of its case in the plan.
    at: usize,
    pub case: &'a Case,
    pub record: &'a Record,
    pub outcome: &'a Outcome,
    /// The method it is, or claims to be.
    pub method: Option<&'static Method>,
}

impl Subject<'_> {
    /// Whether another program computed it, whose work is not its own account but that of the scene's forces along
    /// its path.
    pub fn is_other(&self) -> bool {
        self.case.solver.kind == SolverKind::External
    }
}

impl<'a> Ran<'a> {
    pub fn new(
        gate: &'a Gate<'a>,
        report: &'a Report,
        records: &'a [Record],
        linearised: Option<Linearised>,
    ) -> Self {
        Self {
            gate,
            report,
            records,
            linearised,
            sizes: records.iter().map(|_| OnceLock::new()).collect(),
        }
    }

    pub fn plan(&self) -> &'a Plan<'a> {
        &self.gate.plan
    }

    pub fn scene(&self) -> &'a Scene {
        self.gate.plan.scene
    }

    pub fn system(&self) -> &'a ParticleSystem {
        &self.gate.plan.system
    }

    pub fn subjects(&self) -> impl Iterator<Item = Subject<'a>> + '_ {
        let cases = self.gate.plan.cases.iter().zip(self.records);
        let all = cases.zip(self.report.outcomes());
        all.enumerate()
            .map(|(at, ((case, record), outcome))| Subject {
                at,
                case,
                record,
                outcome,
                method: self.gate.scheme(case).and_then(|scheme| scheme.method),
            })
    }

    /// Those that ran to their end and have velocities, with their trajectory and method.
    pub fn whole(&self) -> impl Iterator<Item = (Subject<'a>, &'a Trajectory, &'static Method)> {
        self.subjects().filter_map(|subject| {
            let run = subject.record.trajectory.as_ref()?;
            let whole = subject.record.status == Status::Completed && run.has_velocities();
            whole.then_some((subject, run, subject.method?))
        })
    }

    /// The prediction for a method at a step; None where it is not known.
    pub fn predicted(&self, method: &Method, timestep: f64) -> Option<Prediction> {
        Some(self.linearised.as_ref()?.predict(method, timestep))
    }

    /// Whether a step is known to lie inside the method's stability limit here.
    pub fn inside(&self, method: &Method, timestep: f64) -> bool {
        let prediction = self.predicted(method, timestep);
        prediction.is_some_and(|p| match p.limit {
            Limit::At(limit) => timestep <= limit * (1.0 - p.error),
            other => other.allows(timestep),
        })
    }

    /// Whether nothing is fixed.
    pub fn is_free(&self) -> bool {
        // Obstacles push, as what is fixed does.
        self.scene().particles.iter().all(|p| !p.fixed) && self.scene().colliders.is_empty()
    }

    /// The relative rounding of one of a run's numbers in each step: that of its arithmetic, and of its solves.
    pub fn rounding(&self, subject: &Subject, run: &Trajectory) -> f64 {
        let single = matches!(
            run.rows().precision,
            Precision::Single | Precision::SingleDecimals(_)
        );
        let bit = if single {
            f64::from(f32::EPSILON)
        } else {
            f64::EPSILON
        };
        let solves = |method: &Method| matches!(method.coefficients, Coefficients::Implicit(_));
        let solved = subject.method.is_some_and(solves);
        let tolerance = Settings::stated(self.scene().solver.tolerance).tolerance;
        // A dozen operations a step, and a dozen forces on a particle.
        16.0 * bit + if solved { tolerance } else { 0.0 }
    }

    /// The sum of m (|v| + h |a|) at each instant of a run, kg m/s: what rounding in a step is relative to. Several
    /// laws use it, and it is computed once.
    pub fn sizes(&self, subject: &Subject, run: &Trajectory) -> &[f64] {
        let size = |k: usize| {
            let (x, v) = (run.x(k), run.v(k));
            let mut a = vec![0.0; x.len()];
            self.system().acceleration(run.time(k), x, v, &mut a);
            let h = subject.case.label.timestep;
            let each = self.scene().particles.iter().enumerate();
            each.map(|(i, p)| {
                let (v, a) = (norm(&v[3 * i..3 * i + 3]), norm(&a[3 * i..3 * i + 3]));
                if p.fixed { 0.0 } else { p.mass * (v + h * a) }
            })
            .sum()
        };
        self.sizes[subject.at].get_or_init(|| (0..run.len()).map(size).collect())
    }

    /// The sum of m times what a recorded velocity is rounded by, kg m/s.
    pub fn recorded(&self, run: &Trajectory, k: usize) -> f64 {
        let rows = run.rows();
        let v = run.v(k).chunks_exact(3).zip(&self.scene().particles);
        let each = v.map(|(v, p)| {
            let half: f64 = v.iter().map(|v| rows.precision_v.half_unit(*v)).sum();
            p.mass * half
        });
        each.sum()
    }
}

pub(super) fn norm(vector: &[f64]) -> f64 {
    vector.iter().map(|c| c * c).sum::<f64>().sqrt()
}

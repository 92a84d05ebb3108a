//! `springcheck` holds hand-written particle-spring integrators against rapier and the laws of
//! mechanics. It says which gain or lose energy, how far each is from the truth, and at what cost.
//!
//! Data flows one way, and the modules are its stages in order:
//!
//! ```text
//! scene file -> Scene -> System (flat vectors, forces) -> Solver (integrator | pair | rapier | program)
//!            -> Trajectory -> measures (truth, laws) -> Report -> terminal, Markdown, JSON, SVG
//! ```
//!
//! - [`scene`] reads a YAML file, strictly;
//! - [`physics`] holds the forces: a [`System`](physics::System) of flat vectors, accelerations and Jacobians, from
//!   the [`effects`](physics::effects) the scene calls for and no others;
//! - [`integrators`] are rows of facts over three steppers: tableau, splitting, Newton; beside them are
//!   [`adaptive`](integrators::adaptive) pairs, which choose their own steps;
//! - [`solvers`] run an integrator, rapier worlds built from the same scene, or other programs;
//! - [`truth`] is the true motion: a closed form or a converged reference, with an error bar;
//! - [`trajectory`] keeps a bounded record of a run, or all of it in a file, and reads those of other
//!   programs;
//! - [`measure`] turns records into errors, energy verdicts, deviations, orders, the scheme they follow,
//!   stability limits, and the twin proof;
//! - [`conformance`] holds any integrator, ours or yours, to the facts it claims;
//! - [`report`] holds what all reports share: tables, sentences, charts;
//! - [`verbs`] holds the program's verbs, one folder each: arguments, plan, result, text and figures of
//!   a [`Report`](verbs::Report).
//!
//! ```
//! use springcheck::verbs;
//! use springcheck::verbs::session::Quiet;
//! use springcheck::verbs::run::{Choice, Plan};
//! use springcheck::{measure::EnergyClass, scene};
//!
//! let yaml = b"solver: {type: explicit_euler, timestep: 0.01, gravity: 0}
//! particles:
//! - {pos: [0, 0, 0], fixed: true}
//! - {pos: [0.5, 0, 0], mass: 1}
//! springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]
//! ";
//! let scene = scene::parse(yaml, "oscillator.yml", verbs::names())?;
//! let plan = Plan::new(&scene, &Choice::default_for(&scene));
//! let report = plan.execute(&Quiet)?;
//! let energy = report.outcomes()[0].energy.as_ref().expect("it ran");
//! assert_eq!(energy.class, Some(EnergyClass::Growing));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod conformance;
mod gram;
pub mod integrators;
mod joined;
mod krylov;
pub mod measure;
pub mod physics;
pub mod report;
pub mod scene;
pub mod shape;
pub mod solvers;
mod space;
pub mod trajectory;
pub mod truth;
mod vector;
pub mod verbs;

//! What acts and what steps, against the laws it has to obey: effects, integrators, pairs that choose
//! their own steps, and rapier's engines against the methods of ours that they are.
//!
//! A new law, a new mutant of an integrator, a new hard scene and a new twin of rapier belong here.

mod adaptive;
mod bending;
mod coincidence;
mod collisions;
mod conformance;
mod contact;
mod damped_contact;
mod damping_flow;
mod driven;
mod effects;
mod force_kinds;
mod hard;
mod implicit;
mod kernel;
mod magnetic;
mod many_impacts;
mod momentum;
mod objects;
mod order;
mod oscillator;
mod penalty;
mod rapier_contact;
mod rest;
mod rods;
mod rods_energy;
mod rods_order;
mod solver;
mod stiff;
mod strain;
#[path = "../testkit/mod.rs"]
mod testkit;
mod time;
mod twins;

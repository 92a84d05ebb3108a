//! A direction of descent at every state.
//!
//! Newton's own direction A⁻¹ r descends where the symmetric part of A = M - γ C - γ² K is positive
//! definite: r·d = dᵀ A d. Compressed springs and the turning of dampers can make it indefinite. Then
//! what is negative is left out spring by spring ([`Linearization::Definite`]; Teran et al. 2005,
//! SCA; for springs Choi & Ko 2002), and where a system cannot say what that is, masses are added
//! until A is definite. Where A is definite nothing is changed, so convergence to a minimum stays
//! quadratic.

use super::super::{StepError, largest};
use super::Newton;
use super::search::{Merit, Search};
use super::solver::Solved;
use super::stage::Stage;
use crate::physics::Linearization;

/// The first share of the masses added, and how it grows.
const SHIFT: f64 = 1.0;
const GROWTH: f64 = 4.0;
/// Tries with masses added: up to 4³⁰, 1e18 times the masses.
const SHIFTS: u32 = 30;

impl Newton {
    /// Overwrites `self.d` with Newton's direction at `self.at`, solved to `tolerance` at least. False
    /// where that need not be one of descent: the matrix is not positive definite.
    ///
    /// # Errors
    /// [`StepError::Singular`] where there is no memory for factors.
    pub(super) fn newton(&mut self, stage: &Stage, tolerance: f64) -> Result<bool, StepError> {
        self.assemble(stage, Linearization::Exact);
        self.try_direction(stage, tolerance)
    }

    /// Newton's whole step with the matrix [`newton`](Self::newton) left, definite or not, in
    /// `self.next`; false unless Φ does not rise and a tenth of the residual is left.
    ///
    /// A plane chain under compression would rather buckle sideways, where nothing pushes it: Φ then has
    /// a saddle, which solves the equation as well as a minimum does, and the directions of
    /// [`descend`](Self::descend) come near it only linearly.
    pub(super) fn leap(&mut self, stage: &Stage) -> bool {
        self.gather();
        if self.solver.solve_lu(&self.matrix, &mut self.z).is_err() {
            return false;
        }
        self.solves += 1;
        self.spread();
        let search = Search {
            stage,
            d: &self.d,
            jacobian: &self.jacobian,
            merit: Merit::Potential,
            extend: false,
            tolerance: self.tolerance,
        };
        search.leaps(&mut self.at, &mut self.next)
    }

    /// Overwrites `self.d` with a direction of descent where Newton's is none.
    ///
    /// # Errors
    /// [`StepError::Singular`] where nothing makes the matrix definite.
    pub(super) fn descend(&mut self, stage: &Stage, tolerance: f64) -> Result<(), StepError> {
        self.assemble(stage, Linearization::Definite);
        if self.try_direction(stage, tolerance)? {
            return Ok(());
        }
        let mut shift = SHIFT;
        for _ in 0..SHIFTS {
            let more = shift * (1.0 - 1.0 / GROWTH);
            let inverse_mass = stage.system.inverse_mass();
            self.matrix
                .add_masses(if shift == SHIFT { shift } else { more }, inverse_mass);
            if self.try_direction(stage, tolerance)? {
                return Ok(());
            }
            shift *= GROWTH;
        }
        Err(StepError::Singular {
            particle: self.at.particle(),
        })
    }

    pub(super) fn assemble(&mut self, stage: &Stage, kept: Linearization) {
        let (system, t) = (stage.system, stage.t);
        self.jacobian.clear();
        system.jacobian(t, &self.at.x, &self.at.u, kept, &mut self.jacobian);
        let inverse_mass = system.inverse_mass();
        if self
            .matrix
            .assemble(inverse_mass, stage.gamma, &self.jacobian)
        {
            self.solver.forget();
        }
    }

    /// False where the matrix is not positive definite, or too nearly so for a finite direction.
    fn try_direction(&mut self, stage: &Stage, tolerance: f64) -> Result<bool, StepError> {
        self.gather();
        let inverse_mass = stage.system.inverse_mass();
        let solved = self
            .solver
            .solve(&self.matrix, inverse_mass, tolerance, &mut self.z)?;
        if solved == Solved::Indefinite {
            return Ok(false);
        }
        self.solves += 1;
        self.spread();
        // Scaled, for what has nearly come to rest: products would underflow. A direction that has
        // itself underflowed to 0 leads nowhere, and is as good as any.
        let (far, steep) = (largest(&self.d), largest(&self.at.residual));
        let pairs = self.d.iter().zip(&self.at.residual);
        let along: f64 = pairs.map(|(d, r)| (d / far) * (r / steep)).sum();
        // NaN is not positive.
        Ok(far == 0.0 || (along > 0.0 && far.is_finite()))
    }

    /// From the residual at `self.at` to the matrix's rows, `self.z`.
    pub(super) fn gather(&mut self) {
        let residual = &self.at.residual;
        self.z.clear();
        let rows = self.matrix.coordinates().iter();
        self.z
            .extend(rows.map(|&at| residual.get(at).copied().unwrap_or(0.0)));
    }

    /// From the matrix's rows, `self.z`, to coordinates, `self.d`.
    pub(super) fn spread(&mut self) {
        self.d.fill(0.0);
        for (&at, z) in self.matrix.coordinates().iter().zip(&self.z) {
            if let Some(d) = self.d.get_mut(at) {
                *d = *z;
            }
        }
    }
}

//! How much work a prediction may be.

/// Sizes, in coordinates that couple, up to which things are done, and how far Krylov spaces go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// All modes of a symmetric stiffness, damped by themselves.
    pub symmetric: usize,
    /// All eigenvalues where damping couples them, of a matrix twice that size.
    pub unsymmetric: usize,
    /// One-step maps as matrices, whose limit is searched.
    pub map: usize,
    /// Coordinates up to which Verlet's limit with coupled damping is found to the end; beyond, the
    /// stiffest vector alone bounds it from above.
    pub flow: usize,
    /// Coordinates up to which outermost eigenvalues are looked for where damping couples; beyond
    /// they lie too close together for one Krylov space.
    pub outermost: usize,
    /// Vectors in a Krylov space.
    pub space: usize,
    /// How often such a space is begun anew from its best vector.
    pub restarts: usize,
    /// Residual, relative to the spectrum's size, at which a vector counts as found; an eigenvalue is
    /// then good to its square.
    pub found: f64,
}

impl Effort {
    /// Some seconds for a method on a scene of several hundred coupled coordinates.
    pub const FULL: Self = Self {
        symmetric: 600,
        unsymmetric: 300,
        map: 60,
        flow: 600,
        outermost: 1_800,
        space: 320,
        restarts: 8,
        found: 1e-10,
    };
    /// Some tens of milliseconds on such a scene.
    pub const BRIEF: Self = Self {
        symmetric: 120,
        unsymmetric: 40,
        map: 12,
        flow: 12,
        outermost: 270,
        space: 60,
        restarts: 2,
        found: 1e-3,
    };
}

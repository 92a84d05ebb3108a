//! Derivatives of one spring's force.

use super::network::Spring;
use super::{Damping, SHORTEST, difference};
use crate::physics::Linearization;
use nalgebra::{Matrix3, Vector3};

/// ∂f_i/∂(x_j - x_i) and ∂f_i/∂(v_j - v_i) of one spring.
#[inline]
pub(super) fn blocks(
    spring: &Spring,
    damping: Damping,
    x: &[f64],
    v: &[f64],
    linearization: Linearization,
) -> (Matrix3<f64>, Matrix3<f64>) {
    let [i, j] = spring.ends.map(|end| 3 * end);
    let d = Vector3::from(difference(x, i, j));
    let length = d.norm();
    let (k, c) = (spring.stiffness, spring.damping);
    let identity = Matrix3::identity();
    if length <= SHORTEST {
        // Without a direction n there is no k n nᵀ, although the exact stiffness is k.
        let exact = linearization != Linearization::Material;
        let position = if exact && spring.rest_length == 0.0 {
            identity * k
        } else {
            Matrix3::zeros()
        };
        let isotropic = damping == Damping::Isotropic;
        return (position, identity * if isotropic { c } else { 0.0 });
    }
    let n = d / length;
    let axial = n * n.transpose();
    let velocity = match damping {
        Damping::None => Matrix3::zeros(),
        Damping::Axial => axial * c,
        Damping::Isotropic => identity * c,
    };
    let mut position = axial * k;
    if linearization != Linearization::Material {
        let definite = linearization == Linearization::Definite;
        let across = identity - axial;
        let tension = k * (length - spring.rest_length) / length;
        position += across * if definite { tension.max(0.0) } else { tension };
        if !definite && damping == Damping::Axial {
            let dv = Vector3::from(difference(v, i, j));
            let turned = n * (dv.transpose() * across) + across * dv.dot(&n);
            position += turned * (c / length);
        }
    }
    (position, velocity)
}

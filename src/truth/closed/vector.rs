//! Functions [`Vector3`] lacks: lengths and directions whose digits survive whatever their size.

use nalgebra::Vector3;

/// Length; exact along an axis, and for components whose squares leave the range of a double.
pub(super) fn norm(a: Vector3<f64>) -> f64 {
    let most = a.amax();
    if most == 0.0 {
        return 0.0;
    }
    most * (a / most).norm()
}

/// Direction, or None of a zero vector.
pub(super) fn unit(a: Vector3<f64>) -> Option<Vector3<f64>> {
    let most = a.amax();
    (most > 0.0).then(|| (a / most) / (a / most).norm())
}

/// How far `a` reaches out of the line along `b`: exactly 0 where it does not.
pub(super) fn across(a: Vector3<f64>, b: Vector3<f64>) -> f64 {
    let most = b.amax();
    if most == 0.0 {
        return norm(a);
    }
    let b = b / most;
    let cross = Vector3::new(
        difference_of_products(a[1], b[2], a[2], b[1]),
        difference_of_products(a[2], b[0], a[0], b[2]),
        difference_of_products(a[0], b[1], a[1], b[0]),
    );
    norm(cross) / norm(b)
}

/// a b - c d, within 1.5 ulp (Kahan; Jeannerod, Louvet, Muller 2013) and 0 where it is 0.
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let rounding = (-c).mul_add(d, cd);
    a.mul_add(b, -cd) + rounding
}

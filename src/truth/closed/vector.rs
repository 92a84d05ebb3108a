//! Three-component vectors, as positions come in scenes.

pub(super) fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn scaled(a: [f64; 3], by: f64) -> [f64; 3] {
    a.map(|a| by * a)
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Length; exact along an axis, and for components whose squares leave the range of a double.
pub(super) fn norm(a: [f64; 3]) -> f64 {
    let most = a.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    if most == 0.0 {
        return 0.0;
    }
    let a = a.map(|a| a / most);
    most * dot(a, a).sqrt()
}

/// Direction, or None of a zero vector.
pub(super) fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let most = a.iter().fold(0.0, |m: f64, a| m.max(a.abs()));
    let a = a.map(|a| a / most);
    let length = dot(a, a).sqrt();
    (most > 0.0).then(|| a.map(|a| a / length))
}

/// How far `a` reaches out of the line along `b`: exactly 0 where it does not.
pub(super) fn across(a: [f64; 3], b: [f64; 3]) -> f64 {
    let Some(most) = b
        .iter()
        .map(|b| b.abs())
        .reduce(f64::max)
        .filter(|m| *m > 0.0)
    else {
        return norm(a);
    };
    let b = b.map(|b| b / most);
    let cross = [
        difference_of_products(a[1], b[2], a[2], b[1]),
        difference_of_products(a[2], b[0], a[0], b[2]),
        difference_of_products(a[0], b[1], a[1], b[0]),
    ];
    norm(cross) / norm(b)
}

/// a b - c d, within 1.5 ulp (Kahan; Jeannerod, Louvet, Muller 2013) and 0 where it is 0.
fn difference_of_products(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let cd = c * d;
    let rounding = (-c).mul_add(d, cd);
    a.mul_add(b, -cd) + rounding
}

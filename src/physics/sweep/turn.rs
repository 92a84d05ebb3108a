//! The exact flow of a force that turns one particle's velocity: a magnetic field.
//!
//! v' = a + w P v, with P v = v x k for the unit vector k along the field. P turns what is across the field by a
//! quarter, so e^(w h P) turns it by w h (Rodrigues), and integrals of it have sines and cosines of w h.

use super::Sweep;
use nalgebra::Vector3;

impl Sweep<'_> {
    /// The force v x `b` on particle i, with `b` in kg/s: q B of a charge q in a field B.
    pub fn turn(&mut self, i: usize, b: [f64; 3]) {
        let Some([i, _]) = self.pair([i, i]) else {
            return;
        };
        let b = Vector3::from(b) * self.scale;
        let size = b.norm();
        let rate = size * self.inverse_mass[i];
        if rate == 0.0 {
            return;
        }
        let (k, z) = (b / size, rate * self.h);
        let after = |v: Vector3<f64>| {
            let (quarter, half) = (v.cross(&k), v.cross(&k).cross(&k));
            move |[by_quarter, by_half]: [f64; 2]| by_quarter * quarter + by_half * half
        };
        let read = |from: &[f64]| Vector3::from_column_slice(&from[i..i + 3]);
        let write =
            |to: &mut [f64], value: Vector3<f64>| to[i..i + 3].copy_from_slice(value.as_slice());
        let Some(a) = self.a.map(read) else {
            let z = if self.midpoint {
                2.0 * (0.5 * z).atan()
            } else {
                z
            };
            let v = read(self.v);
            write(self.v, v + after(v)(turned(z)));
            return;
        };
        let h = self.h;
        let before = read(self.v) - h * a;
        let once = turned_once(z);
        write(
            self.v,
            before + after(before)(turned(z)) + h * (a + after(a)(once)),
        );
        if let Some(moved) = &mut self.moved {
            let added = h * after(before)(once) + h * h * after(a)(turned_twice(z));
            write(moved, read(moved) + added);
        }
    }
}

/// e^(zP) - 1 as its parts along P and P².
fn turned(z: f64) -> [f64; 2] {
    [z.sin(), 2.0 * (0.5 * z).sin().powi(2)]
}

/// The same of φ1(zP) - 1, the mean of e^(sP) - 1 over s from 0 to z.
fn turned_once(z: f64) -> [f64; 2] {
    if z == 0.0 {
        return [0.0; 2];
    }
    [2.0 * (0.5 * z).sin().powi(2) / z, z * lag(z)]
}

/// The same of φ2(zP) - 1/2.
fn turned_twice(z: f64) -> [f64; 2] {
    let chord = if z == 0.0 {
        1.0
    } else {
        2.0 * (0.5 * z).sin() / z
    };
    [lag(z), 0.5 * (1.0 - chord * chord)]
}

/// (z - sin z) / z².
fn lag(z: f64) -> f64 {
    if z.abs() > 0.5 {
        return (z - z.sin()) / z / z;
    }
    // The closed form cancels here; eight terms of z/6 - z³/120 + ... reach rounding.
    (1..9).rev().fold(0.0, |sum, k| {
        let n = 2.0 * f64::from(k);
        (1.0 - z * z * sum) / (n * (n + 1.0))
    }) * z
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lag_is_continuous_where_the_series_takes_over() {
        // The closed form's cancellation is about 30 eps of a value of 0.08 there.
        for z in [0.5_f64, -0.5] {
            let closed = (z - z.sin()) / z / z;
            assert!((lag(z) - closed).abs() < 1e-15, "{z}");
        }
        assert_eq!(lag(0.0), 0.0);
        // mpmath, 30 digits: (z - sin z)/z² at z = 1e-3.
        assert!((lag(1e-3) / 1.666_666_583_333_335_3e-4 - 1.0).abs() < 4.0 * f64::EPSILON);
    }
}

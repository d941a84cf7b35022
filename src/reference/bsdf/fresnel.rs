//! Fresnel's equations from Snell's law and the two amplitudes, in complex numbers (E. Hecht,
//! *Optics*, 4.6 and 4.8), and Schlick's stand-in for them.

use glam::DVec3;
use std::ops::{Add, Div, Mul, Sub};

#[derive(Clone, Copy)]
struct Complex(f64, f64);

impl Add for Complex {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        Self(self.0 + b.0, self.1 + b.1)
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0, self.1 - b.1)
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0 - self.1 * b.1, self.0 * b.1 + self.1 * b.0)
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let top = self * Self(b.0, -b.1);
        let n = b.square();
        Self(top.0 / n, top.1 / n)
    }
}

impl Complex {
    fn square(self) -> f64 {
        self.0 * self.0 + self.1 * self.1
    }

    /// The root with a real part that is not negative.
    fn root(self) -> Self {
        let size = self.square().sqrt();
        let real = (0.5 * (size + self.0)).max(0.0).sqrt();
        let imaginary = (0.5 * (size - self.0)).max(0.0).sqrt();
        Self(real, imaginary.copysign(self.1))
    }
}

/// Reflectance of unpolarised light at a cosine, for the complex index `eta + i k` of the far side
/// over that of the near side. Total reflection included.
pub(super) fn fresnel(cos: f64, eta: f64, k: f64) -> f64 {
    if eta == 1.0 && k == 0.0 {
        return 0.0; // no boundary, whatever 0 / 0 there may be at grazing
    }
    let cos = cos.clamp(0.0, 1.0);
    let (near, index) = (Complex(cos, 0.0), Complex(eta, k));
    let sine = Complex((1.0 - cos * cos).sqrt(), 0.0) / index;
    let far = (Complex(1.0, 0.0) - sine * sine).root();
    let s = (near - index * far) / (near + index * far);
    let p = (index * near - far) / (index * near + far);
    0.5 * (s.square() + p.square())
}

/// Of each colour.
pub(super) fn fresnel_rgb(cos: f64, eta: DVec3, k: DVec3) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|c| fresnel(cos, eta[c], k[c])))
}

/// `2 int F(c) c dc`, by the midpoint rule: F is smooth in the cosine but for its end at grazing,
/// which the factor c mutes.
pub(super) fn fresnel_mean(eta: DVec3, k: DVec3) -> DVec3 {
    const STEPS: u32 = 1000;
    let at = |i| {
        let cos = (f64::from(i) + 0.5) / f64::from(STEPS);
        2.0 * cos * fresnel_rgb(cos, eta, k)
    };
    (0..STEPS).map(at).sum::<DVec3>() / f64::from(STEPS)
}

/// `(1 - cos)^5`: C. Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", 1994.
pub(super) fn schlick(cos: f64) -> f64 {
    (1.0 - cos).clamp(0.0, 1.0).powi(5)
}

/// Where light from `o` goes that a facet of normal `m` refracts, `eta` being the index of the far
/// side over that of the near one; nothing where reflection is total.
pub(super) fn refract(o: DVec3, m: DVec3, eta: f64) -> Option<DVec3> {
    let cos = o.dot(m);
    let square = 1.0 - (1.0 - cos * cos) / (eta * eta);
    (square > 0.0).then(|| ((cos / eta - square.sqrt()) * m - o / eta).normalize())
}

//! Densities to draw from by inversion: a map of the unit cube whose image has a known pdf.

/// A probability density with a map from the unit cube that draws from it.
///
/// The map must be *the* one: if `u` is uniform on `[0, 1)^D`, then `sample(u)` has density `pdf`.
/// It is used with stratified `u` as well as with independent ones, so a map that keeps neighbours
/// together keeps their strata.
pub trait Density<const D: usize> {
    /// Where the density lives: a number, a point, a direction.
    type Point;

    /// The point of `u`, each of whose coordinates lies in `[0, 1)`.
    fn sample(&self, u: [f64; D]) -> Self::Point;

    /// The density at `point`, in the measure of the integral at hand (length, area, volume, solid
    /// angle); 0 outside its support.
    fn pdf(&self, point: &Self::Point) -> f64;
}

/// The density on a line that `inverse_cdf` draws: inversion, written by hand.
///
/// If `P` is a cumulative distribution function and `u` is uniform, `P^-1(u)` is distributed by `P`.
///
/// ```
/// use huygens::estimate::{Density, Inversion};
/// // p = exp(-x) on 0..infinity; P = 1 - exp(-x).
/// let exponential = Inversion {
///     inverse_cdf: |u: f64| -(-u).ln_1p(),
///     pdf: |x: f64| (-x).exp(),
/// };
/// assert_eq!(exponential.sample([0.5]), 2f64.ln());
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Inversion<I, P> {
    /// From `[0, 1)` to the line, rising.
    pub inverse_cdf: I,
    /// The derivative of the cdf.
    pub pdf: P,
}

impl<I: Fn(f64) -> f64, P: Fn(f64) -> f64> Density<1> for Inversion<I, P> {
    type Point = f64;

    fn sample(&self, [u]: [f64; 1]) -> f64 {
        (self.inverse_cdf)(u)
    }

    fn pdf(&self, x: &f64) -> f64 {
        (self.pdf)(*x)
    }
}

/// Uniform over a box: `pdf = 1 / volume`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UniformBox<const D: usize> {
    low: [f64; D],
    extent: [f64; D],
    pdf: f64,
}

impl<const D: usize> UniformBox<D> {
    /// Over the box from `low` to `high`.
    ///
    /// # Panics
    /// If the box is empty or not finite.
    #[must_use]
    pub fn new(low: [f64; D], high: [f64; D]) -> Self {
        let extent: [f64; D] = std::array::from_fn(|d| high[d] - low[d]);
        assert!(
            extent.iter().all(|e| *e > 0.0 && e.is_finite()),
            "from {low:?} to {high:?} is no box"
        );
        let pdf = 1.0 / extent.iter().product::<f64>();
        Self { low, extent, pdf }
    }

    /// Over `[0, 1)^D`.
    #[must_use]
    pub fn unit() -> Self {
        Self::new([0.0; D], [1.0; D])
    }
}

impl<const D: usize> Density<D> for UniformBox<D> {
    type Point = [f64; D];

    fn sample(&self, u: [f64; D]) -> [f64; D] {
        std::array::from_fn(|d| self.low[d] + u[d] * self.extent[d])
    }

    fn pdf(&self, x: &[f64; D]) -> f64 {
        // Upper ends included: a sample may round up to one.
        let inside = |d: usize| (0.0..=self.extent[d]).contains(&(x[d] - self.low[d]));
        if (0..D).all(inside) { self.pdf } else { 0.0 }
    }
}

/// `p = (n + 1) x^n / b^(n + 1)` on `[0, b]`. The cdf is `(x/b)^(n + 1)`, its inverse
/// `b u^(1/(n + 1))`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Power {
    exponent: f64,
    end: f64,
}

impl Power {
    /// With exponent `n` on `[0, end]`.
    ///
    /// # Panics
    /// Unless `exponent > -1` and `end > 0`, both finite.
    #[must_use]
    pub fn new(exponent: f64, end: f64) -> Self {
        assert!(
            exponent > -1.0 && exponent.is_finite() && end > 0.0 && end.is_finite(),
            "x^{exponent} on 0..{end} is no density"
        );
        Self { exponent, end }
    }
}

impl Density<1> for Power {
    type Point = f64;

    fn sample(&self, [u]: [f64; 1]) -> f64 {
        self.end * u.powf(1.0 / (self.exponent + 1.0))
    }

    fn pdf(&self, x: &f64) -> f64 {
        if !(0.0..=self.end).contains(x) {
            return 0.0;
        }
        (self.exponent + 1.0) / self.end * (x / self.end).powf(self.exponent)
    }
}

/// Lorentz's (or Cauchy's) peak cut to an interval: `p ~ 1 / (w^2 + (x - c)^2)`. The cdf is a
/// difference of arc tangents, its inverse a tangent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lorentz {
    centre: f64,
    width: f64,
    low: f64,
    high: f64,
    /// Arc tangents at both ends.
    angles: [f64; 2],
}

impl Lorentz {
    /// About `centre`, of half width at half maximum `width`, on `[low, high]`.
    ///
    /// # Panics
    /// Unless `width > 0` and `low < high`, all finite.
    #[must_use]
    pub fn new(centre: f64, width: f64, low: f64, high: f64) -> Self {
        assert!(
            width > 0.0 && low < high && [centre, width, low, high].iter().all(|v| v.is_finite()),
            "a peak at {centre} of width {width} on {low}..{high} is no density"
        );
        let angles = [low, high].map(|x| ((x - centre) / width).atan());
        Self {
            centre,
            width,
            low,
            high,
            angles,
        }
    }
}

impl Density<1> for Lorentz {
    type Point = f64;

    fn sample(&self, [u]: [f64; 1]) -> f64 {
        let [a, b] = self.angles;
        // Clamped, since tan(atan(x)) may round past the end.
        (self.centre + self.width * (a + u * (b - a)).tan()).clamp(self.low, self.high)
    }

    fn pdf(&self, x: &f64) -> f64 {
        if !(self.low..=self.high).contains(x) {
            return 0.0;
        }
        let [a, b] = self.angles;
        let t = (x - self.centre) / self.width;
        1.0 / ((b - a) * self.width * (1.0 + t * t))
    }
}

//! The ellipsoid on which the readings of a unit at the size of gravity lie, `(y - c)^T A (y - c) = 1`; and the coarse scale and bias that it
//! gives to readings which are not in units of acceleration.

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

/// Least singular value that is not rounding or noise, over the largest.
const LEAST: f64 = 1e-4;

/// The same for a quadric near a sphere, which a misalignment of 0.01 then moves by 0.1 at most.
const HARDLY: f64 = 0.1;

/// The ellipsoid `(y - c)^T A (y - c) = 1` of readings at the size of gravity.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ellipsoid {
    centre: Vector3<f64>,
    a: Matrix3<f64>,
}

impl Ellipsoid {
    /// Through these readings, by linear least squares; `None` if they determine none: nine in general attitudes do.
    pub(super) fn through(means: &[Vector3<f64>]) -> Option<Self> {
        let Extent { middle, half } = Extent::of(means)?;
        let unit = Vector3::repeat(half.max());
        let row = |mean: &Vector3<f64>| terms(&(mean - middle).component_div(&unit));
        Self::of_quadric(solved(means, row)?, &middle, &unit)
    }

    /// The same with axes along those of the instrument, each in its own unit; six readings may suffice.
    fn along_axes(means: &[Vector3<f64>]) -> Option<Self> {
        let Extent { middle, half } = Extent::of(means)?;
        let row = |mean: &Vector3<f64>| {
            let [a, b, c, d, e, f, ..] = terms(&(mean - middle).component_div(&half));
            [a, b, c, d, e, f]
        };
        let [a, b, c, d, e, f] = solved(means, row)?;
        Self::of_quadric([a, b, c, d, e, f, 0.0, 0.0, 0.0], &middle, &half)
    }

    /// Through these readings. What they do not determine, or hardly, is as in an ideal unit: one scale, no bias, no misalignment.
    pub(super) fn nearest(means: &[Vector3<f64>]) -> Self {
        Self::through(means).or_else(|| Self::near_sphere(means)).unwrap_or_else(|| Self::sphere(means))
    }

    /// The sphere about zero through these readings.
    fn sphere(means: &[Vector3<f64>]) -> Self {
        let square = means.iter().map(Vector3::norm_squared).sum::<f64>() / means.len() as f64;
        Self { centre: Vector3::zeros(), a: Matrix3::identity() / square }
    }

    /// The quadric through these readings whose coefficients are nearest to those of the sphere.
    fn near_sphere(means: &[Vector3<f64>]) -> Option<Self> {
        let unit = Self::sphere(means).a.m11.sqrt().recip();
        let rows = DMatrix::from_row_iterator(means.len(), 9, means.iter().flat_map(|mean| terms(&(mean / unit))));
        let sphere = DVector::from_column_slice(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        if means.is_empty() || rows.iter().any(|value| !value.is_finite()) {
            return None;
        }
        let left = DVector::repeat(means.len(), 1.0) - &rows * &sphere;
        let svd = rows.svd(true, true);
        let x = sphere + svd.solve(&left, HARDLY * svd.singular_values.max()).ok()?;
        Self::of_quadric(std::array::from_fn(|k| x[k]), &Vector3::zeros(), &Vector3::repeat(unit))
    }

    /// Of the coefficients `x` of [`terms`] of readings `middle + unit y`; `None` if that is not an ellipsoid.
    fn of_quadric(x: [f64; 9], middle: &Vector3<f64>, unit: &Vector3<f64>) -> Option<Self> {
        let a = Matrix3::new(x[0], x[6], x[7], x[6], x[1], x[8], x[7], x[8], x[2]);
        let centre = a.cholesky()?.solve(&Vector3::new(x[3], x[4], x[5])) * -0.5;
        let size = 1.0 + centre.dot(&(a * centre));
        let per_unit = Matrix3::from_diagonal(&unit.map(f64::recip));
        Some(Self { centre: middle + centre.component_mul(unit), a: per_unit * a * per_unit / size })
    }

    pub(super) fn centre(&self) -> &Vector3<f64> {
        &self.centre
    }

    /// Direction of the noise that changes the size of a reading.
    pub(super) fn normal(&self, reading: &Vector3<f64>) -> Vector3<f64> {
        self.half_gradient(reading).normalize()
    }

    /// Half of what the square of the size of a reading exceeds that of gravity by, over the latter: about the excess of the size.
    pub(super) fn excess(&self, reading: &Vector3<f64>) -> f64 {
        0.5 * (self.half_gradient(reading).dot(&(reading - self.centre)) - 1.0)
    }

    /// Half the gradient of `(y - c)^T A (y - c)`.
    pub(super) fn half_gradient(&self, reading: &Vector3<f64>) -> Vector3<f64> {
        self.a * (reading - self.centre)
    }

    /// Size of a difference of readings in units of gravity.
    pub(super) fn size(&self, of: &Vector3<f64>) -> f64 {
        of.dot(&(self.a * of)).sqrt()
    }
}

/// The least box about some readings.
struct Extent {
    middle: Vector3<f64>,
    half: Vector3<f64>,
}

impl Extent {
    fn of(means: &[Vector3<f64>]) -> Option<Self> {
        let first = *means.first()?;
        let (low, high) = means.iter().fold((first, first), |(low, high), mean| (low.inf(mean), high.sup(mean)));
        Some(Self { middle: 0.5 * (low + high), half: 0.5 * (high - low) })
    }
}

/// Terms of a quadric: squares, components, twice the products.
fn terms(y: &Vector3<f64>) -> [f64; 9] {
    [y.x * y.x, y.y * y.y, y.z * y.z, y.x, y.y, y.z, 2.0 * y.x * y.y, 2.0 * y.x * y.z, 2.0 * y.y * y.z]
}

/// Coefficients of the terms `row` of readings whose sum is one: within the ellipsoid there are such. `None` where the readings do not determine them.
fn solved<const N: usize>(means: &[Vector3<f64>], row: impl Fn(&Vector3<f64>) -> [f64; N]) -> Option<[f64; N]> {
    let rows = DMatrix::from_row_iterator(means.len(), N, means.iter().flat_map(row));
    if means.len() < N || rows.iter().any(|value| !value.is_finite()) {
        return None;
    }
    let svd = rows.svd(true, true);
    if svd.singular_values.min() < LEAST * svd.singular_values.max() {
        return None;
    }
    let x = svd.solve(&DVector::repeat(means.len(), 1.0), 0.0).ok()?;
    Some(std::array::from_fn(|k| x[k]))
}

/// Coarse scale and bias of three newtonometers: `reading = scale f + bias`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoarseScale {
    /// Readings per m/s^2.
    pub scale: Vector3<f64>,
    /// Readings at no specific force.
    pub bias: Vector3<f64>,
}

impl CoarseScale {
    /// Coarse scale and bias by which the readings `means` of rests have the length of `gravity` [m/s^2]: the ellipsoid
    /// `sum_i ((c_i - bias_i) / scale_i)^2 = g^2` with axes along those of the instrument, by linear least squares. Scales are
    /// positive: gravity does not show the sign of an axis. `None` if the rests determine no such ellipsoid: each axis has to point
    /// up and down, about.
    pub fn of(means: &[Vector3<f64>], gravity: f64) -> Option<CoarseScale> {
        let Ellipsoid { centre, a } = Ellipsoid::along_axes(means)?;
        Some(CoarseScale { scale: a.diagonal().map(|a| 1.0 / (a.sqrt() * gravity)), bias: centre })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Readings on an ellipsoid give it back.
    #[test]
    fn an_ellipsoid_goes_through_its_points() {
        let gain = Matrix3::new(1.01, 0.0, 0.0, -0.02, 0.97, 0.0, 0.03, 0.01, 1.05) * 9.8;
        let centre = Vector3::new(0.3, -0.2, 0.5);
        let angle = |n: i32| (f64::from(n) * 2.4, f64::from(n) * 0.9);
        let up = |n: i32| {
            let (a, b) = angle(n);
            Vector3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos())
        };
        let means: Vec<Vector3<f64>> = (0..20).map(|n| centre + gain * up(n)).collect();
        let ellipsoid = Ellipsoid::through(&means).unwrap();
        assert!((ellipsoid.centre - centre).norm() < 1e-10, "{ellipsoid:?}");
        assert!((ellipsoid.size(&(gain * Vector3::new(0.6, 0.0, 0.8))) - 1.0).abs() < 1e-10);
        // Eight points determine none, nor do those of one plane.
        assert!(Ellipsoid::through(&means[..8]).is_none());
        let flat: Vec<Vector3<f64>> = means.iter().map(|mean| Vector3::new(mean.x, mean.y, 0.0)).collect();
        assert!(Ellipsoid::through(&flat).is_none());
    }

    /// What few readings leave open is as in an ideal unit.
    #[test]
    fn few_readings_give_the_nearest_ellipsoid() {
        let bias = Vector3::new(0.3, -0.2, 0.5);
        let faces = [Vector3::x(), -Vector3::x(), Vector3::y(), -Vector3::y(), Vector3::z(), -Vector3::z()];
        let means: Vec<Vector3<f64>> = faces.iter().map(|up| bias + up * 9.8).collect();
        let of_faces = Ellipsoid::nearest(&means);
        assert!((of_faces.centre - bias).norm() < 1e-10, "{of_faces:?}");
        assert!((of_faces.size(&(Vector3::x() * 9.8)) - 1.0).abs() < 1e-10);
        let of_one = Ellipsoid::nearest(&means[..1]);
        assert!(of_one.centre.norm() < 1e-10 && (of_one.size(&means[0]) - 1.0).abs() < 1e-10, "{of_one:?}");
    }
}

use centrical::{is_rotation, rotation, rotation_rate};
use nalgebra::Vector3;
use proptest::prelude::*;

fn vector(size: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-size..size, -size..size, -size..size].prop_map(Vector3::from)
}

proptest! {
    #[test]
    fn rotation_is_one_and_turns_back(v in vector(3.0)) {
        prop_assert!(is_rotation(&rotation(&v)));
        prop_assert!((rotation(&v) * rotation(&-v) - nalgebra::Matrix3::identity()).amax() < 1e-14);
        prop_assert!((rotation(&v) * v - v).amax() < 1e-14);
    }

    /// `d rotation(v) = hat(J dv) rotation(v)`, against central differences. The source's `hat` is the transpose of the usual matrix.
    #[test]
    fn rotation_rate_is_the_differential(v in vector(2.0), dv in vector(1.0)) {
        let h = 1e-5;
        let difference = (rotation(&(v + dv * h)) - rotation(&(v - dv * h))) / (2.0 * h);
        let analytic = (rotation_rate(&v) * dv).cross_matrix().transpose() * rotation(&v);
        // Truncation h^2 |dv|^3 / 6 and rounding eps / h.
        prop_assert!((difference - analytic).amax() < 1e-9);
    }

    /// The series below the threshold and the closed form above it are the same function.
    #[test]
    fn small_angles_join_smoothly(direction in vector(1.0)) {
        prop_assume!(direction.norm() > 0.1);
        let unit = direction.normalize();
        let (below, above) = (unit * 0.999_999e-4, unit * 1.000_001e-4);
        prop_assert!((rotation_rate(&above) - rotation_rate(&below)).amax() < 1e-9);
        prop_assert!((rotation(&above) - rotation(&below)).amax() < 1e-9);
    }
}

//! NIST Statistical Reference Datasets, linear least squares (https://www.itl.nist.gov/div898/strd/lls/lls.shtml):
//! certified to 15 digits by computation with 500 digits.
//!
//! What double precision can attain: neither the data nor the steps of a solver are known better than to half a unit in
//! the last place. The data are perturbed by that at random, many times; the spread of the solutions is what no
//! double-precision solution can escape, and six standard deviations of it are the tolerance, for every number
//! certified. (Worst-case bounds such as `eps kappa^2 tan theta` exceed 1 for Filip and would prove nothing.)

use nalgebra::{DMatrix, DVector};

use crate::common::{Random, Regression};

struct Certified {
    data: &'static str,
    /// Estimate and standard deviation of each parameter.
    parameters: &'static [(f64, f64)],
    residual_standard_deviation: f64,
    residual_sum_of_squares: f64,
}

const LONGLEY: Certified = Certified {
    data: include_str!("strd/longley.csv"),
    parameters: &[
        (-3_482_258.634_595_82, 890_420.383_607_373),
        (15.061_872_271_373_3, 84.914_925_774_766_9),
        (-0.358_191_792_925_910E-01, 0.334_910_077_722_432E-01),
        (-2.020_229_803_816_83, 0.488_399_681_651_699),
        (-1.033_226_867_173_59, 0.214_274_163_161_675),
        (-0.511_041_056_535_807E-01, 0.226_073_200_069_370),
        (1_829.151_464_613_55, 455.478_499_142_212),
    ],
    residual_standard_deviation: 304.854_073_561_965,
    residual_sum_of_squares: 836_424.055_505_915,
};

const PONTIUS: Certified = Certified {
    data: include_str!("strd/pontius.csv"),
    parameters: &[
        (0.673_565_789_473_684E-03, 0.107_938_612_033_077E-03),
        (0.732_059_160_401_003E-06, 0.157_817_399_981_659E-09),
        (-0.316_081_871_345_029E-14, 0.486_652_849_992_036E-16),
    ],
    residual_standard_deviation: 0.205_177_424_076_185E-03,
    residual_sum_of_squares: 0.155_761_768_796_992E-05,
};

const FILIP: Certified = Certified {
    data: include_str!("strd/filip.csv"),
    parameters: &[
        (-1_467.489_614_229_80, 298.084_530_995_537),
        (-2_772.179_591_933_42, 559.779_865_474_950),
        (-2_316.371_081_608_93, 466.477_572_127_796),
        (-1_127.973_940_983_72, 227.204_274_477_751),
        (-354.478_233_703_349, 71.647_866_087_592_7),
        (-75.124_201_739_375_7, 15.289_717_874_740_0),
        (-10.875_318_035_534_3, 2.236_911_598_160_33),
        (-1.062_214_985_889_47, 0.221_624_321_934_227),
        (-0.670_191_154_593_408E-01, 0.142_363_763_154_724E-01),
        (-0.246_781_078_275_479E-02, 0.535_617_408_889_821E-03),
        (-0.402_962_525_080_404E-04, 0.896_632_837_373_868E-05),
    ],
    residual_standard_deviation: 0.334_801_051_324_544E-02,
    residual_sum_of_squares: 0.795_851_382_172_941E-03,
};

/// Rows of the data file: the response, then the predictors.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect()
}

/// All that is certified of a data set, in one order.
fn computed(a: &DMatrix<f64>, b: &DVector<f64>) -> Vec<f64> {
    let fit = Regression::of(a, b);
    let deviations = fit.covariance.diagonal().map(f64::sqrt);
    let estimates = fit.x.iter().chain(deviations.iter()).copied();
    estimates.chain([fit.variance.sqrt(), fit.sum_of_squares]).collect()
}

/// Root mean square changes of [`computed`] when every number of the data is off by up to half a unit in its last place.
fn spread(a: &DMatrix<f64>, b: &DVector<f64>) -> Vec<f64> {
    const TIMES: usize = 100;
    let mut random = Random::new(1);
    let mut off = || 1.0 + f64::EPSILON * (random.uniform() - 0.5);
    let unperturbed = computed(a, b);
    let mut squares = vec![0.0; unperturbed.len()];
    for _ in 0..TIMES {
        // In steps of whole units: half of the entries stay, half go to a neighbour.
        let perturbed = computed(&a.map(|v| v * off()), &b.map(|v| v * off()));
        for (square, (p, u)) in squares.iter_mut().zip(perturbed.iter().zip(&unperturbed)) {
            *square += (p - u).powi(2) / TIMES as f64;
        }
    }
    squares.into_iter().map(f64::sqrt).collect()
}

fn check(certified: &Certified, design: impl Fn(&[f64]) -> Vec<f64>) {
    let data = rows(certified.data);
    let designed: Vec<Vec<f64>> = data.iter().map(|row| design(&row[1..])).collect();
    let a = DMatrix::from_fn(data.len(), certified.parameters.len(), |i, j| designed[i][j]);
    let b = DVector::from_fn(data.len(), |i, _| data[i][0]);
    let (estimates, deviations): (Vec<f64>, Vec<f64>) = certified.parameters.iter().copied().unzip();
    let residual = vec![certified.residual_standard_deviation, certified.residual_sum_of_squares];
    let expected = [estimates, deviations, residual].concat();
    let found = computed(&a, &b);
    assert_eq!(found.len(), expected.len());
    for (n, (spread, (found, expected))) in spread(&a, &b).iter().zip(found.iter().zip(&expected)).enumerate() {
        // Fifteen digits are certified.
        let tolerance = 6.0 * spread + 5e-15 * expected.abs();
        assert!(tolerance < 1e-6 * expected.abs(), "number {n}: {tolerance:e} would prove nothing");
        let error = (found - expected).abs();
        assert!(error <= tolerance, "number {n}: found {found:e}, certified {expected:e}: {error:e} > {tolerance:e}");
    }
}

#[test]
fn longley() {
    check(&LONGLEY, |x| [&[1.0], x].concat());
}

#[test]
fn pontius() {
    check(&PONTIUS, |x| (0..3).map(|power| x[0].powi(power)).collect());
}

#[test]
fn filip() {
    check(&FILIP, |x| (0..11).map(|power| x[0].powi(power)).collect());
}

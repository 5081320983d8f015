//! The colours of the plots, as colour-blind readers see them.
//!
//! Sight without one kind of cone: the matrices of Machado, Oliveira and Fernandes (2009, table 1, severity 1.0), on
//! linear sRGB. Distances in CIE L*a*b*, where 2.3 is the least that is noticed (Mahy et al., 1994).

use centrical_report::plot::{Axis, Plot, Point, Series};
use nalgebra::{Matrix3, Vector3};

/// Least distance of a pair that nothing else distinguishes: four times what is noticed.
const DISTANCE: f64 = 9.2;

fn sights() -> [(&'static str, Matrix3<f64>); 4] {
    [
        ("every cone", Matrix3::identity()),
        (
            "no long-wave cones",
            Matrix3::new(
                0.152_286, 1.052_583, -0.204_868, 0.114_503, 0.786_281, 0.099_216, -0.003_882, -0.048_116, 1.051_998,
            ),
        ),
        (
            "no middle-wave cones",
            Matrix3::new(
                0.367_322, 0.860_646, -0.227_968, 0.280_085, 0.672_501, 0.047_413, -0.011_820, 0.042_940, 0.968_881,
            ),
        ),
        (
            "no short-wave cones",
            Matrix3::new(
                1.255_528, -0.076_749, -0.178_779, -0.078_411, 0.930_809, 0.147_602, 0.004_733, 0.691_367, 0.303_900,
            ),
        ),
    ]
}

/// Linear sRGB of `#rrggbb`.
fn linear(colour: &str) -> Vector3<f64> {
    let channel = |k: usize| f64::from(u8::from_str_radix(&colour[2 * k + 1..2 * k + 3], 16).unwrap()) / 255.0;
    Vector3::from_fn(|k, _| {
        let c = channel(k);
        if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
    })
}

/// L*a*b* of linear sRGB, white D65 (IEC 61966-2-1, CIE 15).
fn lab(rgb: Vector3<f64>) -> Vector3<f64> {
    let to_xyz =
        Matrix3::new(0.412_456, 0.357_576, 0.180_438, 0.212_673, 0.715_152, 0.072_175, 0.019_334, 0.119_192, 0.950_304);
    let xyz = (to_xyz * rgb.map(|c| c.clamp(0.0, 1.0))).component_div(&Vector3::new(0.950_47, 1.0, 1.088_83));
    let f = xyz.map(|t| if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 });
    Vector3::new(116.0 * f.y - 16.0, 500.0 * (f.x - f.y), 200.0 * (f.y - f.z))
}

/// Least distance of two colours to any eye, and whose.
fn distance(a: &str, b: &str) -> (f64, &'static str) {
    let seen =
        |(name, sight): (&'static str, Matrix3<f64>)| ((lab(sight * linear(a)) - lab(sight * linear(b))).norm(), name);
    sights().map(seen).into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).unwrap()
}

/// A plot of a number of series, its style with light colours and with dark ones, and its elements.
fn plot(series: usize) -> (String, [Vec<String>; 2]) {
    let points = || vec![Point::new(0.0, 1.0), Point::new(1.0, 2.0)];
    let empty = Plot::new("", Axis::linear(""), Axis::linear(""));
    let svg = (0..series).fold(empty, |plot, n| plot.with(Series::line_and_markers(format!("{n}"), points()))).to_svg();
    let style = &svg[svg.find("<style>").unwrap()..svg.find("</style>").unwrap()];
    let (light, dark) = style.split_once("@media(prefers-color-scheme:dark)").unwrap();
    let colours = |rules: &str| -> Vec<String> {
        let colour = |rule: &str| rule[rule.find('#').unwrap()..][..7].to_owned();
        (0..6).map(|n| colour(&rules[rules.find(&format!(".s{n}{{")).unwrap()..])).collect()
    };
    (svg.clone(), [colours(light), colours(dark)])
}

/// Colour alone distinguishes the three axes in the records; of all six colours those that go with one dash and one
/// marker, the fifth with the first and the sixth with the second.
#[test]
fn any_eye_tells_series_apart() {
    for colours in plot(3).1 {
        for (a, b) in [(0, 1), (0, 2), (1, 2), (0, 4), (1, 5)] {
            let (distance, eye) = distance(&colours[a], &colours[b]);
            assert!(distance >= DISTANCE, "{} and {} are {distance:.1} apart to {eye}", colours[a], colours[b]);
        }
    }
}

/// Positive and negative correlation.
#[test]
fn any_eye_tells_the_signs_of_correlation_apart() {
    for (positive, negative) in [("#0072b2", "#d55e00"), ("#56b4e9", "#ff8a3c")] {
        assert!(distance(positive, negative).0 >= 2.0 * DISTANCE);
    }
}

/// No two of twelve series share colour and dash.
#[test]
fn twelve_series_look_different() {
    let (svg, _) = plot(12);
    let drawn: Vec<&str> = svg.split("<g class=\"s").skip(1).take(12).collect();
    let looks: Vec<(&str, Option<&str>)> = drawn
        .iter()
        .map(|entry| {
            let dash = entry.split_once("stroke-dasharray=\"").map(|(_, rest)| &rest[..rest.find('"').unwrap()]);
            (&entry[..1], dash.filter(|_| entry.find("stroke-dasharray") < entry.find("</g>")))
        })
        .collect();
    for (n, look) in looks.iter().enumerate() {
        assert!(!looks[..n].contains(look), "series {n} looks like another: {look:?}");
    }
}

/// The test has power: red and green of one lightness are one colour to some eyes.
#[test]
fn red_and_green_are_one_colour_to_some() {
    assert!(distance("#c03030", "#5d6f00").0 < DISTANCE);
}

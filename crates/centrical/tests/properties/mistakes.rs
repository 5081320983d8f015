//! Recording mistakes are named for what they are, and good records are not blamed.

use centrical::STANDARD_GRAVITY;
use centrical::reduction::{NoiseModel, Record, ReductionError};

use crate::stream::Stream;

/// What is wrong with the record, in words; nothing if it is reduced.
fn verdict(stream: &Stream, record: &Record) -> Option<String> {
    record.reduce(None, &stream.schedule()).err().map(|error| error.to_string())
}

fn changed(stream: &Stream, change: impl Fn(&mut [Vec<f64>; 3])) -> Record {
    let mut record = stream.record();
    change(&mut record.f_z);
    record
}

fn times(axis: usize, factor: f64) -> impl Fn(&mut [Vec<f64>; 3]) {
    move |f| f[axis].iter_mut().for_each(|f| *f *= factor)
}

#[test]
fn exchanged_axes_are_named() {
    for stream in [Stream::default(), Stream { unit_error: 1e-2, ..Stream::default() }.rough()] {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let said = verdict(&stream, &changed(&stream, |f| f.swap(i, j))).expect("the record is wrong");
            let expected =
                format!("readings fit axes {0} and {1} exchanged (f{1} as f{0} and f{0} as f{1})", i + 1, j + 1);
            assert!(said.starts_with(&expected), "{said}");
            assert!(said.contains("m/s^2, expected about ("), "{said}");
        }
        let said = verdict(&stream, &changed(&stream, |f| f.rotate_left(1))).expect("the record is wrong");
        assert!(said.starts_with("readings fit axes exchanged in turn (f2 as f1, f3 as f2, f1 as f3)"), "{said}");
    }
}

#[test]
fn reversed_signs_and_wrong_units_are_named() {
    let stream = Stream::default().rough();
    for axis in [0, 2] {
        let said = verdict(&stream, &changed(&stream, times(axis, -1.0))).expect("the record is wrong");
        assert!(said.starts_with(&format!("readings fit f{} with the sign reversed", axis + 1)), "{said}");
    }
    for (factor, words) in [
        (1.0 / STANDARD_GRAVITY, "readings fit the unit g taken for m/s^2"),
        (STANDARD_GRAVITY, "readings fit the unit m/s^2 taken for g"),
    ] {
        let all = |f: &mut [Vec<f64>; 3]| (0..3).for_each(|axis| times(axis, factor)(f));
        let said = verdict(&stream, &changed(&stream, all)).expect("the record is wrong");
        assert!(said.starts_with(words), "{said}");
    }
}

#[test]
fn two_mistakes_at_once_are_named() {
    let stream = Stream::default().rough();
    let both = |f: &mut [Vec<f64>; 3]| {
        f.swap(0, 2);
        (0..3).for_each(|axis| times(axis, 1.0 / STANDARD_GRAVITY)(f));
    };
    let said = verdict(&stream, &changed(&stream, both)).expect("the record is wrong");
    let expected = "readings fit axes 1 and 3 exchanged (f3 as f1 and f1 as f3), the unit g taken for m/s^2";
    assert!(said.starts_with(expected), "{said}");
}

/// The newtonometer across the arm reads nothing on a plateau: its sign and the sense of rotation show in ramps alone.
#[test]
fn the_sense_of_rotation_is_seen_in_the_ramps() {
    for stream in [Stream::default(), Stream { colour: (5e-3, 0.5), ramp: 10.0, ..Stream::default() }.rough()] {
        let record = stream.record();
        let mut schedule = stream.schedule();
        for plateau in &mut schedule {
            plateau.omega = -plateau.omega;
        }
        let error = record.reduce(None, &schedule).expect_err("the record turns the other way");
        let ReductionError::Rotation { ramps, part } = error else { panic!("{error}") };
        assert_eq!(ramps, 5);
        assert!((part + 1.0).abs() < 0.1, "{part}");
        let reversed = changed(&stream, times(1, -1.0));
        assert!(verdict(&stream, &reversed).is_some_and(|said| said.contains("the other sense of rotation")));
    }
}

/// Time in another unit moves no mean but those of the once-per-revolution term: the pull in the ramps shows it.
#[test]
fn smaller_units_of_time_are_seen_in_the_ramps() {
    for seed in 0..20 {
        for stream in [Stream::default(), Stream { ramp: 20.0, unit_error: 0.01, ..Stream::default() }.rough()] {
            let stream = Stream { seed: 300 + seed, ..stream };
            for (factor, name) in [(1e3, "ms"), (1e6, "us")] {
                let mut record = stream.record();
                record.t.iter_mut().for_each(|t| *t *= factor);
                let error = record.reduce(None, &stream.schedule()).expect_err("the record lasts hours");
                let ReductionError::TimeUnit { part, unit, .. } = error else { panic!("{error}") };
                assert!(unit == name && (part / factor - 1.0).abs() < 0.2, "{unit} {part}");
            }
            assert_eq!(verdict(&stream, &stream.record()), None);
        }
    }
}

/// A unit with errors of two percent, seen through all dirt, is not a mistake; nor is one speed without a ramp.
#[test]
fn good_records_are_not_blamed() {
    for seed in 0..40 {
        let error = 0.02 * (f64::from(seed) / 40.0);
        let stream = Stream { unit_error: error, seed: 70 + seed as u64, ..Stream::default() }.rough();
        assert_eq!(verdict(&stream, &stream.record()), None);
    }
}

#[test]
fn a_saturated_plateau_is_named() {
    let stream = Stream::default();
    let top = stream.truth(4).x;
    // The range ends a standard deviation beyond what the fastest plateau reads: a sixth is cut off.
    let end = top - 2e-3;
    let cut_off = |end: f64| changed(&stream, |f| f[0].iter_mut().for_each(|f| *f = f.max(end)));
    let error = cut_off(end).reduce(None, &stream.schedule()).expect_err("the record is cut off");
    let ReductionError::Saturated { index: 4, axis: 0, value, piled_up, samples, .. } = error else {
        panic!("{error}")
    };
    assert_eq!(value, end);
    assert!(piled_up > 100 && piled_up < samples / 4, "{error}");
    // Half of it, nearly all, and all.
    for end in [top, top + 4e-3, top + 1.0] {
        let said = verdict(&stream, &cut_off(end)).expect("the record is cut off");
        assert!(said.contains("saturated") || said.contains("a stuck newtonometer, one beyond its range"), "{said}");
    }
}

/// A gap of seconds in a plateau, repeated stamps by the hundred and a burst of spikes are left out, and counted.
#[test]
fn gaps_repeats_and_spikes_are_counted() {
    let stream = Stream::default();
    let whole = stream.record();
    let [start, _] = stream.windows()[1];
    let at = |seconds: f64| whole.t.partition_point(|t| *t < start + seconds);
    let mut record = Record::default();
    for i in 0..whole.t.len() {
        let copies = match i {
            i if (at(3.0)..at(5.0)).contains(&i) => 0,
            i if (at(6.0)..at(7.0)).contains(&i) => 2,
            _ => 1,
        };
        for _ in 0..copies {
            record.t.push(whole.t[i]);
            for axis in 0..3 {
                let spike = if axis == 0 && (at(8.0)..at(8.0) + 5).contains(&i) { 40.0 } else { 0.0 };
                record.f_z[axis].push(whole.f_z[axis][i] + spike);
            }
        }
    }
    let reduced = record.reduce(None, &stream.schedule()).expect("the plateau is there");
    let means = reduced.means(&NoiseModel::pool([&reduced]));
    let found = means[1].left_out;
    assert_eq!((found.missing, found.repeated, found.spikes, found.stuck), (200, 100, 5, 0));
    let error = means[1].mean - stream.truth(1);
    let square = error.dot(&means[1].covariance.cholesky().expect("positive definite").solve(&error));
    // chi^2 of three degrees of freedom is beyond this once in a million times.
    assert!(square < 30.7, "{square}");
    assert_eq!(means[0].left_out, centrical::reduction::LeftOut::default());
}

/// A plateau cut short is used for as long as it lasts; one of less than a revolution is refused by name.
#[test]
fn a_plateau_cut_short_is_used_or_named() {
    let stream = Stream { lengths: vec![10.0, 10.0, 3.0, 10.0, 10.0, 10.0], ..Stream::default() };
    let reduced = stream.record().reduce(None, &stream.schedule()).expect("three seconds are enough");
    let window = reduced.means(&NoiseModel::pool([&reduced]))[2].window;
    let [start, end] = stream.windows()[2];
    assert!(window[0] >= start && window[1] <= end && window[1] - window[0] > 0.5, "{window:?} in {start} {end}");
    let short = Stream { lengths: vec![10.0, 10.0, 0.3, 10.0, 10.0, 10.0], ..Stream::default() };
    let said = verdict(&short, &short.record()).expect("a third of a second is no plateau");
    assert!(said.starts_with("plateau 3 "), "{said}");
}

/// Without spikes the mean of the remaining samples is that of all of them, but for one good sample in twenty plateaus
/// and axes. That sample lies at the limit of `sqrt(2 ln 20 n)` standard deviations and moves the mean by
/// `(2 ln 20 n) / n` of its variance. So the efficiency is above `1 - (2 ln 20 n) / (20 n)`, 0.999 of a thousand samples.
/// With one spike in ten samples it is the mean of the good ones.
#[test]
fn robust_location_is_as_efficient_as_the_mean() {
    let (mut clean, mut spiked, mut count) = (0.0, 0.0, 0.0);
    for seed in 0..24 {
        let stream = Stream { seed: 200 + seed, ..Stream::default() };
        let record = stream.record();
        let dirty = changed(&stream, |f| {
            f[0].iter_mut().enumerate().filter(|(i, _)| i * 7919 % 10 == 3).for_each(|(_, f)| *f += 30.0);
        });
        let means = |record: &Record| {
            let reduced = record.reduce(None, &stream.schedule()).expect("the plateaus are there");
            reduced.means(&NoiseModel::pool([&reduced]))
        };
        for (means, record, sum) in [(means(&record), &record, &mut clean), (means(&dirty), &dirty, &mut spiked)] {
            for k in [0, 5] {
                let [from, to] = means[k].window;
                let inside = record.t.partition_point(|t| *t < from)..record.t.partition_point(|t| *t <= to);
                for axis in 0..3 {
                    let good = record.f_z[axis][inside.clone()].iter().filter(|f| **f < 20.0);
                    let (n, total) = good.fold((0.0, 0.0), |(n, total), f| (n + 1.0, total + f));
                    *sum += ((means[k].mean[axis] - total / n) / (stream.white / n.sqrt())).powi(2);
                }
            }
        }
        count += 6.0;
    }
    assert!(clean / count < 1e-3, "{}", clean / count);
    // A sample that is a spike on one axis is left out on all: the other two lose a tenth of their samples, and with it a
    // tenth of their efficiency; two thirds of the squares, each 0.11.
    assert!(spiked / count < 0.1, "{}", spiked / count);
}

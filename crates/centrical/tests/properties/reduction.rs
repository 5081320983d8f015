//! Reduction of simulated records: plateaus found where they are, means right to their own uncertainty, and plain
//! words where a plateau is not there.

use centrical::reduction::{
    Averaging, MeasuredSpeed, NoiseModel, PlateauMean, Record, ReducedMounting, ReductionError, Survey,
};
use nalgebra::Vector3;

use crate::common::Random;
use crate::stream::Stream;

/// Streams of every kind: sampling rates, ramps, lengths, settling, colours, dirt.
fn kinds() -> Vec<(&'static str, Stream)> {
    let base = Stream::default();
    let lengths = |length: f64| vec![length; 6];
    vec![
        ("clean", base.clone()),
        ("rough", base.clone().rough()),
        ("no settling", Stream { settling: (0.0, 0.4), ..base.clone() }),
        ("strong settling", Stream { settling: (5e-3, 0.4), ..base.clone() }.rough()),
        ("slow settling", Stream { settling: (1e-3, 2.0), lengths: lengths(30.0), ..base.clone() }.rough()),
        ("fast colour", Stream { colour: (2e-3, 0.1), ..base.clone() }.rough()),
        ("colour", Stream { colour: (1e-3, 0.5), rate: 250.0, ..base.clone() }.rough()),
        ("strong colour", Stream { colour: (5e-3, 0.5), ..base.clone() }.rough()),
        ("slow colour", Stream { colour: (2e-3, 2.0), rate: 50.0, lengths: lengths(120.0), ..base.clone() }.rough()),
        ("short plateaus", Stream { ramp: 1.0, rate: 50.0, lengths: lengths(5.0), ..base.clone() }.rough()),
        ("2 kHz", Stream { ramp: 1.0, rate: 2000.0, lengths: lengths(5.0), ..base.clone() }.rough()),
        ("slow ramps", Stream { ramp: 30.0, rate: 200.0, lengths: lengths(60.0), ..base.clone() }.rough()),
        ("poor unit", Stream { unit_error: 1e-2, ..base.clone() }.rough()),
        ("slow speeds", Stream { omegas: vec![0.0, 3.0, 6.0, 9.0, 4.5, 0.0], lengths: lengths(20.0), ..base.clone() }),
        ("less than two revolutions", Stream { omegas: vec![0.0, 1.05, 6.0, 9.0, 3.0, 0.0], ..base.clone() }),
        ("below twice the revolution", Stream { rate: 13.0, lengths: lengths(30.0), ..base }.rough()),
    ]
}

const MOUNTINGS: u64 = 12;

/// A session of a kind: its streams, reduced.
fn session(stream: &Stream, seed: u64) -> Vec<(Stream, ReducedMounting)> {
    let streams = (0..MOUNTINGS).map(|mounting| Stream { seed: 1000 * seed + mounting, ..stream.clone() });
    streams.map(|stream| (reduced(&stream), stream)).map(|(reduced, stream)| (stream, reduced)).collect()
}

fn reduced(stream: &Stream) -> ReducedMounting {
    match stream.record().reduce(None, &stream.schedule()) {
        Ok(reduced) => reduced,
        Err(error) => panic!("{stream:?}: {error}"),
    }
}

fn pooled(session: &[(Stream, ReducedMounting)]) -> NoiseModel {
    NoiseModel::pool(session.iter().map(|(_, reduced)| reduced))
}

fn means(session: &[(Stream, ReducedMounting)]) -> Vec<(&Stream, usize, PlateauMean)> {
    let noise = pooled(session);
    let of = |reduced: &ReducedMounting| reduced.means(&noise).into_iter().enumerate().collect();
    let all: Vec<Vec<(usize, PlateauMean)>> = session.iter().map(|(_, reduced)| of(reduced)).collect();
    session.iter().zip(all).flat_map(|((s, _), means)| means.into_iter().map(move |(k, mean)| (s, k, mean))).collect()
}

/// Squared error over its covariance: 3 on average.
fn chi_squared(stream: &Stream, plateau: usize, mean: &PlateauMean) -> f64 {
    let error = mean.mean - stream.truth(plateau);
    let factor = mean.covariance.cholesky().expect("a covariance is positive definite");
    error.dot(&factor.solve(&error))
}

/// Every plateau in its place: no further out than one block of the first pass (0.1 s or 8 samples), and most of
/// it used: what a ramp of any length leaves, less settling, its margin and the block at each end.
#[test]
fn plateaus_are_found_in_every_kind_of_stream() {
    for (name, stream) in kinds() {
        let session = session(&stream, 1);
        let block = 0.1_f64.max(8.0 / stream.rate);
        let wait = if stream.settling.0 > 0.0 { 6.0 * stream.settling.1 } else { 0.0 };
        let mut used = Vec::new();
        for (stream, k, mean) in means(&session) {
            let [start, end] = stream.windows()[k];
            let [from, to] = mean.window;
            assert!(
                from >= start - block && to <= end + block,
                "{name}: plateau {k} at {start} to {end}: {from} to {to}"
            );
            let least = if stream.omegas[k] == 0.0 { end - start } else { end - start - wait };
            used.push((to - from) / (least - 4.0 * block));
        }
        used.sort_by(f64::total_cmp);
        assert!(used[used.len() / 20] > 0.9, "{name}: uses {:.2} of what it could", used[used.len() / 20]);
    }
}

/// Three sessions of 12 mountings and 6 plateaus: 648 degrees of freedom, so chi^2 per degree scatters by 0.055; the
/// pooled density of coloured noise is known to about 0.08 a session, 0.05 for three. Bounds: three times both.
#[test]
fn means_are_right_to_their_own_uncertainty() {
    for (name, stream) in kinds() {
        let mut sum = 0.0;
        let mut count = 0.0;
        for seed in 10..13 {
            for (stream, k, mean) in means(&session(&stream, seed)) {
                sum += chi_squared(stream, k, &mean);
                count += 3.0;
            }
        }
        let ratio: f64 = sum / count;
        println!("{name}: {ratio:.3}");
        assert!((ratio - 1.0).abs() < 0.22, "{name}: chi^2 per degree of freedom {ratio:.3}");
    }
}

/// Noise that grows with the speed, on all axes or along the force, or that one speed alone has: means are right to their own uncertainty at
/// each speed. Six sessions have 216 degrees of freedom a speed: 0.10, four times that. Of noise pooled over all speeds the slowest have 0.01
/// and the fastest 4. Where it is hundreds of times that of a rest, the rests were refused or held the start of a ramp. Noise that is squared
/// has a tail on one side: where that is cut as spikes the ratio is 10 and 19.
#[test]
fn means_are_right_at_each_speed_where_the_noise_grows_with_it() {
    let shaken = Stream { shaking: 5e-2, ..Stream::default() };
    let jittery = Stream { jitter: 5e-5, ..Stream::default() };
    let shaken_hard = Stream { shaking: 1.0, ..Stream::default() };
    let resonant = Stream { resonance: (44.0, 0.5), ..Stream::default() };
    let squared = Stream { squared: 2e-2, ..Stream::default() };
    let all = [
        ("shaken", shaken),
        ("jittery", jittery),
        ("shaken hard", shaken_hard),
        ("resonant", resonant),
        ("squared", squared),
    ];
    for (name, stream) in all {
        let mut sums = vec![0.0; stream.omegas.len()];
        for seed in 30..36 {
            for (stream, k, mean) in means(&session(&stream, seed)) {
                sums[k] += chi_squared(stream, k, &mean) / (6.0 * 3.0 * MOUNTINGS as f64);
            }
        }
        println!("{name}: {sums:.2?}");
        assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 0.4), "{name}: {sums:?}");
    }
}

/// Noise of one mounting, ten times that of the others: its means are right to their own uncertainty. Eight sessions have 144 degrees of
/// freedom: 0.12, four times that. With the noise of all mountings the ratio is 9.
#[test]
fn a_noisy_mounting_has_its_own_noise() {
    let mut sum = 0.0;
    for seed in 60..68 {
        let mut whole = session(&Stream::default(), seed);
        let noisy = Stream { white: 2e-2, seed: 1000 * seed + 500, ..Stream::default() };
        whole[4] = (noisy.clone(), reduced(&noisy));
        let of_it = means(&whole).into_iter().filter(|(stream, ..)| stream.seed == noisy.seed);
        sum += of_it.map(|(stream, k, mean)| chi_squared(stream, k, &mean)).sum::<f64>();
    }
    let ratio = sum / 144.0;
    assert!((ratio - 1.0).abs() < 0.48, "{ratio}");
}

/// A speed that runs alike on all plateaus of a speed is a drift, and no noise of that speed: slopes are judged by the noise of all plateaus. By
/// that of each speed their mean square is 8.4 in place of 12.9.
#[test]
fn what_drifts_at_each_speed_is_no_noise_of_it() {
    let stream = Stream { running: 1e-4, lengths: vec![30.0; 6], settling: (0.0, 0.4), ..Stream::default() };
    let square = |mean: &PlateauMean| mean.drift.component_div(&mean.drift_uncertainty).norm_squared() / 3.0;
    let squares: Vec<f64> = means(&session(&stream, 40)).iter().map(|(_, _, mean)| square(mean)).collect();
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    println!("{mean:.1}");
    assert!(mean > 10.5, "{mean}");
}

/// The error of the settling's time constant is not slow noise: the settling starts at ten thousand times the white
/// noise, and the pooled density at zero frequency is that of the same noise without settling. Taken for noise it would
/// raise it by a twentieth.
#[test]
fn settling_is_not_taken_for_noise() {
    let still = Stream { colour: (0.0, 0.5), settling: (0.0, 1.0), ..Stream::default() };
    let settling = Stream { settling: (1e-2, 1.0), ..still.clone() };
    let density = |stream: &Stream, seed| pooled(&session(stream, seed)).density(0.0).trace();
    let ratios = (50..70).map(|seed| density(&settling, seed) / density(&still, seed));
    let mean = ratios.sum::<f64>() / 20.0;
    assert!((mean - 1.0).abs() < 0.02, "{mean}");
}

/// How far dirt in the records of a session moves the means of the first plateau: root mean square over their standard errors.
fn moved_by(seed: u64, dirty: impl Fn(&Stream, &mut Record)) -> f64 {
    let clean = session(&Stream::default(), seed);
    let noise = pooled(&clean);
    let mut squares = Vec::new();
    for (stream, k, mean) in means(&clean).into_iter().filter(|(_, k, _)| *k == 0) {
        let mut record = stream.record();
        dirty(stream, &mut record);
        let dirty = record.reduce(None, &stream.schedule()).expect("dirt hides no plateau").means(&noise);
        let moved = (dirty[k].mean - mean.mean).component_div(&mean.covariance.diagonal().map(f64::sqrt));
        squares.push(moved.norm_squared() / 3.0);
    }
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Spikes are left out: with and without them the means differ by less than a tenth of their standard error on average. Samples that are left
/// out move the mean as well: by the root of their share of its standard error.
#[test]
fn spikes_do_not_move_means() {
    let rms = moved_by(20, |stream, record| {
        let mut random = Random::new(stream.seed);
        for i in 0..record.t.len() {
            if random.uniform() < 2e-3 {
                record.f_z[(3.0 * random.uniform()) as usize][i] += 30.0 + 100.0 * random.uniform();
            }
        }
    });
    assert!(rms < 0.1, "{rms}");
}

/// A recorder that writes zeros, for one sample or for ten: the single ones are spikes and no tail of the noise, although the others are as far
/// off. What is left out, a seventh of the samples, moves the mean by 0.4 of its standard error; the zeros would move it by a hundred.
#[test]
fn dropouts_beside_stuck_readings_are_no_tail() {
    let rms = moved_by(23, |_, record| {
        for i in (0..1000).filter(|i| i % 20 == 7 || i % 100 < 10) {
            record.f_z[1][i] = 0.0;
        }
    });
    assert!(rms < 0.8, "{rms}");
}

/// The correlation of slow noise between the axes is that of the means.
#[test]
fn axes_correlate_as_their_noise_does() {
    let stream = Stream { colour: (4e-3, 0.3), correlation: 0.6, ..Stream::default() };
    for (_, _, mean) in means(&session(&stream, 30)) {
        let c = mean.covariance;
        let correlation = c[(0, 1)] / (c[(0, 0)] * c[(1, 1)]).sqrt();
        assert!((correlation - 0.6).abs() < 0.1, "{correlation}");
    }
}

/// White noise stays white: the density is the variance of a sample times the sampling interval. Some 2000 contrasts
/// an axis scatter it by 3 %; four times that.
#[test]
fn density_of_white_noise_is_variance_by_interval() {
    let session = session(&Stream::default(), 40);
    let noise = pooled(&session);
    for f in [0.0, 0.1, 1.0] {
        let density = noise.density(f);
        for axis in 0..3 {
            assert!((density[(axis, axis)] / 4e-8 - 1.0).abs() < 0.12, "{density}");
        }
    }
}

/// Slopes are reported with an honest uncertainty: 216 slopes without a slope, mean square 1 +- 0.096, and noise
/// colour.
#[test]
fn drift_of_a_steady_plateau_is_within_its_uncertainty() {
    let session = session(&Stream { colour: (1e-3, 0.3), ..Stream::default() }, 50);
    let ratios: Vec<f64> = means(&session)
        .iter()
        .map(|(_, _, m)| m.drift.component_div(&m.drift_uncertainty).norm_squared() / 3.0)
        .collect();
    let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
    assert!((mean - 1.0).abs() < 0.35, "{mean}");
}

/// The error of the settling's time constant tilts all plateaus of a mounting: it is not a drift. Of 10 sessions of 216
/// slopes the mean square is 1 +- 0.03, and the pooled density of the noise is known to about 0.03; four times both. Slopes
/// that share the error of the time constant have 1.5 in short plateaus and 10 with little noise.
#[test]
fn the_tail_of_the_settling_is_no_drift() {
    let settling = |amplitude, time, length: f64, white| Stream {
        settling: (amplitude, time),
        lengths: vec![length; 6],
        white,
        ..Stream::default()
    };
    for (name, stream) in [
        ("short plateaus", settling(1e-3, 0.4, 5.0, 2e-3)),
        ("slow settling", settling(1e-3, 1.0, 5.0, 2e-3)),
        ("little noise", settling(1e-3, 0.4, 10.0, 2e-4)),
        ("strong settling", settling(1e-2, 0.4, 8.0, 2e-3)),
    ] {
        let square = |mean: &PlateauMean| mean.drift.component_div(&mean.drift_uncertainty).norm_squared() / 3.0;
        let of_session =
            |seed| -> Vec<f64> { means(&session(&stream, seed)).iter().map(|(_, _, m)| square(m)).collect() };
        let squares: Vec<f64> = (110..120).flat_map(of_session).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        println!("{name}: {mean:.3}");
        assert!((mean - 1.0).abs() < 0.17, "{name}: {mean}");
    }
}

/// A speed that runs by 1e-4 over its plateau is not settling: each mean is that of the middle, to a tenth of the run.
/// The telemetry shows its slope to a twentieth or better, by reports to 1e-5 rad/s.
#[test]
fn a_speed_that_runs_is_no_settling() {
    for (settling, length) in [(0.0, 30.0), (1e-4, 30.0), (0.0, 10.0)] {
        let stream = Stream { settling: (settling, 0.4), running: 1e-4, lengths: vec![length; 6], ..Stream::default() };
        let reduced = stream.record().reduce(Some(&stream.telemetry(0.0)), &stream.schedule()).unwrap();
        assert_eq!(reduced.settling_time(), None, "{settling}, {length}");
        for (k, mean) in reduced.means(&NoiseModel::pool([&reduced])).iter().enumerate() {
            let (error, run) = ((mean.mean - stream.truth(k)).norm(), 2e-4 * stream.truth(k).norm());
            assert!(error < 0.1 * run + 5e-4, "{settling}, {length}, plateau {k}: {error} of {run}");
        }
        let speeds = MeasuredSpeed::of_all(&stream.omegas, std::slice::from_ref(&reduced));
        for speed in speeds.into_iter().flatten() {
            let [slope, uncertainty] = speed.slope.expect("hundreds of reports");
            let error = slope - 1e-4 / length;
            assert!(error.abs() < 5.0 * uncertainty + 1e-8 / length, "{settling}, {length}: {slope} {uncertainty}");
            assert!(uncertainty < 0.05 * 1e-4 / length, "{settling}, {length}: {uncertainty}");
        }
    }
}

/// The once-per-revolution term has the amplitude it was given, on each axis.
#[test]
fn tilt_is_seen_while_spinning() {
    for (stream, k, mean) in means(&session(&Stream::default().rough(), 60)) {
        let [cos, sin] = mean.once_per_revolution;
        let amplitude = Vector3::from_fn(|axis, _| cos[axis].hypot(sin[axis]));
        let expected =
            if stream.omegas[k] == 0.0 { Vector3::zeros() } else { stream.tilt * Vector3::new(1.0, 1.0, 0.3) };
        // Standard deviation of an amplitude: sigma sqrt(2 / n), 1e-4 here.
        assert!((amplitude - expected).amax() < 5e-4, "plateau {k}: {amplitude}");
    }
}

#[test]
fn the_clock_offset_comes_from_the_ramps() {
    for offset in [-1.7, 0.0, 0.3, 25.0] {
        let stream = Stream::default().rough();
        let telemetry = stream.telemetry(offset);
        let reduced = stream.record().reduce(Some(&telemetry), &stream.schedule()).expect("plateaus are there");
        let found = reduced.clock_agreement().expect("there is telemetry");
        assert_eq!(found.agreeing, 5);
        // A twentieth of a block.
        let [seconds, _] = found.offset.expect("ramps are in both");
        assert!((seconds - offset).abs() < 5e-3, "{found:?}");
        for (mean, omega) in reduced.means(&NoiseModel::pool([&reduced])).iter().zip(&stream.omegas) {
            let speed = mean.measured_speed.expect("telemetry covers the record");
            assert!((speed - omega).abs() < 1e-4 * omega + 1e-9, "{speed} {omega}");
        }
    }
}

#[test]
fn the_same_record_gives_the_same_bits() {
    let stream = Stream { colour: (1e-3, 0.5), ..Stream::default() }.rough();
    let twice = [0, 1].map(|_| {
        let reduced = reduced(&stream);
        reduced.means(&NoiseModel::pool([&reduced]))
    });
    assert_eq!(twice[0], twice[1]);
}

/// A record in stretches of any length, cut anywhere, gives the bits that it gives whole.
#[test]
fn in_stretches_as_whole() {
    let stream = Stream { colour: (1e-3, 0.5), repeats: 0.01, ..Stream::default() }.rough();
    let (record, schedule) = (stream.record(), stream.schedule());
    let whole = record.reduce(None, &schedule).expect("plateaus are there");
    let noise = NoiseModel::pool([&whole]);
    for length in [1, 7, 64, 1000, 4099] {
        let mut survey = Survey::new(&record.t);
        let mut from = 0;
        while from < record.t.len() {
            let to = (from + length).min(record.t.len());
            survey.append(survey.condense(record.as_slice().part(from..to)));
            from = to;
        }
        survey.finish();
        let located = survey.locate(&schedule).expect("plateaus are there");
        let windows = located.windows();
        let average = |k: usize| located.average(k, record.as_slice().between(windows[k])).expect("a steady plateau");
        let averaged = (0..windows.len()).map(average).collect();
        assert_eq!(ReducedMounting::new(located, averaged).means(&noise), whole.means(&noise), "stretches of {length}");
    }
}

/// A plateau whose samples come in parts is the same up to a few samples at the limit; each moves the mean by a tenth of its
/// standard error. As many samples are reported as missing and as repeated.
#[test]
fn in_parts_as_whole() {
    let mut squares = Vec::new();
    for (name, stream) in kinds().into_iter().filter(|(name, _)| !name.starts_with("below")) {
        let stream = Stream { repeats: 0.01, ..stream };
        let (record, schedule) = (stream.record(), stream.schedule());
        let whole = record.reduce(None, &schedule).expect("plateaus are there");
        let noise = NoiseModel::pool([&whole]);
        let mut survey = Survey::new(&record.t);
        survey.append(survey.condense(record.as_slice()));
        survey.finish();
        let located = survey.locate(&schedule).expect("plateaus are there");
        let of_parts = |(k, [from, to]): (usize, [f64; 2])| {
            let cuts = [from, from + 0.4 * (to - from), from + 0.75 * (to - from), to];
            let part = |(i, cut): (usize, &[f64])| [if i == 0 { cut[0] } else { cut[0].next_up() }, cut[1]];
            let parts = cuts.windows(2).enumerate().map(part).collect();
            Averaging::in_parts(&located, k, parts).finish(record.as_slice()).expect("a steady plateau")
        };
        let averaged = located.windows().into_iter().enumerate().map(of_parts).collect();
        let in_parts = ReducedMounting::new(located, averaged).means(&noise);
        for (k, (part, whole)) in in_parts.iter().zip(whole.means(&noise)).enumerate() {
            let off = (part.mean - whole.mean).component_div(&whole.covariance.diagonal().map(f64::sqrt));
            assert!(off.amax() < 0.5, "{name}, {k}: {off}");
            squares.push(off.norm_squared() / 3.0);
            assert!(part.rejected.abs_diff(whole.rejected) <= 2 + whole.rejected / 20, "{name}, {k}: {part:?}");
            assert_eq!(part.samples + part.rejected, whole.samples + whole.rejected, "{name}, {k}");
            assert_eq!(part.left_out.repeated, whole.left_out.repeated, "{name}, {k}");
            assert!(part.left_out.missing.abs_diff(whole.left_out.missing) <= 2, "{name}, {k}: {part:?}");
        }
    }
    let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    assert!(rms < 0.1, "{rms}");
}

/// A clock that stands still at first, or stutters, tells no sampling interval there; the means and their uncertainties are those
/// of the rest, up to where a sample at the edge of a block is counted.
#[test]
fn a_clock_that_starts_late_costs_nothing() {
    let stream = Stream::default();
    let (record, schedule) = (stream.record(), stream.schedule());
    let means = |record: &Record| {
        let reduced = record.reduce(None, &schedule).expect("plateaus are there");
        reduced.means(&NoiseModel::pool([&reduced]))
    };
    let expected = means(&record);
    for stutter in [0.0, 1e-12] {
        let mut late = Record::default();
        for i in 0..=Survey::BEGINNING {
            late.extend(record.as_slice().part(0..1));
            late.t[i] -= stutter * (Survey::BEGINNING + 1 - i) as f64;
        }
        late.extend(record.as_slice());
        for (late, mean) in means(&late).iter().zip(&expected) {
            let u = mean.covariance.diagonal().map(f64::sqrt);
            assert!((late.mean - mean.mean).component_div(&u).amax() < 1.5, "{late:?}, {mean:?}");
            let ratio = late.covariance.diagonal().map(f64::sqrt).component_div(&u);
            assert!(ratio.min() > 0.7 && ratio.max() < 1.4, "{ratio}");
            assert!(late.left_out.missing.abs_diff(mean.left_out.missing) <= 2, "{late:?}");
            let quadrature = late.once_per_revolution_covariance.amax() / mean.once_per_revolution_covariance.amax();
            assert!(
                mean.once_per_revolution_covariance.amax() == 0.0 || (quadrature - 1.0).abs() < 0.2,
                "{quadrature}"
            );
        }
    }
}

/// Two plateaus at rest with a short turn between them, which nobody scheduled.
#[test]
fn two_rests_with_a_turn_between_are_two() {
    let run = Stream {
        omegas: vec![0.0, 0.7, 0.0, 20.0, 0.0],
        lengths: vec![10.0, 1.0, 10.0, 10.0, 10.0],
        ..Stream::default()
    };
    let mut schedule = run.schedule();
    schedule.remove(1);
    let reduced = run.record().reduce(None, &schedule).expect("all four are there");
    let means = reduced.means(&NoiseModel::pool([&reduced]));
    for (mean, k) in means.iter().zip([0, 2, 3, 4]) {
        let [start, end] = run.windows()[k];
        assert!(mean.window[0] >= start - 0.1 && mean.window[1] <= end + 0.1, "{:?} {start} {end}", mean.window);
        assert!(mean.window[1] - mean.window[0] > 0.7 * (end - start));
    }
}

/// A plateau begun, broken off after 2 s and run again: the whole one is taken.
#[test]
fn of_a_plateau_run_twice_the_longer_is_taken() {
    let run = Stream {
        omegas: vec![0.0, 20.0, 0.0, 20.0, 40.0, 0.0],
        lengths: vec![10.0, 2.0, 1.0, 10.0, 10.0, 10.0],
        ..Stream::default()
    }
    .rough();
    let all = run.schedule();
    let schedule = [all[0], all[3], all[4], all[5]];
    let reduced = run.record().reduce(None, &schedule).expect("all four are there");
    let means = reduced.means(&NoiseModel::pool([&reduced]));
    let [start, end] = run.windows()[3];
    assert!(means[1].window[0] >= start && means[1].window[1] <= end, "{:?}", means[1].window);
}

#[test]
fn a_missing_plateau_is_named_with_what_was_seen() {
    let run = Stream::default().rough();
    let mut schedule = run.schedule();
    let missing = Stream { omegas: vec![36.0], lengths: vec![10.0], ..run.clone() }.schedule()[0];
    schedule.insert(3, missing);
    let error = run.record().reduce(None, &schedule).expect_err("it is not there");
    let ReductionError::PlateauNotFound { index, count, omega, ref seen, .. } = error else { panic!("{error}") };
    assert_eq!((index, count, omega), (3, 7, 36.0));
    let taken: Vec<Option<usize>> = seen.iter().map(|stretch| stretch.plateau).collect();
    assert_eq!(taken, [0, 1, 2, 4, 5, 6].map(Some));
    assert!(error.to_string().starts_with("plateau 4 of 7 not found: looked for 36.000 rad/s"), "{error}");
}

/// By noise that is loud enough for the plateaus of a machine that shakes, a ramp through the missing one is steady too.
#[test]
fn a_plateau_that_is_missing_among_noisy_ones_is_refused() {
    for seed in 0..10 {
        let shaken = Stream { shaking: 1.0, seed, ..Stream::default() };
        for missing in 1..5 {
            let mut short = shaken.clone();
            short.omegas.remove(missing);
            short.lengths.pop();
            let error = short.record().reduce(None, &shaken.schedule()).expect_err("one is not there");
            assert!(matches!(error, ReductionError::PlateauNotFound { .. }), "without {missing}: {error}");
        }
    }
}

/// A plateau that was interrupted and resumed has the speed of its two parts.
#[test]
fn the_speed_of_an_interruption_is_not_that_of_the_plateau() {
    let run = Stream { lengths: vec![30.0; 6], settling: (0.0, 1.0), ..Stream::default() };
    let mut telemetry = run.telemetry(0.0);
    let [start, _] = run.windows()[3];
    for (t, omega) in telemetry.t.iter().zip(&mut telemetry.omega) {
        if (start + 12.0..start + 15.0).contains(t) {
            *omega *= 0.5;
        }
    }
    let reduced = run.record().reduce(Some(&telemetry), &run.schedule()).expect("all plateaus are there");
    let speeds = MeasuredSpeed::of_all(&run.omegas, std::slice::from_ref(&reduced));
    let shown = speeds[3].expect("it spins").speed / run.omegas[3];
    assert!((shown - 1.0).abs() < 1e-6, "{shown}");
}

/// Forty loads of 5 g each: a unit 2 % off reads each of the upper ones as the next should.
fn staircase() -> Stream {
    let steps = (1..=40).map(|n| 62.6 * (f64::from(n) / 40.0).sqrt());
    let omegas: Vec<f64> = std::iter::once(0.0).chain(steps).chain([0.0]).collect();
    Stream { lengths: vec![10.0; omegas.len()], omegas, unit_error: 0.02, ..Stream::default() }
}

#[test]
fn loads_closer_than_the_unit_is_to_nominal_are_found() {
    let run = staircase();
    let reduced = run.record().reduce(None, &run.schedule()).expect("all are there");
    let means = reduced.means(&NoiseModel::pool([&reduced]));
    for (mean, [start, end]) in means.iter().zip(run.windows()) {
        assert!(mean.window[0] >= start && mean.window[1] <= end, "{:?} in {start} to {end}", mean.window);
    }
}

#[test]
fn a_load_that_is_missing_among_close_ones_is_refused() {
    let run = staircase();
    for missing in [1, 2, 20, 39, 40] {
        let mut short = run.clone();
        short.omegas.remove(missing);
        short.lengths.pop();
        let error = short.record().reduce(None, &run.schedule()).expect_err("one is not there");
        assert!(matches!(error, ReductionError::PlateauNotFound { .. }), "without {missing}: {error}");
    }
}

#[test]
fn a_record_that_ends_early_lacks_its_last_plateau() {
    let run = Stream::default();
    let whole = run.record();
    let end = run.windows()[4][1];
    let kept = whole.t.partition_point(|t| *t < end);
    let record = Record { t: whole.t[..kept].to_vec(), f_z: whole.f_z.map(|f| f[..kept].to_vec()) };
    let error = record.reduce(None, &run.schedule()).expect_err("the last is not there");
    assert!(matches!(error, ReductionError::PlateauNotFound { index: 5, .. }), "{error}");
}

#[test]
fn plateaus_out_of_order_are_recognised() {
    let run = Stream::default();
    let mut schedule = run.schedule();
    schedule.swap(1, 3);
    let error = run.record().reduce(None, &schedule).expect_err("the order is another");
    let ReductionError::PlateauNotFound { ref seen, .. } = error else { panic!("{error}") };
    assert!(seen.iter().any(|stretch| stretch.plateau.is_none() && !stretch.resembles.is_empty()), "{error}");
    assert!(error.to_string().contains("repeated or out of order"), "{error}");
}

#[test]
fn a_constant_record_has_no_plateaus() {
    let t: Vec<f64> = (0..5000).map(|i| f64::from(i) / 100.0).collect();
    for values in [[0.0, 0.0, 0.0], [0.1, -0.2, 9.81]] {
        let record = Record { f_z: values.map(|value| vec![value; t.len()]), t: t.clone() };
        let error = record.reduce(None, &Stream::default().schedule()).expect_err("nothing moves");
        assert!(matches!(error, ReductionError::PlateauNotFound { .. }), "{error}");
    }
}

/// A recorder that is started on the only plateau and stopped there.
#[test]
fn a_record_of_one_plateau_is_found() {
    for omega in [0.0, 14.0, 60.0] {
        let run = Stream { omegas: vec![omega], lengths: vec![60.0], ..Stream::default() };
        let whole = run.record();
        let [start, end] = run.windows()[0];
        let kept = whole.t.partition_point(|t| *t < start + 5.0)..whole.t.partition_point(|t| *t < end);
        let record = Record { t: whole.t[kept.clone()].to_vec(), f_z: whole.f_z.map(|f| f[kept.clone()].to_vec()) };
        let reduced = record.reduce(None, &run.schedule()).unwrap();
        let mean = reduced.means(&NoiseModel::pool([&reduced]))[0].clone();
        assert!(
            chi_squared(&run, 0, &mean) < 20.0 && mean.window[1] - mean.window[0] > 50.0,
            "{omega}: {:?}",
            mean.window
        );
    }
}

#[test]
fn noise_alone_has_no_plateaus() {
    let run = Stream { omegas: vec![0.0], lengths: vec![60.0], ..Stream::default() };
    let error = run.record().reduce(None, &Stream::default().schedule()).expect_err("nothing spins");
    assert!(matches!(error, ReductionError::PlateauNotFound { .. }), "{error}");
}

#[test]
fn a_reading_stuck_for_a_while_is_left_out() {
    let run = Stream::default();
    let mut record = run.record();
    let [start, _] = run.windows()[2];
    let from = record.t.partition_point(|t| *t < start + 5.0);
    let held = record.f_z[1][from];
    record.f_z[1][from..from + 100].fill(held);
    let reduced = record.reduce(None, &run.schedule()).expect("the rest of it is there");
    let means = reduced.means(&NoiseModel::pool([&reduced]));
    assert!(means[2].rejected >= 100);
    assert!(chi_squared(&run, 2, &means[2]) < 20.0);
}

#[test]
fn a_plateau_read_by_a_stuck_sensor_is_refused() {
    let run = Stream::default();
    let mut record = run.record();
    let [start, end] = run.windows()[2];
    for i in 0..record.t.len() {
        if record.t[i] > start && record.t[i] < end {
            record.f_z[1][i] = -0.7;
        }
    }
    let error = record.reduce(None, &run.schedule()).expect_err("one axis says nothing");
    assert!(matches!(error, ReductionError::Stuck { index: 2, axis: 1, value: -0.7, .. }), "{error}");
}

/// Steps of five times the noise hold a reading still while its level stays: that is not a stuck newtonometer. The
/// squared error over the stated covariance is 1 on average over levels anywhere between two steps, 1/6 to 3 of one session.
#[test]
fn coarse_steps_are_not_stuck() {
    for (white, lsb) in [(2e-3, 1e-2), (1e-4, 1e-3), (2e-4, 1e-2)] {
        let stream = Stream { white, lsb, ..Stream::default() };
        let session = session(&stream, 130);
        let means = means(&session);
        assert!(means.iter().all(|(_, _, mean)| mean.left_out.stuck == 0), "{white}, {lsb}");
        let sum: f64 = means.iter().map(|(stream, k, mean)| chi_squared(stream, *k, mean)).sum();
        let ratio = sum / (3 * means.len()) as f64;
        println!("{white}, {lsb}: {ratio:.3}");
        assert!(ratio < 1.5, "{white}, {lsb}: {ratio}");
    }
}

/// A reading that never changes is stuck, unless the stated resolution explains it.
#[test]
fn a_constant_reading_needs_a_stated_resolution() {
    let run = Stream { white: 2e-4, ..Stream::default() };
    let mut record = run.record();
    record.f_z[2].fill(9.84);
    let reduced = |resolution: f64| -> Result<(), ReductionError> {
        let survey = Survey::of(record.as_slice())?.with_resolution(resolution);
        let located = survey.locate(&run.schedule())?;
        located.average(0, record.as_slice()).map(|_| ())
    };
    assert!(matches!(reduced(0.0), Err(ReductionError::Stuck { index: 0, axis: 2, .. })), "{:?}", reduced(0.0));
    assert_eq!(reduced(1e-2), Ok(()));
}

/// Sampled once a revolution, the once-per-revolution term is a constant.
#[test]
fn sampling_in_step_with_the_rotation_is_refused() {
    let turns = std::f64::consts::TAU;
    let run = Stream {
        omegas: vec![0.0, 5.0 * turns, 0.0],
        lengths: vec![60.0; 3],
        ramp: 20.0,
        rate: 5.0,
        ..Stream::default()
    };
    let error = run.record().reduce(None, &run.schedule()).expect_err("no telling them apart");
    assert!(matches!(error, ReductionError::RevolutionAliased { index: 1, .. }), "{error}");
}

#[test]
fn what_is_no_record_is_refused() {
    let run = Stream::default();
    let (record, schedule) = (run.record(), run.schedule());
    let refused = |record: &Record| record.reduce(None, &schedule).expect_err("no record");
    let empty = Record::default();
    assert!(matches!(refused(&empty), ReductionError::TooShort { found: 0, .. }));
    let mut ragged = record.clone();
    ragged.f_z[2].pop();
    assert!(matches!(refused(&ragged), ReductionError::UnequalColumns { .. }));
    let mut back = record.clone();
    back.t[100] = 0.5;
    assert!(matches!(refused(&back), ReductionError::Time { sample: 101, .. }));
    let mut nan = record.clone();
    nan.t[7] = f64::NAN;
    assert!(matches!(refused(&nan), ReductionError::Time { sample: 8, .. }));
    let mut blind = record;
    blind.f_z[0].fill(f64::NAN);
    assert!(matches!(refused(&blind), ReductionError::TooShort { found: 0, .. }));
}

//! A shared session with CSV records, read with as little as it takes, and the exact model at its true parameters.

use std::f64::consts::PI;
use std::path::{Path, PathBuf};

use centrical::reduction::{Record, ScheduledPlateau, SpeedTrace};
use centrical::{ErrorModel, Site, rotation};
use nalgebra::{Matrix3, Vector3};

/// A session and its truth.
pub struct Session {
    folder: PathBuf,
    gravity: f64,
    coriolis: f64,
    alpha: Vec<f64>,
    dr: Vec<f64>,
    opposite: bool,
    rho_0: Matrix3<f64>,
    drho: Vec<f64>,
    coefficients: Vec<f64>,
    windows: Vec<f64>,
    mountings: Vec<Mounting>,
}

/// One mounting: position, place on the arm, schedule as speed and angle.
struct Mounting {
    position: usize,
    arm_y: Vector3<f64>,
    p_zy: Matrix3<f64>,
    delta: Vector3<f64>,
    plateaus: Vec<(f64, f64)>,
}

impl Session {
    /// Opens `data/name` of the shared folder.
    pub fn open(name: &str) -> Self {
        let shared = std::env::var("CENTRICAL_SHARED").expect("CENTRICAL_SHARED names the shared folder");
        let folder = Path::new(&shared).join("data").join(name);
        let truth = read(&folder.join("truth.json"));
        let experiment = read(&folder.join("experiment.toml"));
        let gravity = numbers(&truth, "\"gravity\":")[0];
        let latitude = numbers(&truth, "\"latitude\":")[0].to_radians();
        let masses = numbers(&experiment, "proof_masses =");
        let delta = numbers(&truth, "\"delta\":");
        Self {
            gravity,
            coriolis: 2.0 * Site::EARTH_RATE * latitude.sin(),
            alpha: numbers(&truth, "\"alpha\":"),
            dr: numbers(&truth, "\"dR\":"),
            opposite: experiment.contains("pair_relation = \"opposite\""),
            rho_0: Matrix3::from_fn(|i, j| masses[3 * j + i] - masses[i]),
            drho: numbers(&truth, "\"drho\":"),
            coefficients: coefficients(&truth, gravity),
            windows: numbers(&truth, "\"plateau_windows_s\":"),
            mountings: mountings(&experiment, &delta),
            folder,
        }
    }

    /// Number of mountings.
    pub fn mountings(&self) -> usize {
        self.mountings.len()
    }

    /// Record of a mounting.
    pub fn record(&self, mounting: usize) -> Record {
        let [t, f1, f2, f3] = columns(&self.folder.join(format!("records/m{:02}.csv", mounting + 1)));
        Record { t, f_z: [f1, f2, f3] }
    }

    /// Telemetry of a mounting.
    pub fn telemetry(&self, mounting: usize) -> SpeedTrace {
        let [t, omega] = columns(&self.folder.join(format!("telemetry/m{:02}.csv", mounting + 1)));
        SpeedTrace { t, omega }
    }

    /// Schedule of a mounting.
    pub fn schedule(&self, mounting: usize) -> Vec<ScheduledPlateau> {
        let m = &self.mountings[mounting];
        let d = |omega: f64| Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * -(omega * omega);
        let nominal = |omega: f64| {
            let pulls = (m.p_zy * d(omega) * m.p_zy.transpose() * self.rho_0).diagonal();
            m.p_zy * (Vector3::z() * self.gravity + d(omega) * m.arm_y) + pulls
        };
        m.plateaus.iter().map(|(omega, _)| ScheduledPlateau { omega: *omega, nominal_z: nominal(*omega) }).collect()
    }

    /// True start and end of a plateau [s].
    pub fn window(&self, mounting: usize, plateau: usize) -> [f64; 2] {
        let before: usize = self.mountings[..mounting].iter().map(|m| m.plateaus.len()).sum();
        let at = 2 * (before + plateau);
        [self.windows[at], self.windows[at + 1]]
    }

    /// True reading of a plateau if its speed is `stretch` times the set point [K3.1], [K3.2], [K4.1].
    pub fn truth(&self, mounting: usize, plateau: usize, stretch: f64) -> Vector3<f64> {
        let m = &self.mountings[mounting];
        let (set_point, angle) = m.plateaus[plateau];
        let omega = set_point * stretch;
        let d = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, 0.0)) * -(omega * (omega + self.coriolis));
        let plumb = rotation(&Vector3::new(self.alpha[0], self.alpha[1], 0.0)) * Vector3::z();
        let u = if set_point == 0.0 { rotation(&(Vector3::z() * angle)) * plumb } else { Vector3::z() * plumb.z };
        let pair = m.position / 2;
        let sign = if self.opposite && m.position % 2 == 1 { -1.0 } else { 1.0 };
        let place = m.arm_y + Vector3::new(self.dr[2 * pair], self.dr[2 * pair + 1], 0.0) * sign;
        let c_zy = rotation(&m.delta) * m.p_zy;
        let rho = self.rho_0 + Matrix3::from_diagonal(&Vector3::new(0.0, self.drho[0], self.drho[1]));
        let f = c_zy * (u * self.gravity + d * place) + (c_zy * d * c_zy.transpose() * rho).diagonal();
        ErrorModel::kozlov_2017().reading(&self.coefficients, &f)
    }
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn columns<const N: usize>(path: &Path) -> [Vec<f64>; N] {
    let mut columns = [const { Vec::new() }; N];
    for line in read(path).lines().skip(1) {
        for (column, field) in columns.iter_mut().zip(line.split(',')) {
            column.push(field.parse().unwrap_or(f64::NAN));
        }
    }
    columns
}

/// All numbers of the value after a key: of a list with everything in it, or the one.
fn numbers(text: &str, key: &str) -> Vec<f64> {
    let value = text[text.find(key).unwrap_or_else(|| panic!("no {key}")) + key.len()..].trim_start();
    let mut depth = 0;
    let end = value.find(|c| {
        depth += i32::from(c == '[') - i32::from(c == ']');
        depth == 0 && matches!(c, ']' | ',' | '\n')
    });
    let number = |word: &str| word.parse().ok();
    value[..end.unwrap_or(value.len())].split(|c: char| "[], \n".contains(c)).filter_map(number).collect()
}

/// In the order of the preset, in SI: the file has the quadratic terms per g and the cubic ones per g^2.
fn coefficients(truth: &str, gravity: f64) -> Vec<f64> {
    let mut all = numbers(truth, "\"df\":");
    let linear = numbers(truth, "\"G0\":");
    all.extend([0, 3, 4, 6, 7, 8].map(|i| linear[i]));
    all.extend(numbers(truth, "\"G1_per_g\":").iter().map(|c| c / gravity));
    all.extend(numbers(truth, "\"G2_per_g2\":").iter().map(|c| c / (gravity * gravity)));
    all
}

fn mountings(experiment: &str, delta: &[f64]) -> Vec<Mounting> {
    let quoted = |line: &str| -> Vec<String> { line.split('"').skip(1).step_by(2).map(str::to_owned).collect() };
    let first = |text: &str| text.split(' ').next().and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0);
    let (mut turns, mut all): (Vec<Matrix3<f64>>, Vec<Mounting>) = (Vec::new(), Vec::new());
    for line in experiment.lines().map(str::trim) {
        if line.starts_with("axes =") {
            turns.push(matrix(&quoted(line)[0]));
        } else if line.starts_with("position =") {
            let position = quoted(line)[0].parse::<usize>().expect("positions are numbered") - 1;
            let delta = Vector3::from_column_slice(&delta[3 * position..3 * position + 3]);
            all.push(Mounting { position, arm_y: Vector3::zeros(), p_zy: turns[position], delta, plateaus: vec![] });
        } else if let Some(mounting) = all.last_mut() {
            if line.starts_with("arm =") {
                mounting.arm_y = Vector3::from_vec(numbers(line, "arm ="));
            } else if line.starts_with("{ speed =") {
                let values = quoted(line);
                let angle = values.get(1).map_or(0.0, |angle| first(angle).to_radians());
                mounting.plateaus.push((first(&values[0]) * PI / 30.0, angle));
            }
        }
    }
    all
}

/// "+2 -3 -1": instrument axes along +y2, -y3, -y1.
fn matrix(axes: &str) -> Matrix3<f64> {
    let mut p_zy = Matrix3::zeros();
    for (i, axis) in axes.split(' ').enumerate() {
        let along: usize = axis[1..].parse().expect("an axis is 1, 2 or 3");
        p_zy[(i, along - 1)] = if axis.starts_with('-') { -1.0 } else { 1.0 };
    }
    p_zy
}

//! MATLAB and Octave: one function file, many readings at a time.

use super::model::{Model, outside_range, vector_rows};
use super::statement::Language;

/// The function file.
pub(super) fn function(model: &Model) -> String {
    let row = |reading: &str, f: &str| format!("    {reading}, {f}");
    let raw = match model.output {
        Some(_) => model.of_raw(RAW_SOURCE, &Octave),
        None => WITHOUT_RAW.to_owned(),
    };
    model
        .fill(include_str!("compensate.m.in"), &Octave)
        .replace("@axes@", &model.in_axes(AXES, "", &Octave))
        .replace("@raw_help@", &model.of_raw(RAW_HELP, &Octave))
        .replace("@raw@", &raw)
        .replace("@raw_test@", &model.of_raw(RAW_TEST, &Octave))
        .replace("@vectors@", &vector_rows(model, &Octave, row))
        .replace("@outside@", &outside_range(model, &Octave))
}

/// Lines of the help of a unit in counts or volts.
const RAW_HELP: &str = "
%
% f = centrical_compensate(raw, 'raw') takes the raw output of the unit, in @raw_unit@.";

/// Statements of the function for such a unit: its raw output is taken to readings first.
const RAW_SOURCE: &str = "    if ~strcmp(kind, 'raw')
      refuse_kind(kind, '''raw'' for raw output, or readings in m/s^2 alone');
    end
    reading = bsxfun(@rdivide, bsxfun(@minus, reading, [@raw_bias@]), [@raw_scale@]);";

/// The same for a unit without raw output of its own.
const WITHOUT_RAW: &str = "    refuse_kind(kind, 'readings in m/s^2 alone: this unit has no other output');";

/// A part of the self-test: the vectors again, as raw output.
const RAW_TEST: &str = "
  raw = bsxfun(@plus, bsxfun(@times, vectors(:, 1:3), [@raw_scale@]), [@raw_bias@]);
  difference = max(abs(centrical_compensate(raw, 'raw') - vectors(:, 4:6)), [], 2);
  if any(difference > 1e-9 * max(abs(vectors), [], 2))
    error('centrical_compensate: a test vector fails as raw output');
  end";

/// Statement of the function for a result in other axes.
const AXES: &str = "  % From the axes of the newtonometers to those of the specific forces.
  f = f * [
    @axes_1@
    @axes_2@
    @axes_3@
  ];
";

struct Octave;

impl Language for Octave {
    fn comment(&self) -> &'static str {
        "%"
    }

    fn table_line(&self, number: &str, remark: &str) -> String {
        format!("    {number} % {remark}")
    }

    fn coefficient(&self, k: usize) -> String {
        format!("c({})", k + 1)
    }

    fn component(&self, j: usize) -> String {
        format!("f{}", j + 1)
    }

    fn sign(&self, j: usize) -> String {
        format!("(1 - 2 * (f{} < 0))", j + 1)
    }

    fn times(&self) -> &'static str {
        " .* "
    }

    fn add_to_error(&self, i: usize, value: &str, remark: &str) -> String {
        format!("  e{n} = e{n} + {value}; % {remark}", n = i + 1)
    }

    fn add_to_gain(&self, i: usize, j: usize, value: &str) -> String {
        format!("  g{n} = g{n} + {value};", n = 10 * (i + 1) + j + 1)
    }
}

//! What a unit in counts or volts has beyond the others: its raw output is taken to readings first. Filled by the nominal
//! scale and bias.

/// Declarations of the C header.
pub(super) const C_HEADER: &str = "
/*
 * The same of the raw output of the unit in @raw_unit@, by its nominal scale (@raw_scale@) per m/s^2
 * and bias (@raw_bias@).
 */
int centrical_compensate_raw(const double raw[3], double f[3]);
int centrical_compensate_raw_float(const float raw[3], float f[3]);
";

/// Definitions of the C source, once for each precision.
pub(super) const C_SOURCE: &str = "
int centrical_compensate_raw@name@(const @real@ raw[3], @real@ f[3]) {
    static const @real@ scale[3] = {@raw_scale@}, raw_bias[3] = {@raw_bias@};
    @real@ reading[3];
    int i;
    for (i = 0; i < 3; i++) { reading[i] = (raw[i] - raw_bias[i]) / scale[i]; }
    return centrical_compensate@name@(reading, f);
}
";

/// A part of the self-test in C: the vectors again, as raw output.
pub(super) const C_TEST: &str = "
    for (n = 0; n < count; n++) {
        static const double scale[3] = {@raw_scale@}, raw_bias[3] = {@raw_bias@};
        double raw[3];
        for (i = 0; i < 3; i++) { raw[i] = vectors[n][0][i] * scale[i] + raw_bias[i]; }
        failures += centrical_compensate_raw(raw, f) != 0 || !agrees(f, vectors[n], 1e-9);
    }";

/// Lines of the help in Octave.
pub(super) const OCTAVE_HELP: &str = "
%
% f = centrical_compensate(raw, 'raw') takes the raw output of the unit, in @raw_unit@.";

/// Statements of the function in Octave.
pub(super) const OCTAVE_SOURCE: &str = "    if ~strcmp(kind, 'raw')
      refuse_kind(kind, '''raw'' for raw output, or readings in m/s^2 alone');
    end
    reading = bsxfun(@rdivide, bsxfun(@minus, reading, [@raw_bias@]), [@raw_scale@]);";

/// The same for a unit without raw output of its own.
pub(super) const OCTAVE_WITHOUT: &str =
    "    refuse_kind(kind, 'readings in m/s^2 alone: this unit has no other output');";

/// A part of the self-test in Octave.
pub(super) const OCTAVE_TEST: &str = "
  raw = bsxfun(@plus, bsxfun(@times, vectors(:, 1:3), [@raw_scale@]), [@raw_bias@]);
  difference = max(abs(centrical_compensate(raw, 'raw') - vectors(:, 4:6)), [], 2);
  if any(difference > 1e-9 * max(abs(vectors), [], 2))
    error('centrical_compensate: a test vector fails as raw output');
  end";

/// Constants and functions of the Python module.
pub(super) const PYTHON_SOURCE: &str = "
RAW_UNIT = \"@raw_unit@\"
RAW_SCALE = (@raw_scale@)  # Nominal scale, raw unit per m/s^2.
RAW_BIAS = (@raw_bias@)  # Nominal bias, raw unit.


def compensate_raw(raw):
    \"\"\"Specific force of the raw output of the unit, in RAW_UNIT.\"\"\"
    raw = _three(raw)
    return compensate([(raw[i] - RAW_BIAS[i]) / RAW_SCALE[i] for i in range(3)])


def compensate_raw_array(raw):
    \"\"\"Specific forces of raw output, an array (n, 3), in RAW_UNIT; NaN as of compensate_array. Needs NumPy.\"\"\"
    import numpy

    return compensate_array((_rows(raw, numpy) - RAW_BIAS) / RAW_SCALE)

";

/// A part of the self-test in Python.
pub(super) const PYTHON_TEST: &str = "
    for reading, expected in VECTORS:
        raw = [reading[i] * RAW_SCALE[i] + RAW_BIAS[i] for i in range(3)]
        largest = max(abs(x) for x in reading + expected)
        if not all(abs(x - y) <= 1e-9 * largest for x, y in zip(compensate_raw(raw), expected)):
            raise AssertionError(f\"{raw}: expected {expected}\")";

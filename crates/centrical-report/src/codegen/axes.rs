//! What a result in other axes has beyond the others: specific forces are turned from the axes of the newtonometers. Filled by the
//! rows of the matrix.

/// Constant of the C source, once for each precision.
pub(super) const C_CONSTANT: &str = "
/* From the axes of specific forces to those of the newtonometers, by rows. */
static const @real@ axes@name@[3][3] = {
    {@axes_1@},
    {@axes_2@},
    {@axes_3@},
};
";

/// Component `i` of a specific force in C.
pub(super) const C_TURNED: &str = "axes@name@[0][i] * x[0] + axes@name@[1][i] * x[1] + axes@name@[2][i] * x[2]";

/// Statement of the function in Octave.
pub(super) const OCTAVE: &str = "  % From the axes of the newtonometers to those of the specific forces.
  f = f * [
    @axes_1@
    @axes_2@
    @axes_3@
  ];
";

/// Constant of the Python module.
pub(super) const PYTHON_CONSTANT: &str = "
# From the axes of specific forces to those of the newtonometers, by rows.
AXES = (
    (@axes_1@),
    (@axes_2@),
    (@axes_3@),
)
";

/// A specific force in Python.
pub(super) const PYTHON_TURNED: &str = "tuple(sum(AXES[i][j] * f[i] for i in range(3)) for j in range(3))";

/// Columns of specific forces in Python.
pub(super) const PYTHON_TURNED_ARRAY: &str =
    "numpy.array([sum(AXES[i][j] * f[i] for i in range(3)) for j in range(3)])";

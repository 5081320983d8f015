//! NumPy arrays of shape `(n, 3)`: what is taken, what is refused, and what is copied first.

use numpy::{
    PyArray2, PyArrayDescrMethods, PyArrayMethods, PyReadonlyArray2, PyReadwriteArray2, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;

/// An array of shape `(n, 3)`, float64 in the byte order of the machine.
pub type Rows<'py> = Bound<'py, PyArray2<f64>>;

/// The array that an argument is. One that is not in C order, or not aligned, is copied into C order where `may_copy`.
///
/// # Errors
/// `TypeError` unless it is an array of float64, `ValueError` for another shape or, unless `may_copy`, another order.
pub fn rows<'py>(argument: &str, object: &Bound<'py, PyAny>, may_copy: bool) -> PyResult<Rows<'py>> {
    let Ok(array) = object.cast::<PyArray2<f64>>() else { return Err(refusal(argument, object)) };
    let [n, columns] = [array.shape()[0], array.shape()[1]];
    if columns != 3 {
        return Err(PyValueError::new_err(format!("{argument}: found shape ({n}, {columns}), expected (n, 3)")));
    }
    // A Fortran array is contiguous too, and would be taken for rows.
    if array.is_c_contiguous() && is_aligned(array) {
        return Ok(array.clone());
    }
    if !may_copy {
        let found = format!("strides {:?} of shape ({n}, 3)", array.strides());
        return Err(PyValueError::new_err(format!("{argument}: found {found}, expected an aligned array in C order")));
    }
    let copy = array.py().import("numpy")?.getattr("require")?.call1((array, "f8", ["C", "A", "O"]))?;
    Ok(copy.cast_into::<PyArray2<f64>>()?)
}

/// Borrows an array to read it.
///
/// # Errors
/// `ValueError` while something writes to it.
pub fn to_read<'py>(argument: &str, array: &Rows<'py>) -> PyResult<PyReadonlyArray2<'py, f64>> {
    array.try_readonly().map_err(|_| {
        PyValueError::new_err(format!("{argument}: found an array that is being written, expected one at rest"))
    })
}

/// Borrows an array to write to it.
///
/// # Errors
/// `ValueError` when it is read-only, or shares memory with one that is in use.
pub fn to_write<'py>(argument: &str, array: &Rows<'py>) -> PyResult<PyReadwriteArray2<'py, f64>> {
    array.try_readwrite().map_err(|error| match error {
        numpy::BorrowError::NotWriteable => {
            PyValueError::new_err(format!("{argument}: found a read-only array, expected a writable one"))
        }
        _ => PyValueError::new_err(format!(
            "{argument}: found memory shared with readings or in use elsewhere, expected the very array of the \
             readings, or memory of its own"
        )),
    })
}

/// The rows in a borrowed array.
pub fn as_rows(elements: &[f64]) -> &[[f64; 3]] {
    elements.as_chunks().0
}

/// The same to write to.
pub fn as_rows_mut(elements: &mut [f64]) -> &mut [[f64; 3]] {
    elements.as_chunks_mut().0
}

fn is_aligned(array: &Rows) -> bool {
    array.data().addr() % align_of::<f64>() == 0
}

/// Why an argument is not a matrix of float64.
fn refusal(argument: &str, object: &Bound<PyAny>) -> PyErr {
    let Ok(array) = object.cast::<PyUntypedArray>() else {
        let found = object.get_type().name().map_or_else(|_| "an object".to_owned(), |name| name.to_string());
        return PyTypeError::new_err(format!("{argument}: found {found}, expected a NumPy array of float64"));
    };
    let dtype = array.dtype();
    let found = dtype.getattr("str").map_or_else(|_| dtype.to_string(), |text| text.to_string());
    if dtype.is_equiv_to(&numpy::dtype::<f64>(object.py())) {
        let shape = array.shape();
        return PyValueError::new_err(format!("{argument}: found shape {}, expected (n, 3)", shown(shape)));
    }
    PyTypeError::new_err(format!("{argument}: found dtype {dtype} ({found}), expected float64 in native byte order"))
}

/// A shape as Python writes it.
fn shown(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        all => format!("({})", all.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}

//! Rows folded into a triangular factor by reflections (Householder): `R'^T R' = R^T R + A^T A` without either product.
//!
//! A reflection that clears column `j` of the rows touches nothing of the triangle but its row `j`, and a column in which the rows
//! are zero is passed over: plateaus of one position leave the unknowns of the others alone.

use nalgebra::DMatrix;

/// Folds `rows` into `triangle`; both have as many columns. `rows` are used up.
pub fn fold(triangle: &mut DMatrix<f64>, rows: &mut DMatrix<f64>) {
    let (n, p) = rows.shape();
    for j in 0..p {
        let (pivot, rest) = rows.as_mut_slice()[j * n..].split_at_mut(n);
        let square = dot(pivot, pivot);
        if square == 0.0 {
            continue;
        }
        let diagonal = triangle[(j, j)];
        let length = -(diagonal * diagonal + square).sqrt().copysign(diagonal);
        // The reflection is E - v v^T / (-length head), v = (head, pivot).
        let head = diagonal - length;
        let scale = -1.0 / (length * head);
        triangle[(j, j)] = length;
        for (k, column) in (j + 1..p).zip(rest.chunks_exact_mut(n)) {
            let part = scale * (head * triangle[(j, k)] + dot(pivot, column));
            triangle[(j, k)] -= part * head;
            column.iter_mut().zip(&*pivot).for_each(|(a, v)| *a -= part * v);
        }
    }
}

/// Scalar product in four sums, which a processor adds side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a4, a_rest) = a.as_chunks::<4>();
    let (b4, b_rest) = b.as_chunks::<4>();
    let mut sums = [0.0; 4];
    for (a, b) in a4.iter().zip(b4) {
        (0..4).for_each(|i| sums[i] += a[i] * b[i]);
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    (sums[0] + sums[1]) + (sums[2] + sums[3]) + rest
}

//! Columns: a grid of numbers turned, so that what ran along columns runs along lines.

use rayon::prelude::*;

/// Lines of `length` become columns: number `i` of each line comes to stand in line `i`.
pub fn columns<T: Copy + Default + Send + Sync>(lines: &[T], length: usize) -> Vec<T> {
    let count = lines.len() / length;
    let mut turned = vec![T::default(); lines.len()];
    turned
        .par_chunks_exact_mut(count)
        .enumerate()
        .for_each(|(i, column)| {
            for (value, line) in column.iter_mut().zip(lines.chunks_exact(length)) {
                *value = line[i];
            }
        });
    turned
}

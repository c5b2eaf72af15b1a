//! Columns: a grid of numbers turned, so that what ran along columns runs along lines.

use rayon::prelude::*;

/// Lines of `length` become columns: number `i` of each line comes to stand in line `i`.
pub fn columns<T: Copy + Default + Send + Sync>(lines: &[T], length: usize) -> Vec<T> {
    // Neighbours of a line lie side by side in memory
    const TOGETHER: usize = 8;
    if lines.is_empty() {
        return Vec::new();
    }
    let count = lines.len() / length;
    let mut turned = vec![T::default(); lines.len()];
    turned
        .par_chunks_mut(TOGETHER * count)
        .enumerate()
        .for_each(|(group, columns)| {
            let first = TOGETHER * group;
            let width = columns.len() / count;
            for (i, line) in lines.chunks_exact(length).enumerate() {
                for (j, value) in line[first..first + width].iter().enumerate() {
                    columns[j * count + i] = *value;
                }
            }
        });
    turned
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_change_places() {
        for (count, length) in [(1, 1), (3, 8), (5, 19)] {
            let lines: Vec<usize> = (0..count * length).collect();
            let turned = columns(&lines, length);
            for (place, value) in turned.into_iter().enumerate() {
                assert_eq!(value, place % count * length + place / count);
            }
        }
    }
}

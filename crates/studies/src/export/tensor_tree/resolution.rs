//! Resolution: the number of cells that lobes need.

use glam::DVec2;

use super::disc::disc;

/// Part of the light that may move within cells.
const RESOLVED: f64 = 0.1;
/// Cells per axis of the grid on which resolution is judged.
const FINEST: usize = 256;

/// Fewest cells per axis of the `candidates`, ascending, that resolve the lobes, or `otherwise`, one of them, and the part of the light that moves within them.
///
/// A lobe is the BSDF over directions projected onto the mean plane.
pub(super) fn resolving(
    candidates: &[usize],
    otherwise: usize,
    lobes: impl Iterator<Item = impl Fn(DVec2) -> f64>,
) -> (usize, f64) {
    let mut moved = vec![0.0; candidates.len()];
    let mut sum = 0.0;
    for bsdf in lobes {
        let mut cells = FINEST;
        let value = |cell: usize| {
            let at = [cell / cells, cell % cells].map(|k| (k as f64 + 0.5) / cells as f64);
            bsdf(disc(at))
        };
        let mut values: Vec<f64> = (0..cells * cells).map(value).collect();
        sum += values.iter().sum::<f64>();
        while cells > candidates[0] {
            let half = cells / 2;
            let mean = |i: usize| {
                let at = 2 * (i / half) * cells + 2 * (i % half);
                let four = [at, at + 1, at + cells, at + cells + 1];
                0.25 * four.map(|one| values[one]).iter().sum::<f64>()
            };
            let means: Vec<f64> = (0..half * half).map(mean).collect();
            if let Some(place) = candidates.iter().position(|count| *count == half) {
                let change = values
                    .iter()
                    .enumerate()
                    .map(|(i, value)| (value - means[i / cells / 2 * half + i % cells / 2]).abs());
                let area = (FINEST / cells).pow(2) as f64;
                moved[place] += 0.5 * area * change.sum::<f64>();
            }
            (values, cells) = (means, half);
        }
    }
    let is_taken = |place: &usize| moved[*place] <= RESOLVED * sum;
    let fewest = (0..candidates.len()).find(is_taken);
    let otherwise = candidates.iter().position(|cells| *cells == otherwise);
    let place = fewest.or(otherwise).unwrap_or(0);
    (candidates[place], moved[place] / sum)
}

//! Effort: surfaces, rays and seed of results, in captions of figures.

use asperity_simulate::counted;

/// The amounts of work of some results, in words: `8 surfaces, 20000 rays per direction, seed 1`. Amounts that differ are given as
/// the largest.
pub(crate) fn effort(work: impl Iterator<Item = [u64; 2]> + Clone, per: &str, seed: u64) -> String {
    let words = |of: fn([u64; 2]) -> u64, noun: &str| {
        let counts = work.clone().map(of);
        let most = counts.clone().max().filter(|most| *most > 0)?;
        let differ = counts.min() != Some(most);
        let up_to = if differ { "up to " } else { "" };
        Some(format!("{up_to}{}", counted(most, noun)))
    };
    let surfaces = words(|[surfaces, _]| surfaces, "surface");
    let rays = words(|[_, rays]| rays, "ray").map(|rays| rays + per);
    let parts = surfaces.into_iter().chain(rays);
    parts
        .chain([format!("seed {seed}")])
        .collect::<Vec<_>>()
        .join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_rays_and_seed_are_named() {
        let text = |work: &[[u64; 2]]| effort(work.iter().copied(), " per direction", 7);
        assert_eq!(
            text(&[[1, 100]]),
            "1 surface, 100 rays per direction, seed 7"
        );
        let several = "up to 4 surfaces, 100 rays per direction, seed 7";
        assert_eq!(text(&[[4, 100], [2, 100]]), several);
        // Nothing was traced.
        assert_eq!(text(&[[0, 0]]), "seed 7");
    }
}

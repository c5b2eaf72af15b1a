//! Time to draw a surface of each recipe, over that of a Gaussian one of the same grid.
//!
//! ```sh
//! cargo bench -p asperity-surface --bench recipes
//! ```
//! One thread; medians of interleaved repeats, in the memory of the last surface.

#![allow(clippy::print_stdout, reason = "a benchmark prints what it measures")]

use std::hint::black_box;
use std::time::Instant;

use asperity_synthesis::{
    FieldSynthesis, NEVER, Psd, Resolution, StudentSlopes, SurfaceRecipe, TransformedHeights,
};

const N: usize = 2048;
const REPEATS: u64 = 7;

fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let gaussian = Psd::gaussian(1.0, 16.0)?;
    let recipes: Vec<(&str, SurfaceRecipe)> = vec![
        ("gaussian", gaussian.clone().into()),
        ("exponential", Psd::exponential(1.0, 16.0, 8.5)?.into()),
        (
            "matern 1.5",
            Psd::matern(1.0, 128.0, 1.5, Some(8.5))?.into(),
        ),
        ("power law", Psd::power_law(1.0, 0.8, 128.0, 8.5)?.into()),
        (
            "two scales",
            gaussian.clone().plus(Psd::gaussian(0.1, 4.0)?).into(),
        ),
        (
            "skewed",
            TransformedHeights::new(gaussian.clone(), -1.0, 4.5)?.into(),
        ),
        ("ggx", StudentSlopes::new(gaussian, 8.0)?.into()),
    ];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| {
        let plan = |(name, recipe): &(&str, SurfaceRecipe)| {
            let start = Instant::now();
            let synthesis =
                FieldSynthesis::new(recipe.clone(), [N; 2], [1.0; 2], Resolution::Facets);
            synthesis.map(|synthesis| (name.to_string(), synthesis, start.elapsed().as_secs_f64()))
        };
        let planned = recipes.iter().map(plan).collect::<Result<Vec<_>, _>>()?;
        let mut times = vec![Vec::new(); planned.len()];
        let mut rooms = vec![Vec::new(); planned.len()];
        for realisation in 0..REPEATS {
            for (i, (_, synthesis, _)) in planned.iter().enumerate() {
                let start = Instant::now();
                let room = std::mem::take(&mut rooms[i]);
                let field = synthesis.draw_into(1, realisation, room, NEVER)?;
                times[i].push(start.elapsed().as_secs_f64() * 1e3);
                rooms[i] = black_box(field).into_heights();
            }
        }
        let medians = times.iter_mut().map(|times| {
            times.sort_by(f64::total_cmp);
            times[times.len() / 2]
        });
        let medians: Vec<f64> = medians.collect();
        println!("recipe        plan, s  draw, ms  over Gaussian");
        for ((name, _, seconds), median) in planned.iter().zip(&medians) {
            println!(
                "{name:12}  {seconds:7.3}  {median:8.1}  {:13.2}",
                median / medians[0]
            );
        }
        Ok(())
    })
}

//! Time of a draw on one thread, and of the FFTs alone.
//!
//! `cargo bench -p asperity-synthesis` prints medians in milliseconds and their ratios. The bare FFTs
//! are those of the whole inverse real FFT, of columns and of rows, on arrays that are there already
//! and in the order that each wants; where most waves are empty, a draw needs fewer of them. `fresh` is
//! [`Synthesis::draw`], whose memory the system provides and clears page by page; `in place` is
//! [`Synthesis::draw_into`] in the memory of the last surface.
#![allow(clippy::print_stdout, reason = "a bench is read by eye")]

use std::hint::black_box;
use std::time::Instant;

use asperity_numerics::{ComplexPair, FourierTransform, RealFourierTransform};
use asperity_synthesis::{NEVER, Psd, Synthesis, SynthesisError};
use num_complex::Complex;

const SIZES: [usize; 4] = [512, 1024, 2048, 4096];
const TAUS: [f64; 2] = [4.0, 16.0];

/// Samples timed in all for each figure, and the fewest repeats.
const SAMPLES: usize = 1 << 26;
const FEWEST_REPEATS: usize = 7;

fn main() -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    pool.install(|| {
        println!("   N  tau     fresh  in place  bare FFTs   fresh/bare  in place/bare");
        for n in SIZES {
            for tau in TAUS {
                let synthesis = Synthesis::new(Psd::gaussian(1.0, tau)?, [n, n], [1.0; 2], false)?;
                let [fresh, in_place, bare] = medians(&synthesis, n)?;
                println!(
                    "{n:4}  {tau:3}  {fresh:8.2}  {in_place:8.2}  {bare:9.2}   {:10.2}  {:13.2}",
                    fresh / bare,
                    in_place / bare
                );
            }
        }
        Ok(())
    })
}

/// Medians of interleaved repeats of a draw, of a draw in place, and of the bare FFTs, milliseconds.
fn medians(synthesis: &Synthesis, n: usize) -> Result<[f64; 3], SynthesisError> {
    let mut ffts = BareFfts::new(n);
    let mut times = [const { Vec::new() }; 3];
    let mut last = synthesis.draw(1, 0)?;
    for realisation in 0..FEWEST_REPEATS.max(SAMPLES / (n * n)) as u64 {
        let start = Instant::now();
        drop(black_box(synthesis.draw(1, realisation)?));
        times[0].push(milliseconds_since(start));

        let room = last.into_heights();
        let start = Instant::now();
        last = synthesis.draw_into(1, realisation, room, NEVER)?;
        times[1].push(milliseconds_since(start));

        ffts.fill();
        let start = Instant::now();
        ffts.process();
        times[2].push(milliseconds_since(start));
    }
    Ok(times.map(|mut times| {
        times.sort_by(f64::total_cmp);
        times[times.len() / 2]
    }))
}

fn milliseconds_since(start: Instant) -> f64 {
    start.elapsed().as_secs_f64() * 1e3
}

/// The FFTs from a half spectrum to `n` by `n` heights.
struct BareFfts {
    along_y: FourierTransform,
    along_x: RealFourierTransform,
    /// Columns of the half spectrum, two in one.
    columns: Vec<ComplexPair>,
    heights: Vec<f64>,
    scratch: Vec<ComplexPair>,
}

impl BareFfts {
    fn new(n: usize) -> Self {
        let (along_y, along_x) = (FourierTransform::inverse(n), RealFourierTransform::new(n));
        Self {
            columns: vec![ComplexPair::default(); n * along_x.waves().div_ceil(2)],
            heights: vec![0.0; n * n],
            scratch: along_y.scratch(),
            along_y,
            along_x,
        }
    }

    /// Sets all waves alike.
    fn fill(&mut self) {
        self.columns
            .fill(ComplexPair::new([Complex { re: 1.0, im: 0.5 }; 2]));
    }

    /// Transforms every column of the half spectrum, then every row into heights. The numbers mean
    /// nothing, since the columns are not turned into rows in between.
    fn process(&mut self) {
        let n = self.along_x.length();
        for two in self.columns.chunks_exact_mut(n) {
            let results = self
                .along_y
                .transform(two.iter().copied(), &mut self.scratch);
            two.copy_from_slice(results);
        }
        let spectra = self.columns.chunks_exact(self.along_x.waves());
        for (spectra, rows) in spectra.zip(self.heights.chunks_exact_mut(2 * n)) {
            let (first, second) = rows.split_at_mut(n);
            self.along_x
                .inverse(spectra, [first, second], &mut self.scratch);
        }
        black_box(&mut self.heights);
    }
}

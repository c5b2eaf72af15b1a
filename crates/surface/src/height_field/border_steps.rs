//! Steps of heights from the last samples to the first, as a periodic border has them.

use super::field::HeightField;

impl HeightField {
    /// Root mean square step of the heights from the last sample to the first, over that between neighbours, along x
    /// and along y: about 1 where opposite borders fit.
    ///
    /// Zero where heights of the border are equal, infinite where only those between neighbours are.
    #[must_use]
    pub fn border_steps(&self) -> [f64; 2] {
        let [ny, nx] = self.shape();
        let step = |a: [usize; 2], b: [usize; 2]| {
            (self.height(a[0], a[1]) - self.height(b[0], b[1])).powi(2)
        };
        let along_x = |iy: usize| {
            let inside: f64 = (1..nx).map(|ix| step([ix, iy], [ix - 1, iy])).sum();
            [step([0, iy], [nx - 1, iy]), inside / (nx - 1) as f64]
        };
        let along_y = |ix: usize| {
            let inside: f64 = (1..ny).map(|iy| step([ix, iy], [ix, iy - 1])).sum();
            [step([ix, 0], [ix, ny - 1]), inside / (ny - 1) as f64]
        };
        [ratio((0..ny).map(along_x)), ratio((0..nx).map(along_y))]
    }
}

/// Root of the ratio of two sums; zero over zero is zero.
fn ratio(squares: impl Iterator<Item = [f64; 2]>) -> f64 {
    let [border, inside] = squares.fold([0.0, 0.0], |[a, b], [c, d]| [a + c, b + d]);
    if border == 0.0 {
        0.0
    } else {
        (border / inside).sqrt()
    }
}

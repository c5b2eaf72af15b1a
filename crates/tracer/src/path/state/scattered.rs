//! Scattered light: the branches that leave facets, field by field.

/// Light that facets have scattered.
#[derive(Default)]
pub(crate) struct ScatteredLight {
    pub(crate) transmitted: Branches,
    pub(crate) reflected: Branches,
}

/// Transmitted or reflected light, field by field.
#[derive(Default)]
pub(crate) struct Branches {
    /// Fraction of the flux that has arrived; later the flux.
    pub(crate) flux: Vec<f64>,
    /// Unit vectors in the orientation of the tile; of no meaning where there is no flux.
    pub(crate) direction: [Vec<f64>; 3],
    /// Numbers of its polarisation, as in [`super::segments::Segments::light`].
    pub(crate) light: Vec<Vec<f64>>,
}

impl Branches {
    pub(crate) fn resize(&mut self, n: usize, numbers: usize) {
        self.light.resize(numbers, Vec::new());
        let columns = self.direction.iter_mut().chain(&mut self.light);
        for column in columns.chain([&mut self.flux]) {
            column.resize(n, 0.0);
        }
    }
}

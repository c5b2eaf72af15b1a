//! Colours of sRGB, mixtures of two, and places along a list of them.

/// A colour of sRGB, 8 bits per channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rgb(pub(crate) u8, pub(crate) u8, pub(crate) u8);

/// Colour map *viridis* (Smith and van der Walt 2015, CC0) at equal steps, which appear equally large, also in grey.
pub(crate) const VIRIDIS: [Rgb; 8] = [
    Rgb(68, 1, 84),
    Rgb(70, 50, 127),
    Rgb(54, 92, 141),
    Rgb(39, 127, 143),
    Rgb(31, 162, 136),
    Rgb(74, 194, 110),
    Rgb(160, 219, 57),
    Rgb(254, 232, 37),
];

impl Rgb {
    /// Mixture of this colour and the fraction `t` of another.
    pub(crate) fn mix(self, Rgb(r, g, b): Rgb, t: f64) -> Rgb {
        let mix =
            |from: u8, to: u8| ((1.0 - t) * f64::from(from) + t * f64::from(to)).round() as u8;
        Rgb(mix(self.0, r), mix(self.1, g), mix(self.2, b))
    }

    /// Colour at a place along two or more, 0 at the first and 1 at the last.
    pub(crate) fn along(colours: &[Rgb], place: f64) -> Rgb {
        let along = place * (colours.len() - 1) as f64;
        let first = (along as usize).min(colours.len() - 2);
        colours[first].mix(colours[first + 1], along - first as f64)
    }

    /// The colour as in `#0072B2`.
    pub(crate) fn hex(self) -> String {
        let Rgb(r, g, b) = self;
        format!("#{r:02X}{g:02X}{b:02X}")
    }
}

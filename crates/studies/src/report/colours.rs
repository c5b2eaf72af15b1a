//! Colours of spectra under D65, for both standard observers.

use asperity_optics::{Colour, ColourObserver, colour_weights};
use asperity_tally::{Estimate, Side};

use super::spectrum::{Spectrum, weighted_sum};
use crate::output::{Column, EstimateWithLimit, Table};
use crate::report::views::Csv;

/// Colour of the light of a spectrum that leaves on one side.
pub(crate) struct SideColour {
    pub(crate) label: String,
    pub(crate) side: Side,
    observer: ColourObserver,
    /// Tristimulus values. Standard errors add, since wavelengths share their rays.
    xyz: [Estimate; 3],
    colour: Colour,
}

impl SideColour {
    /// The colours of a spectrum; none unless it covers visible light finely enough.
    pub(crate) fn of(spectrum: &Spectrum<'_>) -> Vec<Self> {
        let mut colours = Vec::new();
        for side in Side::BOTH {
            let (wavelengths, fluxes): (Vec<f64>, Vec<Estimate>) = spectrum.side(side).unzip();
            if fluxes.iter().all(|flux| flux.mean == 0.0) {
                continue;
            }
            for observer in [ColourObserver::Cie1931, ColourObserver::Cie1964] {
                let Some(weights) = colour_weights(&wavelengths, observer) else {
                    continue;
                };
                let xyz = [0, 1, 2].map(|i| {
                    let weights = weights.iter().map(|weight| weight[i]);
                    weighted_sum(weights.zip(fluxes.iter().copied()))
                });
                colours.push(Self {
                    label: spectrum.label(),
                    side,
                    observer,
                    colour: Colour::from_xyz(xyz.each_ref().map(|one| one.mean), observer),
                    xyz,
                });
            }
        }
        colours
    }

    /// Returns `true` if its observer is that of sRGB.
    pub(crate) fn has_srgb(&self) -> bool {
        self.observer == ColourObserver::Cie1931
    }

    /// Components of sRGB, 0 to 255.
    pub(crate) fn rgb(&self) -> [u8; 3] {
        self.colour.srgb.map(|value| (255.0 * value).round() as u8)
    }

    /// sRGB as in `#d4af37`.
    pub(crate) fn hex(&self) -> String {
        let [r, g, b] = self.rgb();
        format!("#{r:02x}{g:02x}{b:02x}")
    }

    const fn observer(&self) -> &'static str {
        match self.observer {
            ColourObserver::Cie1931 => "CIE 1931 2 degrees",
            ColourObserver::Cie1964 => "CIE 1964 10 degrees",
        }
    }

    /// The colour in words.
    pub(crate) fn text(&self) -> String {
        let [x, y, z] = self.xyz.map(|one| EstimateWithLimit::from(one).text());
        let xy = self.colour.xy.map(|value| format!("{value:.4}"));
        let clipped = if self.colour.is_clipped {
            ", clipped"
        } else {
            ""
        };
        format!(
            "{} light under D65, {}: XYZ {x} {y} {z}, xy {} {}, sRGB {}{clipped}",
            self.side,
            self.observer(),
            xy[0],
            xy[1],
            self.hex(),
        )
    }
}

/// colour.csv: a row per spectrum, side and observer.
pub(crate) fn colour_table<'a>(colours: Vec<SideColour>) -> Option<Csv<'a>> {
    type Row = SideColour;
    let mut table = Table::new()
        .column(Column::new(
            "spectrum",
            "what its results have in common",
            |row: &Row| row.label.clone(),
        ))
        .column(Column::new(
            "side",
            "side that the light leaves on",
            |row: &Row| row.side.to_string(),
        ))
        .column(Column::new("observer", "standard observer", Row::observer));
    for (i, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let about = "tristimulus value under D65; Y = 1 of a perfect diffuse reflector";
        table = table.column(Column::estimate(name, about, move |row: &Row| {
            Some(row.xyz[i])
        }));
    }
    for (i, name) in ["x", "y"].into_iter().enumerate() {
        table = table.column(Column::new(name, "chromaticity", move |row: &Row| {
            row.colour.xy[i]
        }));
    }
    let table = table
        .column(Column::new(
            "srgb",
            "sRGB, of white adapted to D65",
            Row::hex,
        ))
        .column(Column::new(
            "clipped",
            "1: outside of sRGB, and clipped",
            |row: &Row| u64::from(row.colour.is_clipped),
        ));
    (!colours.is_empty()).then(|| table.with_rows(colours))
}

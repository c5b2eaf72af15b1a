//! Statistics: roughness of one surface, and its shadows.

use asperity_optics::Incidence;
use asperity_simulate::{Cells, short};
use asperity_surface::{HeightField, Iso25178, SplineRoughness, SplineSurface};
use asperity_synthesis::DrawnRoughness;
use serde::Serialize;

use crate::attenuation::ShadowShares;
use crate::error::StudyError;
use crate::output::significant;
use crate::report::areal_parameters::areal_table;
use crate::report::roughness::{realisation_table, roughness_table, smooth_table};

/// Roughness of the samples and facets, and of the smooth cells through the same heights.
#[derive(Clone, Debug, Serialize)]
pub struct Statistics {
    /// Roughness of samples and facets.
    #[serde(flatten)]
    pub facets: DrawnRoughness,
    /// Parameters of ISO 25178-2.
    #[serde(flatten)]
    pub areal: Iso25178,
    /// The cells between heights.
    pub cells: Cells,
    /// Roughness of the smooth cells, if cells are smooth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub smooth: Option<SplineRoughness>,
    /// Lit and shadowed fractions, one per light.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub shadows: Vec<ShadowShares>,
    /// Notes on how the file was read, eroded and written, one sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl Statistics {
    /// Measures `field` with these `cells` between heights, under each of `lights`.
    pub(super) fn of(
        field: &HeightField,
        cells: Cells,
        lights: &[Incidence],
    ) -> Result<Self, StudyError> {
        let smooth = || SplineRoughness::of(&SplineSurface::through(field));
        let (facets, areal) = rayon::join(|| DrawnRoughness::of(field), || Iso25178::of(field));
        Ok(Self {
            facets,
            areal,
            cells,
            smooth: (cells == Cells::Smooth).then(smooth),
            shadows: ShadowShares::of(field, cells, lights)?,
            notes: Vec::new(),
        })
    }

    /// The answer in two lines: heights, slopes and correlation lengths.
    pub(super) fn headline(&self) -> Vec<String> {
        let r = &self.facets.roughness;
        let length = |value: Option<f64>| {
            value.map_or_else(
                || "-".to_owned(),
                |value| significant(value) + r.unit.suffix(),
            )
        };
        let heights = [("Sq", r.sq), ("Sa", r.sa), ("Sz", r.sz)];
        let heights = heights.map(|(name, height)| format!("{name} {}", length(Some(height))));
        let [x, y] = [r.tau_x, r.tau_y].map(length);
        let mut lines = vec![
            format!(
                "{}; root mean square gradient Sdq {}",
                heights.join(", "),
                significant(r.sdq)
            ),
            format!("correlation lengths (1/e): {x} along x, {y} along y"),
        ];
        lines.extend(self.shadows.iter().take(MAX_LIGHTS).map(|shares| {
            let parts = [shares.lit, shares.facing_away, shares.hidden];
            let [lit, away, hidden] = parts.map(|part| significant(part.estimate().mean));
            let theta = short(shares.theta_deg);
            format!("light at theta {theta} deg: lit {lit}, facing away {away}, hidden {hidden}")
        }));
        lines
    }

    /// Tables for people.
    #[must_use]
    pub fn text(&self) -> String {
        let facets = &self.facets.roughness;
        let table = roughness_table(facets);
        let realisation = self.facets.realisation();
        let realisation = realisation_table(realisation.as_ref(), facets.unit, [None; 2]);
        let areal = areal_table(&self.areal, facets.unit);
        let cells = match &self.smooth {
            None => FLAT_CELLS.to_owned(),
            Some(smooth) => smooth_table(facets, smooth),
        };
        let shadows = self.shadows.iter().map(|shares| shares.text() + "\n");
        let shadows: String = shadows.collect();
        format!("{table}{areal}{realisation}{cells}{shadows}")
    }
}

/// Most lights of which a headline tells.
const MAX_LIGHTS: usize = 3;

const FLAT_CELLS: &str =
    "traced with flat cells by default, two triangles each; see --cells smooth\n";

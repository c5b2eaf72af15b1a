//! Error budget: the errors of a result by where they come from: rays, surfaces, mesh.

use std::borrow::Cow;

use asperity_numerics::elementary::hypot;
use asperity_tally::{
    Component, Entry, Estimate, Side, TallyResult, TallySpec, TallyStatistics, TallyValues,
};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};

use super::mesh_error::MeshErrors;
use super::refinement::Refinement;
use crate::input::target::{Quantity, ratio};
use crate::methods::method::{ControlVariateMean, Method};

/// The errors of one number, flux fractions; `None` where one is not known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Standard error by the rays on each surface.
    pub rays: Option<f64>,
    /// Standard error by the differences between surfaces.
    pub surfaces: Option<f64>,
    /// Shift of the result by the mesh, with its sign.
    pub mesh: Option<f64>,
    /// Standard error of that, where it was measured.
    pub mesh_se: Option<f64>,
    /// Shift by the mesh that the control variate removed, with its sign.
    pub mesh_removed: Option<f64>,
    /// Root of the sum of the squares of rays, surfaces and mesh, as far as they are known.
    pub total: Option<f64>,
}

/// Explanation of the estimate of each error, a sentence each.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Explanation {
    rays: String,
    surfaces: String,
    mesh: String,
    mesh_removed: String,
    total: Cow<'static, str>,
}

/// The errors of all results of a case, by where they come from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ErrorBudget {
    spec: TallySpec,
    /// `None` where it was not kept.
    kept: Option<Box<KeptErrors>>,
    explanation: Explanation,
}

/// Errors by entry.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct KeptErrors {
    /// Squares; not a number where no scatter could be seen.
    rays: TallyValues,
    /// Squares, where there were several surfaces.
    surfaces: Option<TallyValues>,
    mesh: MeshErrors,
    /// Bounds of an analytic result.
    bounds: Option<TallyValues>,
}

/// Each entry has its errors.
impl TallyResult for ErrorBudget {
    type Value = Errors;

    fn spec(&self) -> &TallySpec {
        &self.spec
    }

    fn at(&self, entry: Entry) -> Errors {
        self.errors(entry)
    }
}

/// Said of rays.
const BY_BLOCKS: &str = "standard error by the scatter between the ray blocks of each surface, and of results of few rays no less than that of one more ray";

/// Said of surfaces.
const BY_SURFACES: &str = "standard error by the scatter of the surfaces, less what their rays explain; 0 where these explain all of it";

/// Said of the sum.
const TOTAL: &str =
    "root of the sum of the squares of rays, surfaces and mesh, without those that are null";

/// Errors below which none is reported, since few samples tell no more.
pub(crate) struct LeastErrors {
    /// By the rays that carry a result.
    pub(crate) by_rays: TallyValues,
    /// By these and by the surfaces.
    pub(crate) all: TallyValues,
}

/// Errors by surfaces, with their explanation.
struct SurfaceErrors {
    /// Squares of the errors by surfaces with their rays, where there were several.
    squares: Option<TallyValues>,
    explanation: String,
}

impl ErrorBudget {
    /// The errors of an analytic result, with no rays traced, to within bounds.
    pub(crate) fn of_bounds(bounds: TallyValues) -> Self {
        let none = || "none: nothing was traced".to_owned();
        let spec = *bounds.spec();
        let kept = KeptErrors {
            rays: TallyValues::filled(spec, f64::NAN),
            surfaces: None,
            mesh: MeshErrors::unknown(spec, "none: nothing was traced"),
            bounds: Some(bounds),
        };
        Self {
            spec,
            kept: Some(Box::new(kept)),
            explanation: Explanation {
                rays: none(),
                surfaces: none(),
                mesh: none(),
                mesh_removed: none(),
                total: "bound on what shadow, masking and multiple scattering can change".into(),
            },
        }
    }

    /// The errors of a result on one surface, of which `blocks` are the ray blocks.
    pub(crate) fn of_one(
        blocks: &TallyStatistics,
        method: &Method,
        least: &LeastErrors,
        mesh: MeshErrors,
    ) -> Self {
        let explanation = match method.control_variate_mean() {
            Some(ControlVariateMean::GaussianSlopes | ControlVariateMean::SlopeMixture) => {
                "unknown: one surface has no scatter between surfaces, and its control variate has the mean of the ensemble"
            }
            _ => "none: the result is that of this one surface alone",
        };
        let surfaces = SurfaceErrors {
            squares: None,
            explanation: explanation.to_owned(),
        };
        Self::new(blocks.error_squares(), surfaces, least, mesh)
    }

    /// The errors of means over `surfaces`; `of_rays` are the squares of their errors by the scatter of ray blocks.
    pub(crate) fn of_surfaces(
        surfaces: &TallyStatistics,
        of_rays: TallyValues,
        least: &LeastErrors,
        mesh: MeshErrors,
    ) -> Self {
        let surfaces = SurfaceErrors {
            squares: Some(surfaces.error_squares()),
            explanation: BY_SURFACES.to_owned(),
        };
        Self::new(of_rays, surfaces, least, mesh)
    }

    /// From squares of errors by rays.
    fn new(
        mut of_rays: TallyValues,
        of_surfaces: SurfaceErrors,
        least: &LeastErrors,
        mesh: MeshErrors,
    ) -> Self {
        let at_least = |square: &mut f64, least: &f64| {
            if !square.is_nan() {
                *square = square.max(least * least);
            }
        };
        of_rays.update(&least.by_rays, at_least);
        let less_rays = |mut all: TallyValues| {
            all.update(&least.all, at_least);
            all.zip_map(&of_rays, |a, r| a - r)
        };
        let said_of_mesh = mesh.explanation.clone();
        let kept = KeptErrors {
            surfaces: of_surfaces.squares.map(less_rays),
            rays: of_rays,
            mesh,
            bounds: None,
        };
        Self {
            spec: *least.all.spec(),
            kept: Some(Box::new(kept)),
            explanation: Explanation {
                rays: BY_BLOCKS.to_owned(),
                surfaces: of_surfaces.explanation,
                mesh: said_of_mesh.remaining,
                mesh_removed: said_of_mesh.removed,
                total: TOTAL.into(),
            },
        }
    }

    /// Without the errors of any entry, which are all `None` then; how they were estimated remains.
    #[must_use]
    pub fn without_values(self) -> Self {
        Self { kept: None, ..self }
    }

    fn errors(&self, i: Entry) -> Errors {
        let Some(kept) = &self.kept else {
            return Errors::default();
        };
        let known = |square: f64| (!square.is_nan()).then(|| square.max(0.0).sqrt());
        let rays = known(kept.rays[i]);
        let surfaces = kept.surfaces.as_ref().and_then(|squares| known(squares[i]));
        let mesh = kept.mesh.remaining[i];
        Errors {
            rays,
            surfaces,
            mesh,
            mesh_se: kept
                .mesh
                .refinement
                .as_ref()
                .and_then(|refinement| refinement.remaining(i).se),
            mesh_removed: kept.mesh.removed.as_ref().map(|removed| removed[i]),
            total: kept
                .bounds
                .as_ref()
                .map(|bounds| bounds[i])
                .or(rays.map(|rays| [surfaces, mesh].into_iter().flatten().fold(rays, hypot))),
        }
    }

    /// Refinement by meshes of several spacings, if there were several.
    #[must_use]
    pub fn refinement(&self) -> Option<&Refinement> {
        self.kept.as_ref()?.mesh.refinement.as_ref()
    }

    /// Warning about the mesh error: of structures, or by meshes of several spacings.
    #[must_use]
    pub fn mesh_warning(&self) -> Option<&'static str> {
        let mesh = &self.kept.as_ref()?.mesh;
        if mesh.cuts_edges {
            return Some(
                "facets cut across edges or curves of the structure, so that results change with the spacing: a smaller one tells by how much",
            );
        }
        mesh.refinement.as_ref()?.convergence().warning()
    }

    /// Explanation of the estimate of mesh errors, or why there is none.
    #[must_use]
    pub fn mesh_explanation(&self) -> &str {
        &self.explanation.mesh
    }

    /// The errors of several results `q` together, relative to `sqrt(sum q^2)` over `means`, as [`Quantity`] has them for targets.
    ///
    /// Each is the root of the sum of squares over all entries; of surfaces, of what the scatter of surfaces in all entries shows beyond
    /// that of rays. `mesh` is therefore without a sign; `mesh_se` and `mesh_removed` are not given.
    #[must_use]
    pub fn relative(&self, of: Quantity, means: &TallyValues) -> Errors {
        let Some(kept) = &self.kept else {
            return Errors::default();
        };
        let entries = of.entries(self.spec());
        let norm = of.norm(entries.iter().map(|&i| means[i].powi(2)).sum());
        let sum = |square: &dyn Fn(Entry) -> f64| {
            let sum: f64 = entries.iter().map(|&i| square(i)).sum();
            (!sum.is_nan()).then(|| sum.max(0.0))
        };
        let rays = sum(&|i| kept.rays[i]);
        let of_surfaces = kept.surfaces.as_ref();
        let surfaces = of_surfaces.and_then(|squares| sum(&|i| squares[i]));
        let mesh = sum(&|i| kept.mesh.remaining[i].map_or(f64::NAN, |mesh| mesh.powi(2)));
        let total = match &kept.bounds {
            Some(bounds) => sum(&|i| bounds[i].powi(2)),
            None => rays.map(|rays| rays + surfaces.unwrap_or(0.0) + mesh.unwrap_or(0.0)),
        };
        let [rays, surfaces, mesh, total] =
            [rays, surfaces, mesh, total].map(|square| Some(ratio(square?.sqrt(), norm)));
        Errors {
            rays,
            surfaces,
            mesh,
            mesh_se: None,
            mesh_removed: None,
            total,
        }
    }

    /// `error_budget` of summary.json, of results with these means.
    #[must_use]
    pub fn to_json(&self, means: &TallyValues) -> Value {
        let spec = self.spec();
        let mut out = Map::new();
        for (name, entry) in totals(spec) {
            let errors = entry.map(|i| self.errors(i));
            out.insert(name.to_owned(), json!(errors));
        }
        for of in [Quantity::Bins, Quantity::Rings, Quantity::InPlane] {
            out.insert(of.to_string(), json!(self.relative(of, means)));
        }
        out.insert("explanations".to_owned(), json!(self.explanation));
        if let Some(refinement) = self.refinement() {
            out.insert("refinement".to_owned(), refinement_json(refinement, spec));
        }
        Value::Object(out)
    }
}

/// Totals by name, and where they stand, if they are requested.
fn totals(spec: &TallySpec) -> [(&'static str, Option<Entry>); 5] {
    let [reflected, transmitted] = Side::BOTH;
    let recorded = |side: Side, entry: Entry| spec.records(side).then_some(entry);
    [
        (
            "reflected",
            recorded(reflected, TallySpec::BUDGET.reflected),
        ),
        (
            "transmitted",
            recorded(transmitted, TallySpec::BUDGET.transmitted),
        ),
        ("absorbed", Some(TallySpec::BUDGET.absorbed)),
        (
            "multiple_reflected",
            recorded(reflected, spec.flux_entry(reflected, Component::Multiple)),
        ),
        (
            "multiple_transmitted",
            recorded(
                transmitted,
                spec.flux_entry(transmitted, Component::Multiple),
            ),
        ),
    ]
}

/// Totals by meshes of several spacings.
fn refinement_json(refinement: &Refinement, spec: &TallySpec) -> Value {
    let spacing = |factor: f64| refinement.given.map(|d| factor * d);
    let mut out = Map::new();
    out.insert(
        "spacings".to_owned(),
        json!({
            "reported": spacing(0.5),
            "given": spacing(1.0),
            "coarser": refinement.has_coarser().then(|| spacing(2.0)),
        }),
    );
    for (name, entry) in totals(spec) {
        let shown = entry.map(|i| {
            let extrapolated: Result<Estimate, String> = refinement.extrapolated(i);
            json!({
                "given_less_reported": refinement.shift(i),
                "coarser_less_given": refinement.coarser_shift(i),
                "order": refinement.order(i).ok(),
                "extrapolated": extrapolated.as_ref().ok(),
                "why_not_extrapolated": extrapolated.as_ref().err(),
            })
        });
        out.insert(name.to_owned(), json!(shown));
    }
    Value::Object(out)
}

//! The errors of a result by where they come from: rays, surfaces, mesh.

use asperity_tally::{BatchStatistics, Estimate, Layout, Side};
use serde::Serialize;
use serde_json::{Map, Value, json};

use crate::mesh_error::{MeshErrors, Refinement};
use crate::method::{ControlMean, Method};

/// The errors of one number, flux fractions; `None` where one is not known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Standard error by the rays on each surface.
    pub rays: Option<f64>,
    /// Standard error by the differences between surfaces.
    pub surfaces: Option<f64>,
    /// What the mesh adds to the result: a shift with its sign.
    pub mesh: Option<f64>,
    /// Standard error of that, where it was measured.
    pub mesh_se: Option<f64>,
    /// What the mesh would have added but for the control: a shift with its sign.
    pub mesh_removed: Option<f64>,
    /// Root of the sum of the squares of rays, surfaces and mesh, as far as they are known.
    pub total: Option<f64>,
}

/// How each error was estimated, a sentence each.
#[derive(Clone, Debug, Serialize)]
struct Ways {
    rays: String,
    surfaces: String,
    mesh: String,
    mesh_removed: String,
    total: &'static str,
}

/// The errors of all results of a run, by where they come from.
#[derive(Clone, Debug)]
pub struct ErrorBudget {
    /// Squares, by the layout; not a number where there was no scatter to be seen.
    rays: Vec<f64>,
    /// Squares, by the layout, where there were several surfaces.
    surfaces: Option<Vec<f64>>,
    mesh: MeshErrors,
    /// Of what was not traced.
    bounds: Option<Vec<f64>>,
    ways: Ways,
}

/// Said of rays.
const BY_BLOCKS: &str = "standard error by the scatter between the ray blocks of each surface";

/// Said of the sum.
const TOTAL: &str =
    "root of the sum of the squares of rays, surfaces and mesh, without those that are null";

impl ErrorBudget {
    /// The errors of what is known without a ray, to within bounds.
    pub(crate) fn of_bounds(bounds: Vec<f64>) -> Self {
        let none = || "none: nothing was traced".to_owned();
        let len = bounds.len();
        Self {
            rays: vec![f64::NAN; len],
            surfaces: None,
            mesh: MeshErrors::unknown(len, "none: nothing was traced"),
            bounds: Some(bounds),
            ways: Ways {
                rays: none(),
                surfaces: none(),
                mesh: none(),
                mesh_removed: none(),
                total: "bound on what shadow, masking and multiple scattering can change",
            },
        }
    }

    /// The errors of the only surface that there is, of which `blocks` are the ray blocks.
    pub(crate) fn of_one(
        blocks: &BatchStatistics,
        (method, layout, rays): (&Method, &Layout, u64),
        mesh: MeshErrors,
    ) -> Self {
        let none = match method.control_mean() {
            Some(ControlMean::GaussianSlopes) => {
                "not known: one surface tells nothing of others, whose mean its control adds"
            }
            _ => "none: the result is that of this one surface alone",
        }
        .to_owned();
        Self::new(
            blocks.error_squares().collect(),
            (None, none),
            (method, layout, rays),
            mesh,
        )
    }

    /// The errors of means over `surfaces`; `ray_squares` are the squares of the errors of each by the
    /// scatter of its ray blocks, summed.
    pub(crate) fn of_surfaces(
        surfaces: &BatchStatistics,
        ray_squares: &[f64],
        method_and_rays: (&Method, &Layout, u64),
        mesh: MeshErrors,
    ) -> Self {
        let n = surfaces.batches() as f64;
        let of_rays = ray_squares.iter().map(|sum| sum / (n * n)).collect();
        let way = "standard error by the scatter of the surfaces, less what their rays explain; 0 where these explain all of it".to_owned();
        let all = surfaces.error_squares().collect();
        Self::new(of_rays, (Some(all), way), method_and_rays, mesh)
    }

    /// From squares of errors by rays, and, with how they were found, by surfaces with their rays.
    fn new(
        mut rays: Vec<f64>,
        (all, of_surfaces): (Option<Vec<f64>>, String),
        (method, layout, count): (&Method, &Layout, u64),
        mut mesh: MeshErrors,
    ) -> Self {
        let mut of_rays = BY_BLOCKS.to_owned();
        if let Some(control) = method.control() {
            for (square, least) in rays.iter_mut().zip(control.least_errors(layout, count)) {
                *square = square.max(least * least);
            }
            of_rays.push_str(", and no less than one ray where the control expects light");
        }
        let surfaces = all.map(|all| all.iter().zip(&rays).map(|(a, r)| a - r).collect());
        let [way, removed] = std::mem::take(&mut mesh.ways);
        Self {
            rays,
            surfaces,
            mesh,
            bounds: None,
            ways: Ways {
                rays: of_rays,
                surfaces: of_surfaces,
                mesh: way,
                mesh_removed: removed,
                total: TOTAL,
            },
        }
    }

    /// The errors of entry `i` of the layout.
    #[must_use]
    pub fn errors(&self, i: usize) -> Errors {
        let known = |square: f64| (!square.is_nan()).then(|| square.max(0.0).sqrt());
        let rays = known(self.rays[i]);
        let surfaces = self.surfaces.as_ref().and_then(|squares| known(squares[i]));
        let mesh = self.mesh.remaining[i];
        Errors {
            rays,
            surfaces,
            mesh,
            mesh_se: self
                .mesh
                .refinement
                .as_ref()
                .and_then(|refinement| refinement.remaining(i).se),
            mesh_removed: self.mesh.removed.as_ref().map(|removed| removed[i]),
            total: self
                .bounds
                .as_ref()
                .map(|bounds| bounds[i])
                .or(rays.map(|rays| {
                    [surfaces, mesh]
                        .into_iter()
                        .flatten()
                        .fold(rays, f64::hypot)
                })),
        }
    }

    /// What meshes of several spacings showed, if there were several.
    #[cfg(test)]
    pub(crate) const fn refinement(&self) -> Option<&Refinement> {
        self.mesh.refinement.as_ref()
    }

    /// How the errors by the mesh were estimated, or why not.
    pub(crate) fn way_of_mesh(&self) -> &str {
        &self.ways.mesh
    }

    /// `error_budget` of summary.json.
    #[must_use]
    pub fn to_json(&self, layout: &Layout) -> Value {
        let mut out = Map::new();
        for (name, entry) in totals(layout) {
            let errors = entry.map(|i| self.errors(i));
            out.insert(name.to_owned(), json!(errors));
        }
        out.insert("ways".to_owned(), json!(self.ways));
        if let Some(refinement) = &self.mesh.refinement {
            out.insert("refinement".to_owned(), refinement_json(refinement, layout));
        }
        Value::Object(out)
    }
}

/// Totals by name, and where they stand, if they are asked for.
fn totals(layout: &Layout) -> [(&'static str, Option<usize>); 5] {
    let [reflected, transmitted] = Side::BOTH;
    let asked = |side: Side, entry: usize| layout.asks(side).then_some(entry);
    [
        ("reflected", asked(reflected, Layout::REFLECTED)),
        ("transmitted", asked(transmitted, Layout::TRANSMITTED)),
        ("absorbed", Some(Layout::ABSORBED)),
        (
            "multiple_reflected",
            asked(reflected, layout.multiple(reflected)),
        ),
        (
            "multiple_transmitted",
            asked(transmitted, layout.multiple(transmitted)),
        ),
    ]
}

/// What meshes of several spacings showed of the totals.
fn refinement_json(refinement: &Refinement, layout: &Layout) -> Value {
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
    for (name, entry) in totals(layout) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use asperity_tally::OrderClass;

    use crate::config::VerifyConfig;
    use crate::progress::Silent;
    use crate::verify::{VerifyOutcome, verify};

    fn run(surface: &str, rays: u64, more: &str) -> VerifyOutcome {
        let text = format!(
            "[surface]\nsize = 64\ntau = 8\n{surface}\n[compare]\nmodels = []\n[run]\nrays = {rays}\n{more}"
        );
        verify(&VerifyConfig::from_toml(&text).unwrap(), &Silent).unwrap()
    }

    /// Of 64 surfaces with two blocks each the ray error is known to 9 %, so their ratio to 13 %.
    /// Random rays: the errors of stratified ones fall faster.
    #[test]
    fn more_rays_make_the_ray_error_less_and_leave_that_between_surfaces() {
        let more = "realisations = 64\nsampling = \"random\"\nestimator = \"plain\"";
        let [few, many] = [20_000, 320_000].map(|rays| {
            let outcome = run("smoothness = 1.5", rays, more);
            let ring = outcome.layout.rings(Side::Reflected, OrderClass::All).start + 4;
            outcome.cases[0].errors.errors(ring)
        });
        println!("{few:?} {many:?}");
        let ratio = few.rays.unwrap() / many.rays.unwrap();
        assert!((ratio / 4.0 - 1.0).abs() < 0.4, "{ratio}");
        let ratio = few.surfaces.unwrap() / many.surfaces.unwrap();
        assert!((ratio - 1.0).abs() < 0.4, "{ratio}");
    }

    #[test]
    fn parts_add_to_the_error_that_surfaces_show_or_rays_explain_all() {
        for estimator in ["plain", "controlled"] {
            let more = format!("realisations = 8\nestimator = \"{estimator}\"");
            let outcome = run("smoothness = 2", 20_000, &more);
            let case = &outcome.cases[0];
            let mut explained = 0;
            for i in 0..outcome.layout.len() {
                let errors = case.errors.errors(i);
                let [rays, surfaces, total] =
                    [errors.rays, errors.surfaces, errors.total].map(Option::unwrap);
                let sampled = rays.hypot(surfaces);
                let se = case.statistics.estimate(i).se.unwrap();
                if surfaces == 0.0 {
                    assert!(sampled >= se * (1.0 - 1e-12));
                    explained += 1;
                } else {
                    assert!((sampled / se - 1.0).abs() < 1e-12, "{sampled} {se}");
                }
                let squares = sampled.powi(2) + errors.mesh.map_or(0.0, |mesh| mesh.powi(2));
                assert!((total.powi(2) - squares).abs() <= 1e-12 * squares);
                // Either the mesh is corrected for, or its error is estimated.
                assert_eq!(errors.mesh_removed.is_some(), estimator == "controlled");
            }
            assert!(explained > 0);
            let of = |i| case.errors.errors(i);
            let [r, t, a] = [Layout::REFLECTED, Layout::TRANSMITTED, Layout::ABSORBED].map(of);
            for part in [|e: &Errors| e.mesh, |e: &Errors| e.mesh_removed] {
                if let (Some(r), Some(t), Some(a)) = (part(&r), part(&t), part(&a)) {
                    assert!(r != 0.0 && (r + t + a).abs() < 1e-10, "{r} {t} {a}");
                }
            }
        }
    }

    /// Branches picked at random are all that differs; the squares of both errors are known to some
    /// 25 % (31 and 64 degrees of freedom), so their difference stays below most of either.
    #[test]
    fn on_flat_surfaces_rays_explain_all() {
        let more = "realisations = 64\nbranching = \"pick\"\nestimator = \"plain\"";
        let outcome = run("sigma = 1e-3", 20_000, more);
        let case = &outcome.cases[0];
        let errors = case.errors.errors(Layout::REFLECTED);
        println!("{errors:?}");
        let rays = errors.rays.unwrap();
        assert!(rays > 0.0 && errors.surfaces.unwrap() < 0.7 * rays);
        // What all surfaces do alike has no error at all.
        let lost = case.errors.errors(Layout::LOST);
        assert_eq!([lost.rays, lost.surfaces], [Some(0.0); 2]);
    }

    #[test]
    fn of_one_surface_nothing_is_said_of_others() {
        let outcome = run("smoothness = 2", 20_000, "realisations = 1");
        let case = &outcome.cases[0];
        let errors = case.errors.errors(Layout::REFLECTED);
        assert_eq!(errors.surfaces, None);
        assert_eq!(errors.rays, case.statistics.estimate(Layout::REFLECTED).se);
        // A block has no scatter.
        let outcome = run(
            "smoothness = 2",
            1,
            "realisations = 2\nestimator = \"plain\"",
        );
        let errors = outcome.cases[0].errors.errors(Layout::REFLECTED);
        assert_eq!([errors.rays, errors.surfaces, errors.total], [None; 3]);
    }
}

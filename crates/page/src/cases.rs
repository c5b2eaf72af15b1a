//! Cases: what a study measured at one direction of the light, with its energies and verdicts.

use asperity_simulate::short;
use serde_json::{Value, json};

use crate::folder::Folder;
use crate::words;

/// Parts of the incident flux, whose sum is one.
pub(crate) const ENERGIES: [&str; 5] =
    ["reflected", "transmitted", "absorbed", "truncated", "lost"];

/// One case of `verify` or `trace`, or one direction of `gonio`.
#[derive(Clone)]
pub(crate) struct Case {
    pub(crate) label: String,
    /// The label without the polar angle of the light.
    pub(crate) group: String,
    /// Polar angle of the light, in degrees.
    pub(crate) theta: f64,
    /// Azimuth of the light, in degrees.
    pub(crate) phi: f64,
    /// Folder of its files, with a slash at its end, or empty.
    pub(crate) folder: String,
    /// Table of its bins.
    pub(crate) bins: String,
    /// Fluxes by name of [`ENERGIES`].
    pub(crate) energy: Value,
    /// Its summary.
    pub(crate) summary: Value,
}

impl Case {
    /// The cases of a folder; none for studies without lobes.
    pub(crate) fn all(folder: &Folder) -> Vec<Self> {
        let summary = &folder.summary;
        match folder.command() {
            "gonio" => {
                let directions = summary["directions"].as_array().into_iter().flatten();
                let measured = directions.filter(|one| one["results"].is_object());
                let azimuths = summary["phis_deg"].as_array().map_or(1, Vec::len);
                measured
                    .map(|one| Self::of_direction(one, azimuths > 1))
                    .collect()
            }
            "verify" | "trace" => match summary["cases"].as_array() {
                None => vec![Self::of_summary(String::new(), summary)],
                Some(cases) => cases
                    .iter()
                    .map(|case| {
                        let folder = case["folder"].as_str().unwrap_or_default();
                        Self::of_summary(format!("{folder}/"), &case["summary"])
                    })
                    .collect(),
            },
            _ => Vec::new(),
        }
    }

    fn of_summary(folder: String, summary: &Value) -> Self {
        let config = &summary["config"];
        let light = match &config["case"]["incidence"] {
            Value::Null => &config["light"],
            incidence => incidence,
        };
        Self {
            bins: format!("{folder}histogram.csv"),
            energy: summary["energy"].clone(),
            summary: summary.clone(),
            ..Self::new(
                summary["label"].as_str().unwrap_or_default(),
                [&light["theta_deg"], &light["phi_deg"]],
                folder,
            )
        }
    }

    /// `names_azimuth`: whether the azimuth of the light tells directions apart.
    fn of_direction(direction: &Value, names_azimuth: bool) -> Self {
        let name = direction["direction"].as_str().unwrap_or_default();
        let mut label = direction["label"].as_str().unwrap_or(name).to_owned();
        if names_azimuth {
            let phi = direction["phi_i_deg"].as_f64().unwrap_or(0.0);
            label += &format!(", phi = {} deg", short(phi));
        }
        let results = &direction["results"];
        let all = &results["flux"]["all"];
        Self {
            bins: format!("directions/{name}.csv"),
            energy: json!({
                "reflected": all["reflected"],
                "transmitted": all["transmitted"],
                "absorbed": results["absorbed"],
                "truncated": results["truncated"],
                "lost": results["lost"],
            }),
            summary: results.clone(),
            ..Self::new(
                &label,
                [&direction["theta_i_deg"], &direction["phi_i_deg"]],
                String::new(),
            )
        }
    }

    fn new(label: &str, angles: [&Value; 2], folder: String) -> Self {
        let [theta, phi] = angles.map(|angle| angle.as_f64().unwrap_or(0.0));
        let is_other = |part: &&str| !part.starts_with("theta = ");
        let group: Vec<&str> = label.split(", ").filter(is_other).collect();
        Self {
            label: words::label(label),
            group: words::label(&group.join(", ")),
            theta,
            phi,
            folder,
            bins: String::new(),
            energy: Value::Null,
            summary: Value::Null,
        }
    }

    /// The polar angle of the light, as in `θᵢ = 30°`.
    pub(crate) fn angle(&self) -> String {
        format!("θᵢ = {}°", short(self.theta))
    }

    /// Returns `true` if the light has this polar angle, as names of files round it.
    pub(crate) fn is_at(&self, theta: f64) -> bool {
        (self.theta - theta).abs() < 1e-4
    }

    /// The models that it is compared with.
    pub(crate) fn models(&self) -> impl Iterator<Item = &Value> {
        let models = self.summary["comparison"]["models"].as_array();
        models.into_iter().flatten()
    }

    /// All verdicts.
    pub(crate) fn verdicts(&self) -> Vec<Verdict> {
        let scopes = [
            ("single", "light scattered once"),
            ("multiple", "light scattered more than once"),
            ("total", "all light"),
        ];
        let of_model = |model: &Value| {
            let name = model["model"].as_str().unwrap_or_default().to_owned();
            let found = scopes.map(|(scope, light)| {
                let test = &model[scope];
                let number = |key: &str| test[key].as_f64().unwrap_or(f64::NAN);
                test["verdict"].as_str().map(|verdict| Verdict {
                    model: name.clone(),
                    light,
                    verdict: verdict.to_owned(),
                    distance: number("total_variation"),
                    noise: number("total_variation_noise"),
                    p: test["p"].as_f64(),
                })
            });
            found.into_iter().flatten().collect::<Vec<_>>()
        };
        self.models().flat_map(of_model).collect()
    }
}

/// Result of the test of one model.
pub(crate) struct Verdict {
    pub(crate) model: String,
    /// The light that is tested.
    pub(crate) light: &'static str,
    /// Words of the test, as in `not rejected`.
    pub(crate) verdict: String,
    /// Total variation distance.
    pub(crate) distance: f64,
    /// The distance that noise alone would cause.
    pub(crate) noise: f64,
    /// `None` if nothing can be tested.
    pub(crate) p: Option<f64>,
}

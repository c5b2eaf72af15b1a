//! Case words: every word for the quantities of a case.
//!
//! Labels, folder names, titles of figures, columns of tables and members of JSON follow from the parts listed here.

use asperity_numerics::fnv1a;
use asperity_optics::{Bottom, Layer, Material, ParticipatingMedium, PhaseFunction, Slab, Spread};
use asperity_surface::LengthUnit;
use asperity_synthesis::SurfaceRecipe;
use asperity_tracer::HalfSpace;
use serde_json::{Map, Value, json};

use super::case::Case;
use super::coordinates::Coordinate;
use crate::text::{short, three_digits};

/// Side of a case that a part describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaseGroup {
    /// The surface.
    Surface,
    /// The material.
    Material,
    /// The layer below.
    Layer,
    /// A further quantity.
    Other,
    /// The light.
    Light,
}

/// Name of the smoothness `tau / sigma`.
const SMOOTHNESS: &str = "s";
/// Name of the roughness of GGX slopes.
pub const GGX_ALPHA: &str = "GGX alpha";

/// One quantity of a case, and the words for it.
#[derive(Clone, Debug, PartialEq)]
pub struct CasePart {
    /// Part of the case that it describes.
    pub group: CaseGroup,
    /// Name of the quantity.
    pub name: String,
    /// Value as text.
    pub value: String,
    /// `true` if the value needs no name before it, as in `mirror`.
    pub is_bare: bool,
}

impl CasePart {
    fn new(group: CaseGroup, name: &str, value: String) -> Self {
        Self {
            group,
            name: name.to_owned(),
            value,
            is_bare: false,
        }
    }

    fn bare(group: CaseGroup, name: &str, value: String) -> Self {
        Self {
            is_bare: true,
            ..Self::new(group, name, value)
        }
    }

    /// Name and value, as in `s = 3`, or the value alone.
    #[must_use]
    pub fn text(&self) -> String {
        match self.is_bare {
            true => self.value.clone(),
            false => format!("{} = {}", self.name, self.value),
        }
    }
}

/// A column that describes cases, and its value for one of them.
#[derive(Clone, Debug, PartialEq)]
pub struct CaseColumn {
    /// Part of the case that it describes.
    pub group: CaseGroup,
    /// Header.
    pub name: String,
    /// Unit; empty for pure numbers and text.
    pub unit: String,
    /// Description.
    pub about: String,
    /// Number or text; null where the case has no such quantity.
    pub value: Value,
}

/// Longest name of a folder: file systems take 255 bytes, of which endings and counters take some.
const LONGEST_NAME: usize = 120;

/// A name for a folder; of one that is too long the beginning, and a hash of all.
fn shortened(name: String) -> String {
    match name.char_indices().nth(LONGEST_NAME) {
        None => name,
        Some((end, _)) => format!("{}_{:08x}", &name[..end], fnv1a(name.bytes()) as u32),
    }
}

/// A refractive index, as a quotient where the reciprocal is the shorter number: `1/1.5`.
fn index_text(eta: f64) -> String {
    let (index, reciprocal) = (short(eta), short(1.0 / eta));
    match reciprocal.len() < index.len() {
        true => format!("1/{reciprocal}"),
        false => index,
    }
}

/// The words for a material: kind as in files, in text, in figures, and as a part of a folder's name.
struct MaterialWords<'a> {
    kind: &'a str,
    in_text: CasePart,
    in_figures: CasePart,
    tag: String,
}

impl<'a> MaterialWords<'a> {
    /// Words for the material of a case: its name, or its kind and index.
    fn of(case: &'a Case) -> Self {
        let by_index = Self::of_material(case.material);
        let Some(name) = &case.at.material else {
            return by_index;
        };
        let part = CasePart::bare(CaseGroup::Material, "material", name.clone());
        let words = name.split(|c: char| !(c.is_alphanumeric() || c == '.'));
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        Self {
            kind: name,
            in_figures: part.clone(),
            in_text: part,
            tag: words.join("-"),
        }
    }

    fn of_material(material: Material) -> Self {
        let index = |value| CasePart::new(CaseGroup::Material, "n", value);
        let words = |kind, in_text: CasePart, tag| Self {
            kind,
            in_figures: in_text.clone(),
            in_text,
            tag,
        };
        let bare = |value| CasePart::bare(CaseGroup::Material, "material", value);
        match material {
            Material::Dielectric { eta } => Self {
                in_figures: index(index_text(eta)),
                ..words("dielectric", index(short(eta)), format!("n{}", short(eta)))
            },
            Material::Conductor { eta, kappa } => {
                let [eta, kappa] = [eta, kappa].map(short);
                let part = index(format!("{eta} + {kappa}i"));
                words("conductor", part, format!("n{eta}k{kappa}"))
            }
            Material::Lambertian { reflectance } => {
                let reflectance = short(reflectance);
                let part = bare(format!("Lambertian {reflectance}"));
                words("lambertian", part, format!("lambertian{reflectance}"))
            }
            Material::Coated { films, eta, kappa } => {
                let layers = films.layers().iter();
                let layers = layers.map(|film| {
                    let [eta, kappa, phase] = [film.eta, film.kappa, film.phase].map(short);
                    format!("_n{eta}k{kappa}d{phase}")
                });
                let [eta, kappa] = [eta, kappa].map(short);
                let part = index(format!("{eta} + {kappa}i under a film"));
                let tag = format!("n{eta}k{kappa}{}", layers.collect::<String>());
                words("coated", part, tag)
            }
            _ => words("mirror", bare("mirror".to_owned()), "mirror".to_owned()),
        }
    }
}

/// Bottom of a layer in words.
#[must_use]
pub fn bottom_text(bottom: Bottom) -> String {
    match bottom {
        Bottom::Open => "open below".to_owned(),
        Bottom::ABSORBING => "absorbing bottom".to_owned(),
        Bottom::MIRROR => "mirror below".to_owned(),
        Bottom::Face(Material::Dielectric { eta }) => {
            format!("interface of n = {} below", short(eta))
        }
        Bottom::Face(Material::Lambertian { reflectance }) => {
            format!("Lambertian bottom of reflectance {}", short(reflectance))
        }
        Bottom::Face(material) => {
            format!(
                "interface of {} below",
                MaterialWords::of_material(material).in_text.text()
            )
        }
    }
}

/// A layer for people, as in `mean free path 0.1 um, albedo 0.9, g = 0.5, 2 um thick on a mirror`.
fn layer_text(layer: &Layer, unit: &str) -> String {
    let medium = layer.medium();
    let mut text = match medium.is_clear() {
        true => "clear".to_owned(),
        false => {
            let [path, albedo] = [medium.mean_free_path(), medium.albedo()].map(short);
            format!("mean free path {path}{unit}, albedo {albedo}")
        }
    };
    match medium.phase() {
        PhaseFunction::Isotropic => {}
        PhaseFunction::Rayleigh => text.push_str(", Rayleigh"),
        phase => text.push_str(&format!(", g = {}", short(phase.mean_cosine()))),
    }
    if let Some(slab) = layer.end() {
        let bottom = match slab.bottom {
            Bottom::Open => "open below".to_owned(),
            Bottom::ABSORBING => "on an absorbing bottom".to_owned(),
            Bottom::MIRROR => "on a mirror".to_owned(),
            Bottom::Face(Material::Lambertian { .. }) => {
                format!("on a {}", bottom_text(slab.bottom))
            }
            Bottom::Face(material) => {
                format!(
                    "on an interface of {}",
                    MaterialWords::of_material(material).in_text.text()
                )
            }
        };
        text.push_str(&format!(", {}{unit} thick {bottom}", short(slab.thickness)));
    }
    text
}

/// A layer as a part of a folder's name, as in `mfp0.1_albedo0.9_g0.5_d2`.
fn layer_tag(layer: &Layer) -> String {
    let medium = layer.medium();
    let path = match medium.is_clear() {
        true => "clear".to_owned(),
        false => format!("mfp{}", short(medium.mean_free_path())),
    };
    let phase = match medium.phase() {
        PhaseFunction::Isotropic => String::new(),
        PhaseFunction::Rayleigh => "_rayleigh".to_owned(),
        phase => format!("_g{}", short(phase.mean_cosine())),
    };
    let depth = layer
        .end()
        .map(|slab| format!("_d{}", short(slab.thickness)));
    format!(
        "{path}_albedo{}{phase}{}",
        short(medium.albedo()),
        depth.unwrap_or_default()
    )
}

const fn phase_name(phase: PhaseFunction) -> &'static str {
    match phase {
        PhaseFunction::Isotropic => "isotropic",
        PhaseFunction::Rayleigh => "rayleigh",
        _ => "henyey-greenstein",
    }
}

impl Case {
    /// Name of the roughness of random surfaces, and its values along the principal axes: GGX's alpha of such slopes, and the smoothness
    /// of all others.
    #[must_use]
    pub fn roughness(&self) -> Option<(&'static str, [f64; 2])> {
        let (recipe, s) = (self.surface.recipe(), self.at.smoothness?);
        if let Some(alpha) = recipe.and_then(SurfaceRecipe::ggx_alpha) {
            // The last digits are those of the spectrum that it is computed back from
            let rounded = |alpha: f64| format!("{alpha:.12e}").parse().unwrap_or(alpha);
            return Some((GGX_ALPHA, alpha.map(rounded)));
        }
        let anisotropy = recipe.and_then(SurfaceRecipe::anisotropy);
        Some((
            SMOOTHNESS,
            [s, s * anisotropy.map_or(1.0, |[ratio, _]| ratio)],
        ))
    }

    /// The roughness along the first axis. That of a structure alone follows from slopes that are measured, and needs no more digits.
    fn roughness_part(&self) -> Option<CasePart> {
        let (name, [first, _]) = self.roughness()?;
        let structure = self.surface.recipe().and_then(SurfaceRecipe::structured);
        let is_alone = structure.is_some_and(|structure| structure.roughness().is_none());
        let text = if is_alone { three_digits } else { short };
        Some(CasePart::new(CaseGroup::Surface, name, text(first)))
    }

    /// Anisotropy: the roughness along the second axis, and the angle from +x to the first, degrees.
    fn anisotropy(&self) -> Option<[String; 2]> {
        let [_, azimuth] = self.surface.recipe()?.anisotropy()?;
        let (_, [_, second]) = self.roughness()?;
        Some([second, azimuth.to_degrees()].map(short))
    }

    fn grooves(&self) -> Option<String> {
        let (name, _) = self.roughness()?;
        let [second, azimuth] = self.anisotropy()?;
        Some(format!(
            "{name} = {second} along the second axis, first axis at {azimuth} deg"
        ))
    }

    /// The layers below for people, from above.
    fn layer_texts(&self) -> impl Iterator<Item = String> {
        let unit = self.at.unit.suffix();
        self.layers.iter().map(move |layer| layer_text(layer, unit))
    }

    /// The side of the light, unless it is the usual one.
    fn side_text(&self) -> Option<String> {
        (self.light.from == HalfSpace::Below).then(|| "from below".to_owned())
    }

    /// The light for people, as in `light from above at theta 30 deg, phi 0 deg`.
    #[must_use]
    pub fn light_text(&self) -> String {
        let side = match self.light.from {
            HalfSpace::Above => "above",
            HalfSpace::Below => "below",
        };
        let incidence = self.light.incidence;
        let (theta, phi) = (incidence.theta_deg(), incidence.phi_deg());
        let spread = self.spread_texts().map(|[text, _]| format!(", {text}"));
        let spread = spread.unwrap_or_default();
        format!("light from {side} at theta {theta} deg, phi {phi} deg{spread}")
    }

    /// Directions of the light around that of incidence: for people, and as a part of a folder's name.
    fn spread_texts(&self) -> Option<[String; 2]> {
        let degrees = |angle: f64| short((angle.to_degrees() * 1e9).round() / 1e9);
        Some(match self.light.spread? {
            Spread::Cone { half_angle } => {
                let angle = degrees(half_angle);
                [format!("cone of {angle} deg"), format!("cone{angle}")]
            }
            Spread::Patch { theta, phi } => {
                let [a, b] = theta.map(degrees);
                let [c, d] = phi.map(degrees);
                [
                    format!("theta {a} to {b}, phi {c} to {d} deg"),
                    format!("patch{a}-{b}x{}", degrees(phi[1] - phi[0])),
                ]
            }
        })
    }

    /// The parts of a label: surface, material, further quantities, light, layer.
    fn label_parts(&self) -> Vec<String> {
        let part = |name, value| CasePart::new(CaseGroup::Surface, name, value).text();
        let material = MaterialWords::of(self).in_text;
        let roughness = self.roughness_part().map(|part| part.text());
        let mut parts: Vec<String> = roughness.into_iter().chain(self.grooves()).collect();
        parts.push(material.text());
        parts.extend(self.at.others.iter().map(Coordinate::text));
        let theta = short(self.light.incidence.theta_deg());
        parts.push(part("theta", format!("{theta} deg")));
        parts.extend(self.side_text());
        parts.extend(self.spread_texts().map(|[text, _]| text));
        parts.extend(self.layer_texts());
        parts
    }

    /// The case in words, as in `s = 3, n = 1.4, theta = 30 deg`.
    #[must_use]
    pub fn label(&self) -> String {
        self.label_parts().join(", ")
    }

    /// Material and further quantities in titles of figures and panels, as in `n = 1/1.5`.
    #[must_use]
    pub fn panel_label(&self) -> String {
        let material = MaterialWords::of(self).in_figures.text();
        let others = self.at.others.iter().map(Coordinate::text);
        let parts: Vec<String> = std::iter::once(material).chain(others).collect();
        parts.join(", ")
    }

    /// The case in a title or legend of a figure, as in `s = 3, n = 1/1.4, θᵢ = 30°`; the azimuth of the light is that on a given surface.
    #[must_use]
    pub fn figure_label(&self) -> String {
        let roughness = self.roughness_part().map(|part| match self.anisotropy() {
            None => part.text(),
            Some([second, azimuth]) => {
                format!("{} along {azimuth}°, {second} across", part.text())
            }
        });
        let is_given = roughness.is_none();
        let incidence = self.light.incidence;
        let mut parts: Vec<String> = roughness.into_iter().collect();
        parts.push(self.panel_label());
        parts.push(format!("θᵢ = {}°", short(incidence.theta_deg())));
        if is_given {
            parts.push(format!("φᵢ = {}°", short(incidence.phi_deg())));
        }
        parts.extend(self.side_text());
        parts.extend(self.layer_texts());
        parts.join(", ")
    }

    /// A folder's name, as in `s3_n1.4_theta30`.
    #[must_use]
    pub fn folder(&self) -> String {
        let theta = format!("theta{}", short(self.light.incidence.theta_deg()));
        let roughness = self.roughness_part();
        let layers: Vec<String> = self.layers.iter().map(layer_tag).collect();
        // On a given surface the light stands last.
        let (before, after) = match roughness {
            Some(_) => (Vec::new(), layers),
            None => (layers, Vec::new()),
        };
        let from = (self.light.from == HalfSpace::Below).then(|| "below".to_owned());
        let others = self.at.others.iter();
        let roughness = roughness.map(|part| match part.name.as_str() {
            GGX_ALPHA => format!("alpha{}", part.value),
            name => format!("{name}{}", part.value),
        });
        let parts = roughness
            .into_iter()
            .chain([MaterialWords::of(self).tag])
            .chain(before)
            .chain(others.map(|one| format!("{}{}", one.name, short(one.value))))
            .chain([theta])
            .chain(self.spread_texts().map(|[_, tag]| tag))
            .chain(from)
            .chain(after);
        shortened(parts.collect::<Vec<_>>().join("_"))
    }

    /// The folder's name with the azimuth of the light, as in `s3_n1.4_theta30_phi0`.
    #[must_use]
    pub fn direction_name(&self) -> String {
        let phi = short(self.light.incidence.phi_deg());
        format!("{}_phi{phi}", self.folder())
    }

    /// Surface, material and layer, quantity by quantity.
    #[must_use]
    pub fn setting_parts(&self) -> Vec<CasePart> {
        use CaseGroup::{Layer, Light, Material, Other, Surface};
        let part = CasePart::new;
        let mut parts = Vec::new();
        parts.extend(self.roughness_part());
        parts.extend(
            self.grooves()
                .map(|grooves| CasePart::bare(Surface, "grooves", grooves)),
        );
        parts.push(match self.material {
            asperity_optics::Material::Lambertian { reflectance } => {
                part(Material, "reflectance", short(reflectance))
            }
            _ => MaterialWords::of(self).in_figures,
        });
        for (number, layer) in (1..).zip(&self.layers) {
            let named = |name: &str| match number {
                1 => name.to_owned(),
                _ => format!("{name} of layer {number}"),
            };
            let length = |length| format!("{}{}", short(length), self.at.unit.suffix());
            let medium = layer.medium();
            if medium.is_clear() {
                let clear = "clear medium".to_owned();
                parts.push(CasePart::bare(Layer, &named("medium"), clear));
            } else {
                let path = length(medium.mean_free_path());
                parts.push(part(Layer, &named("mean free path"), path));
                parts.push(part(Layer, &named("albedo"), short(medium.albedo())));
                parts.push(match medium.phase() {
                    PhaseFunction::Rayleigh => {
                        CasePart::bare(Layer, &named("phase"), "Rayleigh".to_owned())
                    }
                    phase => part(Layer, &named("g"), short(phase.mean_cosine())),
                });
            }
            if let Some(slab) = layer.end() {
                let bottom = bottom_text(slab.bottom);
                parts.push(part(Layer, &named("thickness"), length(slab.thickness)));
                parts.push(CasePart::bare(Layer, &named("bottom"), bottom));
            }
        }
        let others = self.at.others.iter();
        parts.extend(others.map(|one| part(Other, &one.symbol, one.value_text())));
        let side = self.side_text();
        let side = side.unwrap_or_else(|| "from above".to_owned());
        parts.push(CasePart::bare(Light, "light", side));
        parts
    }

    /// Columns that describe the case; the same ones, in the same order, for all cases of a run.
    #[must_use]
    pub fn columns(&self) -> Vec<CaseColumn> {
        use CaseGroup::{Layer, Light, Material, Other, Surface};
        let unit = match self.at.unit {
            LengthUnit::Arbitrary => "length",
            unit => unit.symbol(),
        };
        let column = |group, name: &str, unit: &str, about: &str, value: Value| CaseColumn {
            group,
            name: name.to_owned(),
            unit: unit.to_owned(),
            about: about.to_owned(),
            value,
        };
        let eta = match self.material {
            asperity_optics::Material::Dielectric { eta }
            | asperity_optics::Material::Conductor { eta, .. }
            | asperity_optics::Material::Coated { eta, .. } => Some(eta),
            _ => None,
        };
        let kappa = match self.material {
            asperity_optics::Material::Conductor { kappa, .. }
            | asperity_optics::Material::Coated { kappa, .. } => Some(kappa),
            _ => None,
        };
        let layer = self.layers.first();
        let medium: Option<ParticipatingMedium> = layer.map(|layer| layer.medium());
        let slab: Option<Slab> = layer.and_then(|layer| layer.end());
        // That of a clear medium is infinite, which no field holds.
        let path = medium.map(|medium| medium.mean_free_path());
        let path = path.filter(|path| path.is_finite());
        let kind = MaterialWords::of(self).kind;
        let incidence = self.light.incidence;
        let roughness = self.roughness().map(|(name, [first, _])| (name, first));
        let roughness = match roughness {
            Some((GGX_ALPHA, alpha)) => {
                column(Surface, "alpha", "", "roughness alpha of GGX", json!(alpha))
            }
            smoothness => {
                let s = smoothness.map(|(_, s)| s);
                column(Surface, "s", "", "smoothness tau / sigma", json!(s))
            }
        };
        let mut columns = vec![
            roughness,
            column(
                Material,
                "material",
                "",
                "kind of material, or its name",
                json!(kind),
            ),
            column(
                Material,
                "eta",
                "",
                "relative index of refraction",
                json!(eta),
            ),
            column(
                Material,
                "kappa",
                "",
                "relative extinction coefficient",
                json!(kappa),
            ),
            column(
                Layer,
                "mean_free_path",
                unit,
                "mean free path in the medium",
                json!(path),
            ),
            column(
                Layer,
                "albedo",
                "",
                "single-scattering albedo",
                json!(medium.map(|m| m.albedo())),
            ),
            column(
                Layer,
                "phase",
                "",
                "phase function",
                json!(medium.map(|m| phase_name(m.phase()))),
            ),
            column(
                Layer,
                "g",
                "",
                "mean cosine of the phase function",
                json!(medium.map(|m| m.phase().mean_cosine())),
            ),
            column(
                Layer,
                "thickness",
                unit,
                "thickness of the layer",
                json!(slab.map(|slab| slab.thickness)),
            ),
            column(
                Layer,
                "bottom",
                "",
                "what the layer ends on",
                json!(slab.map(|slab| bottom_text(slab.bottom))),
            ),
        ];
        if self.layers.len() > 1 {
            let all: Vec<String> = self.layers.iter().map(layer_tag).collect();
            let about = "all layers from above, as in names of folders";
            columns.push(column(Layer, "layers", "", about, json!(all.join("_"))));
        }
        let others = self.at.others.iter();
        columns.extend(others.map(|one| {
            column(
                Other,
                &one.column(),
                &one.unit,
                &one.about,
                json!(one.value),
            )
        }));
        columns.push(column(
            Other,
            "from",
            "",
            "half space that the light comes from",
            json!(self.light.from),
        ));
        if let Some([_, spread]) = self.spread_texts() {
            let about = "directions that the light comes from, as in names of folders";
            columns.push(column(Other, "light_spread", "", about, json!(spread)));
        }
        columns.push(column(
            Light,
            "theta_deg",
            "deg",
            "polar angle of the light",
            json!(incidence.theta_deg()),
        ));
        columns
    }

    /// Surface, material and layer, as members of summary.json.
    #[must_use]
    pub fn setting_json(&self) -> Value {
        let mut out = Map::new();
        out.insert("smoothness".to_owned(), json!(self.at.smoothness));
        let grooves = self.grooves().map(|grooves| ("grooves", json!(grooves)));
        self.insert_into(&mut out, grooves);
        Value::Object(out)
    }

    /// The case as summary.json holds it.
    #[must_use]
    pub fn summary_json(&self) -> Value {
        let mut out = Map::new();
        if let Some(smoothness) = self.at.smoothness {
            out.insert("smoothness".to_owned(), json!(smoothness));
        }
        let recipe = self.surface.recipe();
        let recipe = recipe.map(|recipe| ("psd", json!(recipe)));
        self.insert_into(&mut out, recipe);
        let incidence = self.light.incidence;
        let incidence = json!({
            "from": self.light.from,
            "theta_deg": incidence.theta_deg(),
            "phi_deg": incidence.phi_deg(),
            "spread": self.light.spread,
        });
        out.insert("incidence".to_owned(), incidence);
        Value::Object(out)
    }

    /// Puts in what describes the surface, then unit, material, layer and further quantities.
    fn insert_into(&self, out: &mut Map<String, Value>, surface: Option<(&str, Value)>) {
        let is_physical = self.at.unit != LengthUnit::Arbitrary;
        let unit = is_physical.then(|| ("unit", json!(self.at.unit)));
        let layers = (!self.layers.is_empty()).then(|| ("layers", json!(self.layers)));
        let material = Some(("material", json!(self.material)));
        let name = self.at.material.as_ref();
        let name = name.map(|name| ("material_name", json!(name)));
        let members = [surface, unit, name, material, layers];
        let members = members.into_iter().flatten();
        out.extend(members.map(|(key, value)| (key.to_owned(), value)));
        if let Some((GGX_ALPHA, [alpha, _])) = self.roughness() {
            out.insert("ggx_alpha".to_owned(), json!(alpha));
        }
        let others = self.at.others.iter();
        out.extend(others.map(|one| (one.column(), json!(one.value))));
    }
}

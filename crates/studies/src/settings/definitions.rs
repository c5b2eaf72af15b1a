//! The definitions of all settings, one table per section of a configuration.

mod choices;
mod compare;
mod converge;
mod groups;
mod light;
mod material;
mod measured;
mod output;
mod render;
mod run;
mod single;
mod surface;

pub(super) use self::groups::{GROUPS, RANDOM_OR_GIVEN, RANDOM_SURFACES};
use super::command::{Command, Commands};
use super::setting::Setting;

/// A section of a configuration: a heading in the help.
#[derive(Clone, Copy, Debug)]
pub struct Section {
    /// Its name in a file.
    pub name: &'static str,
    /// Its heading.
    pub title: &'static str,
    /// `true` if it is missing from a configuration in which none of its keys is given.
    pub optional: bool,
    /// Its settings.
    pub settings: &'static [Setting],
}

const fn section(name: &'static str, title: &'static str, settings: &'static [Setting]) -> Section {
    Section {
        name,
        title,
        optional: false,
        settings,
    }
}

/// All sections, in the order of the help.
pub static SECTIONS: &[Section] = &[
    section("surface", "Random surfaces, cells", surface::SETTINGS),
    section("generate", "Height map", single::GENERATE_SETTINGS),
    section("measured", "Given surface", measured::SETTINGS),
    section("erosion", "Erosion", single::EROSION),
    section("mesh", "Triangle mesh", single::MESH_SETTINGS),
    section("material", "Material", material::MATERIAL_SETTINGS),
    Section {
        name: "medium",
        title: "Medium below the surface",
        optional: true,
        settings: material::MEDIUM,
    },
    section("light", "Light", light::LIGHT),
    section("view", "View", light::VIEW),
    section("run", "Run", run::SETTINGS),
    section("compare", "Models", compare::COMPARE),
    section("map", "Tolerances", compare::MAP),
    section("converge", "Methods and effort", converge::SETTINGS),
    section("model", "Model", single::MODEL_SETTINGS),
    section("camera", "Camera", render::CAMERA),
    section("lights", "Lights", render::LIGHTS),
    section("picture", "Picture", render::PICTURE),
    section("output", "Figures", output::FIGURES),
    section("results", "Results", output::RESULTS),
    section("program", "Every command", output::PROGRAM),
];

/// The settings of `command`, in the order of the help.
pub fn settings_of(command: Command) -> impl Iterator<Item = &'static Setting> {
    SECTIONS
        .iter()
        .flat_map(|section| section.settings)
        .filter(move |setting| setting.commands.contains(command))
}

/// Commands with lists that are expanded into cases.
const SWEEPS: Commands = Commands::of(&[
    Command::Verify,
    Command::Map,
    Command::Gonio,
    Command::Converge,
]);

/// Commands that draw random surfaces of any kind.
const RANDOM: Commands = SWEEPS.and(Commands::of(&[Command::Generate]));

/// Commands that read a height map, and no mesh.
const HEIGHT_MAPS: Commands = Commands::of(&[Command::Inspect, Command::Mesh]);

/// Commands that read a height map or a triangle mesh.
const SURFACES: Commands = Commands::of(&[Command::Trace, Command::Render, Command::Gonio]);

/// Commands that read a given surface.
const GIVEN: Commands = HEIGHT_MAPS.and(SURFACES);

/// Commands that trace paths into bins.
const TRACING: Commands = Commands::of(&[
    Command::Trace,
    Command::Verify,
    Command::Map,
    Command::Gonio,
]);

const ATTENUATION: Commands = Commands::of(&[Command::Attenuation]);
const CONVERGE: Commands = Commands::of(&[Command::Converge]);
const GENERATE: Commands = Commands::of(&[Command::Generate]);
const GONIO: Commands = Commands::of(&[Command::Gonio]);
const INSPECT: Commands = Commands::of(&[Command::Inspect]);
const MAP: Commands = Commands::of(&[Command::Map]);
const MESH: Commands = Commands::of(&[Command::Mesh]);
const MODEL: Commands = Commands::of(&[Command::Model]);
const RENDER: Commands = Commands::of(&[Command::Render]);
const TRACE: Commands = Commands::of(&[Command::Trace]);
const VERIFY: Commands = Commands::of(&[Command::Verify]);

/// Unit of angles.
const DEGREES: &str = "degrees";

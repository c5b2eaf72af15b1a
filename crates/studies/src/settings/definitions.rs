//! The definitions of all settings, one table per section of a configuration.

mod albedo;
mod choices;
mod commands;
mod compare;
mod converge;
mod erosion;
mod groups;
mod light;
mod material;
mod measured;
mod output;
mod render;
mod run;
mod single;
mod surface;

pub(super) use self::groups::{GROUPS, HELD_BY, RANDOM_OR_GIVEN, RANDOM_SURFACES};
use super::command::Command;
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
    section("surface", "Surface", surface::SETTINGS),
    section("albedo", "Table", albedo::SETTINGS),
    section("generate", "Height map", single::GENERATE_SETTINGS),
    section("measured", "Given surface", measured::SETTINGS),
    section("mesh", "Triangle mesh", single::MESH_SETTINGS),
    section("material", "Material", material::MATERIAL_SETTINGS),
    Section {
        optional: true,
        ..section("medium", "Medium below the surface", material::MEDIUM)
    },
    section("light", "Light", light::LIGHT),
    section("view", "View", light::VIEW),
    section("shadow", "Shadow", light::SHADOW),
    section("run", "Run", run::SETTINGS),
    section("compare", "Models", compare::COMPARE),
    section("map", "Tolerances", compare::MAP),
    section("converge", "Methods and effort", converge::SETTINGS),
    section("model", "Model", single::MODEL_SETTINGS),
    section("materials", "Optical constants", single::MATERIALS_SETTINGS),
    section("export", "Export", single::EXPORT_SETTINGS),
    section("report", "Report", single::REPORT_SETTINGS),
    section("merge", "Merge", single::MERGE_SETTINGS),
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

/// The setting `section.key` of `command`.
pub(super) fn setting_of(command: Command, path: &str) -> Option<&'static Setting> {
    settings_of(command).find(|setting| setting.matches(path))
}

//! Commands that have a setting, by name of their set.

use crate::settings::command::{Command, Commands};

/// Commands with lists that are expanded into cases.
pub(super) const SWEEPS: Commands = Commands::of(&[
    Command::Verify,
    Command::Map,
    Command::Gonio,
    Command::Converge,
]);

/// Commands that draw random surfaces of any kind.
pub(super) const RANDOM: Commands = SWEEPS.and(Commands::of(&[Command::Generate]));

/// Commands that read a height map, and no mesh.
pub(super) const HEIGHT_MAPS: Commands = Commands::of(&[Command::Inspect, Command::Mesh]);

/// Commands that read a height map or a triangle mesh.
pub(super) const SURFACES: Commands =
    Commands::of(&[Command::Trace, Command::Render, Command::Gonio]);

/// Commands that read a given surface.
pub(super) const GIVEN: Commands = HEIGHT_MAPS.and(SURFACES);

/// Commands that trace paths into bins.
pub(super) const TRACING: Commands = Commands::of(&[
    Command::Trace,
    Command::Verify,
    Command::Map,
    Command::Gonio,
]);

/// Commands that run a study, whose results one file keeps.
pub(super) const STUDIES: Commands = TRACING.and(Commands::of(&[
    Command::Albedo,
    Command::Converge,
    Command::Attenuation,
]));

pub(super) const ALBEDO: Commands = Commands::of(&[Command::Albedo]);
pub(super) const ATTENUATION: Commands = Commands::of(&[Command::Attenuation]);
pub(super) const CONVERGE: Commands = Commands::of(&[Command::Converge]);
pub(super) const EXPORT: Commands = Commands::of(&[Command::Export]);
pub(super) const GENERATE: Commands = Commands::of(&[Command::Generate]);
pub(super) const GONIO: Commands = Commands::of(&[Command::Gonio]);
pub(super) const INSPECT: Commands = Commands::of(&[Command::Inspect]);
pub(super) const MAP: Commands = Commands::of(&[Command::Map]);
pub(super) const MATERIALS: Commands = Commands::of(&[Command::Materials]);
pub(super) const MESH: Commands = Commands::of(&[Command::Mesh]);
pub(super) const MERGE: Commands = Commands::of(&[Command::Merge]);
pub(super) const MODEL: Commands = Commands::of(&[Command::Model]);
pub(super) const RENDER: Commands = Commands::of(&[Command::Render]);
pub(super) const REPORT: Commands = Commands::of(&[Command::Report]);
pub(super) const TRACE: Commands = Commands::of(&[Command::Trace]);
pub(super) const VERIFY: Commands = Commands::of(&[Command::Verify]);

/// Unit of angles.
pub(super) const DEGREES: &str = "degrees";

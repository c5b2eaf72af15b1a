//! Commands: which of them have a setting.

use std::fmt;

use asperity_io::HeightMapFormat;

use super::kind::joined_by_or;

/// The commands of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Draws a random surface.
    Generate,
    /// Computes roughness statistics of a height map.
    Inspect,
    /// Writes the triangle mesh of a height map.
    Mesh,
    /// Traces light on given surfaces.
    Trace,
    /// Renders one surface.
    Render,
    /// Compares random surfaces with models.
    Verify,
    /// Maps where models are within tolerance.
    Map,
    /// Measures BRDF and BTDF for many directions.
    Gonio,
    /// Tabulates directional albedos.
    Albedo,
    /// Measures run time against error.
    Converge,
    /// Measures shadowing and masking.
    Attenuation,
    /// Evaluates a model.
    Model,
    /// Lists materials, or shows the optical constants of one.
    Materials,
    /// Writes results as a file of another program.
    Export,
    /// Makes a page of results.
    Report,
    /// Merges the shards of a run.
    Merge,
}

impl Command {
    /// All commands, in the order of the help.
    pub const ALL: [Self; 16] = [
        Self::Generate,
        Self::Inspect,
        Self::Mesh,
        Self::Trace,
        Self::Render,
        Self::Verify,
        Self::Map,
        Self::Gonio,
        Self::Albedo,
        Self::Converge,
        Self::Attenuation,
        Self::Model,
        Self::Materials,
        Self::Export,
        Self::Report,
        Self::Merge,
    ];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Generate => "generate",
            Self::Inspect => "inspect",
            Self::Mesh => "mesh",
            Self::Trace => "trace",
            Self::Render => "render",
            Self::Verify => "verify",
            Self::Map => "map",
            Self::Gonio => "gonio",
            Self::Albedo => "albedo",
            Self::Converge => "converge",
            Self::Attenuation => "attenuation",
            Self::Model => "model",
            Self::Materials => "materials",
            Self::Export => "export",
            Self::Report => "report",
            Self::Merge => "merge",
        }
    }

    /// Purpose in one line of at most 64 characters.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::Generate => "Draw a random rough surface and write it as a height map",
            Self::Inspect => "Compute roughness statistics of a height map",
            Self::Mesh => "Write a height map as a triangle mesh",
            Self::Trace => "Trace light on given surfaces",
            Self::Render => "Render one surface and the medium below it",
            Self::Verify => "Compare random surfaces with the scattering models",
            Self::Map => "Map where each model is within tolerance",
            Self::Gonio => "Measure BRDF and BTDF by direction",
            Self::Albedo => "Tabulate directional albedos for renderers",
            Self::Converge => "Measure run time against error of the estimators",
            Self::Attenuation => "Compare shadowing and masking with Smith and V-cavities",
            Self::Model => "Evaluate a scattering model",
            Self::Materials => "List materials, or show n and k of one",
            Self::Export => "Write results as a file of another program",
            Self::Report => "Show results, or compare several, on one HTML page",
            Self::Merge => "Merge the shards of a run into its results",
        }
    }

    /// Positional argument: its name in the help, and its meaning.
    #[must_use]
    pub fn positional(self) -> Option<(&'static str, String)> {
        let (name, about) = match self {
            Self::Generate => return None,
            Self::Inspect | Self::Mesh => {
                let (name, several) = match self {
                    Self::Mesh => ("FILE..", "; several become meshes in a folder"),
                    _ => ("FILE", ""),
                };
                let about = format!("Height map: {}{several}", height_map_endings());
                return Some((name, about));
            }
            Self::Trace => (
                "FILE..",
                "Height map, triangle mesh or configuration (.toml); flags override it. Several surfaces are an ensemble",
            ),
            Self::Render => ("FILE", "Height map or triangle mesh"),
            Self::Verify
            | Self::Map
            | Self::Gonio
            | Self::Albedo
            | Self::Converge
            | Self::Attenuation => ("CONFIG", "Configuration (.toml); flags override it"),
            Self::Model => ("NAME", "Model, as --list names it"),
            Self::Export => (
                "DIR",
                "Result folder of gonio, trace or verify, or its file results.npz",
            ),
            Self::Report => ("DIR..", "Result folder; several are compared"),
            Self::Merge => ("DIR..", "Result folder of each shard, in any order"),
            Self::Materials => (
                "NAME|FILE",
                "Material: a name of the list, which is printed without one, or a file .yml or .csv",
            ),
        };
        Some((name, about.to_owned()))
    }

    /// Returns `true` if it reads a configuration file.
    #[must_use]
    pub const fn has_configuration(self) -> bool {
        CONFIGURED.contains(self)
    }
}

impl fmt::Display for Command {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Endings of the height maps that are read, as in `.exr, .npy or .gsf`.
fn height_map_endings() -> String {
    let read = HeightMapFormat::ALL.into_iter().filter(|f| f.can_read());
    let mut endings: Vec<String> = Vec::new();
    for ending in read.flat_map(HeightMapFormat::endings) {
        let ending = format!(".{ending}");
        // Several formats may share one
        if !endings.contains(&ending) {
            endings.push(ending);
        }
    }
    let endings: Vec<&str> = endings.iter().map(String::as_str).collect();
    joined_by_or(&endings)
}

/// Commands that read a configuration file.
const CONFIGURED: Commands = Commands::of(&[
    Command::Trace,
    Command::Verify,
    Command::Map,
    Command::Gonio,
    Command::Albedo,
    Command::Converge,
    Command::Attenuation,
]);

/// A set of commands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Commands(u16);

impl Commands {
    /// No command.
    pub const NONE: Self = Self(0);
    /// All commands.
    pub const ALL: Self = Self::of(&Command::ALL);

    /// The set of `commands`.
    #[must_use]
    pub const fn of(commands: &[Command]) -> Self {
        let mut bits = 0;
        let mut i = 0;
        while i < commands.len() {
            bits |= 1 << commands[i] as u16;
            i += 1;
        }
        Self(bits)
    }

    /// These and `others`.
    #[must_use]
    pub const fn and(self, others: Self) -> Self {
        Self(self.0 | others.0)
    }

    /// These, or `others` if there are none.
    #[must_use]
    pub const fn or(self, others: Self) -> Self {
        match self.0 {
            0 => others,
            _ => self,
        }
    }

    /// Returns `true` if `command` is one of them.
    #[must_use]
    pub const fn contains(self, command: Command) -> bool {
        self.0 & (1 << command as u16) != 0
    }

    /// The commands, in the order of the help.
    pub fn iter(self) -> impl Iterator<Item = Command> {
        Command::ALL
            .into_iter()
            .filter(move |command| self.contains(*command))
    }
}

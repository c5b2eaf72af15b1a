//! Examples that the program writes to start from: the files of settings, and what they read.

use asperity_cli::Example;

/// An example with its text.
macro_rules! example {
    ($file:literal) => {
        Example {
            file: $file,
            text: include_str!(concat!("../../examples/", $file)),
        }
    };
}

/// Examples of the program.
pub(crate) static EXAMPLES: [Example; 21] = [
    example!("atlas.toml"),
    example!("brushed.toml"),
    example!("converge.toml"),
    example!("converge_roughness.toml"),
    example!("converge_spacing.toml"),
    example!("first_look.toml"),
    example!("geometric_attenuation.toml"),
    example!("gold.toml"),
    example!("polarised.toml"),
    example!("pyramids.toml"),
    example!("small_gonio.toml"),
    example!("small_map.toml"),
    example!("target_error.toml"),
    example!("terrain_sun.toml"),
    example!("trace_ripples.toml"),
    example!("translucent_matrix.toml"),
    example!("transmission_paper_fig_7.toml"),
    example!("transmission_paper_figs_5_6_8_9.toml"),
    example!("validity_map.toml"),
    example!("visibility.toml"),
    example!("ripples.txt"),
];

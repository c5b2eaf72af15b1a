//! `asperity generate`: a random rough surface.

use asperity_simulate::check_memory;
use asperity_surface::{Psd, Roughness, Synthesis};

use crate::args::{Common, Generate, PsdKind};
use crate::failure::Failure;
use crate::input::{check_height_map_output, per_axis, refuse_surface, samples, write_surface};
use crate::output::{print, print_json};
use crate::text::requested_and_realised;

pub(crate) fn run(command: &Generate, common: &Common) -> Result<(), Failure> {
    check_height_map_output(&command.output)?;
    let sigma = match (command.smoothness, command.sigma) {
        (Some(s), _) if !(s.is_finite() && s > 0.0) => {
            return Err(Failure::usage(format!(
                "--smoothness is {s}; tau / sigma must be positive and finite"
            )));
        }
        (Some(s), _) => command.tau / s,
        (None, Some(sigma)) => sigma,
        (None, None) => return Err(Failure::usage("give --smoothness or --sigma")),
    };
    let tau_y = command.tau_y.unwrap_or(command.tau);
    let azimuth = command.azimuth.to_radians();
    let psd = match command.psd {
        PsdKind::Gaussian => Psd::anisotropic_gaussian(sigma, command.tau, tau_y, azimuth),
    }
    .map_err(Failure::usage)?;
    let [nx, ny] = per_axis(&command.size, "--size")?;
    let shape = [samples(ny)?, samples(nx)?];
    let spacing = per_axis(&command.spacing, "--spacing")?;

    let synthesis = Synthesis::new(psd, shape, spacing, command.insist).map_err(refuse_surface)?;
    check_memory("this surface", synthesis.peak_bytes()).map_err(Failure::failed)?;
    let clock = std::time::Instant::now();
    let field = synthesis
        .draw(command.seed, command.realisation)
        .map_err(Failure::failed)?
        .with_unit(command.unit);
    common.say(|| format!("drawn in {:.3} s", clock.elapsed().as_secs_f64()));
    let note = write_surface(&command.output, &field)?;

    let roughness = Roughness::of(&field);
    if command.json {
        return print_json(&roughness);
    }
    if common.quiet {
        return Ok(());
    }
    let mut text = format!(
        "{}: {nx} x {ny} samples, periodic, seed {}, realisation {}\n",
        command.output.display(),
        command.seed,
        command.realisation
    );
    text.push_str(&requested_and_realised(&roughness, field.unit()));
    if let Some(note) = note {
        text.push_str(&format!("note: {note}\n"));
    }
    print(&text)
}

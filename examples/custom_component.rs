//! Records a component of light that the library does not define.
//!
//! Here it is the reflected light that went through the glass: it was refracted into it and came out again. A
//! component is a filter on exits, and every view of the tally has it.
//!
//! ```text
//! cargo run --release --example custom_component
//! ```

#![allow(clippy::print_stdout, reason = "an example prints")]

use asperity_optics::{Incidence, Material};
use asperity_simulate::{Case, Effort, Light, Settings, Silent, SurfaceSource, simulate};
use asperity_synthesis::{Psd, Synthesis};
use asperity_tally::{Component, ComponentFilter, Side, TallyResult, TallySpec};

static REEMERGED: ComponentFilter = ComponentFilter {
    name: "reemerged",
    label: "re-emerged",
    description: "reflected light that was refracted on its way",
    // The code of a path is zero if none of its events is a transmission.
    accepts: |exit| exit.side == Side::Reflected && exit.path.code() != 0,
};

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    const CUSTOM: Component = Component::Custom(&REEMERGED);
    let surface = Synthesis::new(Psd::gaussian(8.0, 8.0)?, [128, 128], [1.0, 1.0], false)?;
    let light = Light::from_above(Incidence::from_degrees(30.0, 0.0)?);
    let glass = Material::dielectric(1.5)?;
    let surface = SurfaceSource::height_field(surface.draw(1, 0)?);
    let case = Case::new(surface, glass, light);
    let settings = Settings {
        tally: TallySpec::default().with_components(&[CUSTOM]),
        effort: Effort::rays(100_000),
        ..Settings::default()
    };
    for outcome in simulate(&[case], &settings, &Silent)? {
        for component in [Component::All, Component::Multiple, CUSTOM] {
            let flux = outcome.statistics.flux(Side::Reflected, component);
            let label = component.label();
            println!("reflected, {label}: {:.5}", flux.mean);
        }
        let rings = outcome.statistics.rings(Side::Reflected, CUSTOM);
        let grazing = rings.get(rings.len() - 1);
        println!(
            "re-emerged, in the ring at the horizon: {:.2e}",
            grazing.mean
        );
    }
    Ok(())
}

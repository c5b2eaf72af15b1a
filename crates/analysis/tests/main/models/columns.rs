//! Columns of directions: closed forms in lanes are those of one direction at a time, to the bit.

use std::f64::consts::{PI, TAU};

use asperity_analysis::CLOSED_FORMS;
use asperity_optics::{Material, from_spherical};
use glam::DVec3;

use crate::common::{closed_form, correlated};

/// Directions of one side: steps that meet the zenith, the horizon, and no power of two in number.
fn directions(is_up: bool) -> Vec<DVec3> {
    let polar = (0..=30).map(|i| PI * f64::from(i) / 60.0);
    let all = polar.flat_map(|theta| {
        (0..13).map(move |j| {
            let theta = if is_up { theta } else { PI - theta };
            from_spherical(theta, TAU * f64::from(j) / 13.0)
        })
    });
    all.filter(|wo| if is_up { wo.z > 0.0 } else { wo.z < 0.0 })
        .collect()
}

#[test]
fn columns_of_closed_forms_are_those_of_single_directions() {
    let materials = [
        Material::Mirror,
        Material::conductor(0.2, 3.0).unwrap(),
        Material::dielectric(1.5).unwrap(),
        Material::dielectric(1.0 / 1.5).unwrap(),
    ];
    let mut lit = 0;
    for (name, material) in CLOSED_FORMS
        .iter()
        .flat_map(|name| materials.map(|material| (name, material)))
    {
        let mut models = vec![
            closed_form(name, 0.7, material),
            closed_form(name, 8.0, material),
        ];
        if *name != "xu-sun" {
            models.push(correlated(name, 0.5, material));
        }
        for (model, is_up) in models
            .iter()
            .flat_map(|model| [(model, true), (model, false)])
        {
            let wo = directions(is_up);
            let [x, y, z] = [0, 1, 2].map(|i| wo.iter().map(|wo| wo[i]).collect::<Vec<_>>());
            for wi in [from_spherical(1.2, 2.0), DVec3::Z, DVec3::NEG_Z] {
                let mut values = vec![f64::NAN; wo.len()];
                model.bsdf_columns(wi, [&x, &y, &z], &mut values);
                for (wo, value) in wo.iter().zip(values) {
                    let single = model.bsdf(wi, *wo);
                    assert_eq!(value, single, "{name} {material:?} {wi} {wo}");
                    lit += usize::from(single > 0.0);
                }
            }
        }
    }
    assert!(lit > 10_000, "{lit}");
}

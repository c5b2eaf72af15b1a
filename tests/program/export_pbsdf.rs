//! `asperity export --format pbsdf`: Mueller matrices of the file, next to Fresnel's equations and to what was measured.

use crate::support::{Folder, InFolder, json, unwrapped};
use crate::tensor_file::TensorFile;

const LITTLE: &str = "--rays 2e4 --realisations 2 --no-plots --quiet";

/// Angle of incidence in degrees, and elements m01, m22 and m23 over the first one of a facet of index 0.43 + 2.455 i, by Fresnel's equations.
const FACET: [[f64; 4]; 3] = [
    [21.0, 0.01844, -0.99404, 0.10743],
    [45.0, 0.08142, -0.86081, 0.50237],
    [60.0, 0.13283, -0.50937, 0.85023],
];

#[test]
fn matrices_of_single_scattering_are_those_of_a_facet() {
    let folder = Folder::new();
    let line = "gonio --smoothness 20 --material conductor --eta 0.43 --kappa 2.455 --for pbsdf --theta 0:80:10";
    folder.succeed(format!("{line} {LITTLE} -o g"));
    let text = folder.succeed("export g --format pbsdf -o g.pbsdf");
    assert!(unwrapped(&text).contains("9 of 9 directions"), "{text}");
    let file = TensorFile::read(&std::fs::read(folder.join("g.pbsdf")).unwrap());
    assert_eq!(file.numbers("wvls"), [450.0, 500.0, 550.0, 600.0, 650.0]);
    let [phi_d, theta_d, theta_h] = ["phi_d", "theta_d", "theta_h"].map(|name| file.numbers(name));
    let lengths = [phi_d.len(), theta_d.len(), theta_h.len(), 5, 4, 4];
    assert_eq!(file.lengths("M"), lengths);
    let all = file.numbers("M");
    assert!(all.iter().all(|value| value.is_finite()));
    let matrix = |a: usize, d: usize, h: usize, wavelength: usize| {
        let node = ((a * lengths[1] + d) * lengths[2] + h) * 5 + wavelength;
        &all[16 * node..16 * (node + 1)]
    };
    for [degrees, linear, real, imaginary] in FACET {
        let near = |theta: &&f64| (theta.to_degrees() - degrees).abs() < 0.01;
        let d = theta_d.iter().position(|theta| near(&theta)).unwrap();
        for a in [0, 9, 20, 27] {
            let m = matrix(a, d, 8, 0);
            let found = [m[1], m[10], m[11], m[14]].map(|element| element / m[0]);
            // Mitsuba's fourth component has the other sign
            let expected = [linear, real, -imaginary, imaginary];
            for (found, expected) in found.iter().zip(expected) {
                assert!((found - expected).abs() < 0.03, "{degrees} {a}: {m:?}");
            }
            assert!(m[2].abs().max(m[7].abs()) < 0.03 * m[0], "{m:?}");
        }
    }
    for (a, d, h) in [(3, 15, 20), (20, 30, 7)] {
        let [here, mirrored] = [a, 36 - a].map(|a| matrix(a, d, h, 2));
        for i in 0..16 {
            let sign = if (i / 8) == (i / 2 % 2) { 1.0 } else { -1.0 };
            assert!((here[i] - sign * mirrored[i]).abs() < 1e-6 * here[0].abs());
        }
        // Grey
        assert_eq!(here, matrix(a, d, h, 4));
    }
}

#[test]
fn a_pbsdf_file_reflects_what_was_measured() {
    let folder = Folder::new();
    folder.succeed(format!(
        "gonio --smoothness 2 --eta 1.5 --for pbsdf {LITTLE} -o g"
    ));
    let summary = json(&folder.succeed("export g --format pbsdf -o g.pbsdf --json"));
    let rows = summary["agreement"].as_array().unwrap();
    assert_eq!(rows.len(), 17);
    for row in rows {
        let number = |value: &serde_json::Value| value.as_f64().unwrap();
        let measured = number(&row["measured"]["mean"]);
        // Readers clamp beyond the last angle
        let tolerance = if number(&row["theta_i_deg"]) < 85.0 {
            0.01
        } else {
            0.05
        };
        assert!(
            (number(&row["in_file"]) / measured - 1.0).abs() < tolerance,
            "{row}"
        );
    }
}

#[test]
fn results_that_a_pbsdf_file_cannot_hold_are_refused() {
    let folder = Folder::new();
    let line = "gonio --smoothness 3 --rays 1e3 --realisations 1 --no-plots --quiet";
    let mueller = format!("{line} --polarisation mueller");
    folder.succeed(format!("{line} --theta 0,30 -o plain"));
    folder.succeed(format!("{mueller} --theta 0 -o one"));
    folder.succeed(format!("{mueller} --theta 0,30 --from below -o below"));
    folder.succeed(format!(
        "{mueller} --theta 30,60 --phi 0:270:90 --light-azimuth fixed -o azimuths"
    ));
    folder.succeed(format!(
        "{mueller} --theta 0,30 --tau 16um --material gold --wavelength 500nm,600nm -o two"
    ));
    folder.succeed(format!(
        "{mueller} --theta 0,30 --tau 16um --material gold --wavelength 550:551:0.25nm -o fine"
    ));
    for (folder_name, words) in [
        ("plain", "--polarisation mueller"),
        ("one", "several polar angles"),
        ("below", "--from above"),
        ("azimuths", "isotropic samples"),
        ("two", "one wavelength or 5"),
        ("fine", "whole nanometres"),
    ] {
        let text = folder.refused(format!("export {folder_name} --format pbsdf -o a.pbsdf"));
        assert!(unwrapped(&text).contains(words), "{folder_name}: {text}");
    }
    assert!(!folder.join("a.pbsdf").exists());
}

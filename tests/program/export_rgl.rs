//! `asperity export --format rgl`: the file as its readers evaluate it, next to the results that it is made of.

use std::f64::consts::PI;

use glam::DVec3;

use crate::support::{Folder, InFolder, MustContain, Table, unwrapped};
use crate::tensor_file::TensorFile;

const LITTLE: &str = "--rays 2e4 --realisations 2 --no-plots --quiet";

impl TensorFile {
    /// BRDF times cosine of the channel `[azimuth, polar angle, wavelength]` of the light, at its nodes.
    fn value(&self, channel: [usize; 3], field: &str, half: DVec3) -> f64 {
        let lengths = self.lengths(field);
        let n = lengths[4];
        let slice = (channel[0] * lengths[1] + channel[1]) * lengths[2] + channel[2];
        let values = &self.numbers(field)[slice * n * n..(slice + 1) * n * n];
        let theta = half.z.clamp(-1.0, 1.0).acos();
        let turn = half.y.atan2(half.x) / (2.0 * PI) + 0.5;
        let value = bilinear(values, n, [(theta * 2.0 / PI).sqrt(), turn]);
        let columns = self.lengths("sigma")[1];
        let theta = self.numbers("theta_i")[channel[1]];
        let x = (theta * 2.0 / PI).sqrt();
        let turn = self.numbers("phi_i")[channel[0]] / (2.0 * PI) + 0.5;
        value / (4.0 * bilinear(self.numbers("sigma"), columns, [x, turn]))
    }

    /// Flux that leaves, of light from `wi`.
    fn reflected(&self, channel: [usize; 3], field: &str, wi: DVec3) -> f64 {
        let (parts, mut sum) = (200, 0.0);
        for i in 0..parts * parts {
            let [x, y] = [i % parts, i / parts].map(|k| (k as f64 + 0.5) / f64::from(parts as u32));
            let theta = 0.5 * PI * x * x;
            let half = direction(theta, PI * (2.0 * y - 1.0));
            let cosine = wi.dot(half);
            if cosine > 0.0 && (2.0 * cosine * half - wi).z > 0.0 {
                let area = 2.0 * PI * PI * x * theta.sin() / f64::from((parts * parts) as u32);
                sum += self.value(channel, field, half) * 4.0 * cosine * area;
            }
        }
        sum
    }
}

/// Between the nodes of a table whose rows are `n` long.
fn bilinear(values: &[f64], n: usize, [x, y]: [f64; 2]) -> f64 {
    let rows = values.len() / n;
    let cell = |at: f64, n: usize| {
        let cell = (at * (n - 1) as f64).floor().min((n - 2) as f64);
        (cell as usize, at * (n - 1) as f64 - cell)
    };
    let ((i, u), (j, v)) = (cell(x, n), cell(y, rows));
    let row = |j: usize| values[j * n + i] * (1.0 - u) + values[j * n + i + 1] * u;
    row(j) * (1.0 - v) + row(j + 1) * v
}

fn direction(theta: f64, phi: f64) -> DVec3 {
    DVec3::new(
        theta.sin() * phi.cos(),
        theta.sin() * phi.sin(),
        theta.cos(),
    )
}

#[test]
fn a_bsdf_file_reflects_what_was_measured_by_wavelength_and_in_colour() {
    let folder = Folder::new();
    let line =
        "gonio --smoothness 4 --tau 16um --material gold --wavelength 400:700:20nm --theta 0,50,85";
    folder.succeed(format!("{line} {LITTLE} -o g"));
    let text = folder.succeed("export g --format rgl -o g.bsdf");
    unwrapped(&text).must_contain("48 of 48 directions");
    unwrapped(&text).must_contain("at 16 angles or more");
    let table = Table::read(&folder.join("g/gonio.csv"));
    let bsdf = TensorFile::read(&std::fs::read(folder.join("g.bsdf")).unwrap());
    assert_eq!(bsdf.lengths("spectra")[..3], [1, 3, 16]);
    assert_eq!(bsdf.numbers("phi_i"), [0.0]);
    let nm: Vec<f64> = (20..=35).map(|i| f64::from(20 * i)).collect();
    assert_eq!(bsdf.numbers("wavelengths"), nm);
    let wi = [0.0_f64, 50.0, 85.0].map(|theta| direction(theta.to_radians(), 0.0));
    for (wavelength, nm) in nm.iter().enumerate().step_by(5) {
        for (theta, wi) in wi.into_iter().enumerate() {
            let row = (0..table.rows.len()).find(|&row| {
                table.number(row, "wavelength_nm") == *nm
                    && table.number(row, "theta_i_deg") == [0.0, 50.0, 85.0][theta]
            });
            let measured = table.number(row.unwrap(), "reflected");
            let found = bsdf.reflected([0, theta, wavelength], "spectra", wi);
            // The edge at the horizon in parts of 1 / 200
            assert!(
                (found / measured - 1.0).abs() < 1.5e-3,
                "{nm} {theta}: {found} {measured}"
            );
        }
    }

    folder.succeed("export g --format rgl-rgb -o rgb.bsdf --quiet");
    let rgb = TensorFile::read(&std::fs::read(folder.join("rgb.bsdf")).unwrap());
    assert_eq!(rgb.lengths("rgb")[..3], [1, 3, 3]);
    let [red, green, blue] = [0, 1, 2].map(|channel| rgb.reflected([0, 1, channel], "rgb", wi[1]));
    // Gold
    assert!(
        red > 0.95 && green > 0.6 && green < 0.85 && blue < 0.5,
        "{red} {green} {blue}"
    );
}

#[test]
fn a_bsdf_file_of_several_azimuths_has_the_lobes_where_light_went() {
    let folder = Folder::new();
    // Long slopes that face -x, so that no two azimuths are alike
    let row: Vec<String> = (0..32)
        .map(|i| format!("{:.2}", 0.15 * f64::from(i % 8)))
        .collect();
    let text = vec![row.join(" "); 32].join("\n");
    std::fs::write(folder.join("saw.txt"), text).unwrap();
    let line = "gonio --surface saw.txt --spacing 1 --material mirror --theta 20,40 --phi 0:315:45 --bins 18x36";
    folder.succeed(format!("{line} --rays 2e4 --no-plots --quiet -o g"));
    folder.succeed("export g --format rgl -o g.bsdf --quiet");
    let bsdf = TensorFile::read(&std::fs::read(folder.join("g.bsdf")).unwrap());
    let azimuths: Vec<f64> = bsdf
        .numbers("phi_i")
        .iter()
        .map(|phi| phi.to_degrees().round())
        .collect();
    assert_eq!(
        azimuths,
        [-180.0, -135.0, -90.0, -45.0, 0.0, 45.0, 90.0, 135.0, 180.0]
    );
    let table = Table::read(&folder.join("g/bsdf.csv"));
    for phi in [45.0, 135.0, 270.0] {
        let wi = direction(40_f64.to_radians(), f64::to_radians(phi));
        let azimuth = azimuths.iter().position(|&one| (one - phi) % 360.0 == 0.0);
        let value =
            |wo: DVec3| bsdf.value([azimuth.unwrap(), 1, 0], "spectra", (wi + wo).normalize());
        let bins: Vec<(f64, f64)> = (0..table.rows.len())
            .filter(|&row| {
                let light = ["theta_i_deg", "phi_i_deg"].map(|name| table.number(row, name));
                light == [40.0, phi] && table.number(row, "theta_max_deg") <= 90.0
            })
            .map(|row| {
                let [theta, azimuth] =
                    ["theta_o_deg", "phi_o_deg"].map(|name| table.number(row, name).to_radians());
                let measured = table.number(row, "bsdf") * theta.cos();
                (measured, value(direction(theta, azimuth)))
            })
            .collect();
        assert_eq!(bins.len(), 18 * 36);
        let sum = |of: fn(&(f64, f64)) -> f64| bins.iter().map(of).sum::<f64>();
        let cosine = sum(|(a, b)| a * b) / (sum(|(a, _)| a * a) * sum(|(_, b)| b * b)).sqrt();
        assert!(cosine > 0.9, "{phi}: {cosine}");
    }
}

#[test]
fn a_measurement_for_a_format_has_what_that_needs() {
    let folder = Folder::new();
    let line = "gonio --smoothness 20 --tau 16 --eta 1.5 --thickness 1000";
    folder.succeed(format!("{line} {LITTLE} --for klems -o k"));
    folder.succeed("export k --format klems -o k.xml --quiet");
    folder.succeed(format!("{line} {LITTLE} --for rgl --bins 9x18 -o r"));
    let text = folder.succeed("export r --format rgl -o r.bsdf");
    unwrapped(&text).must_contain("17 of 17 directions");
    assert!(!text.contains("or more"), "{text}");
    // Flags of the user come first
    folder.succeed(format!("{line} {LITTLE} --for rgl --theta 5,10 -o two"));
    assert_eq!(Table::read(&folder.join("two/gonio.csv")).rows.len(), 2);
}

#[test]
fn results_that_a_bsdf_file_cannot_hold_are_refused() {
    let folder = Folder::new();
    let line = "gonio --rays 1e3 --realisations 1 --no-plots --quiet";
    folder.succeed(format!("{line} --smoothness 3 --theta 0 -o one"));
    folder.succeed(format!("{line} --smoothness 3,4 --theta 0,30 -o two"));
    folder.succeed(format!(
        "{line} --smoothness 3 --theta 0,30 --from below -o below"
    ));
    folder.succeed(format!(
        "{line} --smoothness 3 --theta 0,30 --side transmitted -o transmitted"
    ));
    folder.succeed(format!(
        "{line} --smoothness 3 --theta 0,30 --phi 0,90 --light-azimuth fixed -o some"
    ));
    folder.succeed(format!(
        "{line} --smoothness 3 --tau 16um --theta 0,30 --wavelength 500nm,600nm --material BK7 -o waves"
    ));
    for (line, words) in [
        ("export one --format rgl -o a.bsdf", "several polar angles"),
        ("export two --format rgl -o a.bsdf", "differ in s"),
        ("export below --format rgl -o a.bsdf", "--from above"),
        (
            "export transmitted --format rgl -o a.bsdf",
            "holds reflected light",
        ),
        ("export some --format rgl -o a.bsdf", "divide the turn"),
        (
            "export waves --format rgl-rgb -o a.bsdf",
            "from 400 to 700 nm",
        ),
        ("export waves --format rgl -o a.xml", "written as .bsdf"),
    ] {
        folder.refused(line).must_contain(words);
    }
    assert!(!folder.join("a.bsdf").exists());
}

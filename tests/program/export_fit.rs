//! `asperity export --format fit`: parameters of laws, for surfaces of which they are known.

use std::f64::consts::PI;

use serde_json::Value;

use crate::support::{Folder, InFolder, MustContain, Table, unwrapped};

const RUN: &str = "--rays 1e5 --realisations 8 --theta 0,20,40 --no-plots --quiet";

/// A parameter with its standard error.
fn parameter(fit: &Value, law: &str, name: &str) -> [f64; 2] {
    let law = &fit["laws"][law];
    ["parameters", "standard_errors"].map(|member| {
        let found = law[member][name].as_f64();
        found.unwrap_or_else(|| panic!("{name}: {law}"))
    })
}

fn deviation(fit: &Value, law: &str) -> f64 {
    fit["laws"][law]["relative_deviation"].as_f64().unwrap()
}

/// Gaussian slopes of smoothness 8 have Beckmann's `alpha` of 2 / 8, and GGX slopes their own, on both sides.
#[test]
fn microfacets_have_the_roughness_of_the_surface() {
    let folder = Folder::new();
    for (surface, law, other) in [
        ("--smoothness 8", "beckmann", "ggx"),
        ("--slopes ggx --ggx-alpha 0.25", "ggx", "beckmann"),
    ] {
        folder.succeed(format!("gonio {surface} --eta 1.5 {RUN} -o {law}"));
        folder.succeed(format!("export {law} --format fit -o fit.json --quiet"));
        let fits = folder.json("fit.json");
        let fits = fits["fits"].as_array().unwrap();
        assert_eq!(fits.len(), 2);
        for fit in fits {
            let [alpha, se] = parameter(fit, law, "alpha");
            // A finite surface, and light of several orders, move it by some 0.2 %; errors are those of the fit
            let at = format!("{surface} {}: {alpha} +- {se}", fit["side"]);
            assert!((alpha / 0.25 - 1.0).abs() < 0.005, "{at}");
            assert!(se > 0.0 && se < 0.005, "{at}");
            assert!(deviation(fit, law) < 0.2 * deviation(fit, other), "{at}");
        }
    }
}

#[test]
fn anisotropic_surfaces_have_a_roughness_along_each_axis() {
    let folder = Folder::new();
    let line = "gonio --sigma 2 --tau 16 --tau-y 32 --eta 1.5 --theta 20 --phi 0,90";
    folder.succeed(format!(
        "{line} --rays 1e5 --realisations 8 --no-plots --quiet -o g"
    ));
    folder.succeed("export g --format fit -o g.json --quiet");
    for fit in folder.json("g.json")["fits"].as_array().unwrap() {
        let [x, y] = ["alpha_x", "alpha_y"].map(|name| parameter(fit, "beckmann", name)[0]);
        assert!((x / 0.25 - 1.0).abs() < 0.01, "{x}");
        assert!((y / 0.125 - 1.0).abs() < 0.01, "{y}");
    }
}

#[test]
fn fits_are_of_one_setting_and_say_what_they_leave_out() {
    let folder = Folder::new();
    let line = "gonio --slopes ggx --ggx-alpha 0.2 --tau 16um --material gold --rays 1e4 --realisations 4 --theta 0,40 --no-plots --quiet";
    folder.succeed(format!("{line} --wavelength 500nm,633nm -o g"));
    let text = unwrapped(&folder.succeed("export g --format fit -o g.json"));
    text.must_contain("the law that deviates least");
    let file = folder.json("g.json");
    let fits = file["fits"].as_array().unwrap();
    let wavelengths: Vec<&Value> = fits
        .iter()
        .map(|fit| &fit["setting"]["wavelength_nm"])
        .collect();
    assert_eq!(wavelengths, [500.0, 633.0]);
    let [sigma, b] = ["sigma_nm", "B_nm"]
        .map(|name| {
            fits.iter()
                .map(move |fit| parameter(fit, "k-correlation", name)[0])
        })
        .map(Iterator::collect::<Vec<f64>>);
    // At normal incidence, by the formula of the page and gold of n = 0.97112 + 1.87367 i
    let fit = &fits[0];
    let [sigma_nm, b_nm, s] =
        ["sigma_nm", "B_nm", "s"].map(|name| parameter(fit, "k-correlation", name)[0]);
    let fresnel =
        (0.02888_f64.powi(2) + 1.87367_f64.powi(2)) / (1.97112_f64.powi(2) + 1.87367_f64.powi(2));
    let law = |theta: f64| {
        let f = theta.sin() / 500.0;
        let psd = (sigma_nm * b_nm).powi(2) * (s - 2.0)
            / (2.0 * PI)
            / (1.0 + (b_nm * f).powi(2)).powf(0.5 * s);
        16.0 * PI.powi(2) / 500.0_f64.powi(4) * theta.cos() * fresnel * psd
    };
    let bins = Table::read(&folder.join("g/bsdf.csv"));
    let mut logs = Vec::new();
    for row in 0..bins.rows.len() {
        let is_here = bins.text(row, "setting") == "0"
            && bins.text(row, "theta_i_deg") == "0"
            && bins.text(row, "side") == "reflected";
        let [theta, mean, se] =
            ["theta_o_deg", "bsdf", "bsdf_se"].map(|name| bins.number(row, name));
        if is_here && mean > 0.0 && se < 0.3 * mean {
            logs.push((law(theta.to_radians()) / mean).ln());
        }
    }
    assert!(logs.len() > 20);
    let ratio = (logs.iter().sum::<f64>() / logs.len() as f64).exp();
    assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
    // The same lobe, of rays, at another wavelength: lengths of the law grow with it, whose errors are 4 and 7 %
    for lengths in [sigma, b] {
        let ratio = lengths[1] / lengths[0];
        assert!((ratio / (633.0 / 500.0) - 1.0).abs() < 0.05, "{lengths:?}");
    }
    for fit in fits {
        assert_eq!(fit["range"]["theta_i_deg"][1], 40.0);
        assert!(deviation(fit, "ggx") < 0.1);
    }

    folder.succeed("gonio --smoothness 8 --eta 1.5 --thickness 1000 --rays 1e4 --realisations 2 --theta 0 --no-plots --quiet -o slab");
    let text = unwrapped(&folder.succeed("export slab --format fit -o slab.json"));
    text.must_contain("no ggx of reflected light: describes one surface");
    text.must_contain("no k-correlation of reflected light: needs a wavelength");

    folder.succeed("gonio --smoothness 8 --eta 1.5 --rays 1 --realisations 1 --theta 0 --no-plots --quiet -o few");
    let noise = folder.refused("export few --format fit -o few.json");
    unwrapped(&noise).must_contain("needs more light");
    let line =
        "gonio --smoothness 8 --eta 1.5 --rays 1e3 --realisations 2 --theta 0 --no-plots --quiet";
    folder.succeed(format!("{line} --stokes 1,1,0,0 -o polarised"));
    let text = folder.refused("export polarised --format fit -o p.json");
    unwrapped(&text).must_contain("unpolarised light");
    folder.succeed(format!("{line} --light-spread 5 -o cone"));
    let text = folder.refused("export cone --format fit -o c.json");
    unwrapped(&text).must_contain("one direction at a time");
    assert!(!folder.join("few.json").exists());
}

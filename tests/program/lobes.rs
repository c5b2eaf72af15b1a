//! Bins around narrow lobes: what commands write of them, and what they say where lobes are narrower than bins.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, Table};

/// A smooth surface in a folder of its own: s = 40.
fn with_smooth_surface() -> Folder {
    let folder = Folder::new();
    folder.succeed("generate --tau 8 --smoothness 40 --size 64 --seed 3 -o h.exr");
    folder
}

fn summary(path: &Path) -> serde_json::Value {
    path.json("summary.json")
}

/// Peak of a column over the rows of a side.
fn peak(table: &Table, side: &str, column: &str) -> f64 {
    let rows = (0..table.rows.len()).filter(|row| table.text(*row, "side") == side);
    rows.map(|row| table.number(row, column))
        .fold(0.0, f64::max)
}

/// Edges cover each side, the largest BSDF is that of the lobe, and the in-plane slice is narrow enough to show it too.
#[test]
fn tables_hold_the_edges_of_bins_that_follow_the_light() {
    let folder = with_smooth_surface();
    let text = folder.succeed("trace h.exr --theta 30 --rays 2e5 --no-plots -o t");
    assert!(
        !text.contains("narrower") && !text.contains("below the peak"),
        "{text}"
    );
    let out = folder.join("t");
    let table = Table::read(&out.join("histogram.csv"));
    let in_plane = Table::read(&out.join("in_plane.csv"));
    let found = summary(&out);
    for side in ["reflected", "transmitted"] {
        let of_side = || (0..table.rows.len()).filter(|row| table.text(*row, "side") == side);
        let solid: f64 = of_side()
            .map(|row| table.number(row, "solid_angle_sr"))
            .sum();
        assert!((solid - 2.0 * std::f64::consts::PI).abs() < 1e-9, "{solid}");
        let widths = of_side()
            .map(|row| table.number(row, "theta_max_deg") - table.number(row, "theta_min_deg"));
        assert!(widths.fold(90.0, f64::min) < 1.2);
        // The slice is about as wide as the finest bin; a dozen facets make the peak of either.
        let ratio = peak(&in_plane, side, "intensity") / peak(&table, side, "intensity");
        assert!((0.3..1.3).contains(&ratio), "{side} {ratio}");
    }
    let lobes = found["lobes"].as_array().unwrap();
    assert_eq!(lobes.len(), 2);
    for lobe in lobes {
        assert_eq!(lobe["resolved"], true);
        let half = lobe["half_width_deg"][0].as_f64().unwrap();
        let bin = lobe["bin_deg"][0].as_f64().unwrap();
        assert!((bin / half - 0.125).abs() < 0.01, "{bin} {half}");
    }
    assert_eq!(found["config"]["bins"], "auto");
}

#[test]
fn named_bins_stay_and_a_warning_gives_both_widths() {
    let folder = with_smooth_surface();
    let trace = "trace h.exr --theta 30 --rays 1e4 --no-plots --bins 18x36 -o t";
    let text = folder.succeed(trace);
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    text.must_contain("its bin is 5 x");
    text.must_contain("the lobe of transmitted light at theta 161 deg falls to half within");
    let table = Table::read(&folder.join("t/histogram.csv"));
    assert_eq!(table.rows.len(), 2 * 18 * 36);
    let warnings = summary(&folder.join("t"))["warnings"].to_string();
    warnings.must_contain("--bins auto");
    // Wide lobes: nothing to say, and bins of equal angles by default.
    let wide = "verify --smoothness 2 --size 32 --tau 8 --rays 4000 --realisations 3 --models none --no-plots -o v";
    let text = folder.succeed(wide);
    assert!(!text.contains("below the peak"), "{text}");
    let table = Table::read(&folder.join("v/histogram.csv"));
    assert_eq!(table.rows.len(), 2 * 18 * 36);
    let said = folder.refused("trace h.exr --theta 30 --bins fine");
    said.must_contain("18x36");
    said.must_contain("auto");
}

/// Models are integrated over the same bins, and a true one is not rejected; each angle has bins of its own.
#[test]
fn models_are_compared_over_bins_that_follow_the_light() {
    let folder = Folder::new();
    let verify = "verify --smoothness 40 --tau 8 --size 48 --theta 0,40 --rays 2e5 --realisations 12 --models smith --estimator plain --no-plots -o v";
    folder.succeed(verify).must_contain("smith is not rejected");
    let sizes = ["s40_n1.5_theta0", "s40_n1.5_theta40"].map(|case| {
        let found = summary(&folder.join("v").join(case));
        assert!(found["lobes"][0]["resolved"].as_bool().unwrap());
        let table = Table::read(&folder.join("v").join(case).join("comparison.csv"));
        // Bin by bin to a few standard errors, and to rounding where there is no light.
        for row in 0..table.rows.len() {
            let [found, model] = ["flux_single", "flux_smith"].map(|name| table.number(row, name));
            assert!((found - model).abs() < 1e-3, "{:?}", table.rows[row]);
        }
        table.rows.len()
    });
    assert!(
        sizes[0] != sizes[1] && sizes.iter().all(|n| *n > 2 * 18 * 36),
        "{sizes:?}"
    );
}

/// Each of several directions has edges of its own; arrays are padded, and a measurement resumes to the same bytes.
#[test]
fn a_measurement_holds_the_edges_of_each_direction_and_resumes() {
    let folder = with_smooth_surface();
    let gonio = "gonio --surface h.exr --theta 0,40 --rays 2e4 -o out";
    folder.succeed(gonio);
    let out = folder.join("out");
    let names = [
        "bsdf.npy",
        "bsdf_se.npy",
        "theta_edges.npy",
        "phi_edges.npy",
        "bsdf.csv",
        "in_plane.csv",
    ];
    let before = names.map(|name| fs::read(out.join(name)).unwrap());
    let shape = |name: &str| -> Vec<usize> {
        let bytes = fs::read(out.join(name)).unwrap();
        let header = String::from_utf8_lossy(&bytes[..128]).into_owned();
        let list = header.split_once("'shape': (").unwrap().1;
        let list = list.split_once(')').unwrap().0;
        list.split(',')
            .filter_map(|n| n.trim().parse().ok())
            .collect()
    };
    let [bsdf, theta, phi] = ["bsdf.npy", "theta_edges.npy", "phi_edges.npy"].map(shape);
    assert_eq!(bsdf[..4], [1, 2, 1, 2]);
    assert_eq!([theta[4], phi[4]], [bsdf[4] + 1, bsdf[5] + 1]);
    let directions = summary(&out)["directions"].clone();
    assert_ne!(directions[0]["bins"], directions[1]["bins"]);
    assert!(out.join("plots/lobe_theta40_transmitted.svg").exists());
    // The same table by trace.
    folder.succeed("trace h.exr --theta 40 --rays 2e4 --no-plots -o t");
    let [ours, theirs] = ["out/directions/n1.5_theta40_phi0.csv", "t/histogram.csv"]
        .map(|name| Table::read(&folder.join(name)));
    assert_eq!(ours.rows.len(), theirs.rows.len());
    for row in 0..ours.rows.len() {
        for column in ["theta_min_deg", "phi_max_deg", "flux", "bsdf_se"] {
            assert_eq!(ours.text(row, column), theirs.text(row, column));
        }
    }
    fs::remove_file(out.join("results.npz")).unwrap();
    folder.succeed(gonio);
    let after = names.map(|name| fs::read(out.join(name)).unwrap());
    assert!(before == after);
}

#[test]
fn gonio_names_the_peak_of_each_side() {
    let folder = with_smooth_surface();
    let text =
        folder.succeed("gonio --surface h.exr --eta 1.5 --theta 30 --rays 2e5 --no-plots -o g");
    text.must_contain("BTDF peak (1/sr)");
    let peak_of = &summary(&folder.join("g"))["directions"][0]["peak"];
    let table = Table::read(&folder.join("g/bsdf.csv"));
    // Mirrored at 30 degrees, refracted at 180 less 19.5
    for (side, expected) in [("reflected", 30.0), ("transmitted", 160.5)] {
        let found = &peak_of[side];
        let [from, to] = [0, 1].map(|i| found["theta_deg"][i].as_f64().unwrap());
        assert!(
            from - 3.0 < expected && expected < to + 3.0,
            "{side} {found}"
        );
        // Noise of two errors may hide a brighter bin
        let ratio = found["bsdf"]["mean"].as_f64().unwrap() / peak(&table, side, "bsdf");
        assert!((0.8..=1.0).contains(&ratio), "{side} {ratio}");
    }
}

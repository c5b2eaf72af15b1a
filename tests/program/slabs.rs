//! Slabs and stacks of layers, lit from either side and over patches of directions.

use crate::support::{Folder, InFolder, MustContain, Table, json, unwrapped, with_surface};

/// Energies of a flat stack by the incoherent series of its faces, for one polarisation: `[R, T]`.
fn flat_stack(indices: &[f64], theta: f64, is_s: bool) -> [f64; 2] {
    let across = indices[0] * theta.to_radians().sin();
    let cosine = |n: f64| (1.0 - (across / n).powi(2)).sqrt();
    let face = |[a, b]: [f64; 2]| {
        let [p, q] = match is_s {
            true => [a * cosine(a), b * cosine(b)],
            false => [b * cosine(a), a * cosine(b)],
        };
        ((p - q) / (p + q)).powi(2)
    };
    // Adds the faces one after the other; a stack reflects alike from both sides where nothing is absorbed only in sum
    let faces = indices.windows(2).map(|pair| face([pair[0], pair[1]]));
    let add = |[above, below, through]: [f64; 3], r: f64| {
        let series = 1.0 / (1.0 - below * r);
        [
            above + through * through * r * series,
            r + (1.0 - r) * (1.0 - r) * below * series,
            through * (1.0 - r) * series,
        ]
    };
    let [above, _, through] = faces.fold([0.0, 0.0, 1.0], add);
    [above, through]
}

#[test]
fn flat_stacks_from_both_sides_are_the_series_of_their_faces() {
    let folder = Folder::new();
    let light = "--theta 50 --rays 1e3 --roulette 1e-6 --no-plots --quiet";
    let layers = "--eta 1.5 --thickness 10 --layer 1.9:5,1.2:7 --bottom-eta 1/1.2";
    folder.succeed(format!("trace --flat {layers} {light} --from both -o s"));
    let stack = [1.0, 1.5, 1.9, 1.2, 1.0];
    let [mut r, mut t] = [0.0; 2];
    for is_s in [true, false] {
        let [reflected, transmitted] = flat_stack(&stack, 50.0, is_s);
        r += 0.5 * reflected;
        t += 0.5 * transmitted;
    }
    let summary = json(&folder.text("s/summary.json"));
    println!("{r} {t} {summary}");
    for case in ["", "_below"] {
        let bins = Table::read(&folder.join(format!(
            "s/n1.5_clear_albedo0_d10_clear_albedo0_d5_clear_albedo0_d7_theta50{case}/theta.csv"
        )));
        let of_side = |side: &str| -> f64 {
            let rows = (0..bins.rows.len()).filter(|row| bins.text(*row, "side") == side);
            rows.map(|row| bins.number(row, "flux")).sum()
        };
        // Roulette ends next to nothing
        assert!((of_side("reflected") - r).abs() < 3e-6, "{case}");
        assert!((of_side("transmitted") - t).abs() < 3e-6, "{case}");
    }
}

/// One run of both sides has the numbers of two runs, and absorption and films by name stand at each wavelength.
#[test]
fn both_sides_in_one_run_have_the_numbers_of_each_alone() {
    let folder = Folder::new();
    folder.succeed("generate --tau 16um --sigma 3um --spacing 1um --size 128 --seed 3 -o h.exr");
    let slab = "--material BK7 --thickness 1mm --layer water:50um --bottom-material SiO2 --bottom-film MgF2:100nm --kappa 0 \
        --wavelength 500,600 --theta 30 --rays 2e3 --no-plots --quiet";
    folder.succeed(format!("trace h.exr {slab} --from both -o both"));
    folder.succeed(format!("trace h.exr {slab} --from below -o below"));
    let names: Vec<String> = std::fs::read_dir(folder.join("below"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.contains("theta30"))
        .collect();
    assert_eq!(names.len(), 2, "{names:?}");
    for name in names {
        assert!(name.ends_with("_below"), "{name}");
        for file in ["histogram.csv", "theta.csv"] {
            let [a, b] = ["both", "below"].map(|out| folder.text(format!("{out}/{name}/{file}")));
            assert_eq!(a, b, "{name}/{file}");
        }
    }
    // A spectrum of each side
    let spectrum = Table::read(&folder.join("both/spectrum.csv"));
    assert_eq!(spectrum.rows.len(), 4);
}

#[test]
fn gonio_measures_both_sides_over_the_patches_of_klems() {
    let folder = with_surface();
    let flags =
        "--eta 1.5 --thickness 30 --theta 0,30,82 --light-spread klems --rays 1e3 --no-plots";
    let text = folder.succeed(format!("gonio --surface h.exr {flags} --from both -o g"));
    unwrapped(&text).must_contain("light = from below");
    let table = Table::read(&folder.join("g/gonio.csv"));
    assert_eq!(table.rows.len(), 6);
    assert_eq!(
        (0..6)
            .map(|row| table.text(row, "from"))
            .collect::<Vec<_>>(),
        ["above", "above", "above", "below", "below", "below"]
    );
    assert!(
        folder
            .join("g/directions")
            .join("n1.5_clear_albedo0_d30_theta82_patch75-90x30_below_phi0.csv")
            .exists()
    );
}

#[test]
fn what_lets_no_light_in_and_wrong_layers_are_refused() {
    let folder = with_surface();
    for (flags, words) in [
        ("--thickness 1", "must exceed"),
        (
            "--from below --material gold --wavelength 550",
            "does not absorb",
        ),
        (
            "--from below --absorption 1",
            "layers that end on an interface",
        ),
        (
            "--from below --thickness 30 --bottom mirror",
            "layers that end on an interface",
        ),
        (
            "--from both --thickness 30 --bottom absorbing",
            "layers that end on an interface",
        ),
        ("--layer 1.3:5", "needs --thickness"),
        ("--thickness 30 --layer 1.3", "MATERIAL:THICKNESS"),
        ("--thickness 30 --layer water:5", "name that one too"),
        ("--thickness 30 --layer 1.3+1i:5", "lets no light through"),
        (
            "--thickness 30 --bottom-eta 1 --bottom-material 1.3",
            "bottom-eta",
        ),
        (
            "--thickness 30 --bottom mirror --bottom-material 1.3",
            "goes with bottom interface",
        ),
        ("--theta 80 --light-spread 15", "reaches the horizon"),
        ("--light-spread round", "klems"),
        ("--light-spread klems --models smith", "one direction"),
    ] {
        let line = match flags.contains("--theta") {
            true => format!("trace h.exr {flags} -o o"),
            false => format!("trace h.exr --theta 30 {flags} -o o"),
        };
        folder.refused(line).must_contain(words);
        assert!(!folder.join("o").exists());
    }
}

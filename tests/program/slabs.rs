//! Slabs and stacks of layers, lit from either side and over patches of directions.

use crate::support::{Folder, InFolder, MustContain, Table, unwrapped, with_surface};

/// Energies of a flat stack by the incoherent series of its faces, for one polarisation: `[R, T]`. `layers`: index, thickness and absorption
/// coefficient, from the side of the light; air is on both sides.
fn flat_stack(layers: &[[f64; 3]], theta: f64, is_s: bool) -> [f64; 2] {
    let across = theta.to_radians().sin();
    let cosine = |n: f64| (1.0 - (across / n).powi(2)).sqrt();
    let face = |a: f64, b: f64| {
        let [p, q] = match is_s {
            true => [a * cosine(a), b * cosine(b)],
            false => [b * cosine(a), a * cosine(b)],
        };
        ((p - q) / (p + q)).powi(2)
    };
    // Adds faces, and layers above them, one after the other: reflected from above and below, and passed
    let mut index = 1.0;
    let mut sum = [0.0, 0.0, 1.0];
    for [n, thickness, absorption] in layers.iter().chain(&[[1.0, 0.0, 0.0]]) {
        let [above, below, through] = sum;
        let r = face(index, *n);
        let series = 1.0 / (1.0 - below * r);
        let left = (-absorption * thickness / cosine(*n)).exp();
        index = *n;
        sum = [
            above + through * through * r * series,
            (r + (1.0 - r) * (1.0 - r) * below * series) * left * left,
            through * (1.0 - r) * series * left,
        ];
    }
    [sum[0], sum[2]]
}

/// Clear and absorbing layers: light is weighted along its way, so that all rays of a polarisation have the same energies.
#[test]
fn flat_stacks_from_both_sides_are_the_series_of_their_faces() {
    let folder = Folder::new();
    let light = "--theta 50 --rays 1e3 --roulette 1e-6 --no-plots --quiet --bottom-eta 1/1.2";
    for (name, absorptions) in [("clear", [0.0, 0.0, 0.0]), ("absorbing", [0.01, 0.05, 0.0])] {
        let [first, second, third] = absorptions;
        folder.succeed(format!(
            "trace --flat --eta 1.5 --thickness 10 --absorption {first} --scattering 0 \
             --layer 1.9:5:absorption={second},1.2:7:absorption={third} {light} --from both -o {name}"
        ));
        let mut layers = [[1.5, 10.0, first], [1.9, 5.0, second], [1.2, 7.0, third]];
        for from in ["above", "below"] {
            let of = |is_s| flat_stack(&layers, 50.0, is_s);
            let [s, p] = [true, false].map(of);
            let rows = Table::read(&folder.join(format!("{name}/appearance.csv")));
            let found = |quantity: &str| {
                let is_row = |row: &usize| {
                    rows.text(*row, "from") == from && rows.text(*row, "quantity") == quantity
                };
                let row = (0..rows.rows.len()).find(is_row).unwrap();
                rows.number(row, "by_rays")
            };
            for (quantity, i) in [("reflectance", 0), ("transmittance", 1)] {
                let expected = 0.5 * (s[i] + p[i]);
                // Roulette ends next to nothing
                let difference = found(quantity) - expected;
                assert!(
                    difference.abs() < 3e-6,
                    "{name} {from} {quantity} {difference:e}"
                );
            }
            layers.reverse();
        }
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
        "--eta 1.5 --thickness 30 --theta 0,30,82.5 --light-spread klems --rays 1e3 --no-plots";
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
            .join("n1.5_clear_albedo0_d30_theta82.5_patch75-90x30_below_phi0.csv")
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
        ("--from below --absorption 1", "needs layers that end"),
        (
            "--from below --thickness 30 --bottom mirror",
            "lets light in",
        ),
        (
            "--from both --thickness 30 --bottom absorbing",
            "lets light in",
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

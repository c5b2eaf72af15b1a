//! Tables of directional albedos: values, files, runs that are extended, and refusals.

use crate::support::{Folder, InFolder, MustContain, Table, assert_same_bytes, files};

/// One row of a table: cosine, reflected and transmitted light of all orders, each a value and its standard error.
type Reference = (f64, [f64; 2], [f64; 2]);

/// Rough glass, alpha = 0.5 and n = 1.5, by an independent double-precision program: Gaussian slopes, smooth cells, a correlation length of
/// 8 samples, random azimuth, 256 surfaces.
const TRACKED: [Reference; 2] = [
    (
        0.9,
        [0.041_246_16, 1.025_696e-5],
        [0.958_754_5, 5.911_792e-6],
    ),
    (
        0.5,
        [0.068_219_96, 1.878_146e-5],
        [0.931_776_4, 1.840_576e-5],
    ),
];

/// The same with s and p averaged at each facet.
const AVERAGED: [Reference; 2] = [
    (
        0.9,
        [0.040_810_43, 1.022_846e-5],
        [0.959_188_1, 6.271_371e-6],
    ),
    (0.5, [0.066_575_67, 1.923_245e-5], [0.933_421, 1.889_169e-5]),
];

/// Light that the independent program lost to failures of its numbers, at most.
const LOST: f64 = 4.2e-5;

/// Standard errors of 1 in 16,000 of a normal distribution, so that eight values exceed them once in 2000 seeds.
const BOUND: f64 = 4.0;

#[test]
fn albedos_are_those_of_an_independent_program() {
    let folder = Folder::new();
    for (polarisation, expected) in [("tracked", TRACKED), ("averaged", AVERAGED)] {
        folder.succeed(format!(
            "albedo --cos 0.9,0.5 --alpha 0.5 --samples 8 --realisations 64 --rays 2e5 --polarisation {polarisation} --no-plots -o {polarisation}"
        ));
        let table = Table::read(&folder.join(polarisation).join("albedo.csv"));
        for (row, (cos, reflected, transmitted)) in expected.into_iter().enumerate() {
            assert_eq!(table.number(row, "cos"), cos);
            for (name, [value, se]) in [("E_R", reflected), ("E_T", transmitted)] {
                let found = table.number(row, name);
                let se = se.hypot(table.number(row, &format!("{name}_se")));
                assert!(se < 2e-4, "{polarisation} {cos} {name}: {se}");
                assert!(
                    (found - value).abs() < BOUND * se + LOST,
                    "{polarisation} {cos} {name}: {found} against {value}, se {se}"
                );
            }
        }
    }
}

/// Height-correlated Smith, Gaussian slopes, alpha = 0.5 and n = 1.5, by a Gauss-Legendre rule of 3000 x 1500 slopes: its own error is
/// below 2e-8.
#[test]
fn single_scattering_is_that_of_independent_quadrature() {
    let folder = Folder::new();
    folder
        .succeed("albedo --cos 0.9,0.5 --alpha 0.5 --realisations 2 --rays 200 --no-plots -o out");
    let table = Table::read(&folder.join("out/albedo.csv"));
    for (row, expected) in [[0.039_568_11, 0.953_354_21], [0.060_433_26, 0.902_814_16]]
        .into_iter()
        .enumerate()
    {
        for (name, value) in ["single_R", "single_T"].into_iter().zip(expected) {
            let found = table.number(row, name);
            assert!((found - value).abs() < 3e-8, "{name}: {found}");
        }
        for side in ["R", "T"] {
            let [all, single, ratio] =
                ["E_", "single_", "ratio_"].map(|name| table.number(row, &format!("{name}{side}")));
            assert!((ratio * single - all).abs() < 1e-15);
        }
    }
}

#[test]
fn dielectrics_keep_all_light_and_mirrors_reflect_it() {
    let folder = Folder::new();
    let effort = "--cosines 3 --alpha 0.2,1 --realisations 8 --rays 8e3 --no-plots";
    for slopes in ["gaussian", "ggx"] {
        // From the denser side too
        let of = format!("albedo --slopes {slopes} {effort}");
        folder.succeed(format!("{of} --eta 1.5,1/1.5 -o {slopes}_glass"));
        let table = Table::read(&folder.join(format!("{slopes}_glass/albedo.csv")));
        assert_eq!(table.rows.len(), 2 * 2 * 3);
        for row in 0..table.rows.len() {
            let [r, t, se] = ["E_R", "E_T", "E_T_se"].map(|name| table.number(row, name));
            // Where all light is totally reflected there is no error but rounding
            assert!(
                (r + t - 1.0).abs() < BOUND * se + 1e-12,
                "{slopes} {row}: {r} + {t}"
            );
            let single = ["single_R", "single_T"].map(|name| table.number(row, name));
            assert!(single[0] + single[1] < 1.0);
        }
        // Fewer paths than 1e-9 of the light are as long as the limit of 1000 interactions
        folder.succeed(format!("{of} --material mirror -o {slopes}_mirror"));
        let table = Table::read(&folder.join(format!("{slopes}_mirror/albedo.csv")));
        for row in 0..table.rows.len() {
            let number = |name: &str| table.number(row, name);
            let [r, se] = ["E_R", "E_R_se"].map(number);
            assert!((r - 1.0).abs() < BOUND * se + 1e-9, "{slopes} {row}: {r}");
            assert!(se < 1e-5, "{slopes} {row}: {se}");
            assert_eq!([number("E_T"), number("ratio_T")], [0.0, 1.0]);
            assert!(number("single_R") < 1.0);
        }
        // The rougher, the less light leaves at the first facet
        assert!(table.number(5, "single_R") < table.number(2, "single_R"));
    }
}

#[test]
fn the_files_hold_the_values_of_the_table() {
    let folder = Folder::new();
    let line = "albedo --alpha 1,0.4 --cosines 2 --eta 1.33,2 --realisations 4 --rays 2e3";
    let text = folder.succeed(format!("{line} -o out"));
    let out = folder.join("out");
    let names = files(&out);
    let expected = [
        "albedo.csv",
        "albedo.exr",
        "albedo.h",
        "albedo.npy",
        "manifest.json",
        "mean.csv",
        "reflected_0.png",
        "reflected_0.svg",
        "reflected_1.png",
        "reflected_1.svg",
        "report.txt",
        "results.npz",
        "summary.json",
        "total_0.png",
        "total_0.svg",
        "total_1.png",
        "total_1.svg",
    ];
    assert_eq!(names, expected);
    text.must_contain("8 of 8 points, 2 materials x 2 alphas x 2 cosines");
    text.must_contain("n = 1.33: cosine-weighted means");
    let table = Table::read(&out.join("albedo.csv"));
    let mean = Table::read(&out.join("mean.csv"));
    let summary = out.json("summary.json");
    assert_eq!(summary["shape"], serde_json::json!([2, 2, 2, 8]));
    assert_eq!(summary["cosines"], serde_json::json!([0.25, 0.75]));
    // An array in the order of the table, after a header of whole 64 bytes
    let bytes = std::fs::read(out.join("albedo.npy")).unwrap();
    let values = &bytes[bytes.len() - 8 * 64..];
    let values: Vec<f64> = values
        .chunks(8)
        .map(|value| f64::from_le_bytes(value.try_into().unwrap()))
        .collect();
    for (row, values) in values.chunks(8).enumerate() {
        let channels = summary["channels"].as_array().unwrap();
        for (channel, value) in channels.iter().zip(values) {
            assert_eq!(table.number(row, channel.as_str().unwrap()), *value);
        }
    }
    // 2 int mu dmu from 0 to 0.5 and on to 1
    for row in 0..4 {
        let of = |name: &str| [2 * row, 2 * row + 1].map(|row| table.number(row, name));
        for name in ["E_R", "E_R_se", "single_R", "E_T", "single_T"] {
            let [grazing, steep] = of(name);
            let found = mean.number(row, &format!("mean_{name}"));
            assert!((found - 0.25 * grazing - 0.75 * steep).abs() < 1e-15);
        }
    }
    // Single precision, and both axes ascending
    let header = out.text("albedo.h");
    header.must_contain("static const float albedo_alpha[ALBEDO_ALPHAS] = { 4e-1f, 1e0f };");
    header.must_contain(" * Material 1: n = 2\n");
    let of = |name: &str, row: usize| format!("{:e}f", table.number(row, name) as f32);
    for name in ["E_R", "single_R", "ratio_R", "E_T", "single_T", "ratio_T"] {
        let declared = format!("float albedo_{name}[ALBEDO_MATERIALS]");
        let (_, values) = header.split_once(&declared).unwrap();
        let (values, _) = values.split_once(';').unwrap();
        let rows: Vec<String> = [2, 0, 6, 4]
            .map(|row| format!("{{ {}, {} }},", of(name, row), of(name, row + 1)))
            .into();
        let found: Vec<&str> = values.lines().map(str::trim).collect();
        let found: Vec<&str> = found
            .into_iter()
            .filter(|line| line.starts_with("{ "))
            .collect();
        assert_eq!(found, rows, "{name}");
    }
}

#[test]
fn points_are_added_to_those_that_are_there() {
    let folder = Folder::new();
    let line = "albedo --samples 3 --realisations 4 --rays 2e3 --no-plots --quiet";
    folder.succeed(format!("{line} --alpha 0.3 --cos 0.2 -o grown"));
    for out in ["grown", "whole"] {
        folder.succeed(format!(
            "{line} --alpha 0.3,0.6 --cos 0.2,0.9 --eta 1.5,1.6 -o {out}"
        ));
    }
    assert_same_bytes(&folder.join("grown"), &folder.join("whole"));
    let other = folder.failed(format!("{line} --alpha 0.3 --cos 0.2 --seed 2 -o grown"));
    other.must_contain("seed");
}

#[test]
fn a_target_error_is_reached() {
    let folder = Folder::new();
    folder.succeed("albedo --alpha 0.7 --cosines 3 --target-error 1e-3 --no-plots -o out");
    let table = Table::read(&folder.join("out/albedo.csv"));
    for row in 0..3 {
        let se = table.number(row, "E_R_se");
        assert!(se > 0.0 && se <= 1e-3, "{se}");
    }
}

#[test]
fn tables_of_metals_have_one_material_per_index_or_wavelength() {
    let folder = Folder::new();
    let effort = "--alpha 0.5 --cosines 2 --realisations 4 --rays 2e3 --no-plots";
    folder.succeed(format!(
        "albedo --material gold --wavelength 500,600 {effort} -o gold"
    ));
    let table = Table::read(&folder.join("gold/albedo.csv"));
    let wavelengths: Vec<f64> = (0..4)
        .map(|row| table.number(row, "wavelength_nm"))
        .collect();
    assert_eq!(wavelengths, [500.0, 500.0, 600.0, 600.0]);
    for row in 0..4 {
        let [all, single] = ["E_R", "single_R"].map(|name| table.number(row, name));
        assert!(single < all && all < 1.0, "{single} {all}");
        assert_eq!(table.number(row, "E_T"), 0.0);
    }
    // Gold is yellow
    assert!(table.number(1, "E_R") < table.number(3, "E_R") - 0.2);
    let text = folder.text("gold/report.txt");
    assert!(!text.contains("E_T"), "{text}");
}

#[test]
fn what_makes_no_table_is_refused() {
    let folder = Folder::new();
    folder.refuses(
        "albedo --material lambertian --reflectance 0.5 => dielectrics and metals
        albedo --cos 0 => must be a number above 0, up to 1
        albedo --cos 0.5 --cosines 3 => excludes --cos 0.5
        albedo --alpha 0.5,0.5 => alpha: 0.5 is given twice
        albedo --cos 0.5,0.1,0.5 => cos: 0.5 is given twice
        albedo --cos 0.5,0.500000001 => values that differ in six digits
        albedo --eta 1 => eta must differ from 1
        albedo --alpha 20 => from 0.001 to 10
        albedo --samples 2 => from 2.5 to 64
        albedo --polarisation mueller => must be tracked or averaged
        albedo --target-error 1e-3 --rays 100 => excludes --target-error
        albedo --material gold => needs --wavelength
        albedo --theta 30 => --theta is for",
    );
    assert!(files(&folder).is_empty());
}

//! `asperity materials`: the list, the constants of one material, its files and refusals.

use crate::support::{Folder, InFolder, MustContain, Table, json, unwrapped};

const FILE: &str = "wavelength_nm,n,k\n400,1.5,\n500,1.6,0.25\n700,1.8,0.5\n";

#[test]
fn materials_are_listed_with_ranges_and_sources() {
    let folder = Folder::new();
    let text = folder.succeed("materials");
    let gold = text.lines().find(|line| line.starts_with("Au "));
    let words: Vec<&str> = gold.unwrap().split_whitespace().collect();
    assert_eq!(
        words,
        ["Au", "188-1937", "188-1937", "Johnson", "1972", "gold"]
    );
    let silica = text.lines().find(|line| line.starts_with("SiO2 "));
    let words: Vec<&str> = silica.unwrap().split_whitespace().collect();
    assert_eq!(words[..5], ["SiO2", "210-6700", "-", "Malitson", "1965"]);
    let list = json(&folder.succeed("materials --json"));
    let list = list.as_array().unwrap();
    let files = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/io/materials");
    assert_eq!(list.len(), std::fs::read_dir(files).unwrap().count());
    let silica = list.iter().find(|row| row["name"] == "SiO2").unwrap();
    assert_eq!(silica["n_range_nm"], json("[210.0, 6700.0]"));
    assert!(silica["k_range_nm"].is_null());
    assert_eq!(silica["aliases"][0], "fused silica");
    assert_eq!(silica["source"], "Malitson 1965");
}

#[test]
fn one_material_is_shown_at_wavelengths() {
    let folder = Folder::new();
    let text = folder.succeed("materials gold");
    for part in [
        "other names  gold",
        "main/Au/Johnson",
        "10.1103/PhysRevB.6.4370",
        "187.9 to 1937 nm",
    ] {
        text.must_contain(part);
    }
    unwrapped(&text).must_contain("550 0.424149 2.47205 600");
    let shown = json(&folder.succeed("materials Gold --wavelength 0.6um,550 --json"));
    let rows = shown["constants"].as_array().unwrap();
    let nm: Vec<f64> = rows
        .iter()
        .map(|row| row["wavelength_nm"].as_f64().unwrap())
        .collect();
    assert_eq!(nm, [550.0, 600.0], "they ascend");
    let k = rows[0]["k"].as_f64().unwrap();
    assert!((k - 2.472_051).abs() < 1e-6, "{k}");
    assert_eq!(shown["record"], "main/Au/Johnson");
    // What is unknown is no zero
    let text = folder.succeed("materials silica --wavelength 550");
    unwrapped(&text)
        .must_contain("550 1.45991 - note: k is unknown at 1 of 1 wavelengths, which is not zero");
    let shown = json(&folder.succeed("materials silica --wavelength 550 --json"));
    assert!(shown["constants"][0]["k"].is_null() && shown["k_range_nm"].is_null());
    // A name is no folder
    std::fs::create_dir(folder.join("gold")).unwrap();
    folder.succeed("materials gold");
}

#[test]
fn tables_are_read_again_as_the_same_material() {
    let folder = Folder::new();
    folder.write("half.csv", FILE);
    for (name, k_is_known) in [("gold", true), ("silica", false), ("half.csv", true)] {
        folder.succeed(format!("materials {name} -o out.csv --quiet"));
        let table = Table::read(&folder.join("out.csv"));
        assert_eq!(table.names().any(|name| name == "k"), k_is_known, "{name}");
        let at = "--wavelength 450,500,600,700 --json";
        let [first, again] =
            [name, "out.csv"].map(|name| json(&folder.succeed(format!("materials {name} {at}"))));
        assert_eq!(first["n_range_nm"], again["n_range_nm"], "{name}");
        assert_eq!(first["k_range_nm"], again["k_range_nm"], "{name}");
        for row in 0..4 {
            let of = |shown: &serde_json::Value, key: &str| shown["constants"][row][key].as_f64();
            let [n, m] = [&first, &again].map(|shown| of(shown, "n").unwrap());
            // A formula is tabulated
            assert!((n - m).abs() < 1e-5, "{name}: {n} {m}");
            let [k, l] = [&first, &again].map(|shown| of(shown, "k"));
            let is_near = |(k, l): (f64, f64)| (k - l).abs() < 1e-12;
            assert_eq!(k.is_some(), l.is_some(), "{name}");
            assert!(k.zip(l).is_none_or(is_near), "{name}: {k:?} {l:?}");
        }
    }
    let known = Table::read(&folder.join("out.csv"));
    assert_eq!(known.text(0, "k"), "");
    assert_eq!(known.number(2, "k"), 0.5);
    // Points are those of the record, to the digit
    folder.succeed("materials Ge -o Ge.csv -q");
    folder.text("Ge.csv").must_contain("\n210.1,1.108,2.831\n");
    folder.succeed("materials gold --wavelength 700,500 -o two.csv -q");
    assert_eq!(Table::read(&folder.join("two.csv")).rows.len(), 2);
    folder.succeed("model smith --smoothness 3 --theta 30 --material two.csv --wavelength 600 -q");
}

#[test]
fn figures_have_both_curves_and_a_logarithmic_panel_over_decades() {
    let folder = Folder::new();
    folder.succeed("materials gold --plot gold.svg -q");
    let gold = folder.text("gold.svg");
    for part in ["wavelength (nm)", ">n<", ">k<", "Johnson 1972"] {
        gold.must_contain(part);
    }
    assert!(!gold.contains("logarithmic"));
    folder.succeed("materials silicon --plot silicon.svg -q");
    folder.text("silicon.svg").must_contain("logarithmic");
    folder.succeed("materials silica --plot silica.svg -q");
    folder.text("silica.svg").must_contain("k is unknown.");
    folder.succeed("materials gold --plot gold.png -q");
    let png = std::fs::read(folder.join("gold.png")).unwrap();
    assert!(png.starts_with(b"\x89PNG"));
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let folder = Folder::new();
    folder.write("half.csv", FILE);
    folder.write("bad.csv", "wavelength,n\n1,2\n");
    folder.write("hole.csv", "wavelength_nm,n,k\n1,2,1\n2,2,\n3,2,1\n");
    folder.refuses(
        "materials goldd => did you mean gold?
        materials gold --wavelength 3um => Au: the wavelength 3000 nm is out of range; the data reach from 187.9 to 1937 nm
        materials half.csv --wavelength 399 => half: the wavelength 399 nm is out of range; the data reach from 400 to 700 nm
        materials --wavelength 550 => --wavelength needs a material
        materials -o list.csv => -o needs a material
        materials --plot list.svg => --plot needs a material
        materials gold -o gold.txt => .csv
        materials gold --plot gold.pdf => .svg
        materials half.csv -o half.csv => half.csv is the input
        materials half.csv --plot p.svg -o ./half.csv => is the input
        materials gold silver => unexpected argument",
    );
    for file in ["missing.csv", "bad.csv", "hole.csv"] {
        let said = folder.failed(format!("materials {file}"));
        said.must_contain(file);
    }
    assert_eq!(folder.text("half.csv"), FILE);
}

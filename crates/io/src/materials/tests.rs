use super::*;

fn index(name: &str, wavelength: f64) -> (f64, Option<f64>) {
    let index = material(name).unwrap().constants.at(wavelength).unwrap();
    (index.n, index.k)
}

#[test]
fn indices_at_550_nm_are_those_of_the_database() {
    for (name, n, k) in [
        ("Au", 0.424149, 2.472051),
        ("Al", 1.015192, 6.627283),
        ("Si", 4.073, 0.028038),
        ("Fe", 2.949697, 2.931818),
        ("water", 1.333, 1.96e-9),
        ("ice", 1.311, 2.289e-9),
        ("BK7", 1.518522, 7.235012e-9),
    ] {
        let (own_n, own_k) = index(name, 0.55);
        let own_k = own_k.unwrap();
        assert!((own_n - n).abs() < 1e-6, "{name}: {own_n}");
        assert!((own_k - k).abs() < 1e-6 * k.max(1e-3), "{name}: {own_k}");
    }
    let (n, k) = index("fused silica", 0.55);
    assert!((n - 1.4599109).abs() < 1e-7 && k.is_none(), "{n}");
}

#[test]
fn names_are_found_without_case_and_punctuation() {
    for (word, name) in [
        ("gold", "Au"),
        ("AU", "Au"),
        ("aluminum", "Al"),
        ("Aluminium", "Al"),
        ("bk7", "BK7"),
        ("N-BK7", "BK7"),
        ("fused_quartz", "SiO2"),
        ("Soda Lime Glass", "soda-lime-glass"),
        ("stainless steel", "stainless-steel"),
        ("h2o", "water"),
    ] {
        assert_eq!(material(word).unwrap().name, name, "{word}");
    }
    let mut all: Vec<String> = materials().iter().flat_map(names).map(plain).collect();
    let count = all.len();
    all.sort_unstable();
    all.dedup();
    assert_eq!(all.len(), count, "a name of two materials");
}

#[test]
fn unknown_names_are_refused_on_one_line() {
    for word in ["goldd", "", "\u{1b}[31m", &"x".repeat(10_000)] {
        let said = material(word).unwrap_err().to_string();
        assert!(said.starts_with("unknown material"), "{said}");
        assert!(
            !said.contains(['\u{1b}', '\n']) && said.len() < 500,
            "{said}"
        );
    }
}

const RECORD: &str = "\
# comment
REFERENCES: |
    A. Author, <a href=\"https://doi.org/10.1/x\"><i>J.</i> <b>1</b>, 2 (3)</a><br>
COMMENTS: \"none\"
DATA:
  - type: formula 5
    wavelength_range: 0.3 2.5
    coefficients: 1.5
  - type: tabulated k
    data: |
        0.3 0.1
        0.5 0.2
CONDITIONS:
    temperature: 293
PROPERTIES: {n_is_absolute: true, list: [1, {a: b}]}
";

const TABLE: &str = "# source\nWavelength [nm],n,k\n400,1.5,0.1\n500,1.6,0.2\n";

fn read(text: &str, ending: &str) -> Result<MaterialRecord, String> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("mine.{ending}"));
    crate::write_bytes(&path, text.as_bytes()).unwrap();
    let read = material(path.to_str().unwrap());
    read.map_err(|error| {
        let said = error.to_string();
        assert!(said.contains("mine.") && !said.contains('\n'), "{said}");
        assert!(!said.ends_with('.') && said.len() < 700, "{said}");
        said
    })
}

#[test]
fn records_of_users_are_read() {
    let record = read(RECORD, "yml").unwrap();
    assert_eq!(record.name, "mine");
    assert_eq!(record.doi.as_deref(), Some("10.1/x"));
    assert_eq!(record.source, "A. Author, J. 1, 2 (3)");
    let index = record.constants.at(0.4).unwrap();
    assert_eq!(index.n, 1.5);
    assert!((index.k.unwrap() - 0.15).abs() < 1e-15);
}

#[test]
fn tables_are_read_with_any_unit_in_the_header() {
    for header in [
        "Wavelength [nm]",
        "wavelength_nm",
        "wl[nm]",
        "lambda (nm)",
        "wavelength nm",
    ] {
        let text = TABLE.replace("Wavelength [nm]", header);
        let table = read(&text, "csv").unwrap();
        assert_eq!(table.constants.n().range(), [0.4, 0.5], "{header}");
        assert_eq!(table.constants.at(0.5).unwrap().k, Some(0.2));
    }
    for header in ["wl_um", "wavelength (\u{b5}m)"] {
        let table = read(&format!("n,{header}\n1.5,0.4\n"), "csv").unwrap();
        assert_eq!(table.constants.n().range(), [0.4, 0.4], "{header}");
    }
}

#[test]
fn empty_extinction_coefficients_are_unknown() {
    let clear = read("wavelength_um,n\n0.4,1.5\n", "CSV").unwrap();
    assert!(clear.constants.k().is_none());
    // Unknown before the first and after the last value, and missing between them
    let rows = "wavelength_um,n,k\n0.4,1.5,\n0.5,1.5,0.1\n0.6,1.5,0.2\n0.7,1.5,\n";
    let partly = read(rows, "csv").unwrap();
    assert_eq!(partly.constants.n().range(), [0.4, 0.7]);
    assert_eq!(partly.constants.k().unwrap().range(), [0.5, 0.6]);
    let gap = read(
        &rows
            .replace("0.7,1.5,", "0.7,1.5,0.2")
            .replace("0.6,1.5,0.2", "0.6,1.5,"),
        "csv",
    );
    assert!(gap.unwrap_err().contains("k is NaN"));
    let unknown = read("wavelength_um,n,k\n0.4,1.5,\n", "csv").unwrap();
    assert!(unknown.constants.k().is_none());
}

#[test]
fn rows_of_records_are_sorted_and_the_first_of_a_wavelength_counts() {
    let text = RECORD.replace("0.5 0.2", "0.5 0.2\n        0.4 0.1\n        0.5 0.9");
    let found = read(&text, "yml").unwrap();
    let k = |um: f64| found.constants.at(um).unwrap().k.unwrap();
    assert_eq!([k(0.4), k(0.5)], [0.1, 0.2]);
}

#[test]
fn invalid_files_are_refused_in_one_sentence() {
    for (old, new, words) in [
        ("formula 5", "formula 12", "formulas 1 to 9"),
        ("formula 5", "formula x", "\"formula 1\" to \"formula 9\""),
        ("tabulated k", "tabulated n2", "is unknown"),
        ("0.3 2.5", "0.3", "two numbers"),
        ("0.3 2.5", "2.5 0.3", "range"),
        ("coefficients: 1.5", "coefficients: 1.5 2", "odd number"),
        ("coefficients: 1.5", "x: 1.5", "no coefficients"),
        ("coefficients: 1.5", "coefficients: nan", "no finite number"),
        ("0.5 0.2", "0.5 0.2 1", "3 numbers"),
        ("0.5 0.2", "0.5 -0.2", "zero or more"),
        ("0.5 0.2", "0.5 inf", "no finite number"),
        ("DATA:", "OTHER:", "DATA"),
        ("DATA:", "DATA: 5\nOTHER:", "line"),
        ("REFERENCES: |", "REFERENCES: [", "line"),
        ("temperature", "a\u{0}b", "control characters"),
    ] {
        assert!(RECORD.contains(old), "{old}");
        let said = read(&RECORD.replace(old, new), "yml").unwrap_err();
        assert!(said.contains(words), "{said}");
    }
    for (old, new, words) in [
        ("Wavelength [nm]", "wavelength", "no unit"),
        ("Wavelength [nm]", "wavelength [px]", "no unit"),
        ("Wavelength [nm]", "wavelength_A", "no unit"),
        ("Wavelength [nm]", "Wavelength, nm", "4 columns are named"),
        ("Wavelength [nm]", "x", "no column of wavelengths"),
        (",n,", ",m,", "no column n"),
        ("500", "400", "occurs twice"),
        ("500,1.6", "500,-1.6", "above zero"),
        ("500,1.6", "500,", "above zero"),
        ("500,1.6", "500,inf", "no finite number"),
        ("500,1.6", "-500,1.6", "above zero"),
    ] {
        assert!(TABLE.contains(old), "{old}");
        let said = read(&TABLE.replace(old, new), "csv").unwrap_err();
        assert!(said.contains(words), "{said}");
    }
    for text in ["{", "- a", "a: *b", "text", "\u{1}", "5"] {
        assert!(read(text, "yml").is_err(), "{text}");
    }
    assert!(read("", "yml").unwrap_err().contains("is empty"));
    assert!(
        material("/tmp/none/x.yml")
            .unwrap_err()
            .to_string()
            .contains("does not exist")
    );
    assert!(
        material("./gold")
            .unwrap_err()
            .to_string()
            .contains(".yml, .yaml or .csv")
    );
}

#[test]
fn hostile_yaml_is_refused_without_a_panic() {
    let deep = format!("DATA: {}", "[".repeat(200_000));
    assert!(read(&deep, "yml").is_err());
    let deep = format!(
        "{RECORD}X: {}1{}\n",
        "{a: ".repeat(50_000),
        "}".repeat(50_000)
    );
    assert!(read(&deep, "yml").is_err());
    let mut laughs = String::from("a0: &a0 [x, x, x, x, x, x, x, x, x]\n");
    for i in 1..12 {
        let uses = vec![format!("*a{}", i - 1); 9].join(", ");
        laughs.push_str(&format!("a{i}: &a{i} [{uses}]\n"));
    }
    assert!(read(&format!("{laughs}{RECORD}"), "yml").is_err());
}

#[test]
fn damaged_files_are_read_or_refused() {
    for (text, ending) in [(RECORD, "yml"), (TABLE, "csv")] {
        for seed in 0..300 {
            let bytes = crate::damage_tests::damaged(text.as_bytes(), seed);
            if let Ok(text) = String::from_utf8(bytes) {
                let _ = read(&text, ending);
            }
        }
    }
}

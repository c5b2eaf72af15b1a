//! Instruction sets and functions of the system: results have the same bytes with all of them.

use std::fs;
use std::path::Path;

use asperity_results::ResultSet;

use crate::support::{Folder, InFolder, MustContain, errors_of, files};

/// Environment of a processor with fewer instructions, for the program or for the C library.
const OTHERS: [(&str, &str); 2] = [
    ("ASPERITY_INSTRUCTIONS", "portable"),
    (
        "GLIBC_TUNABLES",
        "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F",
    ),
];

/// Asserts that two folders hold the same files of the same bytes, but for those with times.
fn assert_same_results(a: &Path, b: &Path) {
    assert_eq!(files(a), files(b));
    let comparable = |path: &Path| ResultSet::read(path).unwrap().comparable_bytes().unwrap();
    for name in files(a) {
        let [a, b] = [a.join(&name), b.join(&name)];
        match name.as_str() {
            "summary.json" | "manifest.json" => {}
            _ if a.is_dir() => assert_same_results(&a, &b),
            "results.npz" => assert!(comparable(&a) == comparable(&b)),
            _ => assert!(fs::read(&a).unwrap() == fs::read(&b).unwrap(), "{name}"),
        }
    }
}

#[test]
fn results_depend_on_no_instruction_set_and_no_function_of_the_system() {
    let runs = [
        "verify --smoothness 2 --theta 60 --realisations 4 --rays 20000 --model-rays 10000 --models smith,heitz,xu-sun-mc",
        "verify --slopes ggx --ggx-alpha 0.4 --theta 30 --realisations 4 --rays 10000",
        "verify --smoothness 2 --theta 30 --size 60 --realisations 4 --rays 10000 --mean-free-path 5 --albedo 0.9",
        "verify --smoothness 3 --theta 40 --material gold --wavelength 600 --realisations 4 --rays 10000 --models heitz-polarised,smith",
        "gonio --smoothness 2 --theta 0,40 --realisations 4 --rays 10000",
        "generate --structure scratches --size 63 --seed 3",
    ];
    for run in runs {
        let folder = Folder::new();
        let of = |number: usize| match run.starts_with("generate") {
            true => format!("{number}/h.npy"),
            false => number.to_string(),
        };
        let line = |i: usize| {
            fs::create_dir(folder.join(i.to_string())).unwrap();
            format!("{run} --quiet --output {}", of(i))
        };
        folder.succeed(line(0));
        for (i, (name, value)) in (1..).zip(OTHERS) {
            let output = folder.command(line(i)).env(name, value).output().unwrap();
            assert!(output.status.success(), "{}", errors_of(&output));
            assert_same_results(&folder.join("0"), &folder.join(i.to_string()));
        }
    }
}

#[test]
fn an_unknown_instruction_set_is_refused() {
    let folder = Folder::new();
    let mut command = folder.command("generate --smoothness 3 --size 16 -o h.npy");
    let output = command
        .env("ASPERITY_INSTRUCTIONS", "mmx")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(2));
    errors_of(&output)
        .must_contain("invalid ASPERITY_INSTRUCTIONS mmx: must be portable, avx2 or avx512");
}

//! Instruction sets and functions of the system: results have the same bytes with all of them.

use crate::support::{Folder, InFolder, MustContain, assert_same_bytes, errors_of};

/// Environment of a processor with fewer instructions, for the program or for the C library.
const OTHERS: [(&str, &str); 2] = [
    ("ASPERITY_INSTRUCTIONS", "portable"),
    (
        "GLIBC_TUNABLES",
        "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F",
    ),
];

#[test]
fn results_depend_on_no_instruction_set_and_no_function_of_the_system() {
    let runs = [
        "verify --smoothness 2 --theta 60 --realisations 8 --rays 40000 --model-rays 20000 --models smith,heitz,xu-sun-mc",
        "verify --ggx-alpha 0.4 --theta 30 --size 60 --realisations 8 --rays 20000 --mean-free-path 5 --albedo 0.9",
        "verify --smoothness 3 --theta 40 --material gold --wavelength 0.6 --realisations 8 --rays 20000 --models heitz-polarised,smith",
        "generate --structure terraces --size 63 --seed 3",
    ];
    for (number, run) in runs.into_iter().enumerate() {
        let folder = Folder::new();
        let of = |number: usize| match run.starts_with("generate") {
            true => format!("{number}/h.npy"),
            false => number.to_string(),
        };
        let line = |i: usize| format!("{run} --quiet --output {}", of(i));
        folder.succeed(line(0));
        for (i, (name, value)) in (1..).zip(OTHERS) {
            let output = folder.command(line(i)).env(name, value).output().unwrap();
            assert!(output.status.success(), "{}", errors_of(&output));
            assert_same_bytes(&folder.join("0"), &folder.join(i.to_string()));
        }
        println!("{number}");
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
        .must_contain("ASPERITY_INSTRUCTIONS: mmx is not one of portable, avx2 and avx512");
}

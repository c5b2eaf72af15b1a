//! Files of instruments: from the file to the light, and what is said of files that are not what their names say.

use crate::support::{Folder, InFolder, MustContain, json, unwrapped};

/// A surface data file of 24 x 16 points, 2 um x 3 um apart, with one missing.
fn sdf() -> String {
    let mut text = "aISO-1.0\nManufacID = Maker\nNumPoints = 24\nNumProfiles = 16\nXscale = 2E-6\nYscale = 3E-6\n\
        Zscale = 1E-9\nZresolution = -1\nCompression = 0\nDataType = 7\nCheckType = 0\n*\n"
        .to_owned();
    for iy in 0..16 {
        for ix in 0..24 {
            let height = 900.0 * (0.7 * f64::from(ix)).sin() * (0.5 * f64::from(iy)).cos();
            text += &if (ix, iy) == (5, 3) {
                "BAD ".to_owned()
            } else {
                format!("{height:.3} ")
            };
        }
        text += "\n";
    }
    text + "*\n"
}

#[test]
fn a_measured_file_becomes_light_in_one_command() {
    let folder = Folder::new();
    folder.write("scan.sdf", sdf());
    let error = folder.failed("inspect scan.sdf");
    error.must_contain("1 of 384 points are missing (the first at column 5, row 3)");

    let fill = "scan.sdf --missing fill --unit um";
    let report = json(&folder.succeed(format!("inspect --json {fill}")));
    assert_eq!(report["unit"], "um");
    assert_eq!(report["spacing"][1], 3.0);
    let text = folder.succeed(format!("inspect {fill}"));
    assert!(
        unwrapped(&text).contains("1 missing point was filled"),
        "{text}"
    );

    let light = "--theta 30 --rays 2e3 --no-plots --json -o light";
    let summary = json(&folder.succeed(format!("trace {fill} {light}")));
    assert_eq!(summary["energy"]["lost"]["mean"], 0.0);
    let gonio = "--directions 2x2 --bins 4x4 --rays 500 --no-plots -o directions --surface";
    folder.succeed(format!("gonio {gonio} {fill}"));
    assert!(folder.join("directions/summary.json").exists());
}

#[test]
fn the_content_of_a_file_decides() {
    let folder = Folder::new();
    folder.write("matrix.dat", "0 1 2\n3 4 6\n");
    folder
        .succeed("inspect matrix.dat")
        .must_contain("3 x 2 samples");
    folder.write("cut.dat", b"\x88\x1b\x03\x6f\0\x01");
    folder.write("picture.sur", b"\x89PNG\r\n\x1a\nand more");
    folder.write("text.plu", "0 1 2\n3 4 6\n");
    folder.write("scan.042", "\\*File list\r\n\\Version: 0x05120000\r\n");
    for (file, words) in [
        ("cut.dat", "its header takes 834 bytes, but it has 6"),
        (
            "picture.sur",
            "its name says Digital Surf file, but it begins like a PNG image",
        ),
        ("text.plu", "its header takes 508 bytes, but it has 12"),
        ("scan.042", "its header does not end in `\\*File list end`"),
    ] {
        let error = folder.failed(format!("trace {file} --theta 30 -o out"));
        error.must_contain(words);
    }
}

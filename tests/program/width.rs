//! Output on a pipe fits 80 columns.

use std::path::Path;

use asperity_studies::settings::Command;

use crate::support::{Folder, InFolder, with_surface};

const WIDTH: usize = 80;

/// Checks each line of the output of a command. A line that ends in a path may be longer.
fn fits(folder: &Path, line: &str) {
    let text = folder.succeed(line);
    assert!(!text.is_empty(), "{line} prints nothing");
    for printed in text.lines().filter(|line| !line.starts_with("results in ")) {
        let columns = printed.chars().count();
        assert!(columns <= WIDTH, "{line}: {columns} columns\n{printed}");
    }
}

#[test]
fn help_and_lists_fit() {
    let folder = Folder::new();
    fits(&folder, "--help");
    fits(&folder, "help trace");
    let names = Command::ALL.map(Command::name);
    for name in names.into_iter().chain(["completions", "man"]) {
        fits(&folder, &format!("{name} --help"));
    }
    fits(&folder, "model --list");
    for line in [
        "materials",
        "materials gold",
        "materials silica --wavelength 400,700",
        "materials TiN",
    ] {
        fits(&folder, line);
    }
}

#[test]
fn tables_of_given_surfaces_fit() {
    let folder = with_surface();
    for line in [
        "generate --tau 8 --smoothness 2 --size 64 --unit um -o u.npy",
        "inspect h.exr",
        "inspect h.exr --cells smooth",
        "inspect u.npy --spacing 1um --assume-unit um --unit nm --border periodic",
        "mesh h.exr --cells smooth -o h.ply",
        "mesh h.exr --cells smooth -o h.stl",
        "trace h.exr --rays 2e3 --no-plots -o t1",
        "trace h.exr --rays 2e3 --refine --polarisation mueller --no-plots -o t2",
        "trace h.exr --rays 2e3 --polarisation both --cells smooth --no-plots",
        "trace h.exr --rays 2e3 --material conductor --eta 0.2 --kappa 3.4 --max-order 1 --no-plots",
        "trace h.exr --rays 2e3 --spacing 1um --assume-unit um --bins 18x36 --no-plots",
        "trace h.exr --rays 500 --mean-free-path 10 --albedo 0.9 --thickness 40 --bottom lambertian --no-plots",
        "trace h.ply --rays 2e3 --border open --side reflected --no-plots",
        "gonio --surface h.exr --theta 0,30.5 --phi 0,45 --rays 1e3 --no-plots -o g1",
        "render h.exr --samples 1 --size 16x12 -o a.png",
        "render h.exr --samples 1 --size 16x12 --cells smooth --border open --mean-free-path 10 --albedo 0.9 -o b.png",
    ] {
        fits(&folder, line);
    }
    let large = "generate --tau 4 --smoothness 6 --size 128 -o large.exr";
    folder.succeed(large);
    let compared = "trace large.exr --rays 5e3 --no-plots --models";
    for models in ["smith", "smith,smith-separable,heitz,v-cavity"] {
        fits(&folder, &format!("{compared} {models}"));
    }
}

#[test]
fn tables_of_random_surfaces_fit() {
    let folder = Folder::new();
    for line in [
        "verify --tau 4 --size 32 --smoothness 3,1 --theta 30,60 --rays 3e3 --realisations 4 --model-rays 1e3 --no-plots -o v1",
        "verify --tau 4 --size 64 --smoothness 3 --cells flat --refine --insist --rays 3e3 --realisations 4 --models none --no-plots -o v2",
        "verify --tau 4 --tau-y 8 --size 64 --smoothness 3 --azimuth 20 --material conductor --eta 0.2 --kappa 3.4 --rays 3e3 --realisations 4 --models smith --no-plots -o v3",
        "verify --tau 4 --size 32 --smoothness 10 --mean-free-path 100 --albedo 0.9 --thickness 40 --rays 2e3 --realisations 4 --no-plots -o v4",
        "verify --tau 4 --size 32 --smoothness 1e5 --models smith --no-plots -o v5",
        "verify --tau 4 --size 32 --smoothness 3 --polarisation both --models heitz --model-rays 1e3 --rays 3e3 --realisations 4 --no-plots -o v6",
        "verify --tau 4 --size 32 --smoothness 3 --target-error 0.1 --models smith --no-plots -o v7",
        "verify --tau 4 --size 32 --smoothness 10,20 --theta 10,30.5 --rays 500 --realisations 2 --model-rays 500 --models smith-separable,xu-sun-mc-smith --insist --no-plots -o v8",
        "map --tau 4 --size 32 --smoothness 3,1 --theta 0,30,60 --rays 2e3 --realisations 4 --model-rays 1e3 --no-plots -o m1",
        "map --tau 4 --tau-y 8 --size 64 --smoothness 3,1.5 --theta 10,20,30,40,50,60,70 --rays 2e3 --realisations 2 --models smith,heitz --model-rays 1e3 --no-plots -o m2",
        "gonio --tau 4 --size 32 --smoothness 3 --theta 0,30 --rays 2e3 --realisations 4 --no-plots -o g3",
        "gonio --tau 4 --size 32 --smoothness 3 --theta 0,30 --rays 500 --realisations 2 --mean-free-path 1,10 --albedo 0.5 --no-plots -o g2",
        "converge --tau 4 --size 32 --smoothness 3 --reference-rays 1e3 --reference-surfaces 4 --rays 256 --surfaces 2,4 --repeats 2 --no-plots -o c1",
        "attenuation --sigma 0.1,0.5 --tau 0.5 --size 256 --spacing 0.05 --theta 42,85 --realisations 2 --heights --demarcation --no-plots",
        "attenuation --sigma 0.5 --theta 0,42 --view-theta 60 --view-phi 90 --realisations 2 --border open --no-plots",
        "attenuation --sigma 0.5 --theta 42 --cells smooth --realisations 2 --no-plots",
        "model smith --smoothness 3",
        "model xu-sun --smoothness 3 --bins 6x6 -o b.csv",
        "model heitz --smoothness 3 --bins 6x6 --rays 1e3 -o h.csv",
        "model flat-layer --mean-free-path 10 --albedo 0.9 --thickness 5 --bins 3x4 -o l.csv",
    ] {
        fits(&folder, line);
    }
}

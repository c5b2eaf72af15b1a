//! What figures of commands say of themselves.

use std::path::Path;

use crate::support::{Folder, InFolder, MustContain, with_surface};

/// The texts of a figure, one per line.
fn texts(folder: &Path, figure: &str) -> String {
    let svg = folder.text(format!("{figure}.svg"));
    let pieces = svg.split('<').filter_map(|piece| piece.split_once('>'));
    let texts = pieces.map(|(_, text)| text.trim());
    texts.collect::<Vec<_>>().join("\n")
}

#[test]
fn captions_name_surfaces_rays_and_seed() {
    let folder = with_surface();
    let run = |line: &str| folder.succeed(line);
    run("trace h.exr --eta 1.5 --theta 30 --rays 1024 --seed 7 -o t");
    for figure in ["lobes", "in_plane_reflected"] {
        let caption = "h.exr; n = 1.5, θᵢ = 30°, φᵢ = 0°; 1 surface, 1024 rays, seed 7";
        assert!(
            texts(&folder, &format!("t/{figure}")).contains(caption),
            "{figure}"
        );
    }
    let drawn = "--smoothness 2 --tau 4 --size 32 --insist --rays 1024 --realisations 2 --seed 7";
    run(&format!("verify {drawn} --theta 30 --models none -o v"));
    let caption = "s = 2, n = 1.5, θᵢ = 30°; 2 surfaces, 1024 rays, seed 7";
    assert!(texts(&folder, "v/lobes").contains(caption));
    assert!(texts(&folder, "v/height_map").contains("First of 2 surfaces of seed 7"));
    run(&format!("gonio {drawn} --theta 0,30,60,75 -o g"));
    let caption = "2 surfaces, 1024 rays per direction, seed 7";
    let matrix = texts(&folder, "g/plots/matrix_reflected");
    assert!(matrix.contains(caption) && matrix.contains("angle of incidence θᵢ"));
    let lines: Vec<&str> = matrix.lines().collect();
    assert!(
        ["0°", "30°", "60°", "75°"]
            .iter()
            .all(|name| lines.contains(name))
    );
    run(&format!("map {drawn} --theta 0 --models smith -o m"));
    let map = texts(&folder, "m/map_own").replace('\n', " ");
    map.must_contain("2 surfaces, 1024 rays per cell, seed 7");
}

#[test]
fn figures_of_a_generated_surface_show_what_was_requested() {
    let folder = with_surface();
    folder.succeed("inspect h.exr -o i");
    let decay = texts(&folder, "i/autocorrelation");
    assert!(decay.lines().any(|text| text == "requested"));
    assert!(texts(&folder, "i/slopes").contains("probability density, logarithmic"));
}

#[test]
fn angles_that_are_not_drawn_are_named() {
    let folder = Folder::new();
    let run = |theta: &str, out: &str| {
        let line = format!(
            "attenuation --sigma 1,2 --tau 8 --spacing 1 --length 64 --insist --realisations 1 --theta {theta} -o {out}"
        );
        folder.succeed(&line);
        texts(&folder, &format!("{out}/attenuation_sigma"))
    };
    assert!(run("0,15,30,45,60,75,85", "seven").contains("Not drawn: θᵢ = 30°, 75°."));
    assert!(!run("0,60", "two").contains("Not drawn"));
}

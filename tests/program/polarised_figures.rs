//! Figures of Mueller matrices.

use crate::support::{InFolder, files, with_surface};

/// The texts of an SVG.
fn texts(svg: &str) -> Vec<&str> {
    let pieces = svg.split('<').filter_map(|piece| piece.split_once('>'));
    pieces.map(|(_, text)| text.trim()).collect()
}

#[test]
fn mueller_matrices_are_drawn_for_each_side_that_light_leaves_to() {
    let folder = with_surface();
    let run = |more: &str, out: &str| {
        folder.succeed(format!("trace h.exr --theta 30 --rays 2e4 -o {out} {more}"));
        let mut names = files(&folder.join(out));
        names.retain(|name| name.starts_with("mueller") && !name.ends_with(".csv"));
        names
    };
    let of = |sides: &[&str]| {
        let mut names: Vec<String> = sides
            .iter()
            .flat_map(|side| {
                [
                    format!("mueller_in_plane_{side}"),
                    format!("mueller_{side}"),
                ]
            })
            .flat_map(|name| [format!("{name}.png"), format!("{name}.svg")])
            .collect();
        names.sort();
        names
    };
    let glass = run("--eta 1.5 --polarisation mueller", "glass");
    assert_eq!(glass, of(&["reflected", "transmitted"]));
    let gold = "--material conductor --eta 0.43 --kappa 2.455 --polarisation mueller";
    assert_eq!(run(gold, "gold"), of(&["reflected"]));
    assert_eq!(run("--eta 1.5", "none"), of(&[]));
    assert_eq!(
        run("--eta 1.5 --polarisation mueller --no-plots", "off"),
        of(&[])
    );
    for kind in ["mueller_in_plane", "mueller"] {
        let svg = folder.text(format!("glass/{kind}_reflected.svg"));
        let texts = texts(&svg);
        for i in 1..16 {
            let name = format!("m{}{}", i / 4, i % 4);
            assert_eq!(
                texts.iter().filter(|t| **t == name.as_str()).count(),
                1,
                "{kind} {name}"
            );
        }
        assert!(texts.iter().any(|t| t.contains("s along z × k, p = k × s")));
    }
}

//! Messages of `--verbose` on standard error.

use crate::support::{InFolder, errors_of, with_surface};

#[test]
fn verbose_tells_what_is_done_and_why() {
    let folder = with_surface();
    let random = "--tau 4 --size 32 --smoothness 3 --realisations 4 --rays 2e3 --seed 5 --no-plots --threads 2 -v";
    let surfaces = "4 random surfaces (as given) of 32 x 32 smooth cells, spacing 0.25 x 0.25 correlation lengths, seed 5";
    for (line, expected) in [
        (
            "trace h.exr --rays 2e4 --seed 5 --threads 2 -v".to_owned(),
            vec![
                "h.exr: 64 x 64 samples",
                "one given surface, seed 5",
                "accelerator: pyramid (auto, by the kind of surface); instruction set: ",
                "2 threads",
                "18x36 bins per side",
                "follows from the facets",
                "traced in",
            ],
        ),
        (
            "trace h.exr --rays 2e3 --accelerator mesh --estimator plain -v".to_owned(),
            vec!["accelerator: mesh (as given)", "plain; estimator: as given"],
        ),
        (
            format!("verify {random} --models none -o v"),
            vec![surfaces, "follows from Gaussian slopes", "1 case in"],
        ),
        (
            format!("verify {random} --models none --mean-free-path 5 --albedo 0.5 -o l"),
            vec!["no control variate covers a medium below the surface"],
        ),
        (
            "verify --tau 4 --size 32 --smoothness 3 --target-error 0.1 --models none --no-plots -v -o t"
                .to_owned(),
            vec!["(planned by a pilot run)"],
        ),
        (
            format!("map {random} --models smith -o m"),
            vec!["theta = 30 deg: ", surfaces],
        ),
        (
            format!("gonio {random} --theta 0,30 -o g"),
            vec!["theta = 0 deg: ", "theta = 30 deg: ", surfaces],
        ),
    ] {
        let output = folder.run(&line);
        let said = errors_of(&output);
        assert!(output.status.success(), "{line}: {said}");
        for line in said.lines() {
            assert!(line.chars().count() <= 80, "{line}");
        }
        // Lines are broken anywhere
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        for part in expected {
            assert!(said.contains(part), "{line}: {part} is missing in\n{said}");
        }
        let quiet = line.replace(" -v", " -q").replace(" -o ", " -o q");
        let output = folder.run(&quiet);
        assert!(output.stderr.is_empty() && output.stdout.is_empty(), "{quiet}");
    }
}

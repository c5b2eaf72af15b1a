//! Headlines: the answer in at most five lines, which begins the printed text and report.txt, and is in summary.json.

use crate::support::{InFolder, MustContain, with_surface};

/// Most lines of a headline.
const MAX_LINES: usize = 5;

#[test]
fn every_study_begins_with_the_answer() {
    let folder = with_surface();
    let random = "--tau 4 --size 32 --smoothness 2 --realisations 4 --rays 2e3 --no-plots";
    for (line, expected) in [
        (
            "trace h.exr --rays 1e4 --no-plots",
            "standard errors from 64 ray blocks",
        ),
        (
            "trace h.exr --rays 1e4 --material gold --wavelength 500:600:50nm --no-plots",
            "of the light in 3 cases",
        ),
        (
            "trace h.exr --rays 1e4 --assume-unit um --wavelength 550nm --thickness 50um --theta 0 --no-plots",
            "haze ",
        ),
        (
            "trace h.exr --rays 1e4 --assume-unit nm --no-plots",
            "diffraction (up to ",
        ),
        (
            &format!("verify {random} --model-rays 2e3"),
            "of single scattering: smith ",
        ),
        (
            &format!("verify {random} --theta 0,30,60 --model-rays 2e3"),
            "of the light in 3 cases",
        ),
        (&format!("gonio {random} --theta 0,30"), "BRDF up to "),
        (
            &format!("map {random} --models smith,heitz --model-rays 2e3"),
            "against all light: ",
        ),
        (
            "albedo --eta 1.5 --cosines 2 --alpha 0.5 --rays 2e3 --realisations 2 --no-plots",
            "times single scattering",
        ),
        (
            "attenuation --sigma 0.3 --theta 45 --realisations 2 --no-plots",
            "light reaches ",
        ),
        ("inspect h.exr", "root mean square gradient Sdq "),
    ] {
        let name = line.split(' ').next().unwrap();
        std::fs::remove_dir_all(folder.join("out")).ok();
        let printed = folder.succeed(format!("{line} -o out/"));
        let headline: Vec<&str> = printed
            .lines()
            .take_while(|line| !line.is_empty())
            .collect();
        assert!(headline.len() <= MAX_LINES, "{line}:\n{printed}");
        for one in &headline {
            assert!(one.chars().count() <= 80, "{line}: {one}");
        }
        headline.join("\n").must_contain(expected);
        let kept = folder.json("out/summary.json")["headline"].clone();
        assert_eq!(kept, serde_json::json!(headline), "{line}");
        if name != "inspect" {
            let report = folder.text("out/report.txt");
            assert!(report.starts_with(&headline.join("\n")), "{line}");
            let all = printed.split("results in ").next().unwrap();
            assert_eq!(all.trim_end(), report.trim_end(), "{line}");
        }
    }
}

/// `script` of util-linux runs a command in a terminal of its own.
#[cfg(target_os = "linux")]
#[test]
fn a_terminal_gets_two_screens_unless_verbose() {
    let folder = with_surface();
    let program = env!("CARGO_BIN_EXE_asperity");
    let lines = |more: &str| {
        let line = format!(
            "{program} verify --tau 4 --size 32 --realisations 4 --rays 2e3 --model-rays 2e3 -o out --no-plots {more}"
        );
        let mut script = std::process::Command::new("script");
        let script = script.args(["-qec", &line, "/dev/null"]);
        let output = script.current_dir(&*folder).env("TERM", "dumb").output();
        let Ok(output) = output else {
            println!("skipped: script is not installed");
            return None;
        };
        let printed = String::from_utf8(output.stdout).unwrap();
        let found = printed
            .lines()
            .map(|line| line.rsplit('\r').next().unwrap_or(line).to_owned());
        Some((found.clone().count(), found.collect::<Vec<_>>().join("\n")))
    };
    let (Some((few, short)), Some((all, whole))) = (lines(""), lines("--verbose")) else {
        return;
    };
    short.must_contain(" more lines: --verbose prints them");
    assert!(few < 60 && all > 80, "{few} {all}\n{short}");
    assert!(!whole.contains("more lines: "), "{whole}");
}

//! The settings as users meet them: help, reference page, files and flags.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use asperity_studies::settings::{Command, reference_pages, settings_of};

use crate::support::{Folder, InFolder, MustContain, json, with_surface};

/// The flags that a help text names, without those of clap.
fn flags(help: &str) -> BTreeSet<String> {
    let options = help.lines().filter_map(|line| {
        let line = line.trim_start();
        let line = match line.split_once(", --") {
            Some((short, _)) if short.len() == 2 => line.split_at(4).1,
            _ => line,
        };
        let flag = line.strip_prefix("--")?;
        flag.split([' ', '<']).next().map(str::to_owned)
    });
    options
        .filter(|flag| !["help", "help-all", "version"].contains(&flag.as_str()))
        .collect()
}

#[test]
fn every_flag_of_the_help_is_in_the_page_and_the_reverse() {
    let folder = Folder::new();
    let pages = reference_pages();
    for command in Command::ALL {
        let help = folder.succeed(format!("{command} --help-all"));
        assert!(
            help.lines().all(|line| line.chars().count() <= 80),
            "{help}"
        );
        let defined: BTreeSet<String> = settings_of(command)
            .filter_map(|setting| setting.flag_name())
            .collect();
        assert_eq!(flags(&help), defined, "{command}");
        for flag in defined {
            let anchor = format!("<a id=\"--{flag}\"></a>`--{flag}`");
            let counts = pages.iter().map(|page| page.text.matches(&anchor).count());
            let counts: Vec<usize> = counts.collect();
            assert!(
                counts.contains(&1) && counts.iter().all(|count| *count <= 1),
                "{anchor}"
            );
        }
    }
}

#[test]
fn short_help_holds_few_flags_and_names_the_rest() {
    let folder = Folder::new();
    for command in Command::ALL {
        let [short, full] =
            ["--help", "--help-all"].map(|flag| folder.succeed(format!("{command} {flag}")));
        let [few, all] = [&short, &full].map(|help| flags(help));
        println!("{command}: {} of {} flags", few.len(), all.len());
        assert!(
            few.is_subset(&all) && few.len() <= 26,
            "{command}: {}",
            few.len()
        );
        let says_rest = short.contains(&format!("all {} flags", all.len()));
        assert_eq!(says_rest, few != all, "{short}");
        for setting in settings_of(command).filter(|setting| setting.required.contains(command)) {
            assert!(few.contains(&setting.flag_name().unwrap()), "{command}");
        }
    }
}

#[test]
fn trace_reads_a_configuration_and_flags_override_it() {
    let folder = with_surface();
    let text =
        "[measured]\nfile = \"h.exr\"\n[light]\ntheta = 40\n[run]\nrays = 2e3\nbins = \"4x6\"\n";
    folder.write("t.toml", text);
    let by_file = folder.succeed("trace t.toml --json");
    let flags = "trace h.exr --theta 40 --rays 2e3 --bins 4x6 --json";
    let by_flags = folder.succeed(flags);
    let named = folder.succeed(flags.replace("h.exr", "--surface h.exr"));
    for other in [by_flags, named] {
        for part in ["energy", "config"] {
            assert_eq!(json(&by_file)[part], json(&other)[part], "{part}");
        }
    }
    let overridden = json(&folder.succeed("trace t.toml --theta 20 --json"));
    assert_eq!(overridden["config"]["light"]["theta_deg"], 20.0);
    folder.write("bad.toml", "[surface]\ntau = 3\n");
    let said = folder.refused("trace bad.toml");
    said.must_contain("bad.toml: line 2: surface.tau is for");
    // The example is for another command, which is named.
    folder.write("first.toml", include_str!("../../examples/first_look.toml"));
    let said = folder.refused("trace first.toml");
    said.must_contain("is for verify");
}

#[test]
fn the_example_of_a_traced_surface_runs_from_the_root() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let found = json(&root.succeed("trace examples/trace_ripples.toml --json"));
    assert_eq!(found["config"]["light"]["theta_deg"], 30.0);
    assert_eq!(found["config"]["surface"]["file"], "examples/ripples.txt");
}

#[test]
fn sizes_are_written_either_way_and_seeds_have_one_default() {
    let folder = Folder::new();
    for (name, size) in [("a.npy", "64x32"), ("b.npy", "64,32")] {
        let line = format!("generate --tau 4 --size {size} -o {name}");
        folder
            .succeed(&line)
            .must_contain("64 x 32 samples, periodic, seed 1,");
    }
    let bytes = |name: &str| fs::read(folder.join(name)).unwrap();
    assert!(bytes("a.npy") == bytes("b.npy"));
}

#[test]
fn refusals_name_the_flag_or_the_line_with_what_is_allowed() {
    let folder = Folder::new();
    folder.write("unit.toml", "[light]\ntheta = 30deg\n");
    folder.write("range.toml", "[light]\ntheta = [30, 95]\n");
    folder.write("json.toml", "{\n \"light\": {\"theta\": 30}}\n");
    folder.write("open.toml", "[surface\ntau = 3\n");
    folder.write("colon.toml", "[light]\ntheta: 30\n");
    let cases = "
        generate --size 64x32x3 -o a.npy => --size 64x32x3: must be a whole number of 1 or more, up to 1e15, for both axes or two as COLUMNSxROWS, such as 512 or 512x256
        generate --seed -1 -o a.npy => --seed -1: must be a whole number from 0 to 18446744073709551615
        model smith --alpha 0.3 => unknown flag --alpha; roughness is given as --smoothness, s = 2 / alpha
        verify unit.toml -o out => unit.toml: line 2: `theta = 30deg` is not valid TOML
        verify range.toml -o out => range.toml: line 2: theta = [30, 95]: must be a number from 0 to below 90
        verify --level 1 -o out => --level 1: must be a number above 0 and below 1
        generate --tau 5 um -o a.npy => `um`; a unit follows its number without a blank, as in 5um
        verify --tau 5 um -o out => `um`; a unit follows its number
        model smith => needs a rough surface: give --smoothness or --slopes-of
        model ggx => or --slopes ggx with --ggx-alpha
        verify --theta 30 60 -o out => `60`; several values of a flag have commas
        generate --structure pyramids --smoothness 3 -o a.npy => excludes --structure pyramids; roughness on top of a structure is given by sigma and tau
        verify json.toml -o out => json.toml: line 1: it is JSON, but a configuration is TOML: a section
        verify open.toml -o out => open.toml: line 1: `[surface` is not valid TOML: a section begins with its name in brackets
        verify colon.toml -o out => colon.toml: line 2: `theta: 30` is not valid TOML: a section
    ";
    folder.refuses(cases);
}

#[test]
fn a_surface_in_the_place_of_a_configuration_is_refused_with_the_right_command() {
    let folder = Folder::new();
    folder.succeed("generate --tau 4 --size 32 -o h.exr -q");
    for (line, expected) in [
        ("gonio h.exr -o out", "use `asperity gonio --surface h.exr`"),
        ("verify h.exr -o out", "`asperity trace h.exr --models"),
        ("verify h.asc -o out", "`h.asc` is a height map"),
        ("attenuation h.exr", "random surfaces alone"),
        ("map missing.npy -o out", "`missing.npy` is a height map"),
        ("converge h.PLY -o out", "`h.PLY` is a triangle mesh"),
    ] {
        let said = folder.refused(line);
        said.must_contain(expected);
        said.must_contain("reads a configuration");
    }
}

#[test]
fn configurations_are_files_that_end_in_toml() {
    let folder = Folder::new();
    let said = folder.refused("verify v.cfg -o out");
    said.must_contain("`v.cfg`: the name of a configuration ends in .toml");
}

#[test]
fn examples_fit_their_setting() {
    let folder = Folder::new();
    let said = folder.refused("verify --tau 8 --threads 0 -o out");
    assert!(
        said.contains("such as 4") && !said.contains("1000"),
        "{said}"
    );
    let said = folder.refused("trace --flat --theta 95");
    said.must_contain("such as 30 or 42.5");
}

#[test]
fn lengths_in_messages_have_their_unit() {
    let folder = Folder::new();
    let said = folder.refused("generate --tau 3um --spacing 1um -o h.exr");
    said.must_contain("is 3 um, only 3.00 spacings of 1 um: take a spacing of at most 0.75 um");
    let generate = "generate --tau 3um --spacing 0.5um --size 16 -o h.exr";
    let said = folder.refused(generate);
    said.must_contain("the tile is 8 um long along x");
    folder.succeed("generate --tau 4um --spacing 1um --size 32 -o h.exr");
    let said = folder.refused("mesh h.exr --cells smooth --deviation 1e-30um -o h.ply");
    said.must_contain("--deviation 1e-30 um: must be above");
    let render = "render h.exr --size 8x6 --samples 1 --view-theta 89 --width 1um -o h.png";
    let said = folder.refused(render);
    said.must_contain(" um above the mean plane");
}

#[test]
fn help_is_a_command_too_and_missing_values_are_named_by_what_they_are() {
    let folder = Folder::new();
    for (command, flag) in [
        ("help", "--help"),
        ("help gonio", "gonio --help"),
        ("help gonio --help-all", "gonio --help-all"),
    ] {
        let [by_command, by_flag] = [command, flag].map(|line| folder.succeed(line));
        assert_eq!(by_command, by_flag);
    }
    let cases = "
        help frobnicate => frobnicate
        frobnicate => the commands are generate, inspect,
        verify --theta => '--theta <DEGREES,..>'
        generate --realisation => '--realisation <NUMBER>'
    ";
    folder.refuses(cases);
}

#[test]
fn a_size_in_a_file_is_written_as_on_the_command_line_or_as_a_list() {
    let folder = Folder::new();
    for (name, size) in [
        ("text", "\"64x32\""),
        ("list", "[64, 32]"),
        ("bad", "\"64x\""),
    ] {
        let text =
            format!("[surface]\ntau = 4\nsize = {size}\n[run]\nrealisations = 1\nrays = 100\n");
        folder.write(format!("{name}.toml"), text);
    }
    let [text, list] = ["text", "list"].map(|name| {
        let line = format!("verify {name}.toml --models none --no-plots --json -o {name}");
        json(&folder.succeed(&line))["config"]["verify"]["surface"]["size"].clone()
    });
    assert_eq!(text, json("[64, 32]"));
    assert_eq!(list, text);
    let said = folder.refused("verify bad.toml -o out");
    said.must_contain("two as COLUMNSxROWS, such as 512 or 512x256");
}

/// `models = "smith"` is the same as a list of one.
#[test]
fn one_name_may_stand_for_a_list() {
    let folder = Folder::new();
    let text = "[surface]\ntau = 4\nsize = 32\n[run]\nrealisations = 2\nrays = 500\nbins = \"2x2\"\n[compare]\nmodels = \"smith\"\nlevel = 0.05\n";
    folder.write("v.toml", text);
    let summary = json(&folder.succeed("verify v.toml --json --no-plots -o out"));
    let compare = &summary["config"]["verify"]["compare"];
    assert_eq!(compare["models"], json("[\"smith\"]"));
    assert_eq!(compare["level"], 0.05);
    // Alpha is a roughness, never a level.
    for (line, hint) in [
        (
            "verify --alpha 0.05 -o a",
            "roughness is given as --smoothness",
        ),
        ("trace h.exr --alpha 0.05", "see --help"),
    ] {
        let said = folder.refused(line);
        said.must_contain(format!("unknown flag --alpha; {hint}"));
    }
    let said = folder.refused("verify --smothness 3 -o a");
    assert_eq!(
        said,
        "asperity: unknown flag --smothness; did you mean --smoothness?\n"
    );
    let said = folder.refused("inspect a.npy b.npy");
    said.must_contain("unexpected argument `b.npy`");
}

//! Completion scripts and man pages.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use asperity_studies::settings::{Command as Named, settings_of};

use crate::support::{Folder, InFolder, MustContain, errors_of, files};

/// The flags of a command, without hyphens.
fn flags(command: Named) -> Vec<String> {
    settings_of(command)
        .filter_map(|setting| setting.flag_name())
        .collect()
}

/// The long flags that the completion script of a shell offers after a command, without hyphens.
fn offered(shell: &str, script: &str, command: Named) -> BTreeSet<String> {
    let name = command.name();
    let flags: Vec<&str> = match shell {
        // opts="-o --output ..." below the label of the command
        "bash" => {
            let label = format!("\n        asperity__subcmd__{name})\n");
            let section = script.split(&label).nth(1).unwrap();
            let options = section.lines().next().unwrap();
            let words = options.split(['"', ' ']);
            words.filter_map(|word| word.strip_prefix("--")).collect()
        }
        // '--output=[...]' or '(...)--output=[...]' below the label of the command
        "zsh" => {
            let section = script
                .split(&format!("({name})\n_arguments"))
                .nth(1)
                .unwrap();
            let section = section.split("\n&& ret=0").next().unwrap();
            let quoted = section.lines().filter_map(|line| line.strip_prefix('\''));
            quoted
                .filter_map(|line| {
                    let line = line.trim_start_matches('*');
                    let line = match line.strip_prefix('(') {
                        Some(others) => others.split_once(')')?.1,
                        None => line,
                    };
                    line.strip_prefix("--")?.split(['=', '[', '+']).next()
                })
                .collect()
        }
        // -l output on the lines of the command
        _ => {
            let line =
                format!("complete -c asperity -n \"__fish_asperity_using_subcommand {name}\" ");
            let options = script.lines().filter_map(|l| l.strip_prefix(&line));
            let long = options.filter_map(|options| options.split("-l ").nth(1));
            long.filter_map(|long| long.split(' ').next()).collect()
        }
    };
    flags.into_iter().map(str::to_owned).collect()
}

#[test]
fn every_example_of_settings_can_be_written() {
    let folder = Folder::new();
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    for entry in fs::read_dir(&examples).unwrap() {
        let path = entry.unwrap().path();
        let Some(name) = path.to_str().unwrap().strip_suffix(".toml") else {
            continue;
        };
        let name = Path::new(name).file_name().unwrap().to_str().unwrap();
        let text = fs::read_to_string(&path).unwrap();
        let text = text.replace(&format!("examples/{name}.toml"), &format!("{name}.toml"));
        let text = text.replace("examples/ripples.txt", "ripples.txt");
        let first = text.lines().next().unwrap().trim_start_matches("# ");
        let folder = Folder::new();
        let printed = folder.succeed(format!("example {name}"));
        assert_eq!(printed, format!("{name}.toml written: {first}\n"));
        let written = fs::read_to_string(folder.join(format!("{name}.toml"))).unwrap();
        assert_eq!(written, text);
    }
    // With the file that it reads
    folder.succeed("example trace_ripples");
    folder.succeed("trace trace_ripples.toml --rays 1e3 --quiet");
    folder.succeed("example first_look");
    folder
        .failed("example first_look")
        .must_contain("`first_look.toml` exists and is not replaced");
    folder.refused("example first").must_contain("first_look");
    folder
        .succeed("example")
        .must_contain("first_look: Rough glass");
}

#[test]
fn completion_scripts_offer_every_command_its_own_flags() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish"] {
        let script = folder.succeed(format!("completions {shell}"));
        for command in Named::ALL {
            let mut expected: BTreeSet<String> = flags(command).into_iter().collect();
            expected.insert("help".to_owned());
            expected.insert("help-all".to_owned());
            assert_eq!(
                offered(shell, &script, command),
                expected,
                "{shell}: {command}"
            );
        }
        for name in ["completions", "man", "brute-force", "xu-sun"] {
            assert!(script.contains(name), "{shell}: {name}");
        }
    }
    let said = folder.refused("completions tcsh");
    said.must_contain("`tcsh`: must be bash, zsh or fish");
    folder.refused("completions");
}

#[test]
fn bash_accepts_its_script() {
    let folder = Folder::new();
    let script = folder.succeed("completions bash");
    let started = Command::new("bash")
        .arg("-n")
        .stdin(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    let Ok(mut bash) = started else {
        println!("skipped: there is no bash");
        return;
    };
    let mut input = bash.stdin.take().unwrap();
    input.write_all(script.as_bytes()).unwrap();
    drop(input);
    let output = bash.wait_with_output().unwrap();
    let errors = errors_of(&output);
    assert!(output.status.success() && errors.is_empty(), "{errors}");
}

#[test]
fn man_writes_a_page_for_every_command() {
    let folder = Folder::new();
    assert_eq!(folder.succeed("man pages/man1"), "");
    let pages = folder.join("pages/man1");
    let names = Named::ALL.map(Named::name);
    let tools = ["example", "completions", "man", "devices"];
    let mut expected: Vec<String> = names.into_iter().chain(tools).map(page).collect();
    expected.push("asperity.1".to_owned());
    expected.sort();
    assert_eq!(files(&pages), expected);
    for page in &expected {
        pages.text(page).must_contain(".SH FILES\n.TP\n\\fI");
    }
    let main = pages.text("asperity.1");
    for command in Named::ALL {
        assert!(main.contains(&escaped(command.about())), "{command}");
        let page = pages.text(page(command.name()));
        assert!(
            page.contains("Print help\n") && !page.contains("see a summary"),
            "{page}"
        );
        for section in [
            "FILES",
            "\"EXIT STATUS\"",
            "EXAMPLES",
            "\"SEE ALSO\"",
            "VERSION",
        ] {
            assert!(
                page.contains(&format!(".SH {section}\n")),
                "{command} {section}"
            );
        }
        let example = escaped(&format!("asperity {command}"));
        page.must_contain(format!("\n{example} "));
        for flag in flags(command) {
            assert!(page.contains(&escaped(&flag)), "{command} {flag}");
        }
        let mut explained = Vec::new();
        for setting in settings_of(command) {
            let flag = setting.flag_name();
            // Of two settings of one flag the first stands for both.
            if flag.is_some() && !explained.contains(&flag) {
                let help = escaped(&setting.flag_help());
                assert!(page.contains(&help), "{command}: {help}");
                explained.push(flag);
            }
        }
    }
    // Pages of an earlier run are written anew.
    folder.succeed("man pages/man1");
    folder.write("file", "");
    folder.failed("man file").must_contain("file");
}

/// Nothing is written if one of the pages would replace a file of the user.
#[test]
fn man_replaces_no_file_but_its_own_pages() {
    let folder = Folder::new();
    fs::create_dir(folder.join("mine")).unwrap();
    let own = folder.join("mine/asperity-trace.1");
    for content in [
        &b"mine\n"[..],
        b"",
        b"\xff\xfe",
        b".TH other 1\n.SH asperity\n",
    ] {
        fs::write(&own, content).unwrap();
        let said = folder.failed("man mine");
        said.must_contain("asperity-trace.1` is not a man page of this program");
        assert_eq!(fs::read(&own).unwrap(), content);
        assert_eq!(files(&folder.join("mine")), ["asperity-trace.1"]);
    }
    fs::remove_file(&own).unwrap();
    folder.succeed("man mine");
    for name in files(&folder.join("mine")) {
        let page = fs::read_to_string(folder.join("mine").join(&name)).unwrap();
        assert!(
            page.lines().any(|line| line.starts_with(".TH asperity")),
            "{name}"
        );
    }
}

/// Text as pages write it.
fn escaped(text: &str) -> String {
    text.replace('-', "\\-")
}

/// Name of the page of a command.
fn page(command: &str) -> String {
    format!("asperity-{command}.1")
}

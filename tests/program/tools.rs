//! Completion scripts and man pages.

use std::fs;
use std::io::Write;
use std::process::{Command, Stdio};

use asperity_studies::settings::{Command as Named, settings_of};

use crate::support::{errors_of, files, refused, succeed};

/// The flags of a command, without hyphens.
fn flags(command: Named) -> Vec<String> {
    settings_of(command)
        .filter_map(|setting| setting.flag_name())
        .collect()
}

#[test]
fn completion_scripts_name_every_command_and_flag() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, long) in [("bash", "--"), ("zsh", "--"), ("fish", "-l ")] {
        let script = succeed(folder.path(), &["completions", shell]);
        for command in Named::ALL {
            assert!(script.contains(command.name()), "{shell}: {command}");
            for flag in flags(command) {
                let flag = format!("{long}{flag}");
                assert!(script.contains(&flag), "{shell}: {command} {flag}");
            }
        }
        for name in ["completions", "man", "brute-force", "xu-sun"] {
            assert!(script.contains(name), "{shell}: {name}");
        }
    }
    let said = refused(folder.path(), &["completions", "tcsh"], 2);
    assert!(said.contains("bash, zsh, fish"), "{said}");
    refused(folder.path(), &["completions"], 2);
}

#[test]
fn bash_accepts_its_script() {
    let folder = tempfile::tempdir().unwrap();
    let script = succeed(folder.path(), &["completions", "bash"]);
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
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert_eq!(succeed(folder, &["man", "pages/man1"]), "");
    let pages = folder.join("pages/man1");
    let names = Named::ALL.map(Named::name);
    let tools = ["completions", "man"];
    let mut expected: Vec<String> = names.into_iter().chain(tools).map(page).collect();
    expected.push("asperity.1".to_owned());
    expected.sort();
    assert_eq!(files(&pages), expected);
    let main = fs::read_to_string(pages.join("asperity.1")).unwrap();
    for command in Named::ALL {
        assert!(main.contains(&escaped(command.about())), "{command}");
        let page = fs::read_to_string(pages.join(page(command.name()))).unwrap();
        for flag in flags(command) {
            assert!(page.contains(&escaped(&flag)), "{command} {flag}");
        }
        let mut explained = Vec::new();
        for setting in settings_of(command) {
            let flag = setting.flag_name();
            // Of two settings of one flag the first stands for both.
            if flag.is_some() && !explained.contains(&flag) {
                let help = escaped(setting.help);
                assert!(page.contains(&help), "{command}: {help}");
                explained.push(flag);
            }
        }
    }
    // Pages of an earlier run are written anew.
    succeed(folder, &["man", "pages/man1"]);
    fs::write(folder.join("file"), "").unwrap();
    let said = refused(folder, &["man", "file"], 1);
    assert!(said.contains("file"), "{said}");
}

/// Text as pages write it.
fn escaped(text: &str) -> String {
    text.replace('-', "\\-")
}

/// Name of the page of a command.
fn page(command: &str) -> String {
    format!("asperity-{command}.1")
}

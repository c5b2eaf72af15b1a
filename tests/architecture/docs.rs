//! Documentation links: the relative links of READMEs and docs/, and the headings that they may lead to.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

use crate::sources::{crates, root};

/// The READMEs of crates and examples, the pages at the root of the workspace, and those of docs/ with its folders.
pub(crate) fn pages() -> Vec<PathBuf> {
    let crates = crates().into_iter().filter(|name| name != "asperity");
    let readmes = crates.map(|name| root().join("crates").join(name).join("README.md"));
    let mut pages: Vec<PathBuf> = readmes.collect();
    for name in [
        "README",
        "ARCHITECTURE",
        "CONTRIBUTING",
        "CHANGELOG",
        "examples/README",
        "examples/python/README",
    ] {
        pages.push(root().join(name).with_extension("md"));
    }
    let mut folders = vec![root().join("docs")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "md") {
                pages.push(path);
            }
        }
    }
    pages
}

/// Relative links of a page that lead to no file, or to no heading of one.
pub(crate) fn broken_links(page: &Path) -> Vec<String> {
    let text = fs::read_to_string(page).unwrap();
    let is_broken = |link: &&str| {
        let (file, anchor) = link.split_once('#').unwrap_or((link, ""));
        let target = match file {
            "" => page.to_owned(),
            file => page.with_file_name(file),
        };
        match anchor {
            "" => !target.exists(),
            anchor => {
                let text = fs::read_to_string(&target).unwrap_or_default();
                !anchors(&text).contains(anchor)
            }
        }
    };
    links(&text).filter(is_broken).map(str::to_owned).collect()
}

/// Targets of the links of a page that have no scheme, such as `https:`.
fn links(text: &str) -> impl Iterator<Item = &str> {
    let prose = prose(text).flat_map(|line| line.split("](").skip(1));
    let targets = prose.filter_map(|rest| rest.split_once(')').map(|(target, _)| target));
    targets.filter(|target| !target.contains(':'))
}

/// Lines outside of fenced code.
fn prose(text: &str) -> impl Iterator<Item = &str> {
    let mut is_code = false;
    text.lines().filter(move |line| {
        let is_fence = line.trim_start().starts_with("```");
        is_code ^= is_fence;
        !is_code && !is_fence
    })
}

/// Anchors of a page: those of its headings, as GitHub makes them, and explicit ones (`id="name"`).
fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in prose(text) {
        let explicit = line.split("id=\"").skip(1);
        found.extend(explicit.filter_map(|rest| Some(rest.split_once('"')?.0.to_owned())));
        let heading = line.trim_start_matches('#');
        if heading.len() == line.len() || !heading.starts_with(' ') {
            continue;
        }
        let is_kept = |c: &char| c.is_alphanumeric() || ['-', '_', ' '].contains(c);
        let slug: String = heading
            .trim()
            .to_lowercase()
            .chars()
            .filter(is_kept)
            .collect();
        let slug = slug.replace(' ', "-");
        let again = (1..).map(|k| format!("{slug}-{k}"));
        let mut names = std::iter::once(slug.clone()).chain(again);
        let free = names.find(|name| !found.contains(name));
        found.extend(free);
    }
    found
}

#[test]
fn headings_have_the_anchors_of_github() {
    let text = "# Spectra: `--psd`\n```sh\n# a comment\n```\n## When a run ends\n## When a run ends\n<a id=\"eta\"></a>\n";
    let expected = [
        "eta",
        "spectra---psd",
        "when-a-run-ends",
        "when-a-run-ends-1",
    ];
    assert_eq!(anchors(text), expected.map(str::to_owned).into());
    let text = "[a](b.md#c) and ![d](e.png)\n```\n[f](g)\n```\n[h](https://i)";
    assert_eq!(links(text).collect::<Vec<_>>(), ["b.md#c", "e.png"]);
}

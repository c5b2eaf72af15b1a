//! Sources: the Rust files of a crate, without comments, without the contents of strings, and without test code.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Root of the workspace.
pub(crate) fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Names of the crates, which are the folders in `crates/`.
pub(crate) fn crates() -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .map(|path| path.file_name().unwrap().to_str().unwrap().to_owned())
        .collect();
    names.sort();
    names
}

/// Every Rust file below a folder, sorted; build output is left out.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() && path.file_name().is_some_and(|name| name != "target") {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The code of each module of a crate by its path, `a::b`; that of the crate's root is empty.
pub(crate) type Modules = BTreeMap<String, String>;

/// The modules of a crate, without those that are compiled for tests alone.
pub(crate) fn modules(name: &str) -> Modules {
    let folder = root().join("crates").join(name);
    let mut folders = [folder.join("src"), folder].into_iter();
    let sources = folders.find(|folder| folder.join("lib.rs").exists());
    let sources = sources.unwrap();
    let mut modules = Modules::new();
    for path in rust_files(&sources) {
        let relative = path.strip_prefix(&sources).unwrap().with_extension("");
        let mut parts: Vec<&str> = relative.iter().map(|part| part.to_str().unwrap()).collect();
        if parts == ["lib"] {
            parts.pop();
        }
        modules.insert(parts.join("::"), bare(&fs::read_to_string(&path).unwrap()));
    }
    without_tests(modules)
}

/// The modules without items under `#[cfg(test)]`, and without the files of modules that are declared so.
pub(crate) fn without_tests(modules: Modules) -> Modules {
    let mut tests = Vec::new();
    let mut kept = Modules::new();
    for (module, code) in modules {
        let (code, declared) = split_tests(&code);
        for name in declared {
            tests.push(if module.is_empty() {
                name
            } else {
                format!("{module}::{name}")
            });
        }
        kept.insert(module, code);
    }
    kept.retain(|module, _| {
        !tests
            .iter()
            .any(|test| module == test || module.starts_with(&format!("{test}::")))
    });
    kept
}

/// Code without the items under `#[cfg(test)]`, and the names of modules among these that have their own file.
fn split_tests(code: &str) -> (String, Vec<String>) {
    const MARK: &str = "#[cfg(test)]";
    let (mut kept, mut declared, mut rest) = (String::new(), Vec::new(), code);
    while let Some(at) = rest.find(MARK) {
        kept.push_str(&rest[..at]);
        let item = &rest[at + MARK.len()..];
        let end = end_of_item(item);
        let text = item[..end].trim();
        if let Some((_, name)) = text.trim_end_matches(';').rsplit_once("mod ")
            && text.ends_with(';')
        {
            declared.push(name.trim().to_owned());
        }
        rest = &item[end..];
    }
    kept.push_str(rest);
    (kept, declared)
}

/// Offset of the end of an item: the first `;` outside of braces, or the brace that closes its first one.
fn end_of_item(item: &str) -> usize {
    let mut depth = 0_usize;
    for (at, c) in item.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth <= 1 => return at + 1,
            '}' => depth -= 1,
            ';' if depth == 0 => return at + 1,
            _ => {}
        }
    }
    item.len()
}

/// Code without comments and without what stands in strings and characters.
pub(crate) fn bare(text: &str) -> String {
    let mut code = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let skipped = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            rest.find("*/").map_or(rest.len(), |end| end + 2)
        } else if c == '"' {
            end_of_string(rest)
        } else if let Some(end) = raw_string(rest, &code) {
            end
        } else if let Some(end) = character(rest) {
            end
        } else {
            code.push(c);
            rest = &rest[c.len_utf8()..];
            continue;
        };
        if c != '/' {
            code.push_str("\"\"");
        }
        rest = &rest[skipped..];
    }
    code
}

fn end_of_string(text: &str) -> usize {
    let mut escaped = false;
    for (at, c) in text.char_indices().skip(1) {
        match c {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => return at + 1,
            _ => {}
        }
    }
    text.len()
}

/// Offset of the end of a raw string that begins here.
fn raw_string(text: &str, before: &str) -> Option<usize> {
    let hashes = text.strip_prefix('r')?;
    let count = hashes.len() - hashes.trim_start_matches('#').len();
    let inside = hashes[count..].strip_prefix('"')?;
    if before.ends_with(|c: char| c.is_alphanumeric() || c == '_') && !before.ends_with('b') {
        return None;
    }
    let close = format!("\"{}", "#".repeat(count));
    let end = inside
        .find(&close)
        .map_or(inside.len(), |at| at + close.len());
    Some(text.len() - inside.len() + end)
}

/// Offset of the end of a character that begins here; a lifetime is none.
fn character(text: &str) -> Option<usize> {
    let inside = text.strip_prefix('\'')?;
    let mut chars = inside.char_indices();
    match chars.next()? {
        (_, '\\') => inside[2..].find('\'').map(|end| end + 4),
        (_, c) => inside[c.len_utf8()..]
            .starts_with('\'')
            .then_some(c.len_utf8() + 2),
    }
}

/// Returns `true` if code has `word` as an identifier of its own.
pub(crate) fn has_word(code: &str, word: &str) -> bool {
    code.split(|c: char| !(c.is_alphanumeric() || c == '_'))
        .any(|found| found == word)
}

#[test]
fn comments_strings_and_tests_are_no_code() {
    let text = r##"
        use a::b; // unsafe
        /* unsafe */ const S: &str = "unsafe \" unsafe"; const R: &str = r#"unsafe "#;
        const C: [char; 2] = ['"', '\''];
        fn f<'a>(x: &'a str) {}
        #[cfg(test)]
        mod tests { fn unsafe_one() { unsafe {} } }
        #[cfg(test)]
        mod others;
        fn kept() {}
    "##;
    let mut modules = Modules::new();
    modules.insert("m".to_owned(), bare(text));
    modules.insert("m::others".to_owned(), String::new());
    modules.insert("m::others::deep".to_owned(), String::new());
    let kept = without_tests(modules);
    assert_eq!(kept.keys().collect::<Vec<_>>(), ["m"]);
    let code = &kept["m"];
    assert!(!has_word(code, "unsafe"), "{code}");
    assert!(code.contains("use a::b;") && code.contains("fn kept()") && code.contains("&'a str"));
}

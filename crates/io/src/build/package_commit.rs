//! Commit of a package: that of `.cargo_vcs_info.json`, which cargo puts beside the manifest of a package.

/// Returns the commit that `text` names, with `-dirty` if files were changed since.
pub(crate) fn package_commit(text: &str) -> Option<String> {
    let text: String = text.split_whitespace().collect();
    let (_, rest) = text.split_once("\"sha1\":\"")?;
    let (commit, _) = rest.split_once('"')?;
    let is_commit = commit.len() >= 40 && commit.chars().all(|c| c.is_ascii_hexdigit());
    let mark = if text.contains("\"dirty\":true") {
        "-dirty"
    } else {
        ""
    };
    is_commit.then(|| commit.to_owned() + mark)
}

#[test]
fn commits_of_packages_are_read() {
    let hash = "0123456789abcdef0123456789abcdef01234567";
    let text = |rest: &str| {
        format!(
            "{{\n  \"git\": {{\n    \"sha1\": \"{hash}\"{rest}\n  }},\n  \"path_in_vcs\": \"crates/io\"\n}}"
        )
    };
    assert_eq!(package_commit(&text("")).as_deref(), Some(hash));
    let dirty = package_commit(&text(",\n    \"dirty\": true"));
    assert_eq!(dirty, Some(format!("{hash}-dirty")));
    for text in ["", "{}", "{\"git\": {\"sha1\": \"main\"}}"] {
        assert_eq!(package_commit(text), None, "{text}");
    }
}

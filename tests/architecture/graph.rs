//! Import graph: which modules of a crate use which others, and where they use each other in a circle.
//!
//! A name that a module re-exports counts as what it stands for. A module and those inside it are one idea in
//! several files, so uses between them are no edges.

use std::collections::{BTreeMap, BTreeSet};

use crate::sources::Modules;

/// For each module the modules that it uses.
pub(crate) type Graph = BTreeMap<String, BTreeSet<String>>;

/// The import graph of the modules of one crate.
pub(crate) fn graph(modules: &Modules) -> Graph {
    let re_exports = re_exports(modules);
    let mut graph = Graph::new();
    for (module, code) in modules {
        // The root lists what the crate offers.
        if module.is_empty() {
            continue;
        }
        let used = paths(code)
            .into_iter()
            .filter_map(|path| absolute(module, &path))
            .filter_map(|path| module_of(modules, &re_exports, path))
            .filter(|used| !is_inside(used, module) && !is_inside(module, used))
            .collect();
        graph.insert(module.clone(), used);
    }
    graph
}

/// Groups of modules each of which uses, over others, all modules of its group.
pub(crate) fn cycles(graph: &Graph) -> BTreeSet<Vec<String>> {
    let reached: BTreeMap<&String, BTreeSet<&String>> = graph
        .keys()
        .map(|module| (module, reachable(graph, module)))
        .collect();
    let mut cycles = BTreeSet::new();
    for (module, from_here) in &reached {
        let group: Vec<String> = from_here
            .iter()
            .filter(|other| {
                reached
                    .get(*other)
                    .is_some_and(|back| back.contains(module))
            })
            .map(|other| (*other).clone())
            .collect();
        if group.len() > 1 {
            cycles.insert(group);
        }
    }
    cycles
}

fn reachable<'a>(graph: &'a Graph, from: &str) -> BTreeSet<&'a String> {
    let mut found = BTreeSet::new();
    let mut waiting: Vec<&String> = graph[from].iter().collect();
    while let Some(module) = waiting.pop() {
        if found.insert(module) {
            waiting.extend(graph.get(module).into_iter().flatten());
        }
    }
    found
}

fn is_inside(module: &str, other: &str) -> bool {
    module == other || module.starts_with(&format!("{other}::"))
}

/// What each re-exported name, by its path from the root, stands for.
fn re_exports(modules: &Modules) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for (module, code) in modules {
        for tree in uses(code).filter_map(|(is_public, tree)| is_public.then_some(tree)) {
            for path in expand(&tree) {
                let (path, name) = renamed(&path);
                let relative = format!("self::{path}");
                let known = ["crate::", "self::", "super::"];
                let is_rooted = known.iter().any(|prefix| path.starts_with(prefix));
                let path = if is_rooted { &path } else { &relative };
                if let Some(target) = absolute(module, path) {
                    found.insert(join(module, &name), target);
                }
            }
        }
    }
    found
}

/// The path of `a::b as c`, and the name that it gets.
fn renamed(path: &str) -> (String, String) {
    match path.split_once(" as ") {
        Some((path, name)) => (path.trim().to_owned(), name.trim().to_owned()),
        None => {
            let name = path.rsplit("::").next().unwrap_or(path);
            (path.to_owned(), name.to_owned())
        }
    }
}

/// The module in which the thing at a path from the root is.
fn module_of(
    modules: &Modules,
    re_exports: &BTreeMap<String, String>,
    mut path: String,
) -> Option<String> {
    // Re-exports of re-exports are few.
    for _ in 0..8 {
        let prefixes = prefixes(&path);
        if let Some((prefix, target)) = prefixes
            .iter()
            .find_map(|prefix| re_exports.get(*prefix).map(|target| (*prefix, target)))
            && !target.starts_with(prefix)
            && !modules.contains_key(prefix)
        {
            path = format!("{target}{}", &path[prefix.len()..]);
            continue;
        }
        return prefixes
            .into_iter()
            .find(|prefix| modules.contains_key(*prefix))
            .map(str::to_owned);
    }
    None
}

/// `a::b::c`, `a::b` and `a`.
fn prefixes(path: &str) -> Vec<&str> {
    let mut found = vec![path];
    while let Some((rest, _)) = found[found.len() - 1].rsplit_once("::") {
        found.push(rest);
    }
    found
}

fn join(module: &str, name: &str) -> String {
    if module.is_empty() {
        name.to_owned()
    } else {
        format!("{module}::{name}")
    }
}

/// A path from the root of the crate; `None` if it leads out of the crate.
fn absolute(module: &str, path: &str) -> Option<String> {
    let (path, _) = renamed(path);
    let mut parts = path.split("::").map(str::trim).peekable();
    let mut base: Vec<&str> = module.split("::").filter(|part| !part.is_empty()).collect();
    match parts.next()? {
        "crate" => base.clear(),
        "self" => {}
        "super" => {
            base.pop();
            while parts.next_if_eq(&"super").is_some() {
                base.pop();
            }
        }
        _ => return None,
    }
    base.extend(parts.filter(|part| *part != "self"));
    Some(base.join("::"))
}

/// All paths that code names: those of its `use` declarations, and those that begin with `crate`, `self` or
/// `super` elsewhere, or with the crate `std`.
pub(crate) fn paths(code: &str) -> Vec<String> {
    let mut found: Vec<String> = uses(code).flat_map(|(_, tree)| expand(&tree)).collect();
    let is_path = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
    for word in code.split(|c: char| !is_path(c)) {
        if ["crate::", "self::", "super::", "std::"]
            .iter()
            .any(|prefix| word.starts_with(prefix))
        {
            found.push(word.trim_end_matches(':').to_owned());
        }
    }
    found
}

/// The trees of `use` declarations, and whether they are re-exports.
fn uses(code: &str) -> impl Iterator<Item = (bool, String)> + '_ {
    code.split_inclusive(';').filter_map(|statement| {
        let line = statement.rfind("use ")?;
        let before = &statement[..line];
        let starts = before
            .rsplit(['\n', '{', '}', ';'])
            .next()
            .unwrap_or_default()
            .trim();
        let is_declaration = starts.is_empty() || starts.starts_with("pub");
        is_declaration.then(|| {
            let tree = statement[line + 4..].trim_end_matches(';');
            (starts.starts_with("pub"), tree.to_owned())
        })
    })
}

/// The paths of a `use` tree.
fn expand(tree: &str) -> Vec<String> {
    let tree = tree.trim();
    let Some((prefix, inner)) = tree.split_once('{') else {
        return vec![tree.split_whitespace().collect::<Vec<_>>().join(" ")];
    };
    let inner = inner.rsplit_once('}').map_or(inner, |(inner, _)| inner);
    let (mut depth, mut start, mut parts) = (0_usize, 0, Vec::new());
    for (at, c) in inner.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                parts.push(&inner[start..at]);
                start = at + 1;
            }
            _ => {}
        }
    }
    parts.push(&inner[start..]);
    parts
        .into_iter()
        .filter(|part| !part.trim().is_empty())
        .flat_map(|part| expand(&format!("{}{}", prefix.trim(), part.trim())))
        .collect()
}

#[cfg(test)]
fn invented(modules: &[(&str, &str)]) -> Graph {
    let owned = |(name, code): &(&str, &str)| ((*name).to_owned(), (*code).to_owned());
    graph(&modules.iter().map(owned).collect())
}

#[test]
fn cycles_are_found_through_re_exports_and_inline_paths() {
    let found = invented(&[
        ("", "pub use a::deep::Thing;"),
        ("a", "mod deep; fn f() { super::b::g() }"),
        ("a::deep", "use super::other; pub struct Thing;"),
        ("b", "use {\n    crate::c::{self, One},\n};"),
        ("c", "pub(crate) use crate::Thing as Another;"),
        ("d", "use crate::c::Another;"),
    ]);
    assert_eq!(found["d"], BTreeSet::from(["a::deep".to_owned()]));
    // A folder and what is inside it are one: a uses b, b uses c, c uses a::deep.
    assert_eq!(found["c"], BTreeSet::from(["a::deep".to_owned()]));
    assert!(cycles(&found).is_empty());
    let found = invented(&[
        ("a", "use crate::b;"),
        ("b", "fn f(x: crate::c::X) {}"),
        ("c", "use super::a::{Y, Z};"),
        ("d", "use crate::a;"),
    ]);
    let cycle = ["a", "b", "c"].map(str::to_owned).to_vec();
    assert_eq!(cycles(&found), BTreeSet::from([cycle]));
}

//! Import graph: the modules that each module of a crate uses, and the cycles among them.
//!
//! A name that a module imports or re-exports stands for the item itself: `crate::X` and `super::X` lead to the module
//! that defines `X`. Parents and children are modules like any others. `mod child;` and `pub use child::X` are no uses
//! of the child, but a parent that names `X` in its own code uses it.

use std::collections::{BTreeMap, BTreeSet};

use crate::sources::{Modules, has_word};

/// For each module the modules that it uses; the name of the root is empty.
pub(crate) type Graph = BTreeMap<String, BTreeSet<String>>;

/// The import graph of the modules of one crate.
pub(crate) fn graph(modules: &Modules) -> Graph {
    let names = Names::of(modules);
    let used = |module: &String, code: &String| names.used(module, code);
    let edges = modules.iter().map(|(m, code)| (m.clone(), used(m, code)));
    edges.collect()
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

/// Names that the modules of a crate know.
struct Names<'a> {
    modules: &'a Modules,
    /// Targets of imported and re-exported names, by the path of the name; `None` in another crate.
    aliases: BTreeMap<String, Option<String>>,
    /// Modules from which a module takes all names.
    globs: BTreeMap<&'a str, Vec<String>>,
}

impl<'a> Names<'a> {
    fn of(modules: &'a Modules) -> Self {
        let mut names = Self {
            modules,
            aliases: BTreeMap::new(),
            globs: BTreeMap::new(),
        };
        let mut aliases = BTreeMap::new();
        for (module, code) in modules {
            for path in uses(code).flat_map(|(_, tree)| expand(&tree)) {
                let (path, name) = renamed(&path);
                let target = names.absolute(module, &path);
                if name != "*" {
                    aliases.insert(join(module, &name), target);
                } else if let Some(from) = target {
                    let globs = names.globs.entry(module).or_default();
                    globs.push(from.trim_end_matches("::*").to_owned());
                }
            }
        }
        names.aliases = aliases;
        names
    }

    /// The modules that `module` uses: those that define what it imports, or names in its code.
    fn used(&self, module: &str, code: &str) -> BTreeSet<String> {
        let body = without_uses(code);
        let mut used = BTreeSet::new();
        for (is_public, tree) in uses(code) {
            for path in expand(&tree) {
                let found = self.used_at(module, &path);
                let is_inside = |used: &String| used.starts_with(&join(module, ""));
                let is_offered = is_public && !has_word(&body, &renamed(&path).1);
                used.extend(found.filter(|used| !(is_offered && is_inside(used))));
            }
        }
        let words = body.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        let inline = words.filter(|word| word.contains("::"));
        used.extend(inline.filter_map(|word| self.used_at(module, word.trim_end_matches(':'))));
        // Of a glob count the names that stand in the code.
        for from in self.globs.get(module).into_iter().flatten() {
            let words = body.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            let words = words.filter(|word| !word.is_empty() && !defines(code, word));
            used.extend(words.filter_map(|word| self.defining(from, word)));
        }
        used.remove(module);
        used
    }

    /// The module that defines the item at a path in `module`. A module or glob that is imported is used
    /// where its items are named.
    fn used_at(&self, module: &str, path: &str) -> Option<String> {
        let path = self.absolute(module, path)?;
        let is_item = !self.modules.contains_key(&path) && !path.ends_with("::*");
        is_item.then(|| self.defining_module(path)).flatten()
    }

    /// The module that defines `name`, as far as the module `from` offers it.
    fn defining(&self, from: &str, name: &str) -> Option<String> {
        let path = join(from, name);
        let found = self.defining_module(path)?;
        let code = self.modules.get(&found)?;
        defines(code, name).then_some(found)
    }

    /// The module that defines the item at a path from the root; `None` for items of other crates.
    fn defining_module(&self, mut path: String) -> Option<String> {
        // Re-exports of re-exports are few.
        for _ in 0..8 {
            let is_module = |prefix: &str| self.modules.contains_key(prefix);
            let alias = prefixes(&path).into_iter().find_map(|prefix| {
                let target = self.aliases.get(prefix).filter(|_| !is_module(prefix))?;
                Some((prefix, target.as_ref()))
            });
            if let Some((prefix, target)) = alias {
                path = format!("{}{}", target?, &path[prefix.len()..]);
                continue;
            }
            let module = prefixes(&path).into_iter().find(|prefix| is_module(prefix));
            let module = module.unwrap_or_default();
            let rest = path[module.len()..].trim_start_matches(':');
            let name = rest.split("::").next().unwrap_or_default();
            let code = self.modules.get(module)?;
            if defines(code, name) {
                return Some(module.to_owned());
            }
            let mut globs = self.globs.get(module).into_iter().flatten();
            return globs
                .find_map(|from| self.defining(from, name))
                .or_else(|| (!module.is_empty()).then(|| module.to_owned()));
        }
        None
    }

    /// A path from the root of the crate; `None` if it leads out of the crate.
    fn absolute(&self, module: &str, path: &str) -> Option<String> {
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
            first => {
                let name = join(module, first);
                if !self.modules.contains_key(&name) && !self.aliases.contains_key(&name) {
                    return None;
                }
                base.push(first);
            }
        }
        base.extend(parts);
        Some(base.join("::"))
    }
}

/// Returns `true` if code has an item `name`, outside of any braces.
fn defines(code: &str, name: &str) -> bool {
    const ITEMS: [&str; 9] = [
        "fn",
        "struct",
        "enum",
        "trait",
        "type",
        "const",
        "static",
        "union",
        "macro_rules",
    ];
    let (mut depth, mut keyword) = (0_usize, false);
    for part in code.split_inclusive(|c: char| !(c.is_alphanumeric() || c == '_')) {
        let word = part.trim_end_matches(|c: char| !(c.is_alphanumeric() || c == '_'));
        if !word.is_empty() {
            if keyword && depth == 0 && word == name {
                return true;
            }
            keyword = ITEMS.contains(&word);
        }
        match part.chars().last() {
            Some('{') => depth += 1,
            Some('}') => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    false
}

/// The path of `a::b as c`, and the name that it gets.
fn renamed(path: &str) -> (String, String) {
    let (path, name) = path.split_once(" as ").unwrap_or((path, ""));
    let path = path.trim();
    let path = path.strip_suffix("::self").unwrap_or(path);
    let last = path.rsplit("::").next().unwrap_or(path);
    let name = if name.is_empty() { last } else { name.trim() };
    (path.to_owned(), name.to_owned())
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

/// The trees of `use` declarations, and `true` for re-exports.
fn uses(code: &str) -> impl Iterator<Item = (bool, String)> + '_ {
    code.split_inclusive(';').filter_map(|statement| {
        let (at, is_public) = declaration(statement)?;
        let tree = statement[at..].trim_end_matches(';');
        Some((is_public, tree.to_owned()))
    })
}

/// Code without its `use` declarations.
fn without_uses(code: &str) -> String {
    let statements = code.split_inclusive(';');
    let kept = |statement| declaration(statement).map_or(statement, |(at, _)| &statement[..at]);
    statements.map(kept).collect()
}

/// Offset of the tree of a `use` declaration in its statement, and `true` if that is a re-export.
fn declaration(statement: &str) -> Option<(usize, bool)> {
    let at = statement.rfind("use ")?;
    let before = &statement[..at];
    let start = before.rsplit(['\n', '{', '}', ';']).next()?.trim();
    (start.is_empty() || start.starts_with("pub")).then(|| (at + 4, start.starts_with("pub")))
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
fn uses_lead_through_imports_and_re_exports_to_the_defining_module() {
    let found = invented(&[
        ("", "pub use a::deep::Thing; pub use glob::*; use std::fs;"),
        ("a", "pub mod deep; fn f() { super::b::g() }"),
        (
            "a::deep",
            "use super::other; pub struct Thing; const fn other() {}",
        ),
        (
            "b",
            "use {\n    crate::c::{self, One},\n}; fn g() { c::f(One) } use crate::fs;",
        ),
        (
            "c",
            "pub(crate) use crate::Thing as Another; pub struct One; pub fn f() {}",
        ),
        ("d", "use crate::c::Another; use crate::{Two, Three};"),
        ("glob", "pub use self::deep::*; struct Two;"),
        ("glob::deep", "struct Three;"),
        ("e", "use super::glob::*; fn f(x: Three) {}"),
        ("f", "use crate::a; fn f(x: a::deep::Thing) {}"),
    ]);
    let expected = [
        ("a", &["b"][..]),
        // What `a` does not define might come from a macro of it.
        ("a::deep", &["a"]),
        ("b", &["c"]),
        ("c", &["a::deep"]),
        ("d", &["a::deep", "glob", "glob::deep"]),
        ("e", &["glob::deep"]),
        ("f", &["a::deep"]),
        ("glob", &[]),
        ("", &[]),
    ];
    for (module, used) in expected {
        let found: Vec<&str> = found[module].iter().map(String::as_str).collect();
        assert_eq!(found, used, "{module}");
    }
}

#[test]
fn cycles_of_modules_and_of_parents_and_children_are_found() {
    let found = invented(&[
        ("a", "use crate::b;  fn f() { b::g() }"),
        ("b", "fn f(x: crate::c::X) {}"),
        ("c", "use super::a::{Y, Z};"),
        ("d", "use crate::a::Y;"),
    ]);
    let cycle = ["a", "b", "c"].map(str::to_owned).to_vec();
    assert_eq!(cycles(&found), BTreeSet::from([cycle]));

    let child = ("a::b", "use super::Limit; pub struct Thing;");
    let offers = "mod b; pub use b::Thing; pub struct Limit;";
    let by_path = "mod b; pub struct Limit; fn f(x: b::Thing) {}";
    let by_name = "mod b; pub use self::b::Thing; pub struct Limit; fn f(x: Thing) {}";
    let elsewhere = "mod b; use crate::c::Limit; fn f(x: b::Thing) {}";
    for (parent, is_cycle) in [
        (offers, false),
        (by_path, true),
        (by_name, true),
        (elsewhere, false),
    ] {
        let found = invented(&[("a", parent), child, ("c", "pub struct Limit;")]);
        assert_eq!(cycles(&found).len(), usize::from(is_cycle), "{parent}");
    }
}

//! Commands of docs/recipes/exports.md, as they stand there but for the number of rays.

use std::fs;
use std::path::Path;

use crate::support::{Folder, InFolder};

/// Lines of the blocks of commands.
fn commands(section: &str) -> impl Iterator<Item = &str> {
    let blocks = section.split("```sh\n").skip(1);
    blocks.flat_map(|block| block.split("```").next().unwrap().lines())
}

#[test]
fn every_recipe_runs() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = fs::read_to_string(root.join("docs/recipes/exports.md")).unwrap();
    let folder = Folder::new();
    folder.succeed("generate --tau 8um --sigma 1um --size 64 --seed 7 -o scan.x3p --quiet");
    for section in page.split("\n## ").skip(1) {
        assert!(commands(section).count() > 0, "{section}");
        for command in commands(section) {
            let line = command.strip_prefix("asperity ").unwrap();
            let few = match line.split_once(' ').unwrap().0 {
                "export" => "",
                _ if line.contains("--surface") => "--rays 1e4 --no-plots",
                _ => "--rays 1e3 --realisations 2 --no-plots",
            };
            folder.succeed(format!("{line} {few} --quiet"));
            let (_, output) = line.rsplit_once(" -o ").unwrap();
            assert!(folder.join(output).exists(), "{command}");
        }
    }
}

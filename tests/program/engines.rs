//! Engines: results are equal on all of them, and a request for a GPU fails with one sentence on a machine without one.

use asperity_results::ResultSet;

use crate::support::{Folder, InFolder, MustContain, errors_of, files};

const RUN: &str = "verify --smoothness 2 --theta 40 --size 64 --tau 8 --realisations 2 --rays 4000 --models none --no-plots";

/// Returns `true` if this machine has a GPU that traces light.
fn has_gpu(folder: &Folder) -> bool {
    folder.succeed("devices").contains(", ready")
}

#[test]
fn devices_are_listed() {
    let folder = Folder::new();
    let listed = folder.succeed("devices");
    listed.must_contain("CPU: ");
    listed.must_contain("instructions\nGPU");
    folder.refused("devices 1").must_contain("1");
}

#[test]
fn results_are_the_same_on_any_engine() {
    let folder = Folder::new();
    for engine in ["cpu", "auto"] {
        let output = folder.run(format!("{RUN} --engine {engine} -o {engine} --verbose"));
        assert!(output.status.success());
        let says_where = errors_of(&output).contains("engine: ");
        assert_eq!(says_where, engine == "auto", "{}", errors_of(&output));
    }
    let bytes = |engine: &str| {
        let results = ResultSet::read(folder.join(engine)).unwrap();
        results.comparable_bytes().unwrap()
    };
    assert!(bytes("cpu") == bytes("auto"));
    // The engine is no part of what results are of
    folder.succeed(format!("{RUN} --engine auto -o cpu"));
}

#[test]
fn a_requested_gpu_must_be_there() {
    let folder = Folder::new();
    if has_gpu(&folder) {
        folder.succeed(format!("{RUN} --engine gpu"));
        return;
    }
    let error = folder.failed(format!("{RUN} --engine gpu -o out"));
    error.must_contain("asperity: --engine gpu: ");
    error.must_contain("; --engine auto uses the CPU instead");
    folder.succeed(format!("{RUN} --engine gpu --plan-only -o plan"));
    assert!(!files(&folder).contains(&"out".to_owned()));
    folder
        .refused(format!("{RUN} --engine cuda"))
        .must_contain("auto, cpu or gpu");
    folder.refused("attenuation --sigma 0.2 --engine cpu");
}

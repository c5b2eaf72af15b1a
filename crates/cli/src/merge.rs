//! `asperity merge`: the results of a run from those of its shards.

use asperity_studies::settings::{Command, Document};
use asperity_studies::{
    AlbedoStudy, AttenuationStudy, ConvergeStudy, GonioStudy, MapStudy, ShardFolders, TraceStudy,
    VerifyStudy,
};

use crate::common::{Common, Results};
use crate::end::End;
use crate::failure::Failure;
use crate::output_files::refuse_input;
use crate::study::merge;

pub(crate) fn run(document: &Document, common: &Common) -> Result<End, Failure> {
    let results = &Results::of(document).map_err(Failure::usage)?;
    refuse_input(&results.required(), document)?;
    let shards = &ShardFolders::of(document).map_err(|error| Failure::of_study(document, error))?;
    match shards.document.command() {
        Command::Trace => merge::<TraceStudy>(shards, results, common),
        Command::Verify => merge::<VerifyStudy>(shards, results, common),
        Command::Map => merge::<MapStudy>(shards, results, common),
        Command::Gonio => merge::<GonioStudy>(shards, results, common),
        Command::Albedo => merge::<AlbedoStudy>(shards, results, common),
        Command::Converge => merge::<ConvergeStudy>(shards, results, common),
        Command::Attenuation => merge::<AttenuationStudy>(shards, results, common),
        other => Err(Failure::failed(format!("{other} has no shards"))),
    }
}

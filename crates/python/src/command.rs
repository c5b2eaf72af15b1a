//! Command: runs a command of the program with keyword arguments, and returns its results.

use std::path::{Path, PathBuf};

use asperity_io::{
    MeshFormat, PictureFormat, ResultFolder, check_ending, check_output_file, json_text,
    write_bytes,
};
use asperity_page::Page;
use asperity_results::Container;
use asperity_simulate::{Deadline, Observer};
use asperity_studies::settings::{Command, Document};
use asperity_studies::{
    AlbedoStudy, AttenuationStudy, ChosenEngine, ConvergeStudy, ExportConfig, Findings,
    GeneratePlan, GonioStudy, InspectConfig, MapStudy, MaterialsConfig, MeshConfig, ModelConfig,
    OneOrMany, RenderConfig, RenderPlan, Resolution, ShardFolders, Study, TraceStudy, VerifyStudy,
    Views, WorkPlan, evaluate_model, is_plan_only, material_list, material_list_text, model_list,
    open_results, share_of, time_limit, trace_shard,
};
use asperity_surface::RawHeightMap;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arguments::{Call, command_of, document_of};
use crate::errors::Failure;
use crate::height_map::HeightMap;
use crate::watch::{Watched, watched};

/// Results of a command: text for people, JSON, a table as CSV, a height map, notes, and the exception that stopped it.
#[pyclass(frozen, get_all, module = "asperity._core")]
#[derive(Default)]
pub(crate) struct Output {
    /// Text as the program prints it.
    text: String,
    /// Results as JSON; empty if the command has none.
    json: String,
    /// Rows as CSV; empty if the command has none.
    table: String,
    /// Height map.
    height_map: Option<Py<HeightMap>>,
    /// Notes, one sentence each.
    notes: Vec<String>,
    /// `False` if a stop came before there was any result.
    has_results: bool,
    /// The exception that stopped the run.
    interrupt: Option<Py<PyAny>>,
}

/// Results of a command, without the interpreter.
#[derive(Default)]
struct Found {
    text: String,
    json: String,
    table: String,
    height_map: Option<HeightMap>,
    notes: Vec<String>,
}

impl Found {
    fn of_text(text: String) -> Self {
        Self {
            text,
            ..Self::default()
        }
    }
}

fn json(value: &impl Serialize) -> Result<String, Failure> {
    json_text(value).map_err(|error| Failure::Failed(error.to_string()))
}

/// Runs the command `name`. `progress` is called with the name of a stage, the steps done and the steps in all, or is `None`.
///
/// Studies write their files into the folder that the argument `output` names. A signal, or an exception that `progress` raises, ends
/// them with the results so far, which `interrupt` of the output tells.
#[pyfunction]
#[pyo3(signature = (name, call, progress = None))]
pub(crate) fn run(
    py: Python<'_>,
    name: &str,
    call: Call,
    progress: Option<Bound<'_, PyAny>>,
) -> PyResult<Output> {
    let command = command_of(name)?;
    let document = document_of(command, &call);
    let document = &document.map_err(|failure| failure.in_python(&call.flags))?;
    let threads = document.value("program.threads");
    let threads = threads.and_then(|threads| threads.as_u64()?.try_into().ok());
    let Watched { result, interrupt } = watched(py, threads, progress.as_ref(), |observer| {
        dispatch(document, &call, observer)
    })?;
    let interrupt = interrupt.map(|exception| exception.into_value(py).into_any());
    let found = match (result, &interrupt) {
        (Ok(found), _) => found,
        (Err(Failure::Stopped(_)), Some(_)) => {
            return Ok(Output {
                interrupt,
                ..Output::default()
            });
        }
        (Err(failure), _) => return Err(failure.in_python(&call.flags)),
    };
    Ok(Output {
        text: found.text,
        json: found.json,
        table: found.table,
        height_map: found.height_map.map(|map| Py::new(py, map)).transpose()?,
        notes: found.notes,
        has_results: true,
        interrupt,
    })
}

fn dispatch(document: &Document, call: &Call, observer: &dyn Observer) -> Result<Found, Failure> {
    let shards = match document.command() {
        Command::Merge => {
            let shards = ShardFolders::of(document);
            Some(shards.map_err(|error| Failure::of_study(document, error))?)
        }
        _ => None,
    };
    let run = StudyRun {
        document: shards.as_ref().map_or(document, |shards| &shards.document),
        output: document,
        shards: shards.as_ref(),
        call,
        observer,
    };
    match run.document.command() {
        Command::Trace => run.study::<TraceStudy>(),
        Command::Verify => run.study::<VerifyStudy>(),
        Command::Map => run.study::<MapStudy>(),
        Command::Gonio => run.study::<GonioStudy>(),
        Command::Albedo => run.study::<AlbedoStudy>(),
        Command::Converge => run.study::<ConvergeStudy>(),
        Command::Attenuation => run.study::<AttenuationStudy>(),
        Command::Generate => generate(document),
        Command::Inspect => inspect(document, observer),
        Command::Mesh => mesh(document, observer),
        Command::Render => render(document, observer),
        Command::Model => model(document),
        Command::Materials => materials(document),
        Command::Export => export(document),
        Command::Report => report(document),
        Command::Merge => Err(Failure::value("shards of a merge have no shards")),
    }
}

/// Where results go.
#[derive(Deserialize)]
struct Results {
    output: Option<PathBuf>,
}

fn output(document: &Document) -> Result<PathBuf, Failure> {
    #[derive(Deserialize)]
    struct Whole {
        results: Results,
    }
    let results = document.read::<Whole>()?.results;
    results
        .output
        .ok_or_else(|| Failure::value("--output is missing"))
}

/// The run of a study, or the merge of its shards.
struct StudyRun<'a> {
    /// Settings of the study.
    document: &'a Document,
    /// Settings that name the folder.
    output: &'a Document,
    shards: Option<&'a ShardFolders>,
    call: &'a Call,
    observer: &'a dyn Observer,
}

impl StudyRun<'_> {
    /// Runs a study in its folder: resumes what an earlier run has finished, runs the rest and writes all files.
    fn study<S: Study>(&self) -> Result<Found, Failure> {
        let document = self.document;
        let refused = |error| Failure::of_study(document, error);
        let engine = ChosenEngine::open(document).map_err(refused)?;
        let observer = &Deadline::new(self.observer, time_limit(document)?);
        let study = S::plan(document, observer).map_err(refused)?;
        let is_plan_only = is_plan_only(document);
        let share = share_of(document).filter(|_| !is_plan_only);
        let names = match share {
            _ if is_plan_only => WorkPlan::views().names(),
            Some(_) => Vec::new(),
            None => {
                let views = study.views().map_err(|error| refused(error.into()))?;
                views.names()
            }
        };
        let inputs = [document.input_files(), self.output.input_files()].concat();
        let inputs: Vec<&Path> = inputs.iter().map(PathBuf::as_path).collect();
        let arguments = self.call.command_line(self.output.command());
        let command = document.command().name();
        let folder =
            ResultFolder::open(output(self.output)?, command, &inputs)?.with_arguments(arguments);
        folder.check(names)?;
        let results = open_results(&study, document, &folder).map_err(refused)?;
        let mut results = results.on(engine.engine());
        let mut notes = [study.notes(), results.notes()].concat();
        if let Some(shards) = self.shards {
            notes.extend(shards.merge_into::<S>(&mut results).map_err(refused)?);
        }
        let found = match share {
            _ if is_plan_only => {
                let plan = WorkPlan::of(&study, document, &mut results, observer);
                plan.map_err(refused)
                    .and_then(|plan| shown(&plan, &WorkPlan::views(), &folder, observer))
            }
            Some(share) => {
                let traced = trace_shard(&study, share, &mut results, observer);
                traced.map_err(refused).and_then(|traced| {
                    folder.finish(false)?;
                    Ok(Found {
                        text: traced.text(),
                        json: json(&traced)?,
                        ..Found::default()
                    })
                })
            }
            None => judged(&study, &mut results, &folder, document, observer),
        };
        if matches!(found, Err(Failure::Stopped(_)))
            && results.close_early().map_err(Failure::file)?
        {
            folder.finish(false)?;
        }
        notes.extend(engine.note());
        Ok(Found { notes, ..found? })
    }
}

/// Runs what results lack, and writes all files.
fn judged<S: Study>(
    study: &S,
    results: &mut Container<'_, S::Kept>,
    folder: &ResultFolder,
    document: &Document,
    observer: &dyn Observer,
) -> Result<Found, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let findings = study.run(results, observer).map_err(refused)?;
    let views = study.views().map_err(|error| refused(error.into()))?;
    shown(&findings, &views, folder, observer)
}

/// Writes the files of findings.
fn shown<F: Findings + Sync>(
    findings: &F,
    views: &Views<'_, F>,
    folder: &ResultFolder,
    observer: &dyn Observer,
) -> Result<Found, Failure> {
    views.write(folder, findings, observer)?;
    folder.finish(findings.stopped_by().is_none())?;
    Ok(Found {
        text: findings.text(),
        json: json(&findings.summary())?,
        ..Found::default()
    })
}

fn generate(document: &Document) -> Result<Found, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let plan = GeneratePlan::new(document).map_err(refused)?;
    let mut map = RawHeightMap::from(plan.draw(0).map_err(refused)?);
    map.notes = plan.notes().to_vec();
    Ok(Found {
        height_map: Some(map.into()),
        ..Found::default()
    })
}

fn inspect(document: &Document, observer: &dyn Observer) -> Result<Found, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config = InspectConfig::new(document).map_err(refused)?;
    let found = config.inspect(document, observer).map_err(refused)?;
    let (text, json) = (found.text(), json(&found.statistics)?);
    let mut map = RawHeightMap::from(found.field);
    map.y_is_north = found.y_is_north;
    map.notes = found.statistics.notes;
    Ok(Found {
        json,
        height_map: Some(map.into()),
        ..Found::of_text(text)
    })
}

fn mesh(document: &Document, observer: &dyn Observer) -> Result<Found, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let (config, path): (MeshConfig, _) = (document.read()?, output(document)?);
    MeshFormat::of_output(&path)?;
    check_output_file(&path)?;
    let files = config.files(document).map_err(refused)?;
    let (file, _) = files[0];
    let mesh = config
        .triangles(file, document, observer)
        .map_err(refused)?;
    mesh.write(&path)?;
    Ok(Found::of_text(mesh.text(&path)))
}

fn render(document: &Document, observer: &dyn Observer) -> Result<Found, Failure> {
    let refused = |error| Failure::of_study(document, error);
    let config = RenderConfig::new(document).map_err(refused)?;
    for path in config.picture.output.as_slice() {
        PictureFormat::from_path(path)?;
        check_output_file(path)?;
    }
    let plan = RenderPlan::new(&config, document, observer).map_err(refused)?;
    let rendered = plan.render(observer).map_err(refused)?;
    Ok(Found::of_text(rendered.text()))
}

fn model(document: &Document) -> Result<Found, Failure> {
    let config: ModelConfig = document.read()?;
    if !document.is_given("model.name") {
        let list = model_list().map_err(|error| Failure::Failed(error.to_string()))?;
        return Ok(Found {
            json: json(&list)?,
            ..Found::default()
        });
    }
    let model = evaluate_model(&config, document, Resolution::Directions)?;
    Ok(Found {
        text: model.report(None),
        json: json(&model.summary(None))?,
        table: model.table().text(),
        notes: model.notes().to_vec(),
        ..Found::default()
    })
}

fn materials(document: &Document) -> Result<Found, Failure> {
    let config: MaterialsConfig = document.read()?;
    let (text, json) = match config.sheet()? {
        Some(sheet) => (sheet.text(), json(&sheet.json())?),
        None => {
            let list = material_list();
            (material_list_text(&list), json(&list)?)
        }
    };
    Ok(Found {
        json,
        ..Found::of_text(text)
    })
}

fn export(document: &Document) -> Result<Found, Failure> {
    let (config, path): (ExportConfig, _) = (document.read()?, output(document)?);
    check_output_file(&path)?;
    let exported = config.export(&path)?;
    exported.write(&path)?;
    Ok(Found {
        json: json(&exported.summary())?,
        ..Found::of_text(exported.text(&path))
    })
}

fn report(document: &Document) -> Result<Found, Failure> {
    #[derive(Deserialize)]
    struct Whole {
        report: Selection,
    }
    #[derive(Deserialize)]
    struct Selection {
        folders: Option<OneOrMany<PathBuf>>,
    }
    let path = output(document)?;
    check_ending(&path, "pages", &["html"])?;
    check_output_file(&path)?;
    let folders = document.read::<Whole>()?.report.folders;
    let page = Page::of(folders.as_ref().map_or(&[][..], OneOrMany::as_slice))?;
    page.check_output(&path)?;
    write_bytes(&path, page.html()?.as_bytes())?;
    Ok(Found::default())
}

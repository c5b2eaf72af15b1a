//! Study: the steps that every study takes, from a document of settings to files, text and JSON.

use std::time::Duration;

use asperity_io::ResultFolder;
use asperity_results::{Container, Header, Stored, coordinates};
use asperity_simulate::{
    Case, CaseColumn, CaseGroup, Deadline, Observer, PlannedWork, StoppedBy, SurfaceSource, counted,
};
use asperity_surface::LengthUnit;
use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::config::error::ConfigError;
use crate::config::values::Seconds;
use crate::error::StudyError;
use crate::report::headline::with_tables;
use crate::report::views::Views;
use crate::settings::{Document, SettingError};

/// A study that is planned: everything is checked, and nothing is traced.
pub trait Study: Sized {
    /// The results that are kept, one per case.
    type Kept: Stored;
    /// The results, judged.
    type Findings<'a>: Findings + Sync
    where
        Self: 'a;

    /// Reads the configuration and the surfaces of a document, and plans the study. Files that are read are explained to `observer`.
    ///
    /// # Errors
    /// [`StudyError`] if a value is invalid, two contradict each other, a file cannot be read, surfaces cannot be drawn or held, or
    /// `observer` gives the first result up.
    fn plan(document: &Document, observer: &dyn Observer) -> Result<Self, StudyError>;

    /// Notes for the user on the files that were read, one sentence each.
    fn notes(&self) -> &[String] {
        &[]
    }

    /// The files that the study writes.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is invalid.
    fn views<'a>(&self) -> Result<Views<'a, Self::Findings<'a>>, ConfigError>
    where
        Self: 'a;

    /// Identity of the results, by which a later run resumes them.
    ///
    /// # Errors
    /// [`ConfigError`] if a value is invalid.
    fn header(&self) -> Result<Header, ConfigError>;

    /// Opens the results of an earlier run of this study and `header` in a folder. Complete results of other settings are replaced, unless the study
    /// extends them by further cases.
    ///
    /// # Errors
    /// [`StudyError`] if they are of another study or results epoch, or cannot be read.
    fn open<'f>(
        &self,
        folder: &'f ResultFolder,
        header: Header,
    ) -> Result<Container<'f, Self::Kept>, StudyError> {
        Ok(Container::open(folder, header)?)
    }

    /// The surfaces of the first case, and the unit of their lengths.
    fn first_surfaces(&self) -> Option<(SurfaceSource, LengthUnit)>;

    /// Computes what `found` lacks, as far as it is in its share, until `observer` stops it. A time limit of the settings is the observer's to
    /// keep; the study shares it out.
    ///
    /// # Errors
    /// [`StudyError`] if a case cannot be computed, or a stop comes before there is any result.
    fn compute(
        &self,
        found: &mut Container<'_, Self::Kept>,
        observer: &dyn Observer,
    ) -> Result<(), StudyError>;

    /// Plans the work that `found` lacks.
    ///
    /// # Errors
    /// [`StudyError`] if a case cannot be planned, or `observer` stops a pilot run.
    fn plan_work(
        &self,
        found: &mut Container<'_, Self::Kept>,
        observer: &dyn Observer,
    ) -> Result<Vec<PlannedRow>, StudyError>;

    /// Judges results, which may be incomplete.
    ///
    /// # Errors
    /// [`StudyError`] if a case cannot be judged.
    fn judge<'a>(
        &'a self,
        found: &'a Container<'_, Self::Kept>,
        observer: &dyn Observer,
    ) -> Result<Self::Findings<'a>, StudyError>;

    /// Computes what `found` lacks, writes its file, and judges all of it.
    ///
    /// # Errors
    /// Those of [`Self::compute`] and [`Self::judge`], and [`StudyError`] if the file cannot be written.
    fn run<'a>(
        &'a self,
        found: &'a mut Container<'_, Self::Kept>,
        observer: &dyn Observer,
    ) -> Result<Self::Findings<'a>, StudyError> {
        self.compute(found, observer)?;
        if let Some((surfaces, unit)) = self.first_surfaces() {
            found.keep_thumbnail(&surfaces, unit, observer)?;
        }
        found.close()?;
        self.judge(found, observer)
    }
}

/// Work that is planned for a case.
#[derive(Clone, Debug)]
pub struct PlannedRow {
    pub(crate) columns: Vec<CaseColumn>,
    pub(crate) work: PlannedWork,
}

impl PlannedRow {
    /// Rows of cases.
    pub(crate) fn of_cases(cases: &[Case], work: Vec<PlannedWork>) -> Vec<Self> {
        let row = |work: PlannedWork| Self {
            columns: coordinates(&cases[work.case]),
            work,
        };
        work.into_iter().map(row).collect()
    }

    /// Row that its number tells from others: a surface, or a run.
    pub(crate) fn numbered(name: &str, work: PlannedWork) -> Self {
        let column = CaseColumn {
            group: CaseGroup::Light,
            name: name.to_owned(),
            unit: String::new(),
            about: format!("number of the {name}"),
            value: json!(work.case),
        };
        Self {
            columns: vec![column],
            work,
        }
    }
}

/// The surfaces of the first of `cases`, and the unit of their lengths.
pub(crate) fn first_of(cases: &[Case]) -> Option<(SurfaceSource, LengthUnit)> {
    let first = cases.first()?;
    Some((first.surface.clone(), first.at.unit))
}

/// Time after which the run of a document is to end; `None` without a limit.
///
/// # Errors
/// [`SettingError`] if settings do not go together.
pub fn time_limit(document: &Document) -> Result<Option<Duration>, SettingError> {
    #[derive(Default, Deserialize)]
    struct Run {
        max_time: Option<Seconds>,
    }
    #[derive(Deserialize)]
    struct Whole {
        #[serde(default)]
        run: Run,
    }
    let limit = document.read::<Whole>()?.run.max_time;
    Ok(limit.and_then(Seconds::duration))
}

/// Ends tracing before the time of a run is over, if other work `follows`: the last tenth is left for comparisons with models and for
/// figures, of short times the last third, up to two seconds.
pub(crate) fn tracing(
    observer: &dyn Observer,
    whole: Option<Seconds>,
    follows: bool,
) -> Deadline<'_> {
    let to_trace =
        |whole: Duration| whole - (whole / 10).max((whole / 3).min(Duration::from_secs(2)));
    let whole = whole.and_then(Seconds::duration).filter(|_| follows);
    Deadline::new(observer, whole.map(to_trace))
}

/// The results of a study, judged.
pub trait Findings {
    /// The contents of summary.json.
    fn summary(&self) -> impl Serialize;

    /// The answer in at most five lines: light, models, errors, and what is left out.
    fn headline(&self) -> Vec<String>;

    /// Tables for people, the most important first.
    fn tables(&self) -> String;

    /// Headline and tables: report.txt.
    fn text(&self) -> String {
        with_tables(&self.headline(), &self.tables())
    }

    /// Reason why the run ended before all that was planned was done.
    fn stopped_by(&self) -> Option<StoppedBy>;

    /// Clause that says what is finished of a run that was stopped; `None` where results say it.
    fn progress(&self) -> Option<String> {
        None
    }

    /// Line that says what was done in which time.
    fn work(&self) -> Option<String> {
        None
    }
}

/// Clause that says how many of the cases are finished: "1 of 4 cells is finished".
pub(crate) fn finished(done: usize, total: usize, noun: &str) -> String {
    let are = if done == 1 || total == 1 { "is" } else { "are" };
    format!("{done} of {} {are} finished", counted(total as u64, noun))
}

//! Story: what was asked, what was found and how sure that is, in sentences.

mod gonio;
mod light;
mod map;
mod others;
mod sentences;

use crate::cases::Case;
use crate::error::PageError;
use crate::folder::Folder;
use crate::words;

pub(crate) use self::sentences::Story;

/// The story of a folder.
pub(crate) fn story(folder: &Folder, cases: &[Case]) -> Result<Story, PageError> {
    let mut story = match folder.command() {
        "gonio" => gonio::story(folder, cases),
        "map" => map::story(folder),
        "converge" => others::converge(folder),
        "attenuation" => others::attenuation(folder)?,
        "albedo" => others::albedo(folder)?,
        "inspect" => others::inspect(folder),
        _ => light::story(folder, cases),
    };
    if !folder.is_complete() {
        let ended = "The run was ended before it was complete: these are the results so far.";
        story.sure.push(ended.to_owned());
    }
    let of_cases = cases.iter().map(|case| &case.summary["warnings"]);
    for warnings in [&folder.summary["warnings"]].into_iter().chain(of_cases) {
        for warning in words::texts(warnings) {
            let warning = words::sentence(&warning);
            if !story.sure.contains(&warning) {
                story.sure.push(warning);
            }
        }
    }
    Ok(story)
}

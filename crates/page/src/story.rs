//! Story: the headline of results, and notes on them.

use crate::cases::Case;
use crate::folder::Folder;
use crate::words;

/// Headings with their sentences.
pub(crate) type Story = Vec<(&'static str, Vec<String>)>;

/// The story of a folder.
pub(crate) fn story(folder: &Folder, cases: &[Case]) -> Story {
    let headline = words::texts(&folder.summary["headline"]);
    let headline = headline.iter().map(|line| words::line(line)).collect();
    let mut notes: Vec<String> = Vec::new();
    if !folder.is_complete() {
        notes.push(
            "The run was ended before it was complete: these are the results so far.".to_owned(),
        );
    }
    if cases
        .iter()
        .any(|case| case.summary["validity"]["holds"] == false)
    {
        notes.push("Geometric optics is doubtful: lengths are not large against the wavelength, or light stays coherent.".to_owned());
    }
    let of_cases = cases.iter().map(|case| &case.summary["warnings"]);
    for warnings in [&folder.summary["warnings"]].into_iter().chain(of_cases) {
        for warning in words::texts(warnings) {
            let warning = words::sentence(&warning);
            if !notes.contains(&warning) {
                notes.push(warning);
            }
        }
    }
    let story = [("Summary", headline), ("Notes", notes)];
    story
        .into_iter()
        .filter(|(_, sentences)| !sentences.is_empty())
        .collect()
}

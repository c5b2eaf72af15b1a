//! Channels of files that have several: the one that is read is named.

use crate::text_lines::short;

/// Note on the channel that is read of a file of several, and on those that are not.
pub(crate) fn note_on_channels(chosen: usize, names: &[String]) -> Option<String> {
    let others: Vec<String> = (0..names.len())
        .filter(|k| *k != chosen)
        .map(|k| format!("`{}`", short(&names[k])))
        .collect();
    let (last, rest) = others.split_last()?;
    let listed = match rest {
        [] => last.clone(),
        _ => format!("{} and {last}", rest.join(", ")),
    };
    Some(format!(
        "channel {} of {}, `{}`, is read, not {listed}",
        chosen + 1,
        names.len(),
        short(&names[chosen])
    ))
}

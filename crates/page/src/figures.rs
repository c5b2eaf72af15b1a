//! Figures: the SVG files of a folder with captions, as many as the page has room for.

use std::io::Write;

use asperity_plot::HeightMapFigure;
use asperity_results::Thumbnail;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;

use crate::cases::Case;
use crate::error::PageError;
use crate::folder::Folder;
use crate::svg;

/// Length of what stands about a figure, in bytes.
const FRAME: usize = 600;

/// Text of a figure.
pub(crate) enum Drawing {
    /// SVG.
    Plain(String),
    /// SVG compressed by zlib, in base64.
    Packed(String),
}

impl Drawing {
    fn packed(svg: &str) -> std::io::Result<Self> {
        let mut encoder = ZlibEncoder::new(Vec::new(), Compression::best());
        encoder.write_all(svg.as_bytes())?;
        Ok(Self::Packed(STANDARD.encode(encoder.finish()?)))
    }

    const fn len(&self) -> usize {
        match self {
            Self::Plain(text) | Self::Packed(text) => text.len(),
        }
    }
}

/// A figure as the page shows it.
pub(crate) struct Figure {
    pub(crate) drawing: Drawing,
    pub(crate) caption: &'static str,
    /// Name of the file.
    pub(crate) file: String,
    /// Tables that hold its numbers.
    pub(crate) data: &'static str,
    /// `true` if another case is shown first.
    pub(crate) is_hidden: bool,
    /// Number of the case that it is of, if it is of one.
    pub(crate) case: Option<usize>,
    /// Polar angle of the light that it is of, if it is of one angle.
    pub(crate) theta: Option<f64>,
}

/// The figures of a folder.
pub(crate) struct Figures {
    pub(crate) figures: Vec<Figure>,
    /// Names of those for which there is no room.
    pub(crate) left_out: Vec<String>,
}

/// Kinds of figures, the most telling first, a line each: the beginning of the names of files, tables with the numbers, the caption.
const KINDS: &str = include_str!("../templates/captions.tsv");

/// A kind of figures.
#[derive(Clone, Copy, Default)]
struct Kind {
    begins: &'static str,
    data: &'static str,
    caption: &'static str,
}

impl Kind {
    /// The kind of a file with its place in the order; empty, and last, of files that are not known.
    fn of(name: &str) -> (usize, Self) {
        let file = name.rsplit('/').next().unwrap_or(name);
        let kinds = KINDS.lines().enumerate().filter_map(|(rank, line)| {
            let (begins, rest) = line.split_once('\t')?;
            let (data, caption) = rest.split_once('\t')?;
            file.starts_with(begins).then_some((
                rank,
                Self {
                    begins,
                    data,
                    caption,
                },
            ))
        });
        // The longest name counts.
        let longest = kinds.max_by_key(|(_, kind)| kind.begins.len());
        longest.unwrap_or((usize::MAX, Self::default()))
    }
}

/// The figures of a folder, whose cases are numbered from `first`, of at most `room` bytes. A figure that is too large for it is left out.
/// `has_surface`: whether the page shows the first surface, in place of its height map.
pub(crate) fn figures(
    folder: &Folder,
    cases: &[Case],
    first: usize,
    mut room: usize,
    has_surface: bool,
) -> Result<Figures, PageError> {
    let is_shown = |name: &&String| {
        name.ends_with(".svg") && !(has_surface && name.ends_with("height_map.svg"))
    };
    let names = folder.files.iter().filter(is_shown);
    let mut names: Vec<(usize, &String)> = names.map(|name| (Kind::of(name).0, name)).collect();
    names.sort();
    let mut found = Figures {
        figures: Vec::new(),
        left_out: Vec::new(),
    };
    for (_, name) in names {
        let Some(text) = folder.text(name)? else {
            continue;
        };
        let damaged = |reason| PageError::Damaged {
            path: folder.path.join(name),
            reason,
        };
        let svg = svg::sanitized(&text).map_err(damaged)?;
        let case = cases
            .iter()
            .position(|case| !case.folder.is_empty() && name.starts_with(&case.folder));
        let theta = theta(name);
        let is_hidden = case.is_some_and(|case| case > 0)
            || theta.is_some_and(|theta| cases.first().is_some_and(|case| !case.is_at(theta)));
        let is_packed = is_hidden || svg.len() + FRAME > room;
        let drawing = match is_packed {
            true => Drawing::packed(&svg).map_err(|error| damaged(error.to_string()))?,
            false => Drawing::Plain(svg),
        };
        if drawing.len() + FRAME > room {
            found.left_out.push(name.clone());
            continue;
        }
        room -= drawing.len() + FRAME;
        let (_, Kind { caption, data, .. }) = Kind::of(name);
        found.figures.push(Figure {
            drawing,
            caption,
            file: name.clone(),
            data,
            is_hidden,
            case: case.map(|case| first + case),
            theta,
        });
    }
    Ok(found)
}

/// The height map of the first surface; `None` if the results have none.
pub(crate) fn surface(folder: &Folder) -> Result<Option<String>, PageError> {
    if !folder.has_results() {
        return Ok(None);
    }
    let Some(thumbnail) = Thumbnail::read(&folder.path)? else {
        return Ok(None);
    };
    let Thumbnail {
        heights,
        shape,
        extent,
        unit,
    } = thumbnail;
    let figure = HeightMapFigure {
        title: "The first surface".into(),
        subtitle: String::new(),
        heights: &heights,
        shape,
        spacing: [extent[1] / shape[0] as f64, extent[0] / shape[1] as f64],
        unit: unit.symbol().into(),
        y_up: false,
    };
    Ok(Some(figure.draw()?.svg()?))
}

/// The polar angle in a name such as `profiles_theta30_reflected.svg`; folders are those of cases.
fn theta(name: &str) -> Option<f64> {
    let file = name.rsplit('/').next()?.trim_end_matches(".svg");
    let (_, after) = file.split_once("_theta")?;
    after.split('_').next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_kind_and_angle() {
        let kind = |name| Kind::of(name).1.begins;
        assert_eq!(kind("lobes.svg"), "lobes");
        assert_eq!(
            kind("s2_n1.5_theta30/in_plane_reflected.svg"),
            "in_plane_reflected"
        );
        assert_eq!(kind("plots/lobe_theta30_reflected.svg"), "lobe_");
        assert_eq!(kind("unknown.svg"), "");
        assert_eq!(theta("plots/lobe_theta2.5_reflected.svg"), Some(2.5));
        assert_eq!(theta("convergence.svg"), None);
        assert_eq!(theta("s2_n1.5_theta30/lobes.svg"), None);
    }
}

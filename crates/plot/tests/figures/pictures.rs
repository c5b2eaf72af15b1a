//! The figures in docs/figures: drawn as figures are drawn today.
//!
//! docs/figures.txt has a line per picture: its file, the kind of figure, a hash of the pixels of a sample of that kind when the picture was drawn,
//! and the command that draws it. A kind that is drawn differently has another hash.

use std::collections::BTreeSet;
use std::fmt::Write;
use std::io::Cursor;
use std::path::Path;
use std::{env, fs};

use asperity_plot::{
    DiscBins, Figure, Hemisphere, Hemispheres, MapVerdict, MappedCell, Point, ProfileComponent,
    ProfileGrid, Relief, Reliefs, SharedColours, Side, Sides, Stroke, ValidityMap,
};

use crate::{curves, diagram, error_over_time, in_plane};

const DOCS: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs");
/// Mark of a picture whose run is too long to have been repeated since figures of its kind have changed.
const OUTDATED: &str = "outdated";

/// A sample of a kind of figure; `None` for pictures that are no figures.
fn sample(kind: &str) -> Option<Figure> {
    let title = "Sample".to_owned();
    let figure = match kind {
        "render" => return None,
        "PolarLobes" => in_plane::polar(in_plane::both_sides(2.0), Sides::Both).draw(),
        "Curves" => curves::sample().draw(),
        "InPlaneCurves" => in_plane::curves(in_plane::both_sides(2.0)).draw(),
        "Diagram" => diagram::diagram(Stroke::Arrow, vec![[-1.0, -1.0], [1.0, 1.0]]).draw(),
        "ErrorOverTime" => error_over_time::sample().draw(),
        "Hemispheres" => {
            let cell = |most: f64| {
                Some(Hemisphere {
                    bins: DiscBins::equal([3, 4]),
                    values: (0..12).map(|i| Some(most * f64::from(i) / 11.0)).collect(),
                    few_rays: vec![],
                    light_deg: Some(0.0),
                    note: "R = 10 %".into(),
                })
            };
            Hemispheres {
                title,
                subtitle: "n = 1.5".into(),
                quantity: "BRDF".into(),
                side: Side::Reflected,
                row_title: "angle of incidence".into(),
                column_title: "mean free path".into(),
                rows: vec!["30°".into()],
                columns: vec!["1".into(), "2".into()],
                colours: SharedColours::Rows,
                cells: vec![cell(1.0), cell(0.5)],
            }
            .draw()
        }
        "ProfileGrid" => {
            let points = (-9..=9).map(|i| Point::with_error(f64::from(10 * i), 0.1, Some(0.01)));
            let component = |name: &str| ProfileComponent {
                name: name.into(),
                points: vec![points.clone().collect(); 2],
            };
            ProfileGrid {
                title,
                subtitle: "n = 1.5".into(),
                quantity: "BRDF".into(),
                panels: vec!["1".into(), "2".into()],
                light_deg: Some(-30.0),
                mirror_deg: Some(30.0),
                components: ["all", "once", "twice", "more"].map(component).to_vec(),
            }
            .draw()
        }
        "Reliefs" => Reliefs {
            title,
            subtitle: String::new(),
            columns: 1,
            panels: vec![Relief {
                caption: "waves".into(),
                shape: [20, 30],
                spacing: 1.0,
                heights: (0..600).map(|i| (0.3 * f64::from(i)).sin()).collect(),
            }],
        }
        .draw(),
        "ValidityMap" => ValidityMap {
            title,
            subtitle: "n = 1.5".into(),
            models: vec!["smith".into()],
            materials: vec!["n = 1.5".into()],
            roughness_label: "smoothness s".into(),
            roughness: vec![1.0, 2.0],
            theta_deg: vec![0.0, 30.0],
            tolerance: 0.01,
            cells: [
                MapVerdict::Within,
                MapVerdict::Beyond,
                MapVerdict::NotResolved,
            ]
            .map(|verdict| {
                Some(MappedCell {
                    distance: 0.02,
                    verdict,
                })
            })
            .into_iter()
            .chain([None])
            .collect(),
        }
        .draw(),
        other => panic!("docs/figures.txt names an unknown kind of figure, {other}"),
    };
    Some(figure.unwrap())
}

/// FNV-1a of the pixels of a figure: files that are compressed otherwise have the same.
fn hash(figure: &Figure) -> String {
    let file = Cursor::new(figure.png().unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let step = |hash: u64, byte: &u8| (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3);
    let hash = pixels.iter().fold(0xcbf2_9ce4_8422_2325, step);
    format!("{hash:016x}")
}

#[test]
fn pictures_of_docs_are_drawn_as_figures_are_today() {
    let list = Path::new(DOCS).join("figures.txt");
    let text = fs::read_to_string(&list).unwrap();
    let (mut updated, mut changed, mut listed) = (String::new(), String::new(), BTreeSet::new());
    for line in text.lines() {
        let fields: Vec<&str> = line.split('\t').collect();
        let [file, kind, recorded, command] = fields[..] else {
            let _ = writeln!(updated, "{line}");
            continue;
        };
        listed.insert(file.to_owned());
        let today = sample(kind).map_or_else(|| "-".to_owned(), |figure| hash(&figure));
        if recorded != today && recorded != OUTDATED {
            let _ = writeln!(changed, "docs/figures/{file}: {command}");
        }
        let kept = if recorded == OUTDATED {
            recorded
        } else {
            &today
        };
        let _ = writeln!(updated, "{file}\t{kind}\t{kept}\t{command}");
    }
    let files = fs::read_dir(Path::new(DOCS).join("figures"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name());
    let files = files.map(|name| name.to_string_lossy().into_owned());
    let pictures: BTreeSet<String> = files.filter(|name| name.ends_with(".png")).collect();
    assert_eq!(
        listed, pictures,
        "docs/figures.txt lists other pictures than docs/figures has"
    );
    if env::var_os("UPDATE_DOCS").is_some() {
        fs::write(&list, updated).unwrap();
        return;
    }
    assert!(
        changed.is_empty(),
        "figures are drawn differently than when these pictures were; draw them with these commands, look at them, and record it \
         with `UPDATE_DOCS=1 cargo test -p asperity-plot --test figures pictures`:\n{changed}"
    );
}

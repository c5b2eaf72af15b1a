//! List of the materials that are known by name.

use asperity_io::{MaterialRecord, materials};
use serde::Serialize;

use super::constants::range_nm;
use crate::output::{Column, Table, wrapped};

/// A material of the list, with ranges of the wavelength in nanometres.
#[derive(Clone, Debug, Serialize)]
pub struct ListedMaterial {
    name: &'static str,
    aliases: &'static [String],
    record: &'static str,
    source: &'static str,
    doi: Option<&'static str>,
    n_range_nm: [f64; 2],
    k_range_nm: Option<[f64; 2]>,
}

/// All materials that are known by name.
#[must_use]
pub fn material_list() -> Vec<ListedMaterial> {
    let listed = |material: &'static MaterialRecord| ListedMaterial {
        name: &material.name,
        aliases: &material.aliases,
        record: &material.record,
        source: &material.cite,
        doi: material.doi.as_deref(),
        n_range_nm: range_nm(material.constants.n()),
        k_range_nm: material.constants.k().map(range_nm),
    };
    materials().iter().map(listed).collect()
}

/// The list as a table for people, at most 80 characters wide.
#[must_use]
pub fn material_list_text(list: &[ListedMaterial]) -> String {
    let range = |[first, last]: [f64; 2]| format!("{}-{}", first.ceil(), last.floor());
    let about = "wavelengths at which it is known, whole nanometres";
    let table = Table::new()
        .column(Column::new("name", "name", |row: &&ListedMaterial| {
            row.name
        }))
        .column(
            Column::new("n (nm)", about, move |row: &&ListedMaterial| {
                range(row.n_range_nm)
            })
            .unit("nm"),
        )
        .column(
            Column::new("k (nm)", about, move |row: &&ListedMaterial| {
                row.k_range_nm.map(range)
            })
            .unit("nm"),
        )
        .column(Column::new(
            "source",
            "first author and year",
            |row: &&ListedMaterial| row.source,
        ))
        .column(Column::new(
            "other names",
            "names that are understood as well",
            |row: &&ListedMaterial| row.aliases.join(", "),
        ));
    let note = "-: k is unknown, which is not zero. `asperity materials NAME` shows n and k.";
    format!("{}\n{}\n", table.folded_text(list), wrapped(note))
}

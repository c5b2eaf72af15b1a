//! Embedded materials: one file per material in `crates/io/materials/`.

use std::sync::OnceLock;

use super::material_record::MaterialRecord;
use super::record;

/// Text of each file, in the order of the list.
const FILES: &[&str] = &[
    include_str!("../../materials/Al.yml"),
    include_str!("../../materials/Ag.yml"),
    include_str!("../../materials/Au.yml"),
    include_str!("../../materials/Cu.yml"),
    include_str!("../../materials/Cr.yml"),
    include_str!("../../materials/Fe.yml"),
    include_str!("../../materials/Ni.yml"),
    include_str!("../../materials/Ti.yml"),
    include_str!("../../materials/Co.yml"),
    include_str!("../../materials/V.yml"),
    include_str!("../../materials/Mn.yml"),
    include_str!("../../materials/Pd.yml"),
    include_str!("../../materials/Pt.yml"),
    include_str!("../../materials/W.yml"),
    include_str!("../../materials/Mo.yml"),
    include_str!("../../materials/Zn.yml"),
    include_str!("../../materials/stainless-steel.yml"),
    include_str!("../../materials/ferritic-steel.yml"),
    include_str!("../../materials/TiN.yml"),
    include_str!("../../materials/Si.yml"),
    include_str!("../../materials/Ge.yml"),
    include_str!("../../materials/GaAs.yml"),
    include_str!("../../materials/GaP.yml"),
    include_str!("../../materials/InP.yml"),
    include_str!("../../materials/SiC.yml"),
    include_str!("../../materials/Si3N4.yml"),
    include_str!("../../materials/ITO.yml"),
    include_str!("../../materials/SiO2.yml"),
    include_str!("../../materials/BK7.yml"),
    include_str!("../../materials/soda-lime-glass.yml"),
    include_str!("../../materials/PMMA.yml"),
    include_str!("../../materials/PC.yml"),
    include_str!("../../materials/PDMS.yml"),
    include_str!("../../materials/PET.yml"),
    include_str!("../../materials/TiO2.yml"),
    include_str!("../../materials/Al2O3.yml"),
    include_str!("../../materials/ZnO.yml"),
    include_str!("../../materials/MgO.yml"),
    include_str!("../../materials/CaF2.yml"),
    include_str!("../../materials/MgF2.yml"),
    include_str!("../../materials/BaF2.yml"),
    include_str!("../../materials/ZnSe.yml"),
    include_str!("../../materials/ZnS.yml"),
    include_str!("../../materials/NaCl.yml"),
    include_str!("../../materials/diamond.yml"),
    include_str!("../../materials/water.yml"),
    include_str!("../../materials/ice.yml"),
    include_str!("../../materials/air.yml"),
];

/// All embedded materials, read at the first call.
pub(super) fn all() -> &'static [MaterialRecord] {
    static ALL: OnceLock<Vec<MaterialRecord>> = OnceLock::new();
    // No file is left out: a test reads them all
    ALL.get_or_init(|| {
        FILES
            .iter()
            .filter_map(|text| record::parse(text).ok())
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_citation_is_of_the_reference() {
        for record in all() {
            let mut words = record.cite.split(' ');
            assert!(
                words.all(|word| !word.is_empty() && record.source.contains(word)),
                "{record:?}"
            );
        }
    }

    #[test]
    fn every_embedded_file_is_read() {
        for text in FILES {
            let read = record::parse(text);
            assert!(read.is_ok(), "{:?} in {}", read.err(), &text[..300]);
        }
        assert_eq!(all().len(), FILES.len());
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/materials");
        let present = std::fs::read_dir(folder).unwrap().count();
        assert_eq!(
            FILES.len(),
            present,
            "files in the folder that are not embedded"
        );
        let bytes: usize = FILES.iter().map(|text| text.len()).sum();
        assert!(bytes < 150_000, "{bytes}");
    }
}

//! Film text: one layer of a thin film as it is written, `MATERIAL:THICKNESS`.

use asperity_surface::LengthUnit;

use super::length::Length;
use super::number::parse_number;

/// One layer of a thin film.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FilmText {
    /// Material as it is written: its name, a file or an index.
    pub(crate) material: String,
    /// Thickness, nanometres, above zero.
    pub(crate) thickness_nm: f64,
}

impl FilmText {
    /// Reads `SiO2:100nm`, `1.38:0.1um` or `2.1+0.05i:20nm`; numbers without a unit are nanometres. `None` for any other text.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let (material, thickness) = text.trim().rsplit_once(':')?;
        let thickness_nm = Length::parse(thickness)?.in_unit(LengthUnit::Nanometre)?;
        let material = material.trim();
        let is_valid = thickness_nm > 0.0 && thickness_nm.is_finite() && !material.is_empty();
        is_valid.then(|| Self {
            material: material.to_owned(),
            thickness_nm,
        })
    }
}

/// An index `n` or `n+ki`, with `n` above zero and `k` zero or more, in place of the name of a material.
pub(crate) fn index(text: &str) -> Option<[f64; 2]> {
    let number = |text: &str| parse_number(text).ok();
    let complex = || {
        let (n, k) = text.strip_suffix('i')?.split_once('+')?;
        Some([number(n)?, number(k)?])
    };
    let [n, k] = number(text).map(|n| [n, 0.0]).or_else(complex)?;
    (n > 0.0 && k >= 0.0).then_some([n, k])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_name_a_material_or_an_index_and_a_thickness() {
        let named = |text, name: &str, thickness_nm| {
            let found = FilmText::parse(text).unwrap();
            assert_eq!((found.material.as_str(), index(name)), (name, None));
            assert_eq!(found.thickness_nm, thickness_nm, "{text}");
        };
        named("SiO2:100nm", "SiO2", 100.0);
        named("my film.yml: 0.25um", "my film.yml", 250.0);
        named("C:/n.csv:80", "C:/n.csv", 80.0);
        for (text, n, k) in [("1.38:100nm", 1.38, 0.0), ("2.1+0.05i:100nm", 2.1, 0.05)] {
            let found = FilmText::parse(text).unwrap();
            assert_eq!(index(&found.material), Some([n, k]));
            assert_eq!(found.thickness_nm, 100.0);
        }
        for text in [
            "100nm",
            "SiO2",
            "SiO2:",
            ":100nm",
            "SiO2:-1nm",
            "SiO2:0",
            "SiO2:1 furlong",
        ] {
            assert_eq!(FilmText::parse(text), None, "{text}");
        }
    }
}

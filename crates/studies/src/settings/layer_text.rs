//! Layer text: one layer of a stack as it is written, `MATERIAL:THICKNESS` with further keys.

use asperity_optics::BottomSurface;

use super::length::Length;
use super::number::parse_number;

/// One layer of a stack.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LayerText {
    /// The text.
    pub(crate) text: String,
    /// Material as it is written: its name, a file or an index.
    pub(crate) material: String,
    /// Thickness, above zero.
    pub(crate) thickness: Length,
    /// Absorption coefficient, 1 / length unit.
    pub(crate) absorption: f64,
    /// Scattering coefficient, 1 / length unit.
    pub(crate) scattering: f64,
    /// Mean cosine of scattering; isotropic without one.
    pub(crate) g: Option<f64>,
    /// Shape of the face above it.
    pub(crate) surface: BottomSurface,
}

impl LayerText {
    /// Reads `1.33:50um` or `water:2mm:scattering=0.1:g=0.8:surface=same`; `None` for any other text.
    pub(crate) fn parse(text: &str) -> Option<Self> {
        let mut parts: Vec<&str> = text.split(':').map(str::trim).collect();
        let keys = parts.iter().rev().take_while(|part| part.contains('='));
        let keys = parts.split_off(parts.len() - keys.count());
        let thickness = Length::parse(parts.pop()?)?;
        let material = parts.join(":");
        let mut layer = Self {
            text: text.to_owned(),
            material,
            thickness,
            absorption: 0.0,
            scattering: 0.0,
            g: None,
            surface: BottomSurface::Flat,
        };
        let mut known = Vec::new();
        for key in keys {
            let (key, value) = key.split_once('=')?;
            if known.contains(&key.trim()) {
                return None;
            }
            known.push(key.trim());
            let number = || parse_number(value).ok();
            match key.trim() {
                "absorption" => layer.absorption = number().filter(|a| *a >= 0.0)?,
                "scattering" => layer.scattering = number().filter(|s| *s >= 0.0)?,
                "g" => layer.g = Some(number().filter(|g| g.abs() < 1.0)?),
                "surface" => layer.surface = value.trim().parse().ok()?,
                _ => return None,
            }
        }
        let is_valid = thickness.number() > 0.0 && thickness.number().is_finite();
        let scatters = layer.g.is_none() || layer.scattering > 0.0;
        (is_valid && scatters && !layer.material.is_empty()).then_some(layer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_have_a_material_a_thickness_and_keys() {
        let parse = |text| LayerText::parse(text).unwrap();
        let plain = parse("1.33:50");
        assert_eq!(
            (plain.material.as_str(), plain.thickness),
            ("1.33", Length::Plain(50.0))
        );
        assert_eq!((plain.g, plain.surface), (None, BottomSurface::Flat));
        let full = parse("water:2mm:scattering=0.1:absorption = 1e-3:g=-0.5:surface=same");
        assert_eq!((full.scattering, full.absorption), (0.1, 1e-3));
        assert_eq!((full.g, full.surface), (Some(-0.5), BottomSurface::Same));
        assert_eq!(parse("C:/n.csv:80").material, "C:/n.csv");
        for text in [
            "",
            "1.33",
            "1.33:0",
            "1.33:-1",
            ":50",
            "1.33:50:scattering=1:g=1",
            "1.33:50:g=0.5",
            "1.33:50:absorption=1:absorption=2",
            "1.33:50:x=1",
            "1.33:50:surface=round",
            "1.33:50:scattering=-1",
            "g=0.5",
        ] {
            assert_eq!(LayerText::parse(text), None, "{text}");
        }
    }
}

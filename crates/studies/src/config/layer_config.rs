//! Layer configuration: one of the further layers of a stack.

use serde::{Deserialize, Serialize};

use super::named_material::NamedMaterial;
use crate::settings::layer_text::LayerText;

/// One of the further layers of `[medium]`, as in `1.33:50um`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub(super) struct LayerConfig {
    pub(super) text: LayerText,
    pub(super) material: NamedMaterial,
}

impl TryFrom<String> for LayerConfig {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let parsed = LayerText::parse(&text).ok_or_else(|| format!("{text} is no layer"))?;
        Ok(Self {
            material: parsed.material.clone().into(),
            text: parsed,
        })
    }
}

impl From<LayerConfig> for String {
    fn from(layer: LayerConfig) -> Self {
        layer.text.text
    }
}

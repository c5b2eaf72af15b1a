//! Components of the light that are compared with models, and their names in files.

use std::borrow::Cow;

use asperity_tally::Component;

/// All components that are compared, in the order of reports.
pub(crate) const COMPARED: [Component; 5] = [
    Component::Single,
    Component::Multiple,
    Component::Unscattered,
    Component::ScatteredOnce,
    Component::All,
];

/// The name in comparison.csv and in JSON, which call all light `total`.
pub(crate) fn key(component: Component) -> Cow<'static, str> {
    match component {
        Component::All => "total".into(),
        _ => component.name(),
    }
}

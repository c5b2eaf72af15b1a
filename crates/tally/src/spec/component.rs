//! Components of light: the parts that a result is split into, and their names.
//!
//! A component is a filter on exits: it selects those that count, and names them in tables, files and plots.
//! [`TallySpec`](crate::TallySpec) selects the components that a tally keeps for each quantity.
//!
//! To add a component, add a variant here with its row in [`Component::text`], its line in
//! [`Component::accepts`] and its position in [`Component::place`], or define a [`ComponentFilter`] and pass it to
//! [`TallySpec::with_components`](crate::TallySpec::with_components). Columns, legends and JSON follow from its names.

use std::borrow::Cow;
use std::fmt;

use serde::{Serialize, Serializer};

use crate::Exit;

/// Highest order of scattering with an entry of its own in the list of orders, less one: higher orders
/// share the last entry.
pub const MAX_LISTED_ORDER: usize = 64;

/// Orders from this one on are grouped in rings and in-plane bins.
pub(crate) const FIRST_GROUPED_ORDER: u8 = 4;

/// A component of the light that leaves.
///
/// # Examples
/// ```
/// use asperity_tally::Component;
///
/// assert_eq!(Component::Multiple.name(), "multiple");
/// assert_eq!(Component::Unscattered.label(), "never scattered inside");
/// ```
#[derive(Clone, Copy, Debug)]
pub enum Component {
    /// All light that leaves.
    All,
    /// Light that interacted with the surface once.
    Single,
    /// Light that interacted with the surface more than once.
    Multiple,
    /// Light of one order of scattering, which is the number of interactions; `Order(1)` is
    /// [`Component::Single`] under the name that lists of orders use.
    Order(u8),
    /// Light of this order of scattering and above.
    OrderAndAbove(u8),
    /// Light that the medium below the surface never scattered.
    Unscattered,
    /// Light that the medium below the surface scattered once.
    ScatteredOnce,
    /// Light that the medium below the surface scattered more than once.
    ScatteredMore,
    /// A component defined outside this crate.
    Custom(&'static ComponentFilter),
}

/// A component defined by its user: its exits and its names.
#[derive(Clone, Copy, Debug)]
pub struct ComponentFilter {
    /// Name in files, in lower case; part of the headers of columns.
    pub name: &'static str,
    /// Name in tables and legends.
    pub label: &'static str,
    /// Light that belongs to it, as a noun phrase.
    pub description: &'static str,
    /// Returns `true` if an exit belongs to the component.
    pub accepts: fn(&Exit) -> bool,
}

impl Component {
    /// Light split by what the medium below the surface did; these add up to [`Component::All`].
    pub const MEDIUM: [Self; 3] = [Self::Unscattered, Self::ScatteredOnce, Self::ScatteredMore];

    /// Light split into single and multiple scattering by the surface; these add up to
    /// [`Component::All`].
    pub const SURFACE: [Self; 2] = [Self::Single, Self::Multiple];

    /// Light split by order of scattering as rings and in-plane bins keep it; these add up to
    /// [`Component::All`].
    pub const ORDERS: [Self; 4] = [
        Self::Order(1),
        Self::Order(2),
        Self::Order(3),
        Self::OrderAndAbove(FIRST_GROUPED_ORDER),
    ];

    /// Components of bins, in addition to those kept in full.
    pub const BINS: [Self; 3] = [Self::Single, Self::Multiple, Self::All];

    /// Components of rings and in-plane bins, in addition to those kept in full.
    pub const RINGS: [Self; 5] = [
        Self::Order(1),
        Self::Order(2),
        Self::Order(3),
        Self::OrderAndAbove(FIRST_GROUPED_ORDER),
        Self::All,
    ];

    /// Returns `true` if `exit` belongs to this component.
    #[inline]
    #[must_use]
    pub fn accepts(self, exit: &Exit) -> bool {
        let order = exit.path.order();
        match self {
            Self::All => true,
            Self::Single => order <= 1,
            Self::Multiple => order > 1,
            Self::Order(n) => order == u32::from(n),
            Self::OrderAndAbove(n) => order >= u32::from(n),
            Self::Unscattered => exit.scatterings == 0,
            Self::ScatteredOnce => exit.scatterings == 1,
            Self::ScatteredMore => exit.scatterings > 1,
            Self::Custom(filter) => (filter.accepts)(exit),
        }
    }

    /// Name in files: `single`, `order_4_and_above`, `once`.
    #[must_use]
    pub fn name(self) -> Cow<'static, str> {
        match self {
            Self::Order(n) => format!("order_{n}").into(),
            Self::OrderAndAbove(n) => format!("order_{n}_and_above").into(),
            _ => self.text()[0].into(),
        }
    }

    /// Name in tables and legends: `single scattering`, `scattered inside once`.
    #[must_use]
    pub fn label(self) -> Cow<'static, str> {
        match self {
            Self::Order(n) => format!("order {n}").into(),
            Self::OrderAndAbove(n) => format!("order {n} and above").into(),
            _ => self.text()[1].into(),
        }
    }

    /// A shorter label where the context says what the light is split by: `single`, `once`.
    #[must_use]
    pub fn short_label(self) -> Cow<'static, str> {
        match self {
            Self::Order(n) => n.to_string().into(),
            Self::OrderAndAbove(n) => format!("{n} and above").into(),
            _ => self.text()[2].into(),
        }
    }

    /// Light that belongs to the component, as a noun phrase.
    #[must_use]
    pub const fn description(self) -> &'static str {
        match self {
            Self::Order(_) => "light that met the surface as often",
            Self::OrderAndAbove(_) => "light that met the surface as often or more often",
            _ => self.text()[3],
        }
    }

    /// Position in the split that it belongs to, by which figures colour it: 0 for all light, then 1, 2, ...
    #[must_use]
    pub const fn place(self) -> usize {
        match self {
            Self::All => 0,
            Self::Single | Self::Unscattered => 1,
            Self::Multiple | Self::ScatteredOnce => 2,
            Self::ScatteredMore | Self::Custom(_) => 3,
            Self::Order(order) | Self::OrderAndAbove(order) => order as usize,
        }
    }

    /// Returns `true` if this is one of [`Component::MEDIUM`].
    #[must_use]
    pub const fn is_of_medium(self) -> bool {
        matches!(
            self,
            Self::Unscattered | Self::ScatteredOnce | Self::ScatteredMore
        )
    }

    /// Number of the component of [`Component::ORDERS`] that holds light of this order.
    #[inline(always)]
    pub(crate) const fn order_group(order: u32) -> u32 {
        let before = if order == 0 { 0 } else { order - 1 };
        if before < 3 { before } else { 3 }
    }

    /// Name, label, short label and description of all but lists of orders.
    const fn text(self) -> [&'static str; 4] {
        match self {
            Self::All | Self::OrderAndAbove(_) => {
                ["all", "all orders", "all", "all light that leaves"]
            }
            Self::Single | Self::Order(_) => [
                "single",
                "single scattering",
                "single",
                "light that met the surface once",
            ],
            Self::Multiple => [
                "multiple",
                "multiple scattering",
                "multiple",
                "light that met the surface more often",
            ],
            Self::Unscattered => [
                "unscattered",
                "never scattered inside",
                "never scattered inside",
                "light that was never scattered inside the medium",
            ],
            Self::ScatteredOnce => [
                "once",
                "scattered inside once",
                "once",
                "light that was scattered inside the medium once",
            ],
            Self::ScatteredMore => [
                "more",
                "scattered inside more often",
                "more often",
                "light that was scattered inside the medium more often",
            ],
            Self::Custom(filter) => [filter.name, filter.label, filter.label, filter.description],
        }
    }
}

/// Components are equal if they accept the same exits; `Order(1)` equals `Single`. Custom components are equal if their names are.
impl PartialEq for Component {
    fn eq(&self, other: &Self) -> bool {
        let canonical = |component: &Self| match *component {
            Self::OrderAndAbove(0 | 1) => Self::All,
            Self::OrderAndAbove(2) => Self::Multiple,
            Self::Order(1) => Self::Single,
            component => component,
        };
        match (canonical(self), canonical(other)) {
            (Self::Order(a), Self::Order(b)) | (Self::OrderAndAbove(a), Self::OrderAndAbove(b)) => {
                a == b
            }
            (Self::Custom(a), Self::Custom(b)) => a.name == b.name,
            (a, b) => std::mem::discriminant(&a) == std::mem::discriminant(&b),
        }
    }
}

impl Eq for Component {}

/// Writes [`Component::name`].
impl fmt::Display for Component {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name())
    }
}

impl Serialize for Component {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{EventPath, Side};
    use glam::DVec3;

    fn exit(order: u32, scatterings: u32) -> Exit {
        Exit {
            side: Side::Reflected,
            wo: DVec3::Z,
            flux: 1.0,
            path: EventPath::from_code(order, 0),
            scatterings,
        }
    }

    #[test]
    fn every_split_accepts_each_exit_once() {
        for order in 1..80 {
            for scatterings in 0..4 {
                let exit = exit(order, scatterings);
                for split in [
                    &Component::MEDIUM[..],
                    &Component::SURFACE,
                    &Component::ORDERS,
                ] {
                    let accepted = split.iter().filter(|c| c.accepts(&exit)).count();
                    assert_eq!(accepted, 1, "order {order}, {scatterings} scatterings");
                }
                let group = Component::ORDERS[Component::order_group(order) as usize];
                assert!(group.accepts(&exit));
            }
        }
    }

    #[test]
    fn components_that_accept_the_same_light_are_equal() {
        assert_eq!(Component::Order(1), Component::Single);
        assert_eq!(Component::OrderAndAbove(2), Component::Multiple);
        assert_ne!(Component::Order(2), Component::Order(3));
        assert_eq!(Component::ORDERS[3].name(), "order_4_and_above");
    }
}

//! Power law: self-affine surfaces, with roll-off and cut-off.

use asperity_numerics::elementary::pow;
use serde::{Deserialize, Serialize};

use super::error::PsdError;
use super::radial_table::RadialTable;

/// `1` up to the roll-off, then `(kappa / roll_off)^(-2 (hurst + 1))` up to the cut-off.
///
/// # Source
/// B. N. J. Persson et al., J. Phys.: Condens. Matter 17 (2005) R1, Eqs. 2 and 5; T. D. B. Jacobs, T. Junge, L. Pastewka, Surf.
/// Topogr.: Metrol. Prop. 5 (2017) 013001.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct PowerLaw {
    hurst: f64,
    roll_off: f64,
    cut_off: f64,
}

impl PowerLaw {
    /// `hurst`: 0 to 1; `roll_off`, `cut_off`: wave numbers, the second larger.
    pub(super) fn new(hurst: f64, roll_off: f64, cut_off: f64) -> Result<Self, PsdError> {
        if !(hurst > 0.0 && hurst <= 1.0) {
            return Err(PsdError::BadParameter {
                name: "hurst",
                value: hurst,
                allowed: "above 0, up to 1",
            });
        }
        Ok(Self {
            hurst,
            roll_off,
            cut_off,
        })
    }

    pub(super) const fn roll_off(&self) -> f64 {
        self.roll_off
    }

    pub(super) const fn cut_off(&self) -> f64 {
        self.cut_off
    }

    pub(super) fn at_square(&self, square: f64) -> f64 {
        let relative = square / (self.roll_off * self.roll_off);
        if relative <= 1.0 {
            1.0
        } else if square <= self.cut_off * self.cut_off {
            pow(relative, -(self.hurst + 1.0))
        } else {
            0.0
        }
    }

    pub(super) fn moment(&self, power: i32, end: f64) -> f64 {
        RadialTable::of_checked(
            vec![self.roll_off, self.cut_off],
            vec![1.0, self.at_square(self.cut_off * self.cut_off)],
        )
        .moment(power, end)
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            hurst: self.hurst,
            roll_off: self.roll_off * factor,
            cut_off: self.cut_off * factor,
        }
    }

    pub(super) fn is_valid(&self) -> bool {
        self.hurst > 0.0
            && self.hurst <= 1.0
            && self.roll_off > 0.0
            && self.cut_off > self.roll_off
            && self.cut_off.is_finite()
    }
}

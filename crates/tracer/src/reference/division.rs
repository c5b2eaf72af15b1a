//! Division: the light of a path divided between the branches in which it leaves an interface.
//!
//! Fields are divided in the world, also in a mirrored tile: directions and normals are brought there.

use glam::DVec3;

use super::amplitudes::Amplitudes;
use super::facet::{Branch, Scattered};
use super::fields::{Deflection, Fields};
use crate::periodic::Heading;

/// Light of a path divided at an interface, as fractions of its flux.
pub(super) struct Division {
    /// Transmission and reflection.
    pub(super) branches: [LitBranch; 2],
    pub(super) absorbed: f64,
}

/// One of the directions in which light leaves an interface, and its fields if the path has any.
#[derive(Clone, Copy)]
pub(super) struct LitBranch {
    pub(super) branch: Branch,
    pub(super) fields: Option<Fields>,
}

impl Division {
    /// Light that counts as unpolarised.
    pub(super) fn averaged(scattered: &Scattered) -> Self {
        Self {
            branches: scattered.branches.map(|branch| LitBranch {
                branch,
                fields: None,
            }),
            absorbed: scattered.absorbed,
        }
    }

    /// This division with the fractions of the fields that a path brings to a point of normal `m`.
    pub(super) fn polarised(
        mut self,
        heading: &Heading,
        fields: &Fields,
        m: DVec3,
        amplitudes: &Amplitudes,
    ) -> Self {
        let amplitudes = [amplitudes.transmission, amplitudes.reflection];
        for (lit, amplitudes) in self.branches.iter_mut().zip(amplitudes) {
            // A branch without light has no direction.
            if lit.branch.fraction > 0.0 {
                let ray = Deflection {
                    k: heading.world_direction(),
                    k_out: heading.to_world(lit.branch.direction),
                    m: heading.to_world(m),
                };
                let fields = fields.after(&ray, amplitudes);
                lit.branch.fraction = fields.flux();
                lit.fields = Some(fields.normalised());
            }
        }
        let kept: f64 = self.branches.iter().map(|lit| lit.branch.fraction).sum();
        if self.absorbed > 0.0 {
            self.absorbed = 1.0 - kept;
        } else {
            // Without absorption both fractions add up to one but for rounding, which is taken out.
            for lit in &mut self.branches {
                lit.branch.fraction /= kept;
            }
        }
        self
    }

    /// This division with unpolarised light.
    pub(super) fn depolarised(mut self, heading: &Heading) -> Self {
        for lit in &mut self.branches {
            let k = heading.to_world(lit.branch.direction);
            lit.fields = Some(Fields::unpolarised(k));
        }
        self
    }
}

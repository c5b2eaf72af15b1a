//! Other ways not to hit the facet just left, which are known to fail and must be seen to.

use asperity_optics::Material;
use asperity_tracer::{BruteForce, HalfSpace, Surface};

use crate::cases::Case;
use crate::generator;
use crate::light::{Aim, watched};
use crate::naive::{Offset, SkipLast};
use crate::paths::{Account, BySide, Scheme};
use crate::scenes::gaussian;

#[test]
fn light_culled_by_side_keeps_its_side_where_other_schemes_fail() {
    for aim in [Aim::Random, Aim::Awkward] {
        let account = rough_and_grazing("culled by side", &BySide(&BruteForce), aim, 300);
        assert_eq!(account.wrong_sides, 0, "{:?}", account.first_fault);
        assert_eq!(account.lost_segments, 0, "{:?}", account.first_fault);
    }
}

#[test]
fn an_offset_along_the_normal_is_caught() {
    // Of random rays, a part as small as the offset comes that near to an edge; small offsets are
    // caught by rays that are aimed.
    offset_fails(1e-3, Aim::Random, 800);
    for epsilon in [1e-3, 1e-4, 1e-6] {
        offset_fails(epsilon, Aim::Awkward, 100);
    }
}

#[test]
fn skipping_the_last_facet_alone_is_caught() {
    let account = rough_and_grazing("last facet skipped", &SkipLast, Aim::Awkward, 100);
    assert!(account.wrong_sides > 0);
    assert!(account.lost > 0.0);
}

/// Follows rays that start `epsilon` columns along the normal, which must be seen to fail.
pub(super) fn offset_fails(epsilon: f64, aim: Aim, rays: usize) {
    let name = format!("offset {epsilon:e}");
    let account = rough_and_grazing(&name, &Offset { epsilon }, aim, rays);
    assert!(account.wrong_sides > 0);
    assert!(account.lost > 0.0);
}

/// A rough surface at 85 degrees, by `scheme`, printed.
fn rough_and_grazing(name: &str, scheme: &dyn Scheme<Surface>, aim: Aim, rays: usize) -> Account {
    let surface = Surface::new(gaussian(0.2, [8, 8], [1.0; 2], 80));
    let case = Case {
        theta_deg: 85.0,
        material: Material::dielectric(1.5).unwrap(),
        incident: HalfSpace::Above,
    };
    let account = watched(&surface, scheme, case, aim, rays, &mut generator(80, 0));
    let aimed = match aim {
        Aim::Random => "random",
        Aim::Awkward => "awkward",
    };
    println!(
        "{name:<18} {aimed:<7} {} rays, {} segments: {} on wrong sides, {} lost with {:.2e} of the light",
        account.rays,
        account.segments,
        account.wrong_sides,
        account.lost_segments,
        account.lost / account.rays as f64,
    );
    account
}

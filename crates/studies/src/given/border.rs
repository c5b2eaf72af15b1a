//! Borders of given surfaces: the one that is assumed, and whether the tile fits it.

use asperity_surface::{Border, HeightField};

/// The border of a height map whose file states none, whatever its format: a measured patch is not periodic, and a
/// mirrored one has no steps.
pub(super) const ASSUMED_BORDER: Border = Border::Mirrored;

/// Step of heights at a periodic border, over the step between neighbours, from which a note warns.
///
/// Over a border that fits, the ratio scatters about 1: the mean square of even eight independent steps exceeds its
/// expectation by a factor of 4^2 with a probability below 1e-20.
const STEP: f64 = 4.0;

/// Notes on the border, one sentence each; `is_known`: the file or the user states it.
pub(super) fn border_notes(field: &HeightField, is_known: bool) -> Vec<String> {
    let mut notes = Vec::new();
    let border = field.border();
    if !is_known {
        notes.push(format!(
            "{border} border, as for every file that states none; set it with --border"
        ));
    }
    let axes = ["x", "y"].into_iter();
    match border {
        Border::Periodic => {
            let steps = axes.zip(field.border_steps());
            notes.extend(steps.filter(|(_, step)| *step > STEP).map(|(axis, step)| {
                let times = match step.is_finite() {
                    true => format!("{step:.0} times as high as"),
                    false => "not level, unlike".to_owned(),
                };
                format!(
                    "opposite borders along {axis} do not fit: the step of a periodic border is {times} those between neighbours; --border mirrored has none"
                )
            }));
        }
        Border::Mirrored => {
            let tilted = axes.zip(field.tilt());
            let tilted = tilted.filter_map(|(axis, mean)| Some((axis, mean?)));
            notes.extend(tilted.map(|(axis, mean)| {
                format!(
                    "the mean slope along {axis} is {mean:.3}, more than slopes scatter: a mirrored border folds the tilt; --remove plane removes it"
                )
            }));
        }
        Border::Open => {}
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(height: impl Fn(f64, f64) -> f64, border: Border) -> HeightField {
        let n = 32;
        let heights = (0..n * n).map(|k| height((k % n) as f64, (k / n) as f64));
        let field = HeightField::new(heights.collect(), [n, n], [1.0, 1.0]).unwrap();
        field.with_border(border)
    }

    #[test]
    fn periodic_borders_are_checked_along_each_axis() {
        let wave = |x: f64| (std::f64::consts::TAU * x / 32.0).sin();
        let fits = field(|x, y| wave(x) + wave(y), Border::Periodic);
        assert_eq!(border_notes(&fits, true), Vec::<String>::new());
        let ramp = field(|x, y| wave(x) + 0.1 * wave(y) + 0.5 * y, Border::Periodic);
        let notes = border_notes(&ramp, true);
        assert!(
            notes.len() == 1 && notes[0].contains("along y do not fit"),
            "{notes:?}"
        );
        let flat = field(|_, _| 1.0, Border::Periodic);
        assert_eq!(border_notes(&flat, true), Vec::<String>::new());
    }

    #[test]
    fn the_assumed_border_is_said_and_tilt_is_warned_of() {
        let rough = |x: f64, y: f64| (x * 1.7).sin() * (y * 2.3).cos();
        let level = field(rough, ASSUMED_BORDER);
        let notes = border_notes(&level, false);
        assert!(
            notes.len() == 1 && notes[0].starts_with("mirrored border"),
            "{notes:?}"
        );
        let tilted = field(|x, y| rough(x, y) + 3.0 * x, ASSUMED_BORDER);
        let notes = border_notes(&tilted, true);
        assert!(
            notes.len() == 1 && notes[0].contains("mean slope along x is 3"),
            "{notes:?}"
        );
    }
}

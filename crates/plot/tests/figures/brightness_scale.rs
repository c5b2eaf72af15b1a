//! Scales of the brightness of pictures.

use asperity_plot::{BrightnessScale, PlotError};

use crate::{assert_has, render};

fn scale(width: u32, range: [f64; 2]) -> BrightnessScale<'static> {
    BrightnessScale {
        title: "radiance",
        width,
        range,
        place: &|value: f64| value / 2.0,
    }
}

#[test]
fn ramps_go_from_black_to_white_in_the_width_of_the_picture() {
    for width in [160, 333, 4096] {
        let figure = scale(width, [0.0, 2.0]).draw().unwrap();
        assert_has(&render(&figure), &["radiance", "0", "1"]);
        let (columns, rows) = figure.size();
        assert_eq!(columns, width);
        let pixels = figure.rgb().unwrap();
        assert_eq!(pixels.len(), (3 * columns * rows) as usize);
        // Along the middle of the ramp, inside its frame
        let row = &pixels[(3 * columns * 21) as usize..][..3 * columns as usize];
        let grey: Vec<u8> = row.chunks(3).map(|rgb| rgb[0]).collect();
        let ramp = &grey[24..columns as usize - 24];
        assert!(ramp.is_sorted() && ramp[0] < 8 && ramp[ramp.len() - 1] > 247);
    }
}

#[test]
fn narrow_scales_and_empty_ranges_are_refused() {
    for (width, range) in [
        (159, [0.0, 2.0]),
        (300, [1.0, 1.0]),
        (300, [-1.0, 1.0]),
        (300, [0.0, f64::NAN]),
    ] {
        let refused = scale(width, range).draw();
        assert!(matches!(refused, Err(PlotError::OutOfRange { .. })));
    }
}

//! Every figure, for ordinary, degenerate and invalid input, as a caller sees it.
#![allow(
    clippy::unwrap_used,
    reason = "helpers of tests fail like the tests themselves"
)]

mod angle_grid;
mod brightness_scale;
mod cell_map;
mod curves;
mod diagram;
mod error_over_time;
mod height_map;
mod in_plane;
mod pictures;

use asperity_plot::{Figure, Sides};

/// Renders both ways, checks that both are well-formed and of the promised size, and returns the SVG's texts.
fn render(figure: &Figure) -> String {
    let svg = figure.svg().unwrap();
    let png = figure.png().unwrap();
    assert!(svg.len() < 2_000_000, "SVG of {} bytes", svg.len());

    let (width, height) = figure.size();
    let document = roxmltree::Document::parse(&svg).unwrap();
    let root = document.root_element();
    assert_eq!(root.attribute("width"), Some(width.to_string().as_str()));
    assert_eq!(root.attribute("height"), Some(height.to_string().as_str()));

    assert!(png.starts_with(b"\x89PNG\r\n\x1a\n"));
    let mut reader = png::Decoder::new(std::io::Cursor::new(&png))
        .read_info()
        .unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut pixels).unwrap();
    assert_eq!((info.width, info.height), (2 * width, 2 * height));
    assert!(pixels.iter().any(|p| *p < 100), "an empty picture");

    // No text may leave the figure by its anchor, in units of a tenth of a pixel.
    let texts = document.descendants().filter(|n| n.has_tag_name("text"));
    let texts: Vec<String> = texts
        .map(|node| {
            let at = |name| node.attribute(name).unwrap().parse::<i64>().unwrap();
            assert!((0..=i64::from(width) * 10).contains(&at("x")));
            assert!((0..=i64::from(height) * 10).contains(&at("y")));
            node.text().unwrap().trim().to_owned()
        })
        .collect();
    texts.join("\n")
}

fn assert_has(texts: &str, wanted: &[&str]) {
    for text in wanted {
        assert!(texts.contains(text), "no \"{text}\" in:\n{texts}");
    }
}

#[test]
fn equal_input_gives_equal_bytes() {
    let heights = height_map::waves(20, 30, 1e-6);
    let draw = || {
        [
            in_plane::polar(in_plane::both_sides(2.0), Sides::Both)
                .draw()
                .unwrap(),
            in_plane::curves(in_plane::both_sides(2.0)).draw().unwrap(),
            height_map::map(&heights, [20, 30], 1e-6).draw().unwrap(),
        ]
    };
    for (a, b) in draw().iter().zip(&draw()) {
        assert_eq!(a.svg().unwrap(), b.svg().unwrap());
        assert_eq!(a.png().unwrap(), b.png().unwrap());
    }
}

//! Gwyddion's own files.

use asperity_surface::LengthUnit;

use super::super::refused;
use super::{Expected, MISSING, numbers, read};
use crate::formats::HeightMapFormat::Gwyddion;

const EXPECTED: Expected = Expected {
    step: 1e-9,
    offset: 0.0,
    spacing: [2e-6, 3e-6],
    unit: LengthUnit::Metre,
    is_whole: false,
};

/// An item: name, type, value.
fn item(name: &str, letter: u8, value: &[u8]) -> Vec<u8> {
    [name.as_bytes(), &[0, letter], value].concat()
}

fn text(name: &str, value: &str) -> Vec<u8> {
    item(name, b's', &[value.as_bytes(), &[0]].concat())
}

fn object(name: &str, items: &[Vec<u8>]) -> Vec<u8> {
    let items = items.concat();
    let length = (items.len() as u32).to_le_bytes();
    [name.as_bytes(), &[0], &length, &items].concat()
}

fn doubles(name: &str, numbers: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
    let count = (numbers.len() as u32).to_le_bytes();
    item(name, b'D', &[&count[..], &bytes].concat())
}

/// A data field of 4 x 3 points over 8 um x 9 um.
fn data_field(unit: &str, numbers: &[f64]) -> Vec<u8> {
    let unit_of =
        |name: &str, unit: &str| item(name, b'o', &object("GwySIUnit", &[text("unitstr", unit)]));
    object(
        "GwyDataField",
        &[
            item("xres", b'i', &4_i32.to_le_bytes()),
            item("yres", b'i', &3_i32.to_le_bytes()),
            item("xreal", b'd', &8e-6_f64.to_le_bytes()),
            item("yreal", b'd', &9e-6_f64.to_le_bytes()),
            unit_of("si_unit_xy", "m"),
            unit_of("si_unit_z", unit),
            doubles("data", numbers),
        ],
    )
}

fn heights() -> Vec<f64> {
    numbers().map(|n| f64::from(n) * 1e-9).collect()
}

fn mask() -> Vec<f64> {
    let mut mask = vec![0.0; 12];
    mask[4 * MISSING[0] + MISSING[1]] = 1.0;
    mask
}

fn container(items: &[Vec<u8>]) -> Vec<u8> {
    [b"GWYP".to_vec(), object("GwyContainer", items)].concat()
}

/// A phase, then a topography with a mask, among items of every type.
fn items() -> Vec<Vec<u8>> {
    let count = 2_u32.to_le_bytes();
    let list = |value: &[u8]| [&count[..], value].concat();
    let inner = object("GwySIUnit", &[]);
    vec![
        item("/0/data", b'o', &data_field("deg", &heights())),
        text("/0/data/title", "Phase"),
        item("/0/data/visible", b'b', &[1]),
        item("/0/data/letter", b'c', b"x"),
        item("/0/data/wide", b'q', &[0; 8]),
        item("/0/letters", b'C', &list(b"ab")),
        item("/0/whole", b'I', &list(&[0; 8])),
        item("/0/wide", b'Q', &list(&[0; 16])),
        item("/0/words", b'S', &list(b"a\0b\0")),
        item("/0/objects", b'O', &list(&[inner.clone(), inner].concat())),
        item("/3/data", b'o', &data_field("m", &heights())),
        text("/3/data/title", "Topography"),
        item("/3/mask", b'o', &data_field("", &mask())),
    ]
}

pub(super) fn file() -> Vec<u8> {
    container(&items())
}

/// A single field with a mask, as Gwyddion writes it.
pub(super) fn single() -> Vec<u8> {
    container(&[
        item("/0/data", b'o', &data_field("m", &heights())),
        text("/0/data/title", "Height"),
        item("/0/mask", b'o', &data_field("", &mask())),
    ])
}

#[test]
fn the_topography_is_read_with_its_mask() {
    let map = read(Gwyddion, &file()).unwrap();
    assert_eq!(
        map.notes,
        [
            "channel 2 of 2, `Topography`, is read, not `Phase`",
            "its mask is of 1 points, which are taken for missing"
        ]
    );
    EXPECTED.assert_read(map);
    let map = read(Gwyddion, &single()).unwrap();
    assert_eq!(map.notes.len(), 1);
    EXPECTED.assert_read(map);
}

#[test]
fn titles_decide_before_numbers() {
    let other: Vec<f64> = heights().into_iter().map(|h| 2.0 * h).collect();
    let mut items = items();
    items.insert(0, item("/1/data", b'o', &data_field("m", &other)));
    let map = read(Gwyddion, &container(&items)).unwrap();
    assert!(
        map.notes[0].contains("channel 3 of 3, `Topography`"),
        "{:?}",
        map.notes
    );
    EXPECTED.assert_read(map);
    // Without a title the lowest number is read
    let untitled = [
        item("/7/data", b'o', &data_field("m", &other)),
        item("/2/data", b'o', &data_field("m", &heights())),
    ];
    let expected = Expected {
        is_whole: true,
        ..EXPECTED
    };
    expected.assert_read(read(Gwyddion, &container(&untitled)).unwrap());
}

#[test]
fn trees_are_checked() {
    let alone = |field: Vec<u8>| container(&[item("/0/data", b'o', &field)]);
    let replaced = |from: &[u8], to: &[u8]| {
        let mut bytes = alone(data_field("m", &heights()));
        let at = bytes
            .windows(from.len())
            .position(|part| part == from)
            .unwrap();
        bytes[at..at + to.len()].copy_from_slice(to);
        bytes
    };
    let mut overlong = container(&[
        item("/0/data", b'o', &data_field("m", &heights())),
        doubles("/after", &[0.0; 40]),
    ]);
    let unit = b"GwySIUnit\0\x0b";
    let at = overlong.windows(11).position(|part| part == unit).unwrap();
    overlong[at + 10] = 0xff;
    let mut masked = items();
    masked[12] = item(
        "/3/mask",
        b'o',
        &object("GwyDataField", &[doubles("data", &[1.0])]),
    );
    for (bytes, words) in [
        (b"GWYO and more".to_vec(), "version 1 of Gwyddion"),
        (
            [b"GWYP".to_vec(), object("Other", &[])].concat(),
            "no GwyContainer",
        ),
        (container(&[]), "none of its 0 channels"),
        (
            alone(data_field("deg", &heights())),
            "none of its 1 channels",
        ),
        (alone(data_field("m", &heights()[1..])), "has 11 numbers"),
        (alone(object("GwyDataField", &[])), "no numbers"),
        (
            replaced(b"xres\0i\x04", b"xres\0i\xff"),
            "12 numbers, but 255 x 3",
        ),
        (replaced(b"xres\0i\x04", b"xres\0?\x04"), "unknown type `?`"),
        (
            replaced(b"data\0D\x0c\0\0\0", b"data\0D\xff\xff\xff\xff"),
            "are needed",
        ),
        (replaced(b"xreal\0d", b"xreaf\0d"), "spacing"),
        (
            replaced(b"unitstr\0sm", b"unitstr\0sV"),
            "unit of x and y is `V`",
        ),
        (overlong, "longer than the object"),
        (container(&masked), "its mask has another size"),
    ] {
        refused(Gwyddion, &bytes, words);
    }
}

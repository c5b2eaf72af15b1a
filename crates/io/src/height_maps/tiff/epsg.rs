//! Units of length of the coordinate systems in the EPSG data set, by code.

/// Lines of a kind, the code of a unit, and ranges of the codes of systems with that unit.
const TABLE: &str = include_str!("epsg.txt");

/// Metres in the unit with a code, if it is a unit of length.
pub(super) fn metres_in(unit: u64) -> Option<f64> {
    let code = unit.to_string();
    let mut lines = lines("unit");
    lines.find_map(|(of, metres)| (of == code).then(|| metres.parse().ok())?)
}

/// Metres in the unit of the axes of a system.
///
/// `kind`: `projected`, `vertical`, or `depth` for vertical systems that count downwards.
pub(super) fn metres_of(kind: &str, system: u64) -> Option<f64> {
    let holds = |range: &str| {
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        let [first, last] = [first, last].map(|code| code.parse::<u64>().ok());
        first <= Some(system) && Some(system) <= last
    };
    let (unit, _) = lines(kind).find(|(_, ranges)| ranges.split(' ').any(holds))?;
    metres_in(unit.parse().ok()?)
}

/// Code of a unit and the rest of each line of a kind.
fn lines(kind: &str) -> impl Iterator<Item = (&'static str, &'static str)> {
    TABLE.lines().filter_map(move |line| {
        let (of, rest) = line.split_once(' ')?;
        (of == kind).then(|| rest.split_once(' '))?
    })
}

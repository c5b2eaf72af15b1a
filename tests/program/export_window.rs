//! `asperity export --format tensor-tree` and `klems`: XML as Radiance looks values up, next to the results that it is made of.

use std::f64::consts::{FRAC_PI_4, PI};

use crate::support::{Folder, InFolder, MustContain, Table, unwrapped};

const LITTLE: &str = "--rays 2e4 --realisations 2 --no-plots --quiet";

/// Flux, and the mean direction of light that leaves, projected onto the mean plane.
#[derive(Debug)]
struct Light {
    flux: f64,
    towards: [f64; 2],
}

impl Light {
    /// Sums over parts: projected direction, and flux.
    fn of(parts: impl Iterator<Item = ([f64; 2], f64)>) -> Self {
        let mut sum = [0.0; 3];
        for ([x, y], flux) in parts {
            sum = [sum[0] + flux, sum[1] + flux * x, sum[2] + flux * y];
        }
        Self {
            flux: sum[0],
            towards: [sum[1] / sum[0], sum[2] / sum[0]],
        }
    }

    fn distance(&self, other: &Self) -> f64 {
        let [a, b] = [self, other].map(|one| one.towards);
        (a[0] - b[0]).hypot(a[1] - b[1])
    }

    /// The same, turned by half a turn.
    fn turned(&self) -> Self {
        Self {
            flux: self.flux,
            towards: self.towards.map(|one| -one),
        }
    }

    /// Light that was measured from the direction `[polar angle, azimuth]` towards the source, degrees; `setting` 0 is light from above, 1 from below.
    fn measured(bsdf: &Table, setting: usize, side: &str, light: [f64; 2]) -> Self {
        let setting = setting.to_string();
        let is_wanted = |&row: &usize| {
            let is_number = |name: &str, value: f64| bsdf.number(row, name) == value;
            bsdf.text(row, "side") == side
                && bsdf.text(row, "setting") == setting
                && is_number("phi_i_deg", light[1])
                && is_number("theta_i_deg", light[0])
        };
        Self::of((0..bsdf.rows.len()).filter(is_wanted).map(|row| {
            let number = |name: &str| bsdf.number(row, name).to_radians();
            let [a, b] = ["theta_min_deg", "theta_max_deg"].map(|name| number(name).sin().powi(2));
            let width = number("phi_max_deg") - number("phi_min_deg");
            let flux = bsdf.number(row, "bsdf") * 0.5 * (b - a).abs() * width;
            let (sin, phi) = (number("theta_o_deg").sin(), number("phi_o_deg"));
            ([sin * phi.cos(), sin * phi.sin()], flux)
        }))
    }
}

/// Data of a function of the file, as `Transmission Back`, in the visible band.
fn data<'a>(xml: &'a str, name: &str) -> &'a str {
    let head = format!("<WavelengthDataDirection>{name}</WavelengthDataDirection>");
    let block = xml.split(&head).nth(1).unwrap();
    let data = block.split("<ScatteringData>").nth(1).unwrap();
    data.split('<').next().unwrap()
}

/// A node of a tree: halves of all axes, or values of two cells per axis, or one.
enum Tree {
    Halves(Vec<Tree>),
    Values(Vec<f64>),
}

impl Tree {
    fn read(text: &str) -> Self {
        let spaced = text.replace('{', " { ").replace('}', " } ");
        let mut words = spaced.split_whitespace();
        assert_eq!(words.next(), Some("{"));
        Self::node(&mut words)
    }

    fn node<'a>(words: &mut impl Iterator<Item = &'a str>) -> Self {
        let (mut halves, mut values) = (Vec::new(), Vec::new());
        loop {
            match words.next().unwrap() {
                "{" => halves.push(Self::node(words)),
                "}" => break,
                number => values.push(number.parse().unwrap()),
            }
        }
        assert!(halves.is_empty() || values.is_empty());
        match halves.is_empty() {
            true => Self::Values(values),
            false => Self::Halves(halves),
        }
    }

    /// Value at a point of the unit cube: the first axis is the lowest bit of the number of a half, and the slowest of values.
    fn at(&self, point: &[f64]) -> f64 {
        let upper = |axis: usize| usize::from(point[axis] >= 0.5);
        match self {
            Self::Values(values) if values.len() == 1 => values[0],
            Self::Values(values) => {
                assert_eq!(values.len(), 1 << point.len());
                values[(0..point.len()).fold(0, |place, axis| 2 * place + upper(axis))]
            }
            Self::Halves(halves) => {
                assert_eq!(halves.len(), 1 << point.len());
                let number = (0..point.len())
                    .map(|axis| upper(axis) << axis)
                    .sum::<usize>();
                let within: Vec<f64> = point.iter().map(|at| (2.0 * at) % 1.0).collect();
                halves[number].at(&within)
            }
        }
    }

    /// Light that leaves, of light at a point of the axes of light.
    fn light(&self, light: &[f64]) -> Light {
        let parts = 128;
        Light::of((0..parts * parts).map(|i| {
            let square = [i / parts, i % parts].map(|k| (k as f64 + 0.5) / f64::from(parts as u32));
            let value = self.at(&[light, &square].concat());
            (disc(square), value * PI / f64::from((parts * parts) as u32))
        }))
    }
}

/// Shirley and Chiu's map from the unit square to the unit disc.
fn disc(square: [f64; 2]) -> [f64; 2] {
    let [a, b] = square.map(|one| 2.0 * one - 1.0);
    let (radius, angle) = match a.abs() > b.abs() {
        true => (a, FRAC_PI_4 * b / a),
        false => (b, FRAC_PI_4 * (2.0 - a / b)),
    };
    [radius * angle.cos(), radius * angle.sin()]
}

/// Its inverse, by search among the middles of cells.
fn square(disc_point: [f64; 2]) -> [f64; 2] {
    let cells = 512;
    let middle = |i: usize| [i / cells, i % cells].map(|k| (k as f64 + 0.5) / cells as f64);
    let distance = |i: &usize| {
        let [x, y] = disc(middle(*i));
        (x - disc_point[0]).hypot(y - disc_point[1])
    };
    let all = 0..cells * cells;
    middle(
        all.min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap(),
    )
}

#[test]
fn a_tensor_tree_of_light_from_random_azimuths_has_its_flux_and_direction() {
    let folder = Folder::new();
    let line = "gonio --smoothness 8 --tau 16 --eta 1.5 --thickness 1000 --for tensor-tree";
    folder.succeed(format!("{line} {LITTLE} -o g"));
    let text = folder.succeed("export g --format tensor-tree -o g.xml");
    unwrapped(&text).must_contain("34 of 34 directions");
    unwrapped(&text).must_contain("TensorTree3");
    let xml = folder.text("g.xml");
    let bsdf = Table::read(&folder.join("g/bsdf.csv"));
    for (setting, from) in ["Back", "Front"].into_iter().enumerate() {
        for (kind, side) in [("Transmission", "transmitted"), ("Reflection", "reflected")] {
            let tree = Tree::read(data(&xml, &format!("{kind} {from}")));
            for theta in [0.0_f64, 38.0, 57.0] {
                let measured = Light::measured(&bsdf, setting, side, [theta, 0.0]);
                let found = tree.light(&[0.5 - 0.5 * theta.to_radians().sin() - 1e-6]);
                // Cells of light are 1/32 wide in the sine, per unit of which reflectance changes by up to 1 at these angles, and merged cells move
                // some light. It comes from -x in the file, from +x in the results
                let error = (found.flux - measured.flux).abs();
                assert!(
                    error < 0.02,
                    "{side} {from} {theta}: {found:?} {measured:?}"
                );
                assert!(
                    found.distance(&measured.turned()) < 0.04,
                    "{side} {from} {theta}: {found:?} {measured:?}"
                );
            }
        }
    }
}

fn long_slopes(folder: &Folder) {
    // They face -x, so that no two azimuths are alike
    let row: Vec<String> = (0..32)
        .map(|i| format!("{:.2}", 0.15 * f64::from(i % 8)))
        .collect();
    folder.write("saw.txt", vec![row.join(" "); 32].join("\n"));
}

#[test]
fn a_tensor_tree_of_a_sample_with_a_direction_sends_light_where_it_went() {
    let folder = Folder::new();
    long_slopes(&folder);
    let line = "gonio --surface saw.txt --spacing 1 --eta 1.5 --thickness 1000 --from both --theta 20,40,60 --phi 0:330:30";
    folder.succeed(format!("{line} --rays 2e4 --no-plots --quiet -o g"));
    let text = folder.succeed("export g --format tensor-tree -o g.xml");
    unwrapped(&text).must_contain("TensorTree4 of 32 cells");
    let xml = folder.text("g.xml");
    let bsdf = Table::read(&folder.join("g/bsdf.csv"));
    for (setting, from) in ["Back", "Front"].into_iter().enumerate() {
        for (kind, side) in [("Transmission", "transmitted"), ("Reflection", "reflected")] {
            let tree = Tree::read(data(&xml, &format!("{kind} {from}")));
            for phi in [0.0_f64, 120.0, 270.0] {
                let measured = Light::measured(&bsdf, setting, side, [40.0, phi]);
                // Directions in which light travels
                let sin = -40_f64.to_radians().sin();
                let at = square([sin * phi.to_radians().cos(), sin * phi.to_radians().sin()]);
                let found = tree.light(&at);
                let what = format!("{side} {from} {phi}: {found:?} {measured:?}");
                // Half a cell of light is 1/32 of the sine, and reflectance changes by 0.4 from 40 to 60 degrees, 1.7 per unit
                assert!((found.flux - measured.flux).abs() < 0.06, "{what}");
                assert!(found.distance(&measured) < 0.08, "{what}");
            }
        }
    }
}

/// Patches of the full Klems basis: centre of their polar and azimuth angles, radians, and projected solid angle.
fn patches() -> Vec<([f64; 2], f64)> {
    let rings = [
        (5.0, 1),
        (15.0, 8),
        (25.0, 16),
        (35.0, 20),
        (45.0, 24),
        (55.0, 24),
        (65.0, 24),
        (75.0, 16),
        (90.0, 12),
    ];
    let mut lower: f64 = 0.0;
    let mut all = Vec::new();
    for (upper, count) in rings {
        let [a, b] = [lower, upper].map(|angle: f64| angle.to_radians().sin().powi(2));
        let theta = (0.5 * (a + b)).sqrt().asin();
        let width = 2.0 * PI / f64::from(count);
        all.extend((0..count).map(|k| ([theta, width * f64::from(k)], 0.5 * (b - a) * width)));
        lower = upper;
    }
    all[0].0 = [0.0, 0.0];
    all
}

#[test]
fn a_klems_matrix_of_a_sample_with_a_direction_has_the_light_of_every_patch() {
    let folder = Folder::new();
    long_slopes(&folder);
    let line =
        "gonio --surface saw.txt --spacing 1 --eta 1.5 --thickness 1000 --for klems --bins 18x36";
    folder.succeed(format!("{line} --rays 2e3 --no-plots --quiet -o g"));
    let text = folder.succeed("export g --format klems -o g.xml");
    unwrapped(&text).must_contain("290 of 290 directions");
    let xml = folder.text("g.xml");
    let gonio = Table::read(&folder.join("g/gonio.csv"));
    let bsdf = Table::read(&folder.join("g/bsdf.csv"));
    let patches = patches();
    for (setting, from) in ["Back", "Front"].into_iter().enumerate() {
        for (kind, side) in [("Transmission", "transmitted"), ("Reflection", "reflected")] {
            let numbers = data(&xml, &format!("{kind} {from}")).split(',');
            let matrix: Vec<f64> = numbers.filter_map(|one| one.trim().parse().ok()).collect();
            assert_eq!(matrix.len(), 145 * 145);
            for (column, (incident, _)) in patches.iter().enumerate().step_by(29) {
                let light = Light::of(patches.iter().enumerate().map(|(row, (angles, area))| {
                    let [sin, phi] = [angles[0].sin(), angles[1]];
                    let flux = matrix[row * 145 + column] * area;
                    ([sin * phi.cos(), sin * phi.sin()], flux)
                }));
                // A column is named by the direction in which light travels
                let towards = (incident[1].to_degrees() + 180.0) % 360.0;
                let wanted = (0..gonio.rows.len()).skip(145 * setting).take(145);
                let mut wanted = wanted.filter(|&row| {
                    let angle = |name| gonio.number(row, name);
                    let ring = angle("theta_i_deg").to_radians() - incident[0];
                    let turned = (angle("phi_i_deg") - towards).abs();
                    ring.abs() < 0.06 && (incident[0] == 0.0 || turned < 1e-6)
                });
                let row = wanted.next().unwrap();
                assert!(wanted.next().is_none());
                let angles = ["theta_i_deg", "phi_i_deg"].map(|name| gonio.number(row, name));
                let measured = Light::measured(&bsdf, setting, side, angles);
                let what = format!("{side} {from} {angles:?}: {light:?} {measured:?}");
                let flux = gonio.number(row, side);
                assert!((light.flux - flux).abs() < 1e-3, "{what}");
                // Half a patch is up to 0.1 wide
                assert!(light.distance(&measured) < 0.1, "{what}");
            }
        }
    }
}

#[test]
fn results_that_a_tensor_tree_cannot_hold_are_refused() {
    let folder = Folder::new();
    let slab = "gonio --smoothness 20 --eta 1.5 --thickness 1000 --rays 1e3 --realisations 1 --no-plots --quiet";
    for (name, flags) in [
        ("half", "--from above --theta 0,40"),
        ("one", "--from both --theta 0"),
        ("patches", "--from both --theta 0,10 --light-spread klems"),
        ("fixed", "--from both --theta 0,40 --light-azimuth fixed"),
    ] {
        folder.succeed(format!("{slab} {flags} -o {name}"));
    }
    for (name, words) in [
        ("half", "needs light from both sides"),
        ("one", "several polar angles"),
        ("patches", "without --light-spread"),
        ("fixed", "four azimuths or more"),
    ] {
        folder
            .refused(format!("export {name} --format tensor-tree -o t.xml"))
            .must_contain(words);
    }
    assert!(!folder.join("t.xml").exists());
}

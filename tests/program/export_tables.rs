//! `asperity export`: tables about the specular direction, next to the results that they are made of.

use netcdf3::FileReader;

use crate::support::{Folder, InFolder, MustContain, Table, unwrapped};

/// Blazed grooves with some roughness, lit from four azimuths: lobes lie off the specular direction, along the plane of incidence and across.
const GROOVES: &str = "gonio --structure blazed-grooves --width 16 --depth 2 --sigma 0.6 --tau 4 --size 64 --spacing 1 --eta 1.5 \
    --theta 0,30 --phi 0:270:90 --rays 1e5 --realisations 2 --bins 36x72 --no-plots --quiet";

/// Random surfaces without a direction of their own.
const GLASS: &str = "gonio --smoothness 8 --eta 1.5 --realisations 4 --no-plots --quiet";

/// A Zemax file.
#[derive(Debug)]
struct Zemax {
    symmetry: String,
    scatter: String,
    rotations: Vec<f64>,
    incidences: Vec<f64>,
    azimuths: Vec<f64>,
    radial: Vec<f64>,
    /// Scattered flux and values by azimuth and angle to the specular direction, by rotation and incidence.
    blocks: Vec<(f64, Vec<f64>)>,
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace()
        .map(|one| one.parse().unwrap())
        .collect()
}

impl Zemax {
    fn read(text: &str) -> Self {
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let mut field = |name: &str| {
            let (found, value) = lines.next().unwrap().split_once("  ").unwrap();
            assert_eq!(found, name);
            value.to_owned()
        };
        assert_eq!(field("Source"), "Measured");
        let symmetry = field("Symmetry");
        assert_eq!(field("SpectralContent"), "Monochrome");
        let scatter = field("ScatterType");
        let mut list = |name: &str| {
            let count = lines.next().unwrap().strip_prefix(name).unwrap();
            let line = lines.next().unwrap();
            // OpticStudio takes no separator at the end
            assert!(!line.ends_with('\t'));
            let found = numbers(line);
            assert_eq!(numbers(count), [found.len() as f64]);
            found
        };
        let [rotations, incidences, azimuths, radial] = [
            "SampleRotation",
            "AngleOfIncidence",
            "ScatterAzimuth",
            "ScatterRadial",
        ]
        .map(&mut list);
        for expected in ["", "Monochrome", "DataBegin"] {
            assert_eq!(lines.next(), Some(expected));
        }
        let blocks = (0..rotations.len() * incidences.len()).map(|_| {
            let flux = lines.next().unwrap().strip_prefix("TIS ").unwrap();
            let rows = azimuths.iter().flat_map(|_| {
                let row = numbers(lines.next().unwrap());
                assert_eq!(row.len(), radial.len());
                row
            });
            let rows = rows.collect();
            (flux.parse().unwrap(), rows)
        });
        let blocks = blocks.collect();
        assert_eq!(lines.next(), Some("DataEnd"));
        Self {
            symmetry,
            scatter,
            rotations,
            incidences,
            azimuths,
            radial,
            blocks,
        }
    }

    /// Flux of a block, and the mean of x and y of the directions in which it leaves, of light from the azimuth of the rotation.
    fn light(&self, rotation: usize, incidence: usize) -> [f64; 3] {
        let (_, values) = &self.blocks[rotation * self.incidences.len() + incidence];
        let tilt = self.incidences[incidence].to_radians();
        let turn = self.rotations[rotation].to_radians();
        let radians = |all: &[f64]| all.iter().map(|one| one.to_radians()).collect::<Vec<f64>>();
        let [azimuths, radial] = [&self.azimuths, &self.radial].map(|all| radians(all));
        let [mut flux, mut x, mut y] = [0.0; 3];
        let steps = 6;
        for j in 1..azimuths.len() {
            for i in 1..radial.len() {
                for part in 0..steps * steps {
                    let [u, v] = [part % steps, part / steps]
                        .map(|part| (f64::from(part) + 0.5) / f64::from(steps));
                    let at = |j: usize, i: usize| values[j * radial.len() + i];
                    let before = at(j - 1, i - 1) * (1.0 - u) + at(j - 1, i) * u;
                    let after = at(j, i - 1) * (1.0 - u) + at(j, i) * u;
                    let value = before * (1.0 - v) + after * v;
                    let r = radial[i - 1] + u * (radial[i] - radial[i - 1]);
                    let a = azimuths[j - 1] + v * (azimuths[j] - azimuths[j - 1]);
                    // Light from +x leaves about -x; azimuth 0 is towards the normal
                    let along = -tilt.sin() * r.cos() + tilt.cos() * r.sin() * a.cos();
                    let across = r.sin() * a.sin();
                    let up = tilt.cos() * r.cos() + tilt.sin() * r.sin() * a.cos();
                    if up <= 0.0 {
                        continue;
                    }
                    let area = (radial[i] - radial[i - 1]) * (azimuths[j] - azimuths[j - 1]);
                    let light = value * up * r.sin() * area / f64::from(steps * steps);
                    flux += light;
                    x += light * (along * turn.cos() - across * turn.sin());
                    y += light * (along * turn.sin() + across * turn.cos());
                }
            }
        }
        [flux, x / flux, y / flux]
    }
}

/// The same of the bins of a measurement, by polar angle and azimuth of the light and side.
fn light_of_bins(folder: &Folder, name: &str) -> impl Fn([usize; 2], usize) -> [f64; 3] {
    folder.succeed(format!("export {name} --format netcdf -o bins.nc --quiet"));
    let mut reader = FileReader::open(folder.join("bins.nc")).unwrap();
    let lengths: Vec<usize> = {
        let variable = reader.data_set().get_var("bsdf").unwrap();
        variable.get_dims().iter().map(|one| one.size()).collect()
    };
    let [bsdf, theta, phi] =
        ["bsdf", "theta_o_bounds", "phi_o_bounds"].map(|name| reader.read_var_f64(name).unwrap());
    move |[t, p]: [usize; 2], side: usize| {
        let [rings, sectors] = [lengths[3], lengths[4]];
        let first = ((t * lengths[1] + p) * lengths[2] + side) * rings * sectors;
        let [mut flux, mut x, mut y] = [0.0; 3];
        for i in 0..rings * sectors {
            let edges = |all: &[f64], k: usize| [all[2 * k], all[2 * k + 1]].map(f64::to_radians);
            let [a, b] = edges(&theta, i / sectors);
            let [from, to] = edges(&phi, i % sectors);
            let area = 0.5 * (b.sin().powi(2) - a.sin().powi(2)) * (to - from);
            let light = bsdf[first + i] * area;
            let [sine, azimuth] = [(0.5 * (a + b)).sin(), 0.5 * (from + to)];
            flux += light;
            x += light * sine * azimuth.cos();
            y += light * sine * azimuth.sin();
        }
        [flux, x / flux, y / flux]
    }
}

#[test]
fn zemax_tables_have_the_light_of_every_azimuth_where_the_results_have_it() {
    let folder = Folder::new();
    folder.succeed(format!("{GROOVES} -o g"));
    let expected = light_of_bins(&folder, "g");
    let table = Table::read(&folder.join("g/gonio.csv"));
    for (number, side) in ["reflected", "transmitted"].into_iter().enumerate() {
        folder.succeed(format!("export g --format zemax --side {side} -o g.bsdf"));
        let file = Zemax::read(&folder.text("g.bsdf"));
        assert_eq!(file.symmetry, "ASymmetrical4D");
        assert_eq!(file.scatter, ["BRDF", "BTDF"][number]);
        assert_eq!(file.rotations, [0.0, 90.0, 180.0, 270.0, 360.0]);
        let refracted = (0.5_f64 / 1.5).asin().to_degrees();
        let specular = [30.0, refracted][number];
        assert!((file.incidences[1] - specular).abs() < 1e-6);
        // The turn ends where it began
        assert_eq!(file.blocks[8..], file.blocks[..2]);
        for rotation in 0..4 {
            for incidence in 0..2 {
                let found = file.light(rotation, incidence);
                let expected = expected([incidence, rotation], number);
                let row = (0..8).find(|&row| {
                    let at = |name: &str| table.number(row, name);
                    at("theta_i_deg") == [0.0, 30.0][incidence]
                        && at("phi_i_deg") == file.rotations[rotation]
                });
                let flux = table.number(row.unwrap(), side);
                let (scattered, _) = file.blocks[rotation * 2 + incidence];
                assert!((scattered - flux).abs() < 1e-6);
                let at = format!("{side} {rotation} {incidence}: {found:?} {expected:?}");
                assert!((found[0] / flux - 1.0).abs() < 0.05, "{at}");
                // The mean tilt of the grooves moves the mean of reflected light by 0.17, of transmitted by 0.02
                let limit = [0.015, 0.01][number];
                for axis in 1..3 {
                    assert!((found[axis] - expected[axis]).abs() < limit, "{at}");
                }
            }
        }
    }
}

#[test]
fn zemax_tables_of_random_surfaces_are_symmetric_and_agree_with_the_flux() {
    let folder = Folder::new();
    folder.succeed(format!("{GLASS} --theta 0,40,70 -o g"));
    for side in ["reflected", "transmitted"] {
        let text = folder.succeed(format!("export g --format zemax --side {side} -o g.bsdf"));
        unwrapped(&text).must_contain("3 of 3 directions");
        let file = Zemax::read(&folder.text("g.bsdf"));
        assert_eq!(file.symmetry, "PlaneSymmetrical");
        assert_eq!(file.azimuths.last(), Some(&180.0));
        for incidence in 0..3 {
            let [half, ..] = file.light(0, incidence);
            let flux = file.blocks[incidence].0;
            assert!(
                (2.0 * half / flux - 1.0).abs() < 0.005,
                "{side} {incidence}: {half} {flux}"
            );
        }
        // Away from the normal the horizon comes first
        let values = &file.blocks[2].1;
        let tilt = file.incidences[2];
        let columns = file.radial.len();
        let beyond = file.radial.iter().position(|r| r + tilt > 90.0).unwrap();
        let last = (file.azimuths.len() - 1) * columns;
        assert!(values[last + beyond..].iter().all(|value| *value == 0.0));
        assert!(side == "transmitted" || values[beyond] > 0.0);
    }
    // The side that is recorded, without being named
    folder.succeed(format!("{GLASS} --theta 30 --side transmitted -o t"));
    folder.succeed("export t --format zemax -o t.bsdf --quiet");
    assert_eq!(Zemax::read(&folder.text("t.bsdf")).scatter, "BTDF");
}

/// Both files have the same values, in another order.
#[test]
fn ssdd_has_the_values_of_the_tables_of_both_sides() {
    let folder = Folder::new();
    folder.succeed(format!("{GROOVES} -o g"));
    folder.succeed("export g --format ssdd -o g.ssdd --quiet");
    let text = folder.text("g.ssdd");
    assert!(text.starts_with("VERSION 0.3\n"));
    let blocks: Vec<&str> = text.split("\nDATA_TYPE ").skip(1).collect();
    for (number, side) in ["reflected", "transmitted"].into_iter().enumerate() {
        folder.succeed(format!(
            "export g --format zemax --side {side} -o g.bsdf --quiet"
        ));
        let table = Zemax::read(&folder.text("g.bsdf"));
        let (head, data) = blocks[number].split_once("DATA ascii\n").unwrap();
        let list = |name: &str| {
            let line = head.lines().find_map(|line| line.strip_prefix(name));
            line.map(numbers)
        };
        assert!(head.starts_with(["brdf", "btdf"][number]));
        assert_eq!(list("PARAM0_LIST").unwrap(), [0.0, 30.0]);
        assert_eq!(list("PARAM1_LIST").unwrap(), table.rotations);
        assert_eq!(list("PARAM2_LIST").unwrap(), table.radial);
        assert_eq!(list("PARAM3_LIST").unwrap(), table.azimuths);
        let offsets = list("PARAM4_LIST").unwrap_or(vec![0.0, 0.0]);
        assert!((offsets[1] + 30.0 - table.incidences[1]).abs() < 2e-6);
        let data = numbers(data);
        let [thetas, turns, radial] = [2, 5, table.radial.len()];
        assert_eq!(data.len(), table.azimuths.len() * radial * turns * thetas);
        for (i, value) in data.iter().enumerate() {
            let block = i / thetas % turns * thetas + i % thetas;
            let expected = table.blocks[block].1[i / (thetas * turns)];
            assert_eq!(*value, expected, "{side} {i}");
        }
    }
}

#[test]
fn ssdd_has_one_column_per_wavelength() {
    let folder = Folder::new();
    let line = "gonio --smoothness 8 --tau 16um --material BK7 --rays 4e3 --realisations 1 --bins 18x36 --no-plots --quiet";
    folder.succeed(format!("{line} --theta 0,40 --wavelength 450nm,650nm -o g"));
    folder.succeed("export g --format ssdd -o g.ssdd --quiet");
    let text = folder.text("g.ssdd");
    text.must_contain("COLOR_MODEL spectrum\nWAVELENGTH_LIST 450 650\n");
    text.must_contain("REDUCTION_TYPE bilateral_symmetry\n");
    let data = text.split("DATA ascii\n").nth(1).unwrap();
    let first = numbers(data.lines().next().unwrap());
    // Glass reflects more of the shorter wave, by Fresnel's equations at normal incidence: 0.0436 of 450 nm, 0.0422 of 650 nm
    assert_eq!(first.len(), 2);
    assert!(
        first[0] > first[1] && first[0] < 1.1 * first[1],
        "{first:?}"
    );
    folder
        .refused("export g --format zemax -o g.bsdf")
        .must_contain("one wavelength");
}

#[test]
fn tables_that_cannot_be_made_are_refused() {
    let folder = Folder::new();
    let fixed = format!("{GLASS} --rays 1e3 --light-azimuth fixed");
    folder.succeed(format!("{fixed} --theta 30 --phi 0,90 -o uneven"));
    folder.succeed(
        "gonio --smoothness 8,9 --eta 1.5 --rays 1e3 --realisations 1 --no-plots --quiet --theta 30 -o two",
    );
    folder.succeed(
        "gonio --smoothness 8 --material mirror --rays 1e3 --realisations 1 --no-plots --quiet --theta 30 -o mirror",
    );
    folder.succeed(
        "gonio --smoothness 8 --eta 1/1.5 --rays 1e3 --realisations 1 --no-plots --quiet --theta 30,60 -o dense",
    );
    for (setting, name) in [
        ("--stokes 1,1,0,0", "polarised"),
        ("--light-spread 5", "cone"),
    ] {
        folder.succeed(format!("{fixed} --theta 30 {setting} -o {name}"));
    }
    for (line, words) in [
        (
            "export polarised --format zemax -o z.bsdf",
            "unpolarised light",
        ),
        (
            "export cone --format ssdd -o z.ssdd",
            "one direction at a time",
        ),
        (
            "export uneven --format zemax -o z.bsdf",
            "divide the turn evenly",
        ),
        (
            "export uneven --format ssdd -o z.ssdd",
            "divide the turn evenly",
        ),
        ("export two --format zemax -o z.bsdf", "differ in s"),
        ("export two --format ssdd -o z.ssdd", "differ in s"),
        (
            "export mirror --format zemax --side transmitted -o z.bsdf",
            "this one is opaque",
        ),
        (
            "export two --format zemax --side both -o z.bsdf",
            "reflected",
        ),
        (
            "export two --format netcdf --side reflected -o z.nc",
            "--side",
        ),
        ("export two --format zemax -o z.nc", "written as .bsdf"),
    ] {
        let text = folder.refused(line);
        assert!(unwrapped(&text).contains(words), "{line}: {text}");
    }
    // Beyond total reflection there is no refracted direction
    let text = folder.succeed("export dense --format zemax --side transmitted -o d.bsdf");
    unwrapped(&text).must_contain("left out: 1 directions");
    let incidences = Zemax::read(&folder.text("d.bsdf")).incidences;
    let expected = 0.75_f64.asin().to_degrees();
    assert!(incidences.len() == 1 && (incidences[0] - expected).abs() < 1e-6);
    assert!(!folder.join("z.bsdf").exists());
}

//! `asperity export`: files of other programs, next to the results that they are made of.

use std::f64::consts::PI;

use netcdf3::FileReader;

use crate::support::{Folder, InFolder, MustContain, Table, json, unwrapped};

/// A small measurement on smooth random surfaces, whose lobes are narrow.
const GONIO: &str =
    "gonio --smoothness 20 --eta 1.5 --rays 1e4 --realisations 2 --no-plots --quiet";

/// Numbers of a variable, and the lengths of its dimensions.
fn read(reader: &mut FileReader, name: &str) -> (Vec<f64>, Vec<usize>) {
    let variable = reader.data_set().get_var(name).unwrap();
    let lengths = variable.get_dims().iter().map(|one| one.size()).collect();
    (reader.read_var_f64(name).unwrap(), lengths)
}

/// Integral over bins between edges `[rings][2]` and `[sectors][2]`, degrees.
fn integral(bsdf: &[f64], theta: &[f64], phi: &[f64]) -> f64 {
    let sectors = phi.len() / 2;
    let values = bsdf.iter().enumerate().filter(|(_, value)| !value.is_nan());
    let parts = values.map(|(i, value)| {
        let [ring, sector] = [i / sectors, i % sectors];
        let square = |angle: f64| angle.to_radians().sin().powi(2);
        let band = 0.5 * (square(theta[2 * ring + 1]) - square(theta[2 * ring]));
        value * band * (phi[2 * sector + 1] - phi[2 * sector]).to_radians()
    });
    parts.sum()
}

#[test]
fn netcdf_has_the_light_of_the_results_over_common_and_over_exact_bins() {
    let folder = Folder::new();
    folder.succeed(format!(
        "{GONIO} --theta 0,40 --phi 0,90 --light-azimuth fixed -o g"
    ));
    let text = folder.succeed("export g --format netcdf -o g.nc");
    unwrapped(&text).must_contain("4 of 4 directions");
    unwrapped(&text).must_contain("bins differ between directions");
    let table = Table::read(&folder.join("g/gonio.csv"));
    let mut reader = FileReader::open(folder.join("g.nc")).unwrap();
    let (flux, lengths) = read(&mut reader, "flux");
    assert_eq!(lengths, [2, 2, 2]);
    let (theta_i, _) = read(&mut reader, "theta_i");
    assert_eq!(theta_i, [0.0, 40.0]);
    let (bsdf, common) = read(&mut reader, "bsdf");
    assert_eq!(common, [2, 2, 2, 18, 36]);
    let (exact, own) = read(&mut reader, "bsdf_exact");
    let [theta, phi] = ["theta_o_bounds", "phi_o_bounds"].map(|name| read(&mut reader, name).0);
    let [theta_own, phi_own] =
        ["theta_o_exact", "phi_o_exact"].map(|name| read(&mut reader, name).0);
    for (i, flux) in flux.iter().enumerate() {
        let side = ["reflected", "transmitted"][i % 2];
        assert_eq!(*flux, table.number(i / 2, side), "{i}");
        let of = |values: &[f64], lengths: &[usize]| {
            let count: usize = lengths[3..].iter().product();
            values[i * count..(i + 1) * count].to_vec()
        };
        // The lobe about the mirror direction or that of refraction, of light from 40 degrees
        let values = of(&bsdf, &common);
        let most = (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b]));
        let (ring, sector) = (most.unwrap() / 36, most.unwrap() % 36);
        if i >= 4 {
            let [rings, sectors] = [[[7, 8], [4, 5]][i % 2], [[17, 18], [26, 27]][(i / 2) % 2]];
            assert!(
                rings.contains(&ring) && sectors.contains(&sector),
                "{i}: {ring} {sector}"
            );
        } else {
            assert_eq!(ring, 0);
        }
        let found = integral(&values, &theta, &phi);
        assert!((found - flux).abs() < 1e-12, "{i}: {found} {flux}");
        let edges =
            |values: &[f64], count: usize| values[2 * i * count..2 * (i + 1) * count].to_vec();
        let [rings, sectors] = [own[3], own[4]];
        let found = integral(
            &of(&exact, &own),
            &edges(&theta_own, rings),
            &edges(&phi_own, sectors),
        );
        assert!((found - flux).abs() < 1e-12, "{i}: {found} {flux}");
    }
    let attribute = |name: &str| reader.data_set().get_global_attr_as_string(name).unwrap();
    assert_eq!(attribute("Conventions"), "CF-1.11");
    assert!(json(&attribute("configuration"))["run"]["rays"] == 10_000);

    folder.succeed("export g/results.npz --format netcdf -o again.nc --quiet");
    let [first, second] =
        ["g.nc", "again.nc"].map(|name| std::fs::read(folder.join(name)).unwrap());
    assert!(first == second);
}

#[test]
fn netcdf_takes_what_tells_settings_apart_for_axes() {
    let folder = Folder::new();
    let line = "gonio --tau 16um --sigma 4um --spacing 1um --size 128 --material BK7 --thickness 1mm --from both --theta 30,0 --rays 1e3 \
        --realisations 1 --bins 9x12 --no-plots --quiet";
    folder.succeed(format!("{line} --wavelength 450nm,650nm -o g"));
    folder.succeed("export g --format netcdf -o g.nc --quiet");
    let mut reader = FileReader::open(folder.join("g.nc")).unwrap();
    let names: Vec<String> = {
        let variable = reader.data_set().get_var("bsdf").unwrap();
        variable.get_dims().iter().map(|one| one.name()).collect()
    };
    let expected = [
        "from",
        "wavelength",
        "theta_i",
        "phi_i",
        "side",
        "theta_o",
        "phi_o",
    ];
    assert_eq!(names, expected);
    assert_eq!(read(&mut reader, "bsdf").1, [2, 2, 2, 1, 2, 9, 12]);
    assert_eq!(read(&mut reader, "theta_i").0, [0.0, 30.0]);
    // What follows from the wavelength is no axis
    let (eta, lengths) = read(&mut reader, "eta");
    assert_eq!(lengths, [2, 2]);
    assert!(eta[0] > eta[1] && eta[..2] == eta[2..], "{eta:?}");
    assert!(reader.data_set().get_var("bsdf_exact").is_none());
}

/// Upper bounds of the polar angles of the rings of the Klems basis, degrees, and their patches.
const RINGS: [(f64, usize); 9] = [
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

#[test]
fn klems_matrices_have_the_light_of_both_sides_and_send_it_straight_on() {
    let folder = Folder::new();
    let line = "gonio --smoothness 40 --tau 16 --eta 1.5 --thickness 1000 --for klems --bins 36x120 --rays 1e4 --realisations 2 --no-plots \
        --quiet";
    folder.succeed(format!("{line} -o k"));
    let text = folder.succeed("export k --format klems -o k.xml");
    unwrapped(&text).must_contain("the lengths of the sample have no unit");
    let xml = folder.text("k.xml");
    let table = Table::read(&folder.join("k/gonio.csv"));
    let blocks: Vec<&str> = xml.split("<WavelengthDataDirection>").skip(1).collect();
    assert_eq!(blocks.len(), 8);
    let lower = [0.0].into_iter().chain(RINGS.map(|(upper, _)| upper));
    let patches: Vec<(usize, f64)> = lower
        .zip(RINGS)
        .enumerate()
        .flat_map(|(ring, (lower, (upper, count)))| {
            let [a, b] = [lower, upper].map(|angle| angle.to_radians().sin().powi(2));
            vec![(ring, PI * (b - a) / count as f64); count]
        })
        .collect();
    for block in &blocks[..4] {
        let (name, rest) = block.split_once('<').unwrap();
        let data = rest.split("<ScatteringData>").nth(1).unwrap();
        let data = data.split('<').next().unwrap();
        let numbers = data.split(',').map(str::trim).filter(|one| !one.is_empty());
        let matrix: Vec<f64> = numbers.map(|one| one.parse().unwrap()).collect();
        assert_eq!(matrix.len(), 145 * 145, "{name}");
        let (side, from) = name.split_once(' ').unwrap();
        let column = if side == "Transmission" {
            "transmitted"
        } else {
            "reflected"
        };
        let first = if from == "Back" { 0 } else { 9 };
        for (incident, (ring, _)) in patches.iter().enumerate() {
            let of = |leaving: usize| matrix[leaving * 145 + incident] * patches[leaving].1;
            let sum: f64 = (0..145).map(of).sum();
            let flux = table.number(first + ring, column);
            // Seven digits, and no negative values
            assert!((sum - flux).abs() < 1e-4, "{name} {incident}: {sum} {flux}");
            let most = (0..145).max_by(|&a, &b| of(a).total_cmp(&of(b))).unwrap();
            assert_eq!(most, incident, "{name}");
        }
    }
}

#[test]
fn results_that_a_format_cannot_hold_are_refused() {
    let folder = Folder::new();
    folder.succeed(format!("{GONIO} --theta 0 -o g"));
    folder.succeed(
        "map --smoothness 3 --theta 0 --rays 1e3 --realisations 2 --no-plots --quiet -o m",
    );
    let slab = "gonio --eta 1.5 --thickness 1000 --theta 0 --light-spread klems --rays 1e3 --realisations 1 --no-plots --quiet";
    folder.succeed(format!("{slab} --smoothness 20 --from above -o half"));
    folder.succeed(format!("{slab} --smoothness 20,30 --from both -o two"));
    folder.succeed(format!(
        "{slab} --smoothness 20 --from both --light-azimuth fixed -o fixed"
    ));
    folder.succeed(format!(
        "{slab} --smoothness 20 --from both --side reflected -o mirrored"
    ));
    folder.succeed(format!(
        "{slab} --smoothness 20 --from both --stokes 1,1,0,0 -o polarised"
    ));
    std::fs::hard_link(folder.join("g/results.npz"), folder.join("link.nc")).unwrap();
    for (line, words) in [
        (
            "export two --format klems -o k.xml",
            "differ in s: measure one at a time",
        ),
        ("export fixed --format klems -o k.xml", "all patches"),
        ("export half --format klems -o k.xml", "--from both"),
        (
            "export g --format klems -o k.xml",
            "a slab between equal media",
        ),
        ("export mirrored --format klems -o k.xml", "--side both"),
        (
            "export polarised --format klems -o k.xml",
            "unpolarised light",
        ),
        ("export g --format netcdf -o link.nc", "is the input"),
        ("export m --format netcdf -o m.nc", "holds results of map"),
        ("export g --format netcdf -o g.xml", "written as .nc"),
        ("export --format netcdf -o g.nc", "no results"),
        ("export g -o g.nc", "--format"),
        ("export g --format rgb -o g.nc", "netcdf"),
    ] {
        folder.refused(line).must_contain(words);
    }
    folder
        .failed("export nothing --format netcdf -o g.nc")
        .must_contain("nothing");
    assert!(!folder.join("g.nc").exists());
}

/// Glass that is clear up to 780 nm, and black from 800 nm on.
#[test]
fn the_solar_band_of_klems_weights_the_spectrum_by_sunlight() {
    let folder = Folder::new();
    let rows = [(300, 0.0), (780, 0.0), (800, 2e-3), (2500, 2e-3)];
    let rows = rows.map(|(nm, k)| format!("{nm},1.5,{k}\n"));
    folder.write(
        "filter.csv",
        format!("wavelength_nm,n,k\n{}", rows.concat()),
    );
    let line = "gonio --smoothness 20 --tau 16um --material filter.csv --thickness 1mm --for klems --bins 9x18";
    let wavelengths = "--wavelength 350nm,400:780:20nm,800:2000:100nm";
    let little = "--rays 200 --realisations 1 --no-plots --quiet";
    folder.succeed(format!("{line} {wavelengths} {little} -o g"));
    let text = unwrapped(&folder.succeed("export g --format klems -o g.xml"));
    text.must_contain("ASTM G173-03");
    let xml = folder.text("g.xml");
    let transmitted = |band: &str| {
        let of_band = xml.split("<WavelengthData>").find(|block| {
            block.contains(&format!(">{band}<")) && block.contains("Transmission Back")
        });
        let data = of_band.unwrap().split("<ScatteringData>\n").nth(1).unwrap();
        let rows = data.split('<').next().unwrap().lines();
        rows.map(|row| row.split(',').next().unwrap().parse::<f64>().unwrap())
            .sum::<f64>()
    };
    // 58.3 % of G173 from 300 to 2500 nm lie below 790 nm
    let ratio = transmitted("Solar") / transmitted("Visible");
    assert!((ratio - 0.583).abs() < 0.02, "{ratio}");

    folder.succeed(format!(
        "{line} --wavelength 400:700:20nm {little} -o visible"
    ));
    let text = unwrapped(&folder.succeed("export visible --format klems -o v.xml"));
    text.must_contain("the Visible band alone");
}

#[test]
fn what_a_format_cannot_hold_is_refused_before_it_is_traced() {
    let folder = Folder::new();
    let slab = "--eta 1.5 --thickness 1000";
    for (format, flags, words) in [
        (
            "klems",
            "--eta 1.5".to_owned(),
            "give the sample a --thickness",
        ),
        ("klems", format!("{slab} --from above"), "--from both"),
        (
            "klems",
            format!("{slab} --theta 0,30"),
            "light from all patches",
        ),
        (
            "tensor-tree",
            format!("{slab} --theta 30"),
            "several polar angles",
        ),
        (
            "tensor-tree",
            format!("{slab} --light-azimuth fixed --phi 0,180"),
            "four azimuths",
        ),
        ("rgl", "--from both".to_owned(), "--from above"),
        ("rgl-rgb", "--theta 30".to_owned(), "several polar angles"),
        (
            "pbsdf",
            "--polarisation averaged".to_owned(),
            "Mueller matrices",
        ),
        (
            "zemax",
            "--light-spread 2".to_owned(),
            "without --light-spread",
        ),
        ("ssdd", "--directions 3x4".to_owned(), "from 0 on"),
        ("fit", "--stokes 1,1,0,0".to_owned(), "unpolarised"),
    ] {
        // Far more rays than the test has time for
        let line =
            format!("gonio --for {format} --smoothness 3 {flags} --rays 1e12 --quiet -o out");
        folder.refused(line).must_contain(words);
        assert!(!folder.join("out").exists(), "{format}");
    }
}

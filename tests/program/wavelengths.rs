//! Named materials and wavelengths: spectra in every study, films, bodies that absorb, colours and emissivity.

use crate::support::{Folder, InFolder, MustContain, Table, json, with_surface};

/// A surface with lengths in micrometres.
fn with_lengths() -> Folder {
    let folder = Folder::new();
    folder.succeed("generate --tau 16um --sigma 3um --spacing 1um --size 128 --seed 3 -o h.exr");
    folder
}

#[test]
fn one_trace_of_many_wavelengths_has_the_numbers_of_separate_ones() {
    let folder = with_surface();
    let light = "--material gold --theta 30 --rays 2e4 --no-plots --quiet";
    folder.succeed(format!(
        "trace h.exr {light} --wavelength 450,550nm,0.65um -o all"
    ));
    for nm in [450, 550, 650] {
        folder.succeed(format!("trace h.exr {light} --wavelength {nm} -o w{nm}"));
        for file in ["histogram.csv", "theta.csv", "in_plane.csv"] {
            let of_all = format!("all/gold_wavelength{nm}_theta30/{file}");
            assert_eq!(
                folder.text(&of_all),
                folder.text(format!("w{nm}/{file}")),
                "{file}"
            );
        }
    }
    let spectrum = Table::read(&folder.join("all/spectrum.csv"));
    let reflectance = [0, 1, 2].map(|row| spectrum.number(row, "reflectance"));
    assert!(reflectance.is_sorted(), "gold reflects red light best");
    for (row, reflectance) in reflectance.into_iter().enumerate() {
        let absorptance = spectrum.number(row, "absorptance");
        // Russian roulette ends some of the light.
        assert!((reflectance + absorptance - 1.0).abs() < 1e-3);
        assert_eq!(spectrum.number(row, "emissivity"), 1.0 - reflectance);
        assert!(spectrum.number(row, "reflectance_se") > 0.0);
    }
    // It resumes, and another list is another run.
    folder.succeed(format!(
        "trace h.exr {light} --wavelength 450,550,650 -o all"
    ));
}

#[test]
fn every_study_takes_wavelengths() {
    let folder = with_lengths();
    let gold = "--material gold --wavelength 500:700:100nm --theta 30 --quiet";
    let few = "--rays 1e3 --realisations 2 --size 128 --no-plots";
    let random = "--tau 8um --sigma 1um --spacing 0.5um";
    for line in [
        format!("verify {random} {gold} {few} --models smith -o v"),
        format!("gonio {random} {gold} {few} -o g"),
        format!("gonio --surface h.exr {gold} --rays 1e3 --no-plots -o gs"),
        format!("trace h.exr {gold} --rays 1e3 --no-plots -o t"),
    ] {
        folder.succeed(&line);
    }
    for out in ["v", "g", "gs", "t"] {
        let spectrum = Table::read(&folder.join(format!("{out}/spectrum.csv")));
        let wavelengths = [0, 1, 2].map(|row| spectrum.number(row, "wavelength_nm"));
        assert_eq!(wavelengths, [500.0, 600.0, 700.0], "{out}");
    }
    folder.succeed(format!("map {random} {gold} {few} --models smith -o m"));
    let cells = Table::read(&folder.join("m/map.csv"));
    assert_eq!(cells.number(0, "wavelength_nm"), 500.0);
    let model = folder.succeed(
        "model smith --smoothness 3 --material gold --wavelength 500,600 --theta 30 --json",
    );
    model.must_contain("wavelength_nm");
    folder.succeed(
        "converge --tau 8um --sigma 1um --spacing 1um --size 64 --material gold --wavelength 550 --theta 30 --rays 256 --surfaces 2,4 --no-plots --quiet -o c",
    );
    folder.succeed(
        "render h.exr --material gold --wavelength 550 --size 16x12 --samples 1 -o p.png --quiet",
    );
}

#[test]
fn thin_films_and_absorbing_bodies_change_what_is_reflected() {
    let folder = with_lengths();
    let run = |more: &str| {
        let line = format!("trace h.exr --theta 0 --rays 2e4 --no-plots --quiet --json {more}");
        let found = json(&folder.succeed(line));
        let mean = |name: &str| found["energy"][name]["mean"].as_f64().unwrap();
        [mean("reflected"), mean("transmitted"), mean("absorbed")]
    };
    let [bare, transmitted, absorbed] = run("--below silicon --wavelength 600nm");
    assert_eq!(transmitted, 0.0);
    assert!((bare + absorbed - 1.0).abs() < 1e-9 && bare > 0.3);
    // A quarter wave of index 1.97 on silicon
    let [coated, ..] = run("--below silicon --wavelength 600nm --film Si3N4:75nm --kappa 0");
    assert!(coated < 0.3 * bare, "{coated} {bare}");
    let [mirror, ..] = run("--material gold --wavelength 600nm --film 1+0i:100nm");
    let [same, ..] = run("--material gold --wavelength 600nm");
    assert!((mirror - same).abs() < 1e-9);
    let [reflected, transmitted, absorbed] = run("--above BK7 --wavelength 550nm");
    assert!(absorbed == 0.0 && (reflected + transmitted - 1.0).abs() < 1e-9);
}

/// Fresnel's equations at normal incidence: a film of index 1.38 on 1.5, seen from either side, and over a medium between two faces.
#[test]
fn films_are_seen_from_either_side_and_lie_over_media() {
    let folder = Folder::new();
    let run = |line: &str| {
        let line = format!("trace --flat --wavelength 550 --no-plots --quiet --json {line}");
        let found = json(&folder.succeed(line));
        let of = |part: &str| found["energy"]["reflected"][part].as_f64().unwrap();
        [of("mean"), of("se")]
    };
    let films = "--film 1.38:100nm,2.1:60nm";
    for theta in [0, 35, 60] {
        let below = run(&format!("--theta {theta} --below 1.5 {films} --from below"));
        let swapped = "--above 1.5 --below 1 --film 2.1:60nm,1.38:100nm";
        let above = run(&format!("--theta {theta} {swapped}"));
        assert!((below[0] - above[0]).abs() < 1e-14, "{below:?} {above:?}");
    }
    // The faces add without interference: R1 + T1^2 R2 / (1 - R1 R2)
    let [top, _] = run("--theta 0 --below 1.5 --film 1.38:100nm");
    let [slab, se] = run("--theta 0 --below 1.5 --film 1.38:100nm --thickness 1mm --rays 2e5");
    let bottom = 0.04;
    let exact = top + (1.0 - top) * (1.0 - top) * bottom / (1.0 - top * bottom);
    assert!(
        (slab - exact).abs() < 4.5 * se + 1e-9,
        "{slab} {se} {exact}"
    );
}

/// Absorption in glass goes from 0.1 m to some cm of depth among these wavelengths; slabs of silicon from opaque to clear.
#[test]
fn spectra_do_not_jump_where_a_body_becomes_clear_or_opaque() {
    let folder = with_lengths();
    let run = |line: &str, out: &str| {
        folder.succeed(format!(
            "trace {line} --theta 0 --rays 1e3 --no-plots --quiet -o {out}"
        ));
        Table::read(&folder.join(format!("{out}/spectrum.csv")))
    };
    let glass = run(
        "h.exr --material soda-lime-glass --wavelength 400:700:20nm",
        "glass",
    );
    for row in 0..16 {
        assert!(glass.number(row, "transmittance") > 0.9, "{row}");
    }
    let wafer = run(
        "--flat --material silicon --wavelength 400,700,900,1000 --thickness 180um",
        "wafer",
    );
    let absorptance = [0, 1, 2, 3].map(|row| wafer.number(row, "absorptance"));
    assert!(
        absorptance[1] > 0.6 && absorptance[1] > absorptance[3],
        "{absorptance:?}"
    );
    let media = run(
        "h.exr --below water --scattering 0.2 --wavelength 500,600",
        "media",
    );
    assert_eq!(media.number(1, "wavelength_nm"), 600.0);
}

#[test]
fn each_list_beside_wavelengths_makes_spectra_of_its_own() {
    let folder = with_lengths();
    folder.succeed(
        "trace h.exr --material SiO2 --kappa 0,0.1 --wavelength 500,600 --theta 0 --rays 1e3 --no-plots --quiet -o k",
    );
    let spectrum = Table::read(&folder.join("k/spectrum.csv"));
    let absorptance = [0, 1, 2, 3].map(|row| spectrum.number(row, "absorptance"));
    let wavelengths = [0, 1, 2, 3].map(|row| spectrum.number(row, "wavelength_nm"));
    assert_eq!(wavelengths, [500.0, 600.0, 500.0, 600.0]);
    assert!(absorptance[..2] == [0.0; 2] && absorptance[2] > 0.9);
    let report = folder.succeed(
        "verify --tau 8um --sigma 1um --spacing 1um --size 64 --material gold --wavelength 500,600 --theta 0,60 --rays 1e3 --realisations 2 --models none --no-plots",
    );
    for theta in [0, 60] {
        report.must_contain(format!("gold, theta = {theta} deg"));
    }
}

#[test]
fn visible_spectra_have_colours_and_opaque_ones_an_emissivity() {
    let folder = with_lengths();
    let gold = "--material gold --rays 1e3 --no-plots --quiet";
    folder.succeed(format!(
        "trace h.exr {gold} --theta 10 --wavelength 400:700:20nm -o t"
    ));
    let colours = folder.text("t/colour.csv");
    for words in [
        "CIE 1931 2 degrees",
        "CIE 1964 10 degrees",
        "reflected",
        "#f",
    ] {
        colours.must_contain(words);
    }
    let line = format!("gonio --surface h.exr {gold} --wavelength 1064 --theta 5:85:10 -o g");
    folder.succeed(&line);
    let report = folder.text("g/report.txt");
    report.must_contain("hemispherical emissivity");
    report.must_contain("1 less the directional-hemispherical reflectance");
    let emissivity = Table::read(&folder.join("g/emissivity.csv"));
    assert_eq!(emissivity.number(0, "theta_deg"), 5.0);
    let hemispherical = emissivity.number(0, "hemispherical_emissivity");
    // 1 - R of gold at normal incidence is 0.018 there, and rough surfaces reflect some light twice
    assert!((0.018..0.03).contains(&hemispherical), "{hemispherical}");
    folder.succeed(format!(
        "gonio --surface h.exr {gold} --wavelength 1064 --theta 0:60:20 -o low"
    ));
    let low = folder.text("low/report.txt");
    assert!(!low.contains("hemispherical emissivity"), "{low}");
}

#[test]
fn wrong_materials_and_wavelengths_get_a_sentence() {
    let folder = with_surface();
    folder.refuses(
        "
        trace h.exr --material gold => needs --wavelength
        trace h.exr --material golld --wavelength 550 => did you mean gold?
        trace h.exr --material gold --wavelength 20nm => 20 nm is out of range; the data reach from 187.9 to 1937 nm
        trace h.exr --material gold --kappa 3 --wavelength 550 => leave out kappa
        trace h.exr --material gold --eta 3 --wavelength 550 => --eta 3
        trace h.exr --material SiO2 --wavelength 550 => 0 for a clear one
        trace h.exr --material mirror --film SiO2:100nm => NAME or INDEX
        trace h.exr --material gold --wavelength 400:700:1e5 => FIRST:LAST:STEP
        trace h.exr --material gold --film MgF2:75nm --wavelength 550 => material MgF2 at 550 nm
        trace --flat --material gold --thickness 50nm --wavelength 550 => give that as a film
        trace h.exr --material gold --film 100nm --wavelength 550 => MATERIAL:THICKNESS
        trace h.exr --material gold --below silver --wavelength 550 => give one or the other
        trace h.exr --below silicon --wavelength 800 => have no unit
        trace h.exr --eta 1.5 --wavelength 500,600 => change nothing
        trace h.exr --above silver --below gold --wavelength 500 => no light comes through
        trace h.exr --material gold --wavelength 500 --from below => does not absorb
        render h.exr --below 0.5 -o p.png => --radiance-below
        model smith --smoothness 3 --eta 1.5 --wavelength 500 => changes nothing
        ",
    );
    folder.write("bad.csv", "wavelength,n\n1,2\n");
    let message = folder.failed("trace h.exr --material bad.csv --wavelength 550");
    message.must_contain("unit");
}

//! Models by name: alone, and against explicit surfaces with single and multiple scattering separate.

use crate::support::{Folder, InFolder, MustContain, Table, json, rows};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn every_model_says_where_it_holds() {
    let folder = Folder::new();
    let text = folder.succeed("model --list");
    let names = [
        "xu-sun",
        "xu-sun-mc",
        "xu-sun-mc-smith",
        "smith",
        "smith-separable",
        "ggx",
        "ggx-separable",
        "smith-slopes",
        "heitz",
        "heitz-ggx",
        "heitz-polarised",
        "v-cavity",
        "cook-torrance-neumann",
        "cook-torrance-neumann-smith",
        "oren-nayar",
        "hanrahan-krueger",
        "flat-layer",
    ];
    for name in names {
        assert!(text.lines().any(|line| line == name), "{name} in {text}");
    }
    assert_eq!(text.matches("\n  for ").count(), names.len());
}

#[test]
fn a_model_that_follows_rays_gives_energies_by_order_with_errors_and_bins() {
    let folder = Folder::new();
    let flags =
        "model heitz --smoothness 1 --eta 1.5 --theta 30 --rays 2e4 --bins 9x12 --json -o bins.csv";
    let result = json(&folder.succeed(flags));
    let energy = |name: &str| number(&result["energy"][name]["mean"]);
    // Glass loses nothing but what roulette leaves open.
    let sum = energy("reflected") + energy("transmitted") + energy("truncated");
    let se = |name: &str| number(&result["energy"][name]["se"]);
    // However the two are correlated.
    let largest = se("reflected") + se("transmitted");
    println!("sum {sum} +- {largest} at most");
    assert!(largest > 0.0 && largest < 0.01);
    assert!((sum - 1.0).abs() < 4.0 * largest);
    let orders = result["orders"]["transmitted"].as_array().unwrap();
    assert!(orders.len() > 3);
    assert_eq!(number(&orders[0]["se"]), 0.0, "single scattering is exact");
    assert!(number(&orders[1]["se"]) > 0.0);
    assert_eq!(result["rays"], 20_032, "64 batches of 313 rays");
    let table = folder.text("bins.csv");
    assert_eq!(table.lines().count(), 1 + 2 * 9 * 12);
    let total: f64 = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').nth(6).unwrap().parse::<f64>().unwrap())
        .sum();
    assert!((total - energy("reflected") - energy("transmitted")).abs() < 1e-9);
}

#[test]
fn a_closed_form_can_be_had_by_bins_and_turns_with_its_grooves() {
    let folder = Folder::new();
    let of = |flags: &str| {
        let flags = format!("model smith --smoothness 2 --eta 1.5 --theta 50 --json {flags}");
        let result = json(&folder.succeed(flags.trim_end()));
        number(&result["energy"]["reflected"]["mean"])
    };
    let round = of("");
    assert_eq!(of("--smoothness-y 2"), round);
    let across = of("--smoothness-y 8");
    let along = of("--smoothness-y 8 --azimuth 90");
    println!("isotropic {round}, light across the grooves {across}, along {along}");
    assert!((across / along - 1.0).abs() > 0.01);
    // Turning surface and light together changes nothing but the roundings of the axes.
    let turned = of("--smoothness-y 8 --azimuth 25 --phi 25");
    assert!((turned / across - 1.0).abs() < 1e-8, "{turned} {across}");
}

#[test]
fn single_and_multiple_scattering_are_judged_apart() {
    let folder = Folder::new();
    let flags = "verify --tau 8 --size 128 --smoothness 1 --realisations 12 --rays 6e4 --models \
                 smith,heitz --model-rays 6e4 --bins 9x12 -o out";
    let text = folder.succeed(flags);
    for heading in ["single scattering", "multiple scattering", "all orders"] {
        text.must_contain(format!("\n{heading} "));
    }
    for sentence in ["Single", "Multiple", "All orders together"] {
        assert!(text.contains(&format!("\n{sentence}")), "{sentence}");
    }
    let summary = folder.text("out/summary.json");
    let models = &json(&summary)["comparison"]["models"];
    let [smith, heitz] = [&models[0], &models[1]];
    assert_eq!(smith["scope"], "single-scattering");
    assert_eq!(heitz["scope"], "all-orders");
    assert!(smith["multiple"].is_null() && smith["total"]["verdict"].is_null());
    assert!(heitz["multiple"]["verdict"].is_string() && heitz["total"]["verdict"].is_string());
    assert_eq!(heitz["verdict"], heitz["total"]["verdict"]);
    // The same closed form, which is exact, for light scattered once.
    assert_eq!(
        smith["single"]["total_variation"],
        heitz["single"]["total_variation"]
    );
    let energy = |component: &str| {
        let of = &heitz["energy"][component];
        number(&of["reflected"]["mean"]) + number(&of["transmitted"]["mean"])
    };
    assert!((energy("single") + energy("multiple") - energy("total")).abs() < 1e-12);
    assert!(energy("multiple") > 0.05);
    // What a model of single scattering lacks is most of its distance from all light.
    assert!(
        number(&smith["total"]["total_variation"])
            > 1.5 * number(&heitz["total"]["total_variation"])
    );
    let comparison = folder.text("out/comparison.csv");
    let header = comparison.lines().next().unwrap();
    for column in ["flux_smith", "flux_multiple_heitz", "z_total_heitz"] {
        assert!(header.split(',').any(|name| name == column), "{column}");
    }
    assert!(!header.contains("flux_multiple_smith"));
}

#[test]
fn models_are_refused_what_they_cannot_do_by_name() {
    let folder = Folder::new();
    let cases = "
        verify --models cook-torrance-neumann -o out => cook-torrance-neumann describes reflected light alone
        verify --tau-y 32 --models xu-sun -o out => xu-sun is defined for isotropic surfaces
        verify --models walter -o out => unknown model `walter`
        verify --model-rays 0 -o out => 1 or more
        model heitz --smoothness 2 --theta 30 --sphere => take --bins
        model xu-sun-mc --smoothness 2 --smoothness-y 4 --theta 30 => xu-sun-mc is defined for isotropic surfaces
        model heitz --smoothness 0 --theta 30 => --smoothness 0: must be
        model heitz --theta 30 => smoothness
        model smith --smoothness 2 --azimuth 3 --theta 30 => smoothness-y
    ";
    folder.refuses(cases);
    // Reflection alone is what it describes.
    let reflection = "verify --tau 8 --size 64 --realisations 3 --rays 3e3 --side reflected \
                      --models cook-torrance-neumann,v-cavity --no-plots -o out";
    folder.succeed(reflection);
}

/// Slopes of a Gaussian surface, once as its height map and once as a table of their exact density: both give the model of Gaussian slopes,
/// the map within the scatter of some 700 correlation areas.
#[test]
fn a_model_takes_the_slopes_of_a_height_map_or_of_a_table() {
    let folder = Folder::new();
    // Facets of 16 per correlation length have 0.2 % less slope variance than the surface
    let map = "generate --tau 16 --smoothness 4 --size 768 --spacing 1 -o gaussian.exr";
    folder.succeed(map);
    let variance: f64 = 2.0 / 16.0;
    let mut text = String::from("x,y,density\n");
    for y in -60..=60 {
        for x in -60..=60 {
            let [x, y] = [x, y].map(|i| 0.03 * f64::from(i));
            let density = (-0.5 * (x * x + y * y) / variance).exp();
            text += &format!("{x},{y},{density}\n");
        }
    }
    folder.write("slopes.csv", text);
    let reflected = |roughness: &str| {
        let flags =
            format!("model smith-slopes {roughness} --eta 1.5 --theta 50 --bins 9x12 --json");
        let found = json(&folder.succeed(&flags));
        number(&found["energy"]["reflected"]["mean"])
    };
    let gaussian = reflected("--smoothness 4");
    let [of_table, of_map] =
        ["slopes.csv", "gaussian.exr"].map(|file| reflected(&format!("--slopes-of {file}")));
    println!("{gaussian} {of_table} {of_map}");
    // Cells of 0.03 widen variances by a sixth of their square, 0.1 %
    assert!((of_table / gaussian - 1.0).abs() < 2e-3);
    assert!((of_map / gaussian - 1.0).abs() < 0.02 && of_map != gaussian);
    // Models of Gaussian slopes take the root mean square
    let flags = "model smith --slopes-of slopes.csv --eta 1.5 --theta 50 --bins 9x12 --json";
    let smith = number(&json(&folder.succeed(flags))["energy"]["reflected"]["mean"]);
    assert!((smith / gaussian - 1.0).abs() < 2e-3);

    // Isotropic models take slopes that are nearly so, and a histogram has no single directions
    for model in ["xu-sun", "smith"] {
        let flags =
            format!("model {model} --slopes-of gaussian.exr --eta 1.5 --theta 50 --bins 9x12");
        let text = folder.succeed(&flags);
        text.must_contain("taken off");
        text.must_contain("taken as isotropic");
    }
    let flags = "model smith-slopes --slopes-of gaussian.exr --eta 1.5 --theta 50 --step 5";
    folder.refused(flags).must_contain("take --bins");
    let table = folder.succeed("model smith-slopes --slopes-of gaussian.exr --eta 1.5");
    table.must_contain("reflected by order");

    folder.succeed("generate --structure v-grooves --size 64 --spacing 1 -o grooves.exr");
    folder.write("bad.csv", "x,y,density\n0,0,1\n1,0,1\n0,1,1\n");
    folder.write("flat.csv", "x,y,density\n0,0,0\n1,0,0\n0,1,0\n1,1,0\n");
    let flags = "model smith --slopes-of grooves.exr --eta 1.5 --theta 50";
    folder.failed(flags).must_contain("lie along one direction");
    folder.succeed("model smith-slopes --slopes-of grooves.exr --eta 1.5");
    for (flags, code, expected) in [
        ("--slopes-of bad.csv", 1, "not those of a grid"),
        ("--slopes-of flat.csv", 1, "flat.csv"),
        ("--slopes-of none.exr", 1, "none.exr"),
        ("--slopes-of slopes.csv --smoothness 3", 2, "smoothness"),
    ] {
        let flags = format!("model smith-slopes {flags} --eta 1.5 --theta 50");
        folder.stopped(&flags, code).must_contain(expected);
    }
}

/// Rows of a table in text, without comments, each with `prefix` in front; none of its header.
fn prefixed(text: &str, prefix: &str) -> Vec<String> {
    let rows = text.lines().filter(|line| !line.starts_with('#'));
    rows.skip(1).map(|row| format!("{prefix}{row}")).collect()
}

#[test]
fn lists_give_a_model_at_every_combination() {
    let folder = Folder::new();
    let run = |line: &str| folder.succeed(line);
    let layer = "model hanrahan-krueger --mean-free-path 2 --albedo 0.9 --step 30";
    let all = run(&format!("{layer} --thickness 1,4 --theta 0,50"));
    let rows: Vec<&str> = all.lines().filter(|line| !line.starts_with('#')).collect();
    assert_eq!(rows[0], "thickness,theta_i_deg,side,theta_deg,phi_deg,bsdf");
    let mut expected = Vec::new();
    for thickness in [1, 4] {
        for theta in [0, 50] {
            let single = run(&format!("{layer} --thickness {thickness} --theta {theta}"));
            expected.extend(prefixed(&single, &format!("{thickness},{theta},")));
            let note = single.lines().next().unwrap().strip_prefix("# ").unwrap();
            let labelled = format!("# thickness = {thickness}, theta_i_deg = {theta}: {note}");
            all.must_contain(&labelled);
        }
    }
    assert_eq!(rows[1..], expected);

    let rough = "model heitz --eta 1.5 --bins 3x4 --rays 1e4";
    let text = run(&format!("{rough} --smoothness 2,3 -o all.csv"));
    text.must_contain("smoothness = 3");
    text.must_contain("48 bins");
    let all = folder.text("all.csv");
    let mut expected = Vec::new();
    let cases = json(&run(&format!("{rough} --smoothness 2,3 --json")))["cases"].clone();
    for (number, smoothness) in [2, 3].into_iter().enumerate() {
        run(&format!("{rough} --smoothness {smoothness} -o one.csv"));
        let one = folder.text("one.csv");
        expected.extend(prefixed(&one, &format!("{smoothness},")));
        let single = json(&run(&format!("{rough} --smoothness {smoothness} --json")));
        assert_eq!(cases[number]["energy"], single["energy"]);
        assert_eq!(cases[number]["at"]["smoothness"], f64::from(smoothness));
    }
    assert_eq!(all.lines().skip(1).collect::<Vec<_>>(), expected);

    let message = folder.refused("model smith --smoothness 3 --sphere --step 0.1 --theta 0,10");
    message.must_contain("rows of all combinations");
    for (line, why) in [
        ("model smith --smoothness 2,2", "twice"),
        ("model smith --smoothness 2,-1", "from 1e-6"),
    ] {
        folder.refused(line).must_contain(why);
    }
}

#[test]
fn counted_attenuation_takes_the_place_of_that_of_cook_torrance_and_neumann() {
    let folder = Folder::new();
    let count = "attenuation --tau 0.5 --sigma 0.25 --size 128 --spacing 0.05 --realisations 2";
    let angles = "--theta 0,40 --view-theta 0,20,60 --view-phi 180 --no-mirror --no-plots";
    folder.succeed(format!("{count} {angles} -o a"));
    let table = Table::read(&folder.join("a/attenuation.csv"));
    let step = "--smoothness 2 --material mirror --step 20 --attenuation-of a/attenuation.csv";
    for name in ["v-cavity", "cook-torrance-neumann"] {
        let text = folder.succeed(format!("model {name} {step} --theta 40"));
        let rows: Vec<&str> = text.lines().skip(1).collect();
        assert_eq!(rows.len(), 4, "{text}");
        for (row, theta) in rows.iter().zip([0.0, 20.0, 40.0, 60.0]) {
            let cells: Vec<&str> = row.split(',').collect();
            assert_eq!(cells[..3], ["reflected", &theta.to_string(), "180"]);
            // Of the light at 40 degrees, the rows 3 to 5 of the table; 40 degrees lie halfway between 20 and 60.
            let g2 = |row| table.number(row, "g2");
            let g2 = match theta {
                0.0 => g2(3),
                20.0 => g2(4),
                40.0 => 0.5 * (g2(4) + g2(5)),
                _ => g2(5),
            };
            // Gaussian slopes of variance 2 / s^2 along each axis, at the half vector in the plane of incidence.
            let [i, o] = [40.0_f64, theta].map(f64::to_radians);
            let m = 0.5 * (o - i);
            let variance = 2.0 / 4.0;
            let d = (-m.tan().powi(2) / (2.0 * variance)).exp()
                / (std::f64::consts::TAU * variance * m.cos().powi(4));
            let below = match name {
                "v-cavity" => i.cos() * o.cos(),
                _ => i.cos().max(o.cos()),
            };
            let expected = d * g2 / (4.0 * below);
            let found: f64 = cells[3].parse().unwrap();
            assert!((found / expected - 1.0).abs() < 1e-12, "{row}: {expected}");
        }
    }
    let cases = "
        model smith --theta 40 => no attenuation that a table can replace => 2
        model v-cavity --theta 40 --sphere => leave out --bins => 2
        model v-cavity --theta 60 => beyond those of the table, 0 to 40 => 1
    ";
    for [line, why, code] in rows(cases) {
        let message = folder.stopped(format!("{line} {step}"), code.parse().unwrap());
        message.must_contain(why);
    }
    for other in ["--smoothness 3", "--smoothness 2 --smoothness-y 5"] {
        let other = step.replace("--smoothness 2", other);
        let message = folder.failed(format!("model v-cavity {other} --theta 40"));
        message.must_contain("other slopes");
    }
    let wrong = step.replace("a/attenuation.csv", "wrong.csv");
    folder.write("wrong.csv", "theta,g2\n0,1\n");
    let message = folder.failed(format!("model v-cavity {wrong} --theta 40"));
    message.must_contain("attenuation.csv of one sigma");
}

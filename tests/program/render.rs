//! Pictures as users make them: files out, and sentences for what makes no sense.

use std::fs;

use crate::support::{InFolder, MustContain, errors_of, files, rows, with_surface};

const SMALL: &str = "render h.exr --size 24x18 --samples 4";

#[test]
fn a_picture_comes_as_numbers_and_for_the_eye_with_the_same_bytes_on_any_number_of_threads() {
    let folder = with_surface();
    for threads in ["1", "3"] {
        let [exr, png] = ["exr", "png"].map(|ending| format!("p{threads}.{ending}"));
        let medium = "--mean-free-path 2 --albedo 0.9 --g 0.5";
        let rest = format!("-o {exr} -o {png} --threads {threads}");
        let text = folder.succeed(format!("{SMALL} {medium} {rest}"));
        text.must_contain("24 x 18 pixels of 4 camera rays, 1728 rays in");
        text.must_contain("standard error");
    }
    for ending in ["exr", "png"] {
        let [one, three] =
            ["1", "3"].map(|n| fs::read(folder.join(format!("p{n}.{ending}"))).unwrap());
        assert!(one == three, "{ending}");
    }
}

#[test]
fn smooth_cells_have_pictures_of_their_own_and_say_that_sunlight_below_is_left_to_chance() {
    let folder = with_surface();
    let medium = " --mean-free-path 2 --albedo 0.9";
    for (medium, is_noted) in [
        (String::new(), false),
        (medium.to_owned(), true),
        (format!("{medium} --sun 0"), false),
        (
            format!("{medium} --thickness 30 --bottom-surface h.exr"),
            true,
        ),
    ] {
        let [flat, one, two] = ["auto", "smooth --threads 1", "smooth --threads 2"].map(|cells| {
            let line = format!("{SMALL}{medium} --cells {cells} -o p.exr");
            let text = folder.succeed(&line);
            let noted = text.contains("by random paths alone");
            assert_eq!(noted, is_noted && cells != "auto", "{line}: {text}");
            fs::read(folder.join("p.exr")).unwrap()
        });
        assert!(one == two && one != flat, "{medium}");
    }
}

#[test]
fn meshes_and_flat_surfaces_have_pictures_too() {
    let folder = with_surface();
    folder.succeed("mesh h.exr -o h.ply");
    let rest = "--border periodic --size 16x12 --samples 2 --camera orthographic -o m.png";
    folder.succeed(format!("render h.ply {rest}"));
    let flat = "render --flat --size 16x12 --samples 2 --sun 0 --sky 1 --horizon 1 --radiance-below 0 --view-theta 0 -o f.exr";
    let text = folder.succeed(flat);
    // Fresnel at normal incidence, (n - 1)^2 / (n + 1)^2, but for the slant of a pinhole's lines.
    text.must_contain("mean radiance 0.040");
}

#[test]
fn what_makes_no_sense_gets_a_sentence_and_no_file() {
    let folder = with_surface();
    let cases = "
        -o p.jpg => .exr and .png
        -o p.png --size 640 => 640x480
        -o p.png --size 0x4 => 0 x 4 pixels
        -o p.png --size 99999x4 => 16384
        -o p.png --samples 0 => 1 or more
        -o p.png --view-theta 90 => --view-theta 90: must be a number from 0 to below 90
        -o p.png --view-theta 89.999999 --camera orthographic => the camera at theta 89.999999
        -o p.png --sun-theta 89.999999 => the sun at theta 89.999999
        -o p.png --fov 180 => --fov 180: must be
        -o p.png --fov 20 --camera orthographic => goes with camera pinhole
        -o p.png --view-theta 88 --width 4 => the eye is
        -o p.png --width 0 => --width 0: must be
        -o p.png --look-at 1 => must be 2 numbers as X,Y
        -o p.png --sky -1 => --sky -1: must be
        -o p.png --radiance-below -1 => --radiance-below -1: must be
        -o p.png --sun -1 => --sun -1: must be
        -o p.png --sun-theta 95 => --sun-theta
        -o p.png --sun-radius 0 => 0.01 to 60
        -o p.png --patch 0,0,1 => X0,Y0,X1,Y1
        -o p.png --patch 0,0,0,1 => below the other two
        -o p.png --exposure 0 => --exposure 0: must be
        -o p.png --tone gamma => reinhard, linear or log
        -o p.png --scale-bar => a scale bar for a picture of 24 columns: needs 160 columns or more
        -o p.png --error-image e.exr => .png and .svg
        -o p.png --error-image p.png => given as two outputs
        -o p.png --error-image h.exr => .png and .svg
        -o p.png --wavelength 400:700:20 => 16 wavelengths: change nothing unless the material is a named one
        -o p.png --material gold --wavelength 450,550,650 => 3 wavelengths: a picture takes one, or in colour those from 400 to 700 nm
        -o p.png --material gold --wavelength 700:400:20 => --wavelength 700:400:20
        -o p.png --material gold --wavelength 420:700:20 => from 400 to 700 nm in increasing steps of at most 20 nm
        -o p.png --albedo 0.9 => needs --mean-free-path
        -o p.png --mean-free-path 1 --albedo 0.9 --thickness 0.1 => invalid thickness
        -o p.png --mean-free-path 1 --albedo 0.9 --thickness 99 --bottom-surface independent => must be flat, same or a file
    ";
    for [flags, expected] in rows(cases) {
        let command = format!("{SMALL} {flags}");
        // What is given twice is given as the last says, but for outputs.
        let command = match flags.contains("--size") || flags.contains("--samples") {
            true => format!("render h.exr {flags}"),
            false => command,
        };
        folder.refused(&command).must_contain(expected);
    }
    assert_eq!(files(&folder), ["h.exr"]);
}

#[test]
fn an_output_that_would_replace_an_input_or_another_output_is_refused() {
    let folder = with_surface();
    let before = fs::read(folder.join("h.exr")).unwrap();
    for (outputs, expected) in [
        (["p.png", "p.png"], "given as two outputs"),
        (["p.exr", "./p.exr"], "given as two outputs"),
        (["p.png", "h.exr"], "h.exr is the input"),
    ] {
        let [a, b] = outputs;
        let rest = format!("-o {a} -o {b}");
        let sentence = folder.refused(format!("{SMALL} {rest}"));
        sentence.must_contain(expected);
    }
    assert_eq!(files(&folder), ["h.exr"]);
    assert!(fs::read(folder.join("h.exr")).unwrap() == before);
}

#[test]
fn a_folder_that_cannot_be_made_is_told_before_light_is_followed_and_nothing_is_written() {
    let folder = with_surface();
    let sentence = folder.failed("render h.exr --samples 1e8 -o q1.exr -o h.exr/q.png");
    sentence.must_contain("`h.exr` is a file");
    assert_eq!(files(&folder), ["h.exr"]);
}

/// Flights far longer than the tile end at once, and so do passes of many lines when time is over.
#[test]
fn long_flights_and_many_lines_come_to_an_end() {
    let folder = with_surface();
    for flags in [
        "--mean-free-path 1e5 --albedo 0.9 --samples 2",
        "--samples 1e8 --max-time 0.05",
    ] {
        let output = folder.run(format!("render --flat --size 8x6 {flags} -o f.exr"));
        let errors = errors_of(&output);
        assert!(output.status.success(), "{errors}");
        let is_stopped = errors.starts_with("the time is over; the picture of ");
        assert_eq!(is_stopped, flags.contains("--max-time"), "{errors}");
    }
}

#[test]
fn exposure_and_the_radius_of_the_sun_reach_the_picture() {
    let folder = with_surface();
    let png = |flags: &str| {
        let text = folder.succeed(format!("{SMALL} {flags} -o e.png"));
        (text, fs::read(folder.join("e.png")).unwrap())
    };
    let (text, bright) = png("--exposure 2");
    text.must_contain("exposure 2,");
    let (_, dim) = png("--exposure 0.5");
    assert!(bright != dim);
    let (_, wide) = png("--exposure 2 --sun-radius 20");
    assert!(bright != wide);
}

/// The text of a PNG on its brightness.
fn comment(png: &[u8]) -> String {
    let text = String::from_utf8_lossy(png);
    let from = text.find("tEXtComment").unwrap();
    let end = text[from..].find("IDAT").unwrap();
    text[from..from + end].to_owned()
}

#[test]
fn tones_differ_and_the_png_says_which_it_has() {
    let folder = with_surface();
    let mut all = Vec::new();
    for tone in ["reinhard", "linear", "log"] {
        let text = folder.succeed(format!("{SMALL} --tone {tone} -o t.png"));
        text.must_contain(format!("tone {tone}, exposure"));
        assert!(tone != "reinhard" || !text.contains("clipped"), "{text}");
        let png = fs::read(folder.join("t.png")).unwrap();
        let comment = comment(&png);
        for part in [
            tone,
            "exposure ",
            "white: ",
            "in the unit in which the lights were given",
        ] {
            comment.as_str().must_contain(part);
        }
        assert!(!all.contains(&png), "{tone}");
        all.push(png);
    }
    folder.succeed(format!("{SMALL} -o t.png"));
    assert!(
        fs::read(folder.join("t.png")).unwrap() == all[0],
        "the default"
    );
    let text = folder.succeed(format!("{SMALL} --tone linear --exposure 99 -o t.png"));
    text.must_contain("100 % of the");
}

#[test]
fn a_scale_and_an_image_of_errors_come_with_the_picture() {
    let folder = with_surface();
    let large = "render h.exr --size 160x40 --samples 2";
    let rows = |png: &str| {
        let bytes = fs::read(folder.join(png)).unwrap();
        u32::from_be_bytes(bytes[20..24].try_into().unwrap())
    };
    for (flags, more) in [("", 0), ("--scale-bar", 40)] {
        for errors in ["e.svg", "e.png"] {
            let text = folder.succeed(format!("{large} {flags} -o p.png --error-image {errors}"));
            text.must_contain(format!("picture in p.png\nerrors in {errors}"));
        }
        assert!(rows("p.png") >= 40 + more && (more > 0 || rows("p.png") == 40));
    }
    let figure = folder.text("e.svg");
    for part in [
        "Standard error of the pixels of h.exr",
        "160 × 40 pixels",
        "standard error / radiance",
    ] {
        figure.as_str().must_contain(part);
    }
}

#[test]
fn several_wavelengths_give_a_picture_in_colour() {
    let folder = with_surface();
    let gold = format!("{SMALL} --material gold");
    let both = "-o c.exr -o c.png --denoise";
    let [one, three] = ["1", "3"].map(|threads| {
        let line = format!("{gold} --wavelength 400:700:20 --threads {threads} {both}");
        let text = folder.succeed(line);
        text.must_contain("4 camera rays at each of 16 wavelengths, 27648 rays");
        text.must_contain("mean luminance 0.");
        text.must_contain("denoised by non-local means");
        ["c.exr", "c.png"].map(|name| fs::read(folder.join(name)).unwrap())
    });
    assert!(one == three);
    let [exr, png] = one;
    // Colour type 2 of a PNG is RGB, 0 is grey.
    assert_eq!(png[25], 2);
    comment(&png)
        .as_str()
        .must_contain("denoised by non-local means");
    let header = String::from_utf8_lossy(&exr[..2000.min(exr.len())]).into_owned();
    for part in [
        "R, G, B: linear sRGB",
        "error: standard error of Y before denoising",
    ] {
        header.as_str().must_contain(part);
    }
    folder.succeed(format!("{gold} --wavelength 550 -o c.png"));
    assert_eq!(fs::read(folder.join("c.png")).unwrap()[25], 0);
}

/// Every wavelength has its part of the time.
#[test]
fn colours_come_in_time() {
    let folder = with_surface();
    let light = "--material gold --wavelength 400:700:20 --samples 1e8 --max-time 0.1";
    let output = folder.run(format!("render --flat --size 8x6 {light} -o f.png"));
    let errors = errors_of(&output);
    assert!(output.status.success(), "{errors}");
    assert!(
        errors.starts_with("the time is over; the picture of "),
        "{errors}"
    );
}

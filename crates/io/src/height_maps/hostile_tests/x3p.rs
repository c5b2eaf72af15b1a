//! X3P files of other programs: types, masks, checksums, and inconsistent headers.

use std::io::Cursor;

use asperity_surface::{Border, LengthUnit, MissingPolicy};

use super::{field, read, refused, valid, whole};
use crate::damage_tests::changes;
use crate::formats::HeightMapFormat;

/// An X3P of the given main.xml and parts, as any ZIP program would pack it.
fn x3p(xml: &str, parts: &[(&str, &[u8])]) -> Vec<u8> {
    use std::io::Write;
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default();
    for (name, bytes) in [("main.xml", xml.as_bytes())].iter().chain(parts) {
        archive.start_file(*name, options).unwrap();
        archive.write_all(bytes).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A main.xml for 3 x 2 points.
fn main_xml(z: &str, data: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\
         <p:ISO5436_2 xmlns:p=\"http://www.opengps.eu/2008/ISO5436_2\">\
         <Record1><Revision>ISO5436 - 2000</Revision><FeatureType>SUR</FeatureType><Axes>\
         <CX><AxisType>I</AxisType><Increment>1e-6</Increment><Offset>0</Offset></CX>\
         <CY><AxisType>I</AxisType><Increment>2e-6</Increment><Offset>0</Offset></CY>\
         <CZ><AxisType>A</AxisType>{z}</CZ></Axes></Record1>\
         <Record3><MatrixDimension><SizeX>3</SizeX><SizeY>2</SizeY><SizeZ>1</SizeZ></MatrixDimension>\
         {data}</Record3></p:ISO5436_2>"
    )
}

const LINK: &str = "<DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink>";
const DATA: &str = "bindata/data.bin";

#[test]
fn x3p_is_read_in_every_type() {
    use HeightMapFormat::X3p;
    let heights = |bytes: &[u8]| {
        let map = read(X3p, bytes).unwrap();
        assert_eq!(map.shape(), [2, 3]);
        assert_eq!(map.unit, LengthUnit::Metre);
        let field = whole(map);
        assert_eq!(field.spacing(), [1e-6, 2e-6]);
        field.into_heights()
    };
    let numbers = [1, -2, 3, 4, 5, 100];
    let scaled = numbers.map(|n| f64::from(n) * 0.5 + 10.0);
    let scale = "<Increment>0.5</Increment><Offset>10</Offset>";
    let i16s: Vec<u8> = numbers
        .iter()
        .flat_map(|n| (*n as i16).to_le_bytes())
        .collect();
    let i32s: Vec<u8> = numbers.iter().flat_map(|n: &i32| n.to_le_bytes()).collect();
    let f32s: Vec<u8> = numbers
        .iter()
        .flat_map(|n| (*n as f32).to_le_bytes())
        .collect();
    let f64s: Vec<u8> = numbers
        .iter()
        .flat_map(|n| f64::from(*n).to_le_bytes())
        .collect();
    let z = |kind: &str, scale: &str| format!("<DataType>{kind}</DataType>{scale}");
    assert_eq!(
        heights(&x3p(&main_xml(&z("I", scale), LINK), &[(DATA, &i16s)])),
        scaled
    );
    assert_eq!(
        heights(&x3p(&main_xml(&z("L", scale), LINK), &[(DATA, &i32s)])),
        scaled
    );
    let plain = numbers.map(f64::from);
    assert_eq!(
        heights(&x3p(&main_xml(&z("F", ""), LINK), &[(DATA, &f32s)])),
        plain
    );
    assert_eq!(
        heights(&x3p(&main_xml(&z("D", ""), LINK), &[(DATA, &f64s)])),
        plain
    );
    // A program on Windows may name the part by a backslash.
    let name = "bindata\\data.bin";
    assert_eq!(
        heights(&x3p(&main_xml(&z("D", ""), LINK), &[(name, &f64s)])),
        plain
    );

    let list = "<DataList><Datum>;;1</Datum><Datum>0;0;-2</Datum><Datum>3</Datum>\
        <Datum>4</Datum><Datum>5</Datum><Datum>1e2</Datum></DataList>";
    assert_eq!(heights(&x3p(&main_xml(&z("D", ""), list), &[])), plain);
    let hole = list.replace("0;0;-2", ";;");
    assert_eq!(
        read(X3p, &x3p(&main_xml(&z("D", ""), &hole), &[]))
            .unwrap()
            .missing(),
        1
    );
    let short = list.replace("<Datum>3</Datum>", "");
    refused(X3p, &x3p(&main_xml(&z("D", ""), &short), &[]), "5 data");

    // Bits 1 and 4 are zero, the lowest bit first.
    let masked = LINK.replace(
        "</DataLink>",
        "<ValidPointsLink>bindata/valid.bin</ValidPointsLink></DataLink>",
    );
    let mask: &[u8] = &[0b10_1101];
    let bytes = x3p(
        &main_xml(&z("I", scale), &masked),
        &[(DATA, &i16s), ("bindata/valid.bin", mask)],
    );
    let map = read(X3p, &bytes).unwrap();
    assert_eq!(map.missing(), 2);
    let first = map
        .into_height_field(MissingPolicy::Refuse, Border::Open)
        .unwrap_err();
    assert!(first.to_string().contains("column 1, row 0"), "{first}");
    let infinite: Vec<u8> = [0.0, 0.0, 0.0, f64::INFINITY, 0.0, 0.0]
        .iter()
        .flat_map(|x: &f64| x.to_le_bytes())
        .collect();
    let file = x3p(&main_xml(&z("D", ""), LINK), &[(DATA, &infinite)]);
    assert_eq!(read(X3p, &file).unwrap().missing(), 1);
    let single: Vec<u8> = [0.0, f32::NEG_INFINITY, 0.0, f32::INFINITY, 0.0, f32::NAN]
        .iter()
        .flat_map(|x: &f32| x.to_le_bytes())
        .collect();
    let file = x3p(&main_xml(&z("F", scale), LINK), &[(DATA, &single)]);
    assert_eq!(read(X3p, &file).unwrap().missing(), 3);
    let listed = list.replace("0;0;-2", "0;0;inf");
    let file = x3p(&main_xml(&z("D", ""), &listed), &[]);
    assert_eq!(read(X3p, &file).unwrap().missing(), 1);
}

#[test]
fn x3p_parts_may_lie_in_a_folder_with_separators_of_windows() {
    use std::io::Write;
    let data: &[u8] = &[0; 48];
    let xml = main_xml("<DataType>D</DataType>", LINK);
    let archive = |names: &[(&str, &[u8])]| {
        let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
        let options = zip::write::SimpleFileOptions::default();
        for (name, bytes) in names {
            archive.start_file(*name, options).unwrap();
            archive.write_all(bytes).unwrap();
        }
        archive.finish().unwrap().into_inner()
    };
    let wrong: &[u8] = b"00000000000000000000000000000000 *main.xml\n";
    for [main, part, checksum] in [
        [
            "scan/main.xml",
            "scan/bindata/data.bin",
            "scan/md5checksum.hex",
        ],
        [
            "a\\b\\main.xml",
            "a\\b\\bindata\\data.bin",
            "a\\b\\md5checksum.hex",
        ],
        ["Main.xml", "Bindata/data.bin", "md5checksum.hex"],
        [
            "./scan/main.xml",
            "./scan/bindata/data.bin",
            "./scan/md5checksum.hex",
        ],
    ] {
        let apple: (&str, &[u8]) = ("__MACOSX/scan/main.xml", b"x");
        let file = archive(&[apple, (main, xml.as_bytes()), (part, data)]);
        assert_eq!(
            read(HeightMapFormat::X3p, &file).unwrap().shape(),
            [2, 3],
            "{main}"
        );
        let file = archive(&[(main, xml.as_bytes()), (part, data), (checksum, wrong)]);
        refused(HeightMapFormat::X3p, &file, "MD5 checksum");
    }
    let two = archive(&[
        ("a/main.xml", xml.as_bytes()),
        ("b/main.xml", xml.as_bytes()),
    ]);
    refused(HeightMapFormat::X3p, &two, "in two folders, `a` and `b`");
}

#[test]
fn x3p_checksums_are_verified() {
    use HeightMapFormat::X3p;
    let z = "<DataType>D</DataType>";
    let data: &[u8] = &[0; 48];
    // MD5 of 48 zero bytes, by an independent program.
    let right = "b203621a65475445e6fcdca717c667b5";
    let stated = |sum: &str| {
        let sum = format!("<MD5ChecksumPointData>{sum}</MD5ChecksumPointData></DataLink>");
        main_xml(z, &LINK.replace("</DataLink>", &sum))
    };
    assert!(read(X3p, &x3p(&stated(&right.to_uppercase()), &[(DATA, data)])).is_ok());
    refused(
        X3p,
        &x3p(&stated(&right.replace('0', "1")), &[(DATA, data)]),
        "states",
    );
    let line: &[u8] = b"00000000000000000000000000000000 *main.xml\n";
    let bytes = x3p(
        &main_xml(z, LINK),
        &[(DATA, data), ("md5checksum.hex", line)],
    );
    refused(X3p, &bytes, "part `main.xml`");
    // A checksum of another part than main.xml, as SurfaceTopography writes it
    let line = format!("{right} *bindata/data.bin\n");
    let bytes = x3p(
        &stated(right),
        &[(DATA, data), ("md5checksum.hex", line.as_bytes())],
    );
    assert!(read(X3p, &bytes).is_ok());
    let masked = LINK.replace(
        "</DataLink>",
        "<ValidPointsLink>v</ValidPointsLink>\
         <MD5ChecksumValidPoints>00</MD5ChecksumValidPoints></DataLink>",
    );
    let bytes = x3p(&main_xml(z, &masked), &[(DATA, data), ("v", &[0xff])]);
    refused(X3p, &bytes, "part `v`");
    // Any damage to the stored samples of our own files is found.
    let mut own = valid(X3p);
    let sample = field().heights()[7].to_le_bytes();
    let at = own.windows(8).position(|w| w == sample).unwrap();
    own[at] ^= 1;
    refused(X3p, &own, "damaged");
}

#[test]
fn x3p_descriptions_are_bounded_before_they_are_parsed() {
    use HeightMapFormat::X3p;
    let z = "<DataType>D</DataType>";
    let data: &[u8] = &[0; 48];
    let good = main_xml(z, LINK);
    let with = |more: &str| {
        let xml = good.replace("<Record3>", &format!("<Record2>{more}</Record2><Record3>"));
        x3p(&xml, &[(DATA, data)])
    };
    // What a file may have: comments, raw text and quotes that look like tags
    let harmless = "<!-- <a b=\"c\"> --><Comment a=\"1 > 0\"><![CDATA[<b/>]]></Comment>";
    assert!(read(X3p, &with(harmless)).is_ok());
    let many = |count: usize, of: &dyn Fn(usize) -> String| (0..count).map(of).collect::<String>();
    let start = std::time::Instant::now();
    for (more, words) in [
        (many(1 << 20, &|_| "<a/>".into()), "4096 elements"),
        (
            format!("<a{}/>", many(40_000, &|i| format!(" a{i}=\"\""))),
            "32 attributes",
        ),
        (
            many(4000, &|i| format!("<a xmlns:n{i}=\"n{i}\"><a/></a>")),
            "32 namespaces",
        ),
        (
            format!("<a{}/>", many(20_000, &|i| format!(" xmlns:n{i}=\"n{i}\""))),
            "32 namespaces",
        ),
        ("x".repeat(1 << 21), "1048576 are allowed"),
        ("<a".into(), "cannot be parsed"),
        ("<!-- <a>".into(), "cannot be parsed"),
        ("<![CDATA[".into(), "cannot be parsed"),
    ] {
        refused(X3p, &with(&more), words);
    }
    // Each takes seconds to minutes where it is parsed first.
    assert!(start.elapsed().as_secs() < 5);

    let listed = |list: &str| x3p(&main_xml(z, list), &[]);
    let full = format!(
        "<DataList>{}</DataList>",
        "<Datum>1</Datum>".repeat(5) + "<Datum/>"
    );
    assert_eq!(read(X3p, &listed(&full)).unwrap().missing(), 1);
    let cases = "
        <Datum/> => <a/> => other than Datum
        <Datum/> => <Datum><a/></Datum> => other than Datum
        <Datum/> => <Datum> => other than Datum
        <Datum/> => <Datum/><Datum/> => 7 data
        </DataList> =>  => does not end
    ";
    for (list, words) in changes(&full, cases) {
        refused(X3p, &listed(&list), words);
    }
}

#[test]
fn x3p_headers_are_checked() {
    use HeightMapFormat::X3p;
    let data: &[u8] = &[0; 48];
    let z = "<DataType>D</DataType>";
    let good = main_xml(z, LINK);
    assert!(read(X3p, &x3p(&good, &[(DATA, data)])).is_ok());
    let cases = "
        <SizeX>3</SizeX><SizeY>2 => <SizeX>4000000000</SizeX><SizeY>4000000000 => claims 4000000000 x 4000000000
        <SizeX>3</SizeX><SizeY>2 => <SizeX>18446744073709551615</SizeX><SizeY>18446744073709551615 => claims
        <SizeX>3</SizeX><SizeY>2 => <SizeX>99999999999999999999</SizeX><SizeY>2 => whole number
        <SizeX>3</SizeX><SizeY>2 => <SizeX>1</SizeX><SizeY>1 => at least 2 x 2
        <SizeX>3</SizeX><SizeY>2 => <SizeX>0</SizeX><SizeY>0 => at least 2 x 2
        <SizeX>3</SizeX><SizeY>2 => <SizeX>-3</SizeX><SizeY>-3 => whole number
        <SizeY>2</SizeY> => <SizeY>3</SizeY> => claims 48 bytes
        <SizeY>2</SizeY> =>  => lacks SizeY
        <SizeX>3</SizeX> => <SizeX>3</SizeX><SizeX>3</SizeX> => SizeX twice
        <SizeZ>1</SizeZ> => <SizeZ>2</SizeZ> => 2 layers
        <CX><AxisType>I => <CX><AxisType>A => axis CX is of type `A`
        <Increment>1e-6</Increment> =>  => lacks Increment
        <Increment>1e-6 => <Increment>0 => spacing along x is 0
        <Increment>2e-6 => <Increment>-1 => spacing along y is -1
        <Increment>2e-6 => <Increment>wide => `wide`
        <DataType>D => <DataType>L => no Increment
        <DataType>D => <DataType>Q => I, L, F and D
        </DataType> => </DataType><Increment>0</Increment> => not zero
        <AxisType>A => <AxisType>I => CZ is of type `I`
        SUR => PCL => `PCL`
        MatrixDimension => ListDimension => list of points
        bindata/data.bin => elsewhere.bin => no part `elsewhere.bin`
        <DataLink><PointDataLink>bindata/data.bin</PointDataLink></DataLink> =>  => lacks DataList
        p:ISO5436_2 => p:Other => `Other`
        </Record3> =>  => cannot be parsed
    ";
    for (xml, words) in changes(&good, cases) {
        refused(X3p, &x3p(&xml, &[(DATA, data)]), words);
    }
    refused(X3p, &x3p("", &[(DATA, data)]), "cannot be parsed");
    let deep = format!("{}{}", "<a>".repeat(200_000), "</a>".repeat(200_000));
    refused(X3p, &x3p(&deep, &[]), "more than 4096 elements");
    let bomb = "<!DOCTYPE a [<!ENTITY b \"bbbb\">]><a>&b;</a>";
    refused(X3p, &x3p(bomb, &[]), "cannot be parsed");
    let parts = x3p(&good, &[("other", data)]);
    refused(X3p, &parts, "no part `bindata/data.bin`");
    // Deflated zeros, a thousandfold: within what deflate can do, but not what the axes say.
    refused(
        X3p,
        &x3p(&good, &[(DATA, &vec![0; 10_000_000])]),
        "claims 10000000 bytes",
    );
    let text = [good.as_bytes(), b"<!-- \xff -->"].concat();
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    archive
        .start_file("main.xml", zip::write::SimpleFileOptions::default())
        .unwrap();
    std::io::Write::write_all(&mut archive, &text).unwrap();
    let bytes = archive.finish().unwrap().into_inner();
    refused(X3p, &bytes, "not UTF-8");
}

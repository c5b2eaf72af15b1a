//! Thumbnails of first surfaces: kept, resumed, merged and read.

use asperity_surface::LengthUnit;

use super::*;

/// Gives up whatever is drawn.
struct Hasty;

impl Observer for Hasty {
    fn begin(&self, _stage: &str, _total: u64) {}
    fn advance(&self, _steps: u64) {}
    fn end(&self) {}
    fn gives_up_first(&self) -> bool {
        true
    }
}

#[test]
fn the_first_surface_is_drawn_once_and_changes_no_other_member() {
    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let micrometres = LengthUnit::Micrometre;
    let [first, other] = [1.0, 2.0].map(|sigma| random(sigma, 0.0).surface);
    let mut set = ResultSet::open(&folder, header()).unwrap();
    run(&mut set, &Silent).unwrap();
    set.keep_thumbnail(&first, micrometres, &Hasty).unwrap();
    assert_eq!(set.thumbnail, None);
    set.close().unwrap();
    assert_eq!(Thumbnail::read(place.path()).unwrap(), None);
    set.keep_thumbnail(&first, micrometres, &Silent).unwrap();
    set.close().unwrap();

    let found = Thumbnail::read(place.path()).unwrap().unwrap();
    assert_eq!((found.shape, found.extent), ([32; 2], [32.0; 2]));
    assert_eq!(found.unit, micrometres);
    let SurfaceSource::Random(surfaces) = &first else {
        panic!("random surfaces")
    };
    let drawn = surfaces.heights(set.header.seed, 0, &|| false).unwrap();
    for (kept, height) in found.heights.iter().zip(drawn.heights()) {
        // Of a range of up to 8 sigma.
        assert!((kept - height).abs() <= 8.0 / 65536.0, "{kept} {height}");
    }

    let mut again = ResultSet::open(&folder, header()).unwrap();
    let file = fs::read(place.path().join(FILE)).unwrap();
    again.keep_thumbnail(&other, micrometres, &Silent).unwrap();
    again.close().unwrap();
    assert!(fs::read(place.path().join(FILE)).unwrap() == file);
    let bare = ResultSet::in_memory(header());
    let mut merged = ResultSet::in_memory(header());
    let shards = [1, 2].into_iter().zip([bare, again]);
    let finished = shards.map(|(share, mut shard)| {
        shard.header.shards = Some(merging::shard_of(share, 2));
        (share.to_string(), shard)
    });
    merged.merge(finished.collect()).unwrap();
    assert_eq!(merged.thumbnail.take(), Some(found));
    assert!(merged.comparable_bytes().unwrap() == whole());
}

#[test]
fn sets_without_a_folder_draw_nothing_and_a_new_first_case_has_its_own_surface() {
    let [first, second] = [0.5, 1.0].map(|sigma| random(sigma, 0.0));
    let unit = LengthUnit::Arbitrary;
    let mut bare = ResultSet::in_memory(header());
    bare.keep_thumbnail(&first.surface, unit, &Silent).unwrap();
    assert_eq!(bare.thumbnail, None);

    let place = tempfile::tempdir().unwrap();
    let folder = folder(place.path());
    let open = |cases: &[Case]| ResultSet::open_cases(&folder, header(), cases).unwrap();
    let one = [second.clone()];
    let mut set = open(&one);
    set.run_missing(0, &one, &settings(), &Silent).unwrap();
    set.keep_thumbnail(&second.surface, unit, &Silent).unwrap();
    set.close().unwrap();
    assert!(open(&one).thumbnail.is_some());
    assert_eq!(open(&[first, second]).thumbnail, None);
}

fn main() {
    for m in asperity_io::materials() {
        let c = &m.constants;
        let mut w: Vec<f64> = c.n().points().to_vec();
        if let Some(k) = c.k() {
            w.extend(k.points());
        }
        let [a, b] = c.range();
        w.extend((0..=50).map(|i| (a + (b - a) * f64::from(i) / 50.0).min(b)));
        for w in w {
            let Ok(i) = c.at(w) else { continue };
            println!("{} {w:?} {:?} {:?}", m.record, i.n, i.k.unwrap_or(-1.0));
        }
    }
    for f in std::env::args().skip(1) {
        if let Err(e) = asperity_io::material(&f) {
            println!("# {e}");
        }
    }
}

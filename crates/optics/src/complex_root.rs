//! Complex root by plain arithmetic: that of the number type uses functions of the system.

use num_complex::Complex64;

/// The root of `re + i im` in the first quadrant, `im >= 0`: by plain arithmetic, the same on every platform.
pub(crate) fn first_quadrant_root(re: f64, im: f64) -> Complex64 {
    let larger = (0.5 * ((re * re + im * im).sqrt() + re.abs())).sqrt();
    let smaller = if larger > 0.0 { 0.5 * im / larger } else { 0.0 };
    if re < 0.0 {
        Complex64::new(smaller, larger)
    } else {
        Complex64::new(larger, smaller)
    }
}

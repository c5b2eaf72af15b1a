//! The tables as a C header: albedo.h.

use std::fmt::Write;

use asperity_tally::Side;

use super::outcome::{AlbedoOutcome, AlbedoPoint};
use super::tables::letter;

/// Function that looks a table up between its points.
const LOOKUP: &str = "\
/* Place between two of n ascending values: number of the first, and the fraction beyond it. */
static inline int albedo_place(const float *axis, int n, float x, float *fraction)
{
    int i = 0;
    if (n < 2 || x <= axis[0]) { *fraction = 0.0f; return 0; }
    while (i < n - 2 && x >= axis[i + 1]) ++i;
    *fraction = (x - axis[i]) / (axis[i + 1] - axis[i]);
    if (*fraction > 1.0f) *fraction = 1.0f;
    return i;
}

/* Bilinear lookup; beyond the ends of an axis the value at its end holds. */
static inline float albedo_lookup(const float table[ALBEDO_ALPHAS][ALBEDO_COSINES], float alpha, float cosine)
{
    float u, v;
    const int i = albedo_place(albedo_alpha, ALBEDO_ALPHAS, alpha, &v), i1 = v > 0.0f ? i + 1 : i;
    const int j = albedo_place(albedo_cos, ALBEDO_COSINES, cosine, &u), j1 = u > 0.0f ? j + 1 : j;
    const float low = table[i][j] + u * (table[i][j1] - table[i][j]);
    const float high = table[i1][j] + u * (table[i1][j1] - table[i1][j]);
    return low + v * (high - low);
}
";

/// The text of the header; `None` where a point is missing.
pub(super) fn header(outcome: &AlbedoOutcome<'_>) -> Option<String> {
    let axes = outcome.axes;
    let [alphas, cosines] = [&axes.alphas, &axes.cosines].map(|axis| order(axis));
    let mut out = String::from(
        "/* Directional albedos of rough surfaces, written by asperity albedo.\n\
         \x20* E: light of all orders on explicit surfaces; single: single scattering, Smith's model;\n\
         \x20* ratio: E over single, by which single scattering is to be multiplied. R reflected, T transmitted.\n\
         \x20* Tables: [material][alpha][cosine of incidence], both axes ascending.\n",
    );
    for material in 0..outcome.materials() {
        let name = outcome.material(material).replace("*/", "* /");
        let _ = writeln!(out, " * Material {material}: {name}");
    }
    out.push_str(" */\n#ifndef ASPERITY_ALBEDO_H\n#define ASPERITY_ALBEDO_H\n\n");
    for (name, count) in [
        ("MATERIALS", outcome.materials()),
        ("ALPHAS", alphas.len()),
        ("COSINES", cosines.len()),
    ] {
        let _ = writeln!(out, "#define ALBEDO_{name} {count}");
    }
    for (name, axis, order) in [
        ("alpha[ALBEDO_ALPHAS]", &axes.alphas, &alphas),
        ("cos[ALBEDO_COSINES]", &axes.cosines, &cosines),
    ] {
        let values: Vec<f64> = order.iter().map(|&i| axis[i]).collect();
        let _ = write!(out, "\nstatic const float albedo_{name} = {}", row(&values));
        out.push_str(";\n");
    }
    for side in Side::BOTH {
        type Quantity = fn(&AlbedoPoint<'_>, Side) -> Option<f64>;
        let quantities: [(&str, Quantity); 3] = [
            ("E", |point, side| Some(point.flux(side)?.mean)),
            ("single", |point, side| Some(point.single(side))),
            ("ratio", |point, side| point.ratio(side)),
        ];
        for (name, quantity) in quantities {
            let name = format!("albedo_{name}_{}", letter(side));
            let sizes = "[ALBEDO_MATERIALS][ALBEDO_ALPHAS][ALBEDO_COSINES]";
            let _ = writeln!(out, "\nstatic const float {name}{sizes} = {{");
            for material in 0..outcome.materials() {
                out.push_str("  {\n");
                for &alpha in &alphas {
                    let points = cosines
                        .iter()
                        .map(|&cos| outcome.point(material, alpha, cos));
                    let values = points.map(|point| quantity(&point, side));
                    let _ = writeln!(out, "    {},", row(&values.collect::<Option<Vec<_>>>()?));
                }
                out.push_str("  },\n");
            }
            out.push_str("};\n");
        }
    }
    let _ = write!(out, "\n{LOOKUP}\n#endif\n");
    Some(out)
}

/// Numbers of the values of an axis, ascending.
fn order(axis: &[f64]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..axis.len()).collect();
    order.sort_by(|&a, &b| axis[a].total_cmp(&axis[b]));
    order
}

/// Values in braces, in single precision.
fn row(values: &[f64]) -> String {
    // With an exponent every one is a floating constant
    let values: Vec<String> = values.iter().map(|v| format!("{:e}f", *v as f32)).collect();
    format!("{{ {} }}", values.join(", "))
}

// Polarisation: Stokes vectors divided by the flux, and how interfaces change them: as `asperity_optics::polarisation`.
//
// Source: Born and Wolf, Principles of Optics, Secs. 1.5 and 14.2, rearranged; signs as in SCATMECH.
#pragma once

#include "vectors.h"

// Mueller matrix of an interface in the axes of its plane of incidence, by its distinct elements.
struct FacetMueller {
    double m00, m01, m22, m23;
};

// Stokes vector in the axes of a ray.
struct Stokes {
    double i, q, u, v;
};

// Cosine and sine of twice the angle by which axes are turned about a ray.
struct Turn {
    double cos, sin;
};

// The horizontal part of a direction that decides its axes: (1, 0) for a vertical ray.
DEVICE void heading_of(Vec3 k, double &x, double &y) {
    const bool is_vertical = k.x * k.x + k.y * k.y < 1e-150;
    x = is_vertical ? 1.0 : k.x;
    y = is_vertical ? 0.0 : k.y;
}

// A vector along the normal of the plane of incidence.
DEVICE Vec3 incidence_axis(Vec3 k, Vec3 m) {
    const Vec3 axis = {k.y * m.z - m.y * k.z, k.z * m.x - m.z * k.x, k.x * m.y - m.x * k.y};
    double x, y;
    heading_of(k, x, y);
    const bool is_normal = dot(axis, axis) < 1e-30;
    return is_normal ? Vec3{-y, x, 0.0} : axis;
}

// The turn that takes the s axis of a ray along `k` to `axis`.
DEVICE Turn turn_to_axis(Vec3 k, Vec3 axis) {
    double x, y;
    heading_of(k, x, y);
    // Project the axis on s and p, both times |z x k|
    const double along_s = x * axis.y - y * axis.x;
    const double along_p = (k.x * x + k.y * y) * axis.z - k.z * (x * axis.x + y * axis.y);
    const double s_squared = along_s * along_s, p_squared = along_p * along_p;
    const double sum = s_squared + p_squared;
    const bool is_defined = sum > 0.0;
    const double inverse = 1.0 / (is_defined ? sum : 1.0);
    return {is_defined ? (s_squared - p_squared) * inverse : 1.0, 2.0 * along_s * along_p * inverse};
}

DEVICE Stokes turned_axes(const Stokes &light, const Turn &turn) {
    return {light.i, turn.cos * light.q + turn.sin * light.u, turn.cos * light.u - turn.sin * light.q, light.v};
}

// The light after an interface that it meets along `k` and leaves along `k_out`, and its flux per flux that has arrived. `light`: Q, U and V
// over I, in axes of which +z is on the side of the sign `handedness`.
DEVICE_CALL double pass(double light[3], Vec3 k, Vec3 k_out, Vec3 axis, const FacetMueller &facet, double handedness) {
    const double h = handedness;
    const Stokes in = turned_axes({1.0, light[0], h * light[1], h * light[2]}, turn_to_axis(k, axis));
    const Stokes after = {facet.m00 * in.i + facet.m01 * in.q, facet.m01 * in.i + facet.m00 * in.q,
                          facet.m22 * in.u + facet.m23 * in.v, facet.m22 * in.v - facet.m23 * in.u};
    Turn back = turn_to_axis(k_out, axis);
    back.sin = -back.sin;
    const Stokes out = turned_axes(after, back);
    const double q = out.q, u = h * out.u, v = h * out.v;
    // Rounding may have made the polarised part longer than the whole
    const double polarised = sqrt(q * q + u * u + v * v);
    const double norm = out.i > polarised ? out.i : polarised;
    const double inverse = 1.0 / (norm > 0.0 ? norm : 1.0);
    light[0] = q * inverse;
    light[1] = u * inverse;
    light[2] = v * inverse;
    return out.i > 0.0 ? out.i : 0.0;
}

// Reflection by the reflectance for s light and the ratio (sin2 - c g) / (sin2 + c g) of the amplitudes.
DEVICE FacetMueller reflection(double reflectance_s, double cos_theta_i, double g_re, double g_im) {
    const double sin2 = (1.0 - cos_theta_i) * (1.0 + cos_theta_i);
    const double re = cos_theta_i * g_re, im = cos_theta_i * g_im;
    const double sum = sin2 + re;
    const double scale = reflectance_s / (sum * sum + im * im);
    const double sin4 = sin2 * sin2, cg_squared = re * re + im * im;
    return {scale * (sin4 + cg_squared), scale * (2.0 * sin2 * re), scale * (sin4 - cg_squared), scale * (2.0 * sin2 * im)};
}

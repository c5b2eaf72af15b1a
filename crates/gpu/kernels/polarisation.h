// Polarisation: Stokes vectors divided by the flux, and how interfaces change them: as `asperity_optics::polarisation`.
//
// Source: Born and Wolf, Principles of Optics, Secs. 1.5 and 14.2, rearranged; signs as in SCATMECH.
#pragma once

#include "tables.h"
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

// One interface on the way of polarised light: turns to the axes of its plane of incidence and back, and the sign by which U and V change.
struct Passage {
    Turn in, back;
    FacetMueller facet;
    double handedness;

    DEVICE Stokes apply(const Stokes &light) const {
        const double h = handedness;
        const Stokes at = turned_axes({light.i, light.q, h * light.u, h * light.v}, in);
        const Stokes after = {facet.m00 * at.i + facet.m01 * at.q, facet.m01 * at.i + facet.m00 * at.q,
                              facet.m22 * at.u + facet.m23 * at.v, facet.m22 * at.v - facet.m23 * at.u};
        const Stokes out = turned_axes(after, back);
        return {out.i, out.q, h * out.u, h * out.v};
    }
};

// Numbers that a path carries: Q, U and V over I; then, if N > 3, the averaged flux over the flux, or the other columns of a Mueller matrix.
template <int N>
struct Light {
    double numbers[N];

    // Column number `column` > 0 of a Mueller matrix.
    DEVICE Stokes column(int column) const {
        const double *of = numbers + 4 * column - 1;
        return {of[0], of[1], of[2], of[3]};
    }

    DEVICE void set_column(int column, const Stokes &light) {
        double *of = numbers + 4 * column - 1;
        of[0] = light.i;
        of[1] = light.q;
        of[2] = light.u;
        of[3] = light.v;
    }

    // Loses its polarisation: fluxes stay.
    DEVICE void depolarise() {
        for (int k = 0; k < N; k++) {
            numbers[k] = k % 4 == 3 ? numbers[k] : 0.0;
        }
    }
};

// Takes light through an interface that it meets along `k` and leaves along `k_out`, and returns its flux per flux that has arrived. Its axes
// have +z on the side of the sign `handedness`.
template <int N>
DEVICE_CALL double pass(const Job &job, Light<N> &light, Vec3 k, Vec3 k_out, Vec3 axis, const FacetMueller &facet, double handedness) {
    Passage passage = {turn_to_axis(k, axis), turn_to_axis(k_out, axis), facet, handedness};
    passage.back.sin = -passage.back.sin;
    double *numbers = light.numbers;
    const Stokes out = passage.apply({1.0, numbers[0], numbers[1], numbers[2]});
    // Rounding may have made the polarised part longer than the whole
    const double polarised = sqrt(out.q * out.q + out.u * out.u + out.v * out.v);
    const double norm = out.i > polarised ? out.i : polarised;
    const double inverse = 1.0 / (norm > 0.0 ? norm : 1.0);
    const double fraction = out.i > 0.0 ? out.i : 0.0;
    numbers[0] = out.q * inverse;
    numbers[1] = out.u * inverse;
    numbers[2] = out.v * inverse;
    if (N > 3 && job.polarisation == BOTH) {
        // Exactly one where unpolarised light arrives
        numbers[3] *= facet.m00 / (fraction > 0.0 ? fraction : 1.0);
    } else if (N > 3) {
        for (int column = 1; column < 4; column++) {
            const Stokes of = passage.apply(light.column(column));
            light.set_column(column, {of.i * inverse, of.q * inverse, of.u * inverse, of.v * inverse});
        }
    }
    return fraction;
}

// The turn of the axes of a vertical ray along z that follow an azimuth turned by the angle of `cos` and `sin`, against those that it has.
DEVICE Turn axes_turned(double z, double cos, double sin) {
    return turn_to_axis({0.0, 0.0, z}, turned({-0.0, 1.0, 0.0}, cos, sin));
}

// Turns the axes of light about its ray.
template <int N>
DEVICE void turn_light(const Job &job, Light<N> &light, const Turn &turn) {
    double *numbers = light.numbers;
    const Stokes first = turned_axes({1.0, numbers[0], numbers[1], numbers[2]}, turn);
    numbers[0] = first.q;
    numbers[1] = first.u;
    numbers[2] = first.v;
    if (N > 3 && job.polarisation == MUELLER) {
        for (int column = 1; column < 4; column++) {
            light.set_column(column, turned_axes(light.column(column), turn));
        }
    }
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

// Patch: z over one cell of a bicubic B-spline, by values of its blossom, which are weighted means of the coefficients around it.
//
// Source: Ramshaw, Blossoms are polar forms, Computer Aided Geometric Design 6, 323 (1989); written as `patch.rs` of the tracer.
#pragma once

#include "tables.h"

// a where x is 0, b where it is 1.
DEVICE double mix(double a, double b, double x) { return a * (1.0 - x) + b * x; }

// f(-1, 0, a), f(0, 1, a) and f(1, 2, a).
DEVICE void thirds(const double c[4], double a, double out[3]) {
    const double third = 1.0 / 3.0;
    out[0] = mix(c[0], c[1], (a + 2.0) * third);
    out[1] = mix(c[1], c[2], (a + 1.0) * third);
    out[2] = mix(c[2], c[3], a * third);
}

// f(0, a, b) and f(1, a, b), from the thirds of a.
DEVICE void halves(const double of_a[3], double b, double &low, double &high) {
    low = mix(of_a[0], of_a[1], 0.5 * (b + 1.0));
    high = mix(of_a[1], of_a[2], 0.5 * b);
}

// f(0, u, u) and f(1, u, u).
DEVICE void ends(const double c[4], double u, double &low, double &high) {
    double of_u[3];
    thirds(c, u, of_u);
    halves(of_u, u, low, high);
}

// Bernstein coefficients from a to b: f(a, a, a), f(a, a, b), f(a, b, b) and f(b, b, b).
DEVICE void between(const double c[4], double a, double b, double out[4]) {
    double of_a[3], of_b[3], low, high, low_mixed, high_mixed, low_b, high_b;
    thirds(c, a, of_a);
    thirds(c, b, of_b);
    halves(of_a, a, low, high);
    halves(of_a, b, low_mixed, high_mixed);
    halves(of_b, b, low_b, high_b);
    out[0] = mix(low, high, a);
    out[1] = mix(low_mixed, high_mixed, a);
    out[2] = mix(low_mixed, high_mixed, b);
    out[3] = mix(low_b, high_b, b);
}

struct Patch {
    // The first of four rows of four coefficients, and the distance between rows.
    const double *c;
    int stride;

    DEVICE static Patch of(const Surface &s, int ix, int iy) { return {s.z + (u64)iy * s.stride + ix, s.stride}; }

    DEVICE const double *row(int k) const { return c + (u64)k * stride; }

    // z at the place (u, v) of the cell, and its rise along x and along y.
    DEVICE double at(double u, double v, double &along_x, double &along_y) const {
        double low[4], high[4];
        for (int k = 0; k < 4; k++) {
            ends(row(k), u, low[k], high[k]);
        }
        double low_0, high_0, low_1, high_1;
        ends(low, v, low_0, high_0);
        ends(high, v, low_1, high_1);
        const double near = mix(low_0, low_1, u), far = mix(high_0, high_1, u);
        const double left = mix(low_0, high_0, v), right = mix(low_1, high_1, v);
        along_x = 3.0 * (right - left);
        along_y = 3.0 * (far - near);
        return mix(near, far, v);
    }

    // Bernstein coefficients of z along the line between the places (a, c) and (b, d), of degree six.
    DEVICE void along(double a, double c, double b, double d, double out[7]) const {
        double rows[4][4], at[4][4];
        for (int k = 0; k < 4; k++) {
            between(row(k), a, b, rows[k]);
        }
        for (int k = 0; k < 4; k++) {
            const double column[4] = {rows[0][k], rows[1][k], rows[2][k], rows[3][k]};
            between(column, c, d, at[k]);
        }
        out[0] = at[0][0];
        out[1] = 0.5 * (at[0][1] + at[1][0]);
        out[2] = 0.2 * (at[0][2] + at[2][0]) + 0.6 * at[1][1];
        out[3] = 0.05 * (at[0][3] + at[3][0]) + 0.45 * (at[1][2] + at[2][1]);
        out[4] = 0.2 * (at[1][3] + at[3][1]) + 0.6 * at[2][2];
        out[5] = 0.5 * (at[2][3] + at[3][2]);
        out[6] = at[3][3];
    }
};

// Elementary functions: those of `asperity_numerics::elementary` that paths need, operation by operation.
#pragma once

#include "portable.h"

#define PI 3.14159265358979323846
#define HALF_PI 1.57079632679489661923
#define TAU 6.28318530717958647692

// Sum of coefficients[i] x^i, by four sums side by side.
template <int N>
DEVICE double short_polynomial(double x, const double (&coefficients)[N]) {
    const double square = x * x;
    const double fourth = square * square;
    double sums[4] = {0.0, 0.0, 0.0, 0.0};
    for (int i = N - 1; i >= 0; i--) {
        sums[i % 4] = sums[i % 4] * fourth + coefficients[i];
    }
    return (sums[0] + x * sums[1]) + square * (sums[2] + x * sums[3]);
}

// Sine and cosine of 2 pi turn.
DEVICE void sin_cos_of_turn(double turn, double &sin, double &cos) {
    const double rounding = 6755399441055744.0;
    const double sines[8] = {-1.0 / 6.0,         1.0 / 120.0,         -1.0 / 5040.0,          1.0 / 362880.0,
                             -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0};
    const double cosines[7] = {1.0 / 24.0,          -1.0 / 720.0,        1.0 / 40320.0,          -1.0 / 3628800.0,
                               1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0};
    // The nearest quarter turn, and the rest
    const double rounded = 4.0 * turn + rounding;
    const u64 quarter = bits_of(rounded);
    const double r = HALF_PI * (4.0 * turn - (rounded - rounding));
    const double square = r * r;
    const double sine = r + r * square * short_polynomial(square, sines);
    const double cosine = 1.0 + square * (square * short_polynomial(square, cosines) - 0.5);
    // Swap and change signs by the quarter
    const bool is_odd = (quarter & 1) != 0;
    const double along = is_odd ? sine : cosine;
    const double across = is_odd ? cosine : sine;
    sin = number_of(bits_of(across) ^ (quarter & 2) << 62);
    cos = number_of(bits_of(along) ^ ((quarter + 1) & 2) << 62);
}

// The angle of the point (x, y), from -pi to pi. Neither is infinite or no number.
DEVICE_CALL double arc_tangent(double y, double x) {
    const double coefficients[9] = {1.0 / 3.0,   -1.0 / 5.0, 1.0 / 7.0,   -1.0 / 9.0, 1.0 / 11.0,
                                    -1.0 / 13.0, 1.0 / 15.0, -1.0 / 17.0, 1.0 / 19.0};
    // atan(k / 4), and what its nearest number leaves
    const double nodes[5][2] = {{0.0, 0.0},
                                {0.24497866312686414, 1.0698755618734451e-17},
                                {0.4636476090008061, 2.2698777452961687e-17},
                                {0.6435011087932844, 1.5834785051444286e-17},
                                {HALF_PI / 2.0, 3.061616997868383e-17}};
    const double rest_of_half_pi = 6.123233995736766e-17;
    const double ax = fabs(x), ay = fabs(y);
    const bool is_steep = ay > ax;
    double low = is_steep ? ax : ay, high = is_steep ? ay : ax;
    // Scale what is subnormal
    const double scale = high < 1e-290 ? 18014398509481984.0 : 1.0;
    low = low * scale;
    high = high * scale;
    high = high == 0.0 ? 1.0 : high;
    // Subtract the nearest of the nodes: tan(a - b) = (tan a - tan b) / (1 + tan a tan b)
    double tangent = 0.0, angle = 0.0, rest = 0.0;
    for (int k = 1; k < 5; k++) {
        if (low > (0.25 * k - 0.125) * high) {
            tangent = 0.25 * k;
            angle = nodes[k][0];
            rest = nodes[k][1];
        }
    }
    const double u = (low - tangent * high) / (high + tangent * low);
    const double square = u * u;
    const double first = angle + (u - (u * square * short_polynomial(square, coefficients) - rest));
    // Undo the reflections
    const double second = is_steep ? HALF_PI - (first - rest_of_half_pi) : first;
    const bool is_left = (bits_of(x) >> 63) != 0;
    const double third = is_left ? PI - (second - 2.0 * rest_of_half_pi) : second;
    return (bits_of(y) >> 63) != 0 ? -fabs(third) : fabs(third);
}

// The angle from -pi/2 to pi/2 of a sine within one. Source: asin of FreeBSD, by way of the crate libm.
DEVICE double arc_sine(double x) {
    const double half_pi = 1.57079632679489655800, rest = 6.12323399573676603587e-17;
    const double ax = fabs(x);
    const bool is_small = ax < 0.5;
    if (ax >= 1.0) {
        return x * half_pi;
    }
    if (ax < 1.4901161193847656e-8) {
        return x;
    }
    const double z = is_small ? x * x : (1.0 - ax) * 0.5;
    const double p = z * (1.66666666666666657415e-01 +
                          z * (-3.25565818622400915405e-01 +
                               z * (2.01212532134862925881e-01 +
                                    z * (-4.00555345006794114027e-02 +
                                         z * (7.91534994289814532176e-04 + z * 3.47933107596021167570e-05)))));
    const double q = 1.0 + z * (-2.40339491173441421878 +
                                z * (2.02094576023350569471 +
                                     z * (-6.88283971605453293030e-01 + z * 7.70381505559019352791e-02)));
    const double r = p / q;
    if (is_small) {
        return x + x * r;
    }
    const double s = sqrt(z);
    double angle;
    if ((bits_of(ax) >> 32) >= 0x3fef3333) {
        angle = half_pi - (2. * (s + s * r) - rest);
    } else {
        const double f = number_of(bits_of(s) & 0xffffffff00000000ULL);
        const double c = (z - f * f) / (s + f);
        angle = 0.5 * half_pi - (2.0 * s * r - (rest - 2.0 * c) - (0.5 * half_pi - 2.0 * f));
    }
    return x < 0.0 ? -angle : angle;
}

// The square of a number, and what rounding left of it.
DEVICE void split_square(double x, double &high, double &low) {
    const double xc = x * 134217729.0;
    const double xh = x - xc + xc;
    const double xl = x - xh;
    high = x * x;
    low = xh * xh - high + 2. * xh * xl + xl * xl;
}

// Length of the vector (x, y), neither infinite or no number. Source: hypot of musl, by way of the crate libm.
DEVICE double length_of(double x, double y) {
    x = fabs(x);
    y = fabs(y);
    if (x < y) {
        const double larger = y;
        y = x;
        x = larger;
    }
    const i64 ex = (i64)(bits_of(x) >> 52), ey = (i64)(bits_of(y) >> 52);
    if (y == 0.0) {
        return x;
    }
    if (ex - ey > 64) {
        return x + y;
    }
    double z = 1.0;
    if (ey < 0x3ff - 450) {
        const double up = number_of(0x6bb0000000000000ULL), down = number_of(0x1430000000000000ULL);
        z = down;
        x *= up;
        y *= up;
    }
    double hx, lx, hy, ly;
    split_square(x, hx, lx);
    split_square(y, hy, ly);
    return z * sqrt(ly + lx + hy + hx);
}

// Polar angle from +z.
DEVICE double polar_angle(double x, double y, double z) { return arc_tangent(length_of(x, y), z); }

// Azimuth from +x towards +y in [0, 2 pi); zero for a vertical direction.
DEVICE double azimuth(double x, double y) {
    if (x == 0.0 && y == 0.0) {
        return 0.0;
    }
    const double phi = arc_tangent(y, x);
    if (!(phi < 0.0)) {
        return phi;
    }
    // A tiny negative angle rounds up to the full turn, which is zero.
    const double wrapped = phi + TAU;
    return wrapped < TAU ? wrapped : 0.0;
}

// The remainder in [0, 2 pi) of an angle within a few turns: so far, sums and differences are exact.
DEVICE double within_turn(double angle) {
    while (angle >= TAU) {
        angle -= TAU;
    }
    while (angle <= -TAU) {
        angle += TAU;
    }
    return angle < 0.0 ? angle + TAU : angle;
}

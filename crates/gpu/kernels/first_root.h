// First root: the first parameter in [0, 1] at which a polynomial in Bernstein form falls below zero.
//
// It has no more roots than its coefficients have changes of sign, and as many but for an even number (Descartes' rule). Where that
// does not decide, the interval is halved, and the first half looked at first. As `first_root.rs` of the tracer does.
#pragma once

#include "portable.h"

// Halvings after which an interval is as narrow as rounding.
#define MAX_HALVINGS 50

// A polynomial of degree six.
struct Sextic {
    double b[7];
};

// No root.
#define NO_ROOT (-1.0)

// 1, -1, or 0 within the noise.
DEVICE int sign_of(double x, double noise) { return x < -noise ? -1 : (x > noise ? 1 : 0); }

// Number of changes of sign, and the first sign.
DEVICE_CALL int changes_of_sign(const Sextic &p, double noise, int &first) {
    int last = 0, changes = 0;
    first = 0;
    for (int k = 0; k < 7; k++) {
        const int sign = sign_of(p.b[k], noise);
        changes += last * sign < 0 ? 1 : 0;
        last = sign == 0 ? last : sign;
        first = first == 0 ? sign : first;
    }
    return changes;
}

// An interval that contains a root, and a guess at it.
struct Bracket {
    double low, high, s, change;

    // The first guess is where the coefficients, taken as values at equal distances, change sign.
    DEVICE static Bracket of(const Sextic &p) {
        double s = 0.5;
        for (int i = 5; i >= 0; i--) {
            const double guess = (i + p.b[i] / (p.b[i] - p.b[i + 1])) * (1.0 / 6.0);
            s = p.b[i] > 0.0 && p.b[i + 1] < 0.0 ? guess : s;
        }
        return {0.0, 1.0, s, 1.0};
    }

    // A step of Halley's method, or half the interval where that leaves it.
    DEVICE void narrow(const Sextic &p) {
        // Value, derivative and half the second derivative, by de Casteljau's algorithm
        const double r = 1.0 - s;
        double c[7];
        for (int i = 0; i < 7; i++) {
            c[i] = p.b[i];
        }
        for (int last = 6; last > 2; last--) {
            for (int i = 0; i < last; i++) {
                c[i] = r * c[i] + s * c[i + 1];
            }
        }
        const double first = c[1] - c[0], second = c[2] - c[1];
        const double rate = 6.0 * (r * first + s * second);
        const double value = r * (r * c[0] + s * c[1]) + s * (r * c[1] + s * c[2]);
        const double half_bend = 15.0 * (second - first);
        low = value > 0.0 ? s : low;
        high = value > 0.0 ? high : s;
        const double guess = s - value * rate / (rate * rate - value * half_bend);
        const double next = guess >= low && guess <= high ? guess : 0.5 * (low + high);
        change = fabs(next - s);
        s = next;
    }
};

// The root of a polynomial that changes from positive to negative once.
DEVICE_CALL double single_root(const Sextic &p) {
    Bracket bracket = Bracket::of(p);
    for (int step = 0; step < 3; step++) {
        bracket.narrow(p);
    }
    for (int step = 0; step < 200 && !(bracket.change < 1e-7); step++) {
        bracket.narrow(p);
    }
    return bracket.s;
}

// The two halves of a polynomial, by de Casteljau's algorithm.
DEVICE void halve(const Sextic &p, Sextic &low, Sextic &high) {
    high = p;
    for (int k = 0; k < 7; k++) {
        low.b[k] = high.b[0];
        for (int i = 0; i < 6 - k; i++) {
            high.b[i] = 0.5 * (high.b[i] + high.b[i + 1]);
        }
    }
}

// A part of [0, 1] that waits, and its polynomial.
struct Part {
    double from, width;
    int halvings;
    Sextic p;
};

// The smallest s in [0, 1] at which a polynomial, positive before, becomes negative. Coefficients within `noise` of zero count as zero.
DEVICE_CALL double first_root(const Sextic &whole, double noise) {
    int first;
    const int changes = changes_of_sign(whole, noise, first);
    if (changes == 0) {
        return first < 0 ? 0.0 : NO_ROOT;
    }
    if (changes == 1 && first == 1) {
        return single_root(whole);
    }
    // The first half comes last; each that waits is half as wide as the one before.
    Part waiting[MAX_HALVINGS + 2];
    waiting[0] = {0.0, 1.0, 0, whole};
    int count = 1;
    while (count > 0) {
        const Part part = waiting[--count];
        const int changes = changes_of_sign(part.p, noise, first);
        if (changes == 0 && first == -1) {
            return part.from;
        } else if (changes == 0) {
            continue;
        } else if (changes == 1 && first == 1) {
            return part.from + part.width * single_root(part.p);
        } else if (part.halvings == MAX_HALVINGS) {
            if (part.p.b[6] < -noise) {
                return part.from;
            }
        } else {
            const double half = 0.5 * part.width;
            Part &high = waiting[count++], &low = waiting[count++];
            high.from = part.from + half;
            low.from = part.from;
            low.width = high.width = half;
            low.halvings = high.halvings = part.halvings + 1;
            halve(part.p, low.p, high.p);
        }
    }
    return NO_ROOT;
}

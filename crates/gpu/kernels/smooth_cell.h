// Smooth cell: a cell of a bicubic B-spline, and where a ray passes through it: as `smooth.rs` of the tracer decides.
#pragma once

#include "first_root.h"
#include "hit.h"
#include "patch.h"

// Rounding of a height above a patch, and of a coordinate along a ray; factor of rounding by the division by a known root.
#define HEIGHT_ROUNDING (64.0 * 2.220446049250313e-16)
#define RAY_ROUNDING (4.0 * 2.220446049250313e-16)
#define DIVIDED 12.0
// Amount by which the heights are extended, relative to them and to a column.
#define PADDING 1e-9

struct SmoothCells {
    // The part of a ray above a cell, between all heights; empty unless enter < leave. `rate`: that at which it crosses the side by which
    // it enters, infinite if it begins in the cell.
    struct Stretch {
        double enter, leave, rate;

        DEVICE void clip(double o, double d, double low, double high) {
            if (d == 0.0) {
                leave = o < low || o > high ? -INFINITE : leave;
                return;
            }
            const double a = (low - o) / d, b = (high - o) / d;
            const double near = d > 0.0 ? a : b, far = d > 0.0 ? b : a;
            if (near > enter) {
                enter = near;
                rate = fabs(d);
            }
            leave = far < leave ? far : leave;
        }
    };

    // Distance by which rounding may have put a ray that enters a cell onto the wrong side.
    DEVICE static double tolerance(const Surface &s, const Ray &ray, const Stretch &stretch) {
        const double reach = 1.0 + s.reach + extent_of(ray.o) + stretch.enter * extent_of(ray.d);
        const double place = HEIGHT_ROUNDING * reach;
        const double travel = fabs(ray.d.x) + fabs(ray.d.y);
        const double falls = fabs(ray.d.z) + s.steepest * travel;
        return place * (1.0 + s.steepest + falls / stretch.rate);
    }

    // A polynomial, less its value at 0, divided by s; as one of the same degree.
    DEVICE static Sextic without_first(const Sextic &p) {
        double divided[6];
        for (int k = 0; k < 6; k++) {
            divided[k] = 6.0 / (k + 1) * (p.b[k + 1] - p.b[0]);
        }
        Sextic raised;
        raised.b[0] = divided[0];
        for (int k = 1; k < 6; k++) {
            const double part = k * (1.0 / 6.0);
            raised.b[k] = part * divided[k - 1] + (1.0 - part) * divided[k];
        }
        raised.b[6] = divided[5];
        return raised;
    }

    // Tests a cell.
    DEVICE static void test(const Surface &s, int ix, int iy, const Ray &ray, Hit &closest) {
        const Vec3 d = ray.d;
        Stretch stretch = {0.0, INFINITE, INFINITE};
        const double slab = s.reach + PADDING * (1.0 + s.reach) + HEIGHT_ROUNDING * fabs(ray.o.z);
        stretch.clip(ray.o.x, d.x, ix, ix + 1.0);
        stretch.clip(ray.o.y, d.y, iy, iy + 1.0);
        stretch.clip(ray.o.z, d.z, -slab, slab);
        const double enter = stretch.enter, leave = stretch.leave;
        if (enter >= leave) {
            return;
        }
        // The height of the ray above the patch
        const Vec3 o = {ray.o.x - ix, ray.o.y - iy, ray.o.z};
        const Patch patch = Patch::of(s, ix, iy);
        const double u = unit_interval(o.x + enter * d.x), v = unit_interval(o.y + enter * d.y);
        Sextic gaps;
        patch.along(u, v, unit_interval(o.x + leave * d.x), unit_interval(o.y + leave * d.y), gaps.b);
        const double from = o.z + enter * d.z, to = o.z + leave * d.z;
        for (int k = 0; k < 7; k++) {
            gaps.b[k] = ray.q * (from + k * (1.0 / 6.0) * (to - from) - gaps.b[k]);
        }
        const double along = s.steepest * (fabs(o.x) + fabs(o.y));
        const double noise = HEIGHT_ROUNDING * s.reach + RAY_ROUNDING * (along + fabs(o.z));
        double root;
        if (gaps.b[0] > noise) {
            root = first_root(gaps, noise);
        } else if (gaps.b[0] < -tolerance(s, ray, stretch)) {
            return;
        } else {
            // It enters on the surface: it passes at once if it falls, or leaves what it has begun on
            double along_x, along_y;
            patch.at(u, v, along_x, along_y);
            if (ray.q * (d.z - along_x * d.x - along_y * d.y) < 0.0) {
                closest.keep(enter, facet_number(ix, iy, false));
                return;
            }
            root = first_root(without_first(gaps), DIVIDED * noise);
        }
        if (root != NO_ROOT) {
            closest.keep(enter + root * (leave - enter), facet_number(ix, iy, false));
        }
    }

    // The cell over a place of the tile.
    DEVICE static u64 facet_over(const Surface &s, double x, double y) {
        return facet_number(cell_at(x, s.cells[0]), cell_at(y, s.cells[1]), false);
    }

    // The point of a cell above or below p, and the unit normal there, upwards.
    DEVICE static void arrive(const Surface &s, u64 cell, Vec3 &p, Vec3 &m) {
        const int ix = column_of(cell), iy = row_of(cell);
        const double x = ix + unit_interval(p.x - ix), y = iy + unit_interval(p.y - iy);
        double along_x, along_y;
        const double z = Patch::of(s, ix, iy).at(x - ix, y - iy, along_x, along_y);
        p = {x, y, z};
        const double mx = -along_x, my = -along_y * s.aspect;
        const double scale = 1.0 / sqrt(mx * mx + my * my + 1.0);
        m = {mx * scale, my * scale, scale};
    }
};

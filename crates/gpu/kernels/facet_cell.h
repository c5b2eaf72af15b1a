// Facet cell: the two triangles between four heights, split from corner 00 to 11, and where a ray passes through them.
#pragma once

#include "hit.h"

struct FacetCells {
    // A cell's heights at its corners.
    struct Cell {
        double z00, z10, z01, z11;
    };

    // A plane: z at the corner 00, and its rise along a column and a row.
    struct Plane {
        double z00, per_column, per_row;
    };

    DEVICE static Cell cell(const Surface &s, int ix, int iy) {
        const double *near = s.z + (u64)iy * s.stride + ix, *far = near + s.stride;
        return {near[0], near[1], far[0], far[1]};
    }

    DEVICE static Plane plane(const Cell &c, bool is_upper) {
        if (is_upper) {
            return {c.z00, c.z11 - c.z01, c.z01 - c.z00};
        }
        return {c.z00, c.z10 - c.z00, c.z11 - c.z10};
    }

    // The part of a ray over a footprint of three sides.
    struct Span {
        double enter, leave;

        // Keeps the part in which value + t rate >= 0.
        DEVICE void keep_positive(double value, double rate) {
            if (rate > 0.0) {
                enter = greatest(enter, -value / rate);
            } else if (rate < 0.0) {
                leave = least(leave, -value / rate);
            } else if (value < 0.0) {
                leave = -INFINITE;
            }
        }
    };

    // True if a ray that passes the plane of a facet at t, before it enters the footprint, is farther on the wrong side there than
    // rounding explains: see `Size::comes_from_beneath` of the Rust engine.
    DEVICE static bool comes_from_beneath(const Surface &s, const Ray &ray, double g_rate, double t, double enter,
                                          const double (&values)[3], const double (&rates)[3]) {
        const double epsilon = 2.220446049250313e-16;
        const double reach = 1.0 + s.reach + extent_of(ray.o) + enter * extent_of(ray.d);
        const double place = 64.0 * epsilon * reach;
        const double height = place * (1.0 + s.steepest);
        const double before = enter - t;
        bool is_on_side = false;
        for (int k = 0; k < 3; k++) {
            const bool entered_by = rates[k] > 0.0 && -values[k] / rates[k] >= enter;
            is_on_side |= entered_by && before * rates[k] <= place;
        }
        return before * fabs(g_rate) > height && !is_on_side;
    }

    DEVICE static void intersect(const Surface &s, const Cell &c, int ix, int iy, bool is_upper, const Ray &ray, Hit &closest) {
        const Plane p = plane(c, is_upper);
        const Vec3 d = ray.d;
        const double x = ray.o.x - ix, y = ray.o.y - iy;
        const double g = ray.o.z - p.z00 - p.per_column * x - p.per_row * y;
        const double g_rate = d.z - p.per_column * d.x - p.per_row * d.y;
        if (ray.q * g_rate >= 0.0) {
            return;
        }
        // The sides of the footprint: u and v in [0, 1], and the diagonal u = v
        const double values[3] = {is_upper ? x : 1.0 - x, is_upper ? 1.0 - y : y, is_upper ? y - x : x - y};
        const double rates[3] = {is_upper ? d.x : -d.x, is_upper ? -d.y : d.y, is_upper ? d.y - d.x : d.x - d.y};
        Span span = {0.0, INFINITE};
        for (int k = 0; k < 3; k++) {
            span.keep_positive(values[k], rates[k]);
        }
        if (span.enter > span.leave || ray.q * (g + g_rate * span.leave) >= 0.0) {
            return;
        }
        double t = -g / g_rate;
        if (t < span.enter && comes_from_beneath(s, ray, g_rate, t, span.enter, values, rates)) {
            return;
        }
        t = t < span.enter ? span.enter : t;
        t = t > span.leave ? span.leave : t;
        closest.keep(t, facet_number(ix, iy, is_upper));
    }

    // Tests the facets of a cell.
    DEVICE static void test(const Surface &s, int ix, int iy, const Ray &ray, Hit &closest) {
        const Cell c = cell(s, ix, iy);
        intersect(s, c, ix, iy, false, ray, closest);
        intersect(s, c, ix, iy, true, ray, closest);
    }

    // The facet over a place of the tile.
    DEVICE static u64 facet_over(const Surface &s, double x, double y) {
        const int ix = cell_at(x, s.cells[0]), iy = cell_at(y, s.cells[1]);
        return facet_number(ix, iy, !(x - ix > y - iy));
    }

    // The point of a facet above or below p, moved into its cell, and the unit normal there, upwards.
    DEVICE static void arrive(const Surface &s, u64 facet, Vec3 &p, Vec3 &m) {
        const int ix = column_of(facet), iy = row_of(facet);
        const Plane on = plane(cell(s, ix, iy), facet & 1);
        const double u = unit_interval(p.x - ix), v = unit_interval(p.y - iy);
        p = {ix + u, iy + v, on.z00 + on.per_column * u + on.per_row * v};
        const double mx = -on.per_column, my = -on.per_row * s.aspect;
        const double scale = 1.0 / sqrt(mx * mx + my * my + 1.0);
        m = {mx * scale, my * scale, scale};
    }
};

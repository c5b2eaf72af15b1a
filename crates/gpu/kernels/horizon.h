// Horizon: bounds on how high the surface rises before a ray, by which it escapes without a search.
#pragma once

#include "tables.h"
#include "vectors.h"

// Results of the bounds: a search must tell; the ray is steeper than all facets; it stays above the bounds nearby and farther on.
enum { UNKNOWN, STEEPER_THAN_ALL, ABOVE_HORIZON };

// An upper bound of a rise in the direction (x, y), from those along an axis and the diagonal beside it.
DEVICE double rise_bound(double x, double y, double axis, double diagonal) {
    x = fabs(x);
    y = fabs(y);
    return fabs(x - y) * axis + least(x, y) * diagonal;
}

// The steepest rise of any facet in a direction.
DEVICE double steepest_along(const Surface &s, double x, double y) {
    const int left = x < 0.0, down = y < 0.0;
    const int axis = fabs(x) >= fabs(y) ? 4 * left : 2 + 4 * down;
    const int diagonal = 1 + 2 * (left ^ down) + 4 * down;
    return rise_bound(x, y, s.all[axis], s.all[diagonal]);
}

DEVICE int block_of(const Surface &s, double place, int axis) {
    const int block = (int)place >> s.block_level;
    return block < s.last_block[axis] ? block : s.last_block[axis];
}

DEVICE double value_of(const double scale[2], double steps) { return scale[0] + scale[1] * steps; }

// True if a ray from its place in the tile stays above the bounds.
DEVICE bool is_above_horizon(const Surface &s, const Ray &ray, double rise) {
    const double dx = ray.d.x, dy = ray.d.y;
    const int block = block_of(s, ray.o.y, 1) * (s.last_block[0] + 1) + block_of(s, ray.o.x, 0);
    const int quadrant = (dx < 0.0 ? 1 : 0) | (dy < 0.0 ? 2 : 0);
    const unsigned short *bounds = s.quadrants + 8 * (8 * (u64)block + 2 * quadrant + (ray.q < 0.0 ? 1 : 0));
    const bool is_along_x = fabs(dx) >= fabs(dy);
    const double axis = value_of(s.rise_scale, is_along_x ? bounds[0] : bounds[1]);
    const double diagonal = value_of(s.rise_scale, bounds[2]);
    bool is_above = rise > rise_bound(dx, dy, axis, diagonal);
    // Height gained on the way past one block
    const double z = ray.q * ray.o.z;
    double gain = rise * (double)(1 << s.block_level) / (is_along_x ? fabs(dx) : fabs(dy));
    for (int k = 3; k < 8; k++) {
        is_above &= z + gain > value_of(s.height_scale, bounds[k]);
        gain *= 2.0;
    }
    return is_above & (z + gain > -s.height_scale[0]);
}

// The bound by which a ray hits nothing.
DEVICE int escape_class(const Surface &s, const Ray &ray) {
    const double rise = ray.q * ray.d.z;
    if (!(rise > 0.0)) {
        return UNKNOWN;
    }
    if (rise > steepest_along(s, ray.q * ray.d.x, ray.q * ray.d.y)) {
        return STEEPER_THAN_ALL;
    }
    const bool is_within = 0.0 <= ray.o.x && ray.o.x <= s.extent[0] && 0.0 <= ray.o.y && ray.o.y <= s.extent[1];
    return is_within && is_above_horizon(s, ray, rise) ? ABOVE_HORIZON : UNKNOWN;
}

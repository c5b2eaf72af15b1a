// Pyramid: searches a hierarchy of height bounds for the first facet that a ray meets, in f64.
//
// Nodes are visited from the top down, near children first, without a stack: a node knows its place among the children of its parent.
// As `quadtree.rs` of the tracer does, which holds the argument why no facet is left out that brute force finds.
#pragma once

#include "hit.h"

// Widening of footprints, relative to the size of the tile and to how far a ray comes.
#define WIDENING 1e-10

// Interval of t in which a ray is over a square; empty if enter > leave.
DEVICE void clip(double o, double d, double low, double high, double &enter, double &leave) {
    if (d == 0.0) {
        leave = o < low || o > high ? -INFINITE : leave;
        return;
    }
    const double a = (low - o) / d, b = (high - o) / d;
    enter = greatest(enter, least(a, b));
    leave = least(leave, greatest(a, b));
}

// True if the surface may be met in a node before `closest`.
DEVICE bool may_meet(const Surface &s, const Ray &ray, int level, int x, int y, double widening, const Hit &closest) {
    const double size = (double)(1 << level);
    const double low_x = x * size - widening, low_y = y * size - widening;
    double enter = 0.0, leave = 1.7976931348623157e308;
    clip(ray.o.x, ray.d.x, low_x, low_x + size + 2.0 * widening, enter, leave);
    clip(ray.o.y, ray.d.y, low_y, low_y + size + 2.0 * widening, enter, leave);
    if (enter > leave || closest.t < enter) {
        return false;
    }
    if (level < s.lowest_level) {
        return true;
    }
    // The lowest height that the ray has over the node, on its own side
    const double rise = ray.q * ray.d.z;
    const double lowest = ray.q * ray.o.z + rise * (rise < 0.0 ? leave : enter);
    const u32 word = s.nodes[s.first_node[level] + y * s.node_width[level] + x];
    const u32 steps = ray.q < 0.0 ? word >> 16 : word & 0xffff;
    return lowest <= s.node_scale[0] + s.node_scale[1] * steps;
}

// The first facet that a ray meets in the tile.
template <class Cells>
DEVICE Hit closest_hit(const Surface &s, const Ray &ray) {
    const double size = s.cells[0] > s.cells[1] ? s.cells[0] : s.cells[1];
    const double farthest = greatest(greatest(fabs(ray.o.x), fabs(ray.o.y)), fabs(ray.o.z));
    const double widening = WIDENING * greatest(farthest, size);
    // Low digits of the nearest child
    const int near_x = ray.d.x > 0.0 ? 0 : 1, near_y = ray.d.y > 0.0 ? 0 : 1;
    Hit closest = Hit::none();
    int level = s.top, x = 0, y = 0;
    for (;;) {
        const bool exists = x << level < s.cells[0] && y << level < s.cells[1];
        const bool is_open = exists && may_meet(s, ray, level, x, y, widening, closest);
        if (is_open && level > 0) {
            level--;
            x = 2 * x + near_x;
            y = 2 * y + near_y;
            continue;
        }
        if (is_open) {
            Cells::test(s, x, y, ray, closest);
        }
        // The next child of the same parent, or of the first ancestor that has one
        for (;;) {
            if (level == s.top) {
                return closest;
            }
            const bool is_far_x = (x & 1) != near_x, is_far_y = (y & 1) != near_y;
            if (!is_far_y || !is_far_x) {
                x = is_far_y ? x ^ 1 : x;
                y ^= 1;
                break;
            }
            level++;
            x >>= 1;
            y >>= 1;
        }
    }
}

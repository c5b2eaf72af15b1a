// Traversal: takes a ray from tile to tile of a surface until it meets the surface or leaves it: as `periodic/` of the tracer.
#pragma once

#include "horizon.h"
#include "pyramid.h"
#include "work.h"

// What becomes of a path segment. OPEN: a search must tell; LEFT: it leaves an open patch towards surface that is not there; ENDED: nothing is
// left to do.
enum Outcome { OPEN, MET, ESCAPED, LEFT, LOST, ENDED };

// Tiles that a ray may cross before it is given up as lost.
#define MAX_TILES 100000

// Interval of t, from zero, between the lowest and the highest point, a little widened; empty if start > end.
DEVICE void between_heights(const Surface &s, const Ray &ray, double &start, double &end) {
    double low = -s.reach, high = s.reach;
    const double pad = 1e-6 * (1.0 + high - low);
    low -= pad;
    high += pad;
    const double z = ray.o.z, rate = ray.d.z;
    if (rate == 0.0) {
        start = 0.0;
        end = low <= z && z <= high ? INFINITE : -INFINITE;
        return;
    }
    const double a = (low - z) / rate, b = (high - z) / rate;
    start = greatest(least(a, b), 0.0);
    end = greatest(a, b);
}

DEVICE Outcome nothing_met(const Surface &s, const Ray &ray) {
    return ray.q * ray.d.z > 0.0 ? ESCAPED : (s.border == OPEN_PATCH ? LEFT : LOST);
}

// True if a tile, by its number from the first along an axis, is a mirror image of that.
DEVICE bool is_image(const Surface &s, double tile) {
    return s.border == MIRRORED && tile - 2.0 * floor(0.5 * tile) == 1.0;
}

// A ray of the first tile in tile (x, y), in the orientation of that.
DEVICE Ray in_tile(const Surface &s, const Ray &first, double x, double y) {
    const bool image_x = is_image(s, x), image_y = is_image(s, y);
    Ray ray = first;
    ray.o.x = image_x ? (x + 1.0) * s.extent[0] - first.o.x : first.o.x - x * s.extent[0];
    ray.o.y = image_y ? (y + 1.0) * s.extent[1] - first.o.y : first.o.y - y * s.extent[1];
    const u32 images = (image_x ? 1 : 0) | (image_y ? 2 : 0);
    ray.d = mirrored(first.d, images);
    ray.flips ^= images;
    return ray;
}

// True if a ray from outside of an open patch comes over its border beneath the surface.
template <class Cells>
DEVICE bool comes_from_beneath_patch(const Surface &s, const Ray &ray) {
    double enter = 0.0, leave = INFINITE;
    clip(ray.o.x, ray.d.x, 0.0, s.extent[0], enter, leave);
    clip(ray.o.y, ray.d.y, 0.0, s.extent[1], enter, leave);
    if (!(enter > 0.0 && enter < leave)) {
        return false;
    }
    const Vec3 rim = at(ray, enter);
    Vec3 on = {rim.x, rim.y, 0.0}, m;
    Cells::arrive(s, Cells::facet_over(s, rim.x, rim.y), on, m);
    return ray.q * (rim.z - on.z) < 0.0;
}

// Begins a segment anywhere: OPEN if it is to be searched, with its origin moved to the first tile.
template <class Cells>
DEVICE_CALL Outcome begin(const Surface &s, Ray &ray, Work &work) {
    const double sum = ray.o.x + ray.o.y + ray.o.z + ray.d.x + ray.d.y + ray.d.z;
    if (!is_finite(sum)) {
        work.add(SEGMENTS);
        return LOST;
    }
    const int escape = escape_class(s, ray);
    if (escape != UNKNOWN) {
        work.add(SKIPPED);
        if (escape == ABOVE_HORIZON) {
            work.add(SKIPPED_NEARBY);
        }
        return ESCAPED;
    }
    const Vec3 o = ray.o;
    const bool is_within = 0.0 <= o.x && o.x < s.extent[0] && 0.0 <= o.y && o.y < s.extent[1] && fabs(o.z) <= s.reach;
    if (is_within) {
        return OPEN;
    }
    if (s.border == OPEN_PATCH && comes_from_beneath_patch<Cells>(s, ray)) {
        work.add(SEGMENTS);
        return LEFT;
    }
    double start, end;
    between_heights(s, ray, start, end);
    if (start > end) {
        work.add(SEGMENTS);
        return nothing_met(s, ray);
    }
    if (s.border != OPEN_PATCH) {
        const Vec3 entry = at(ray, start);
        ray = in_tile(s, ray, floor(entry.x / s.extent[0]), floor(entry.y / s.extent[1]));
    }
    return OPEN;
}

// True if a ray that moves away from the surface leaves the heights before it leaves the tile.
DEVICE bool leaves_heights_in_tile(const Surface &s, const Ray &ray) {
    const double high = s.reach + 1e-6 * (1.0 + 2.0 * s.reach);
    const double rise = ray.q * ray.d.z;
    if (!(rise > 0.0)) {
        return false;
    }
    const Vec3 p = at(ray, (high - ray.q * ray.o.z) / rise);
    return 0.0 < p.x && p.x < s.extent[0] && 0.0 < p.y && p.y < s.extent[1];
}

// Ray parameter at which a ray leaves tile number `tile` along an axis; infinite if it runs along the other.
DEVICE double crossing(double o, double d, i64 tile, double size) {
    const double k = (double)tile + (d > 0.0 ? 1.0 : 0.0);
    return d == 0.0 ? INFINITE : (k * size - o) / d;
}

// A facet that a segment meets: the point, the unit normal there, upwards, and the axes along which the segment has been mirrored.
struct Meeting {
    Vec3 p, m;
    u64 facet;
    u32 flips;
    // Beyond the first tile.
    bool is_far;

    // Moves the point to the facet once more, as the engine does with all arrivals that have been moved before.
    template <class Cells>
    DEVICE void arrive_again(const Surface &s) {
        Cells::arrive(s, facet, p, m);
    }
};

// Searches a segment tile by tile.
template <class Cells>
DEVICE_CALL Outcome search(const Surface &s, const Ray &first, Meeting &at_facet, Work &work) {
    work.add(SEGMENTS);
    Ray ray = first;
    double entered, end;
    between_heights(s, first, entered, end);
    i64 tile_x = 0, tile_y = 0;
    for (int searched = 1;; searched++) {
        const Hit hit = closest_hit<Cells>(s, ray);
        if (!hit.is_none()) {
            at_facet.p = at(ray, hit.t);
            at_facet.facet = hit.facet;
            at_facet.flips = ray.flips;
            at_facet.is_far = searched > 1;
            Cells::arrive(s, hit.facet, at_facet.p, at_facet.m);
            return MET;
        }
        if (searched == 1 && leaves_heights_in_tile(s, ray)) {
            return ESCAPED;
        }
        if (s.border == OPEN_PATCH) {
            return nothing_met(s, first);
        }
        if (searched == MAX_TILES) {
            return LOST;
        }
        // Step across the boundary that comes first
        const double at_x = crossing(first.o.x, first.d.x, tile_x, s.extent[0]);
        const double at_y = crossing(first.o.y, first.d.y, tile_y, s.extent[1]);
        const bool is_along_y = at_y < at_x;
        const double next = is_along_y ? at_y : at_x;
        entered = greatest(next, entered);
        if (!is_finite(next) || !(entered <= end)) {
            return nothing_met(s, first);
        }
        if (is_along_y) {
            tile_y += first.d.y > 0.0 ? 1 : -1;
        } else {
            tile_x += first.d.x > 0.0 ? 1 : -1;
        }
        ray = in_tile(s, first, (double)tile_x, (double)tile_y);
    }
}

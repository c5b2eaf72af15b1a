// Starts: the places at which paths begin, one in each stratum of the lit window, and their directions.
#pragma once

#include "elementary.h"
#include "polarisation.h"
#include "random.h"

// A path segment: its ray in physical directions, and what its path carries.
struct Segment {
    Vec3 o, k;
    double q, flux;
    u32 order, events;
    // Axes of the tile that are mirrored against the world.
    u32 mirrored;
};

// A path segment and its polarisation.
template <int N>
struct PolarisedSegment : Segment {
    Light<N> light;
};

// Of a path: its number among those of the call, and the angle by which its exits are turned back.
struct Path {
    u32 ray, batch;
    double cos, sin;
};

// Column and row of stratum number `number` along a Morton curve over a square of `side` strata a side.
DEVICE void stratum(u32 side, u32 number, u32 &column, u32 &row) {
    u32 size = 1;
    while (size < side) {
        size *= 2;
    }
    column = row = 0;
    // Go down to ever smaller quarters, past those that come before
    while (size > 1) {
        size /= 2;
        for (u32 quarter = 0; quarter < 4; quarter++) {
            const u32 x = column + size * (quarter & 1), y = row + size * (quarter >> 1);
            const u32 columns = side > x ? side - x : 0, rows = side > y ? side - y : 0;
            const u32 strata = (columns < size ? columns : size) * (rows < size ? rows : size);
            if (number < strata || quarter == 3) {
                column = x;
                row = y;
                break;
            }
            number -= strata;
        }
    }
}

// The light that falls on the surface. `cos` and `sin`: those of the azimuth by which it is turned. The axes of vertical rays do not turn
// with the azimuth, so the light does.
template <int N>
DEVICE Light<N> incident_light(const Job &job, double cos, double sin) {
    Light<N> light = {};
    if (job.polarisation == MUELLER) {
        // The identity
        for (int k = 4; k < N; k += 5) {
            light.numbers[k] = 1.0;
        }
    } else {
        for (int k = 0; k < 3; k++) {
            light.numbers[k] = job.stokes[k];
        }
        if (N > 3) {
            light.numbers[3] = 1.0;
        }
    }
    const bool is_vertical = job.wi[0] == 0.0 && job.wi[1] == 0.0;
    if (job.turns && is_vertical && !(cos == 1.0 && sin == 0.0)) {
        Turn turn = axes_turned(-1.0, cos, sin);
        turn.sin = -turn.sin;
        turn_light(job, light, turn);
    }
    return light;
}

// Begins path number `number` of the call, batch after batch of each stratum: at the highest point, or over the place where it meets the
// surface.
template <int N>
DEVICE PolarisedSegment<N> start(const Job &job, u64 number, Path &path) {
    const Surface &s = *job.surface;
    const u32 stratum_number = job.first_stratum + (u32)(number / job.batches);
    path.batch = (u32)(number % job.batches);
    path.ray = path.batch << 20 | stratum_number;
    u32 column, row;
    stratum(job.strata, stratum_number, column, row);
    const double width = 1.0 / job.strata;
    const Pair along = random_pair(job, path.ray, 0, 0, USE_START, 0);
    const double u = (column + along.first) * width, v = (row + along.second) * width;
    // Turn the light by an azimuth of the path; light that leaves is turned back
    Vec3 k = {-job.wi[0], -job.wi[1], -job.wi[2]};
    path.cos = 1.0;
    path.sin = 0.0;
    if (job.turns) {
        double sin, cos;
        sin_cos_of_turn(random_pair(job, path.ray, 0, 0, USE_START, 1).first, sin, cos);
        k = turned(k, cos, sin);
        path.cos = cos;
        path.sin = -sin;
    }
    const double x = job.corner[0] + u * job.size[0], y = job.corner[1] + v * job.size[1];
    Vec3 o = {x, y, 0.0};
    u32 images = 0;
    if (!job.on_surface) {
        o = {x - job.to_mean_plane * k.x, y - job.to_mean_plane * k.y * s.aspect, job.start_z};
    } else if (s.border == MIRRORED) {
        images = (x >= s.extent[0] ? 1 : 0) | (y >= s.extent[1] ? 2 : 0);
        o.x = images & 1 ? 2.0 * s.extent[0] - x : x;
        o.y = images & 2 ? 2.0 * s.extent[1] - y : y;
    }
    return {{o, mirrored(k, images), job.incident, 1.0, 0, 0, images}, incident_light<N>(job, path.cos, -path.sin)};
}

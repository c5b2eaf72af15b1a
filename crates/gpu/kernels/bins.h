// Bins: finds the ring, the sector and the half of the in-plane slice of a direction, by its angles, and adds light that leaves.
//
// The angles define the bins: see `HemisphereGrid` and `InPlaneSlice` of the crate `asperity-tally`.
#pragma once

#include "elementary.h"
#include "sums.h"
#include "vectors.h"

// Longest event path, and highest order of scattering, with an entry of its own; orders that share rings.
#define MAX_LISTED_PATH 6
#define PATH_ENTRIES ((1 << (MAX_LISTED_PATH + 1)) - 1)
#define MAX_LISTED_ORDER 64
#define GROUPS 5
// Most measures of polarised light: the elements of a Mueller matrix.
#define MAX_MEASURES 16

// Light that leaves: side 0 is reflected, 1 transmitted. Masked light would leave if nothing were in its way.
struct Exit {
    Vec3 wo;
    double flux;
    u32 side, order, events, batch;
    bool is_masked;
    // Measures of polarised light, divided by the flux; null without any.
    const double *measures;
};

// Whole part of x >= 0, where anything within 1e-9 below a whole number counts as that number.
DEVICE u32 snapped_floor(double x) { return (u32)(x + 1e-9); }

// Number of starts that do not exceed an angle.
DEVICE u32 starts_up_to(const double *starts, u32 count, double angle) {
    u32 low = 0;
    while (count > 0) {
        const u32 half = count / 2;
        if (starts[low + half] <= angle) {
            low += half + 1;
            count -= half + 1;
        } else {
            count = half;
        }
    }
    return low;
}

DEVICE u32 ring_of(const Job &job, const Exit &exit) {
    const double theta = polar_angle(exit.wo.x, exit.wo.y, exit.wo.z);
    const u32 last = job.n_theta - 1;
    if (job.ring_starts) {
        return starts_up_to(job.ring_starts + exit.side * last, last, theta);
    }
    const double fraction = (theta - HALF_PI * exit.side) / HALF_PI;
    const u32 ring = snapped_floor(greatest(fraction, 0.0) * job.n_theta);
    return ring < last ? ring : last;
}

DEVICE u32 sector_of(const Job &job, const Exit &exit, double phi) {
    if (job.sector_starts) {
        const double *starts = job.sector_starts + exit.side * job.n_phi;
        return starts_up_to(starts, job.n_phi, within_turn(phi - job.first_edge[exit.side])) % job.n_phi;
    }
    return snapped_floor(phi / TAU * job.n_phi) % job.n_phi;
}

// 1 in the forward half of the in-plane slice, -1 in the backward half, 0 in neither.
DEVICE int half_of_slice(const Job &job, const Exit &exit, double phi) {
    const bool is_vertical = exit.wo.x == 0.0 && exit.wo.y == 0.0;
    const double relative = within_turn((is_vertical ? job.forward : phi) - job.forward);
    const bool is_backward = 0.5 * PI <= relative && relative < 1.5 * PI;
    const double off_plane = is_backward ? fabs(relative - PI) : least(relative, TAU - relative);
    return off_plane <= job.half_width ? (is_backward ? -1 : 1) : 0;
}

// The factor with which light counts under the control variate that leaves through a ring, or would.
DEVICE double weight_of(const Job &job, const Exit &exit, u32 ring) {
    if (!job.fractions) {
        return 1.0;
    }
    const double fraction = job.fractions[exit.side * job.n_theta + ring];
    if (exit.is_masked) {
        const bool is_away = exit.side == 0 ? exit.wo.z > 0.0 : exit.wo.z < 0.0;
        return is_away ? -fraction : 0.0;
    }
    return exit.order == 1 ? 1.0 - fraction : 1.0;
}

// Adds the measures of light that leaves to those of a flux entry, by its position among those that have measures.
DEVICE void add_measures(const Job &job, const Exit &exit, u32 position) {
    const u32 count = exit.measures ? (job.polarisation == MUELLER ? MAX_MEASURES : 1) : 0;
    for (u32 k = 0; k < count; k++) {
        add_flux(job, job.measures + position * count + k, exit.batch, exit.measures[k] * exit.flux);
    }
}

// Adds light that leaves to all its entries, or to the flux that is not recorded.
DEVICE_CALL void add_exit(const Job &job, const Exit &exit) {
    const u32 side = exit.side, order = exit.order, batch = exit.batch;
    const u32 ring = ring_of(job, exit);
    const double flux = weight_of(job, exit, ring) * exit.flux;
    // Where the control variate cancels all of it, no ray of the bin is left either. It has no part in measures
    if (flux == 0.0 && !exit.measures) {
        return;
    }
    if (!job.records[side]) {
        add_flux(job, job.truncated, batch, flux);
        add_flux(job, job.not_recorded, batch, flux);
        return;
    }
    const u32 before = order > 1 ? order - 1 : 0;
    const bool is_listed = order >= 1 && order <= MAX_LISTED_PATH;
    const u32 path = is_listed ? (1u << order) - 2 + exit.events : PATH_ENTRIES - 1;
    const u32 group = side * GROUPS + (before < 3 ? before : 3);
    add_flux(job, job.orders + side * MAX_LISTED_ORDER + (before < MAX_LISTED_ORDER ? before : MAX_LISTED_ORDER - 1), batch, flux);
    add_flux(job, job.paths + side * PATH_ENTRIES + path, batch, flux);
    const u32 ring_of_group = group * job.n_theta + ring;
    add_flux(job, job.rings + ring_of_group, batch, flux);
    add_measures(job, exit, group);
    add_measures(job, exit, 2 * GROUPS + ring_of_group);
    const double phi = job.has_azimuths ? azimuth(exit.wo.x, exit.wo.y) : 0.0;
    const u32 sector = job.has_azimuths ? sector_of(job, exit, phi) : 0;
    const u32 bins_of_both = 2 * job.n_theta * job.n_phi;
    const u32 bin_of_all = (side * job.n_theta + ring) * job.n_phi + sector;
    const u32 bin = (order > 1 ? bins_of_both : 0) + bin_of_all;
    add_flux(job, job.hits + bin, batch, flux == 0.0 ? 0.0 : 1.0);
    if (!job.has_azimuths) {
        return;
    }
    add_flux(job, job.bins + bin, batch, flux);
    add_measures(job, exit, 2 * GROUPS + job.hits - job.rings + bin_of_all);
    const int half = half_of_slice(job, exit, phi);
    if (half != 0) {
        const u32 n = job.n_theta, from_normal = side == 0 ? ring : n - 1 - ring;
        const u32 number = group * 2 * n + (half > 0 ? n + from_normal : n - 1 - from_normal);
        add_flux(job, job.in_plane + number, batch, flux);
        add_measures(job, exit, 2 * GROUPS + job.in_plane - job.rings + number);
    }
}

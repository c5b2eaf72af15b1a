// Exits: light that leaves, and, for the control variate, light that is shadowed or masked.
#pragma once

#include "apertures.h"
#include "bins.h"
#include "scatter.h"

DEVICE u32 side_of(const Job &job, const Segment &segment) { return segment.q == job.incident ? 0 : 1; }

// The exit of a segment that leaves, with +z on the side of the light and its azimuth turned back.
DEVICE Exit exit_of(const Job &job, const Path &path, const Segment &segment) {
    Vec3 wo = mirrored(segment.k, segment.mirrored);
    wo.z *= job.incident;
    wo = job.turns ? turned(wo, path.cos, path.sin) : wo;
    return {wo, segment.flux, side_of(job, segment), segment.order, segment.events, path.batch, false, nullptr};
}

// Measures of light that leaves along `wo`, divided by its flux: the part of it that averaging misses, or the elements of its Mueller matrix
// column by column, in axes that follow the azimuth of the light that has fallen on the surface.
template <int N>
DEVICE void measure(const Job &job, const Path &path, Light<N> light, Vec3 wo, double (&measures)[MAX_MEASURES]) {
    if (job.polarisation == BOTH) {
        measures[0] = 1.0 - light.numbers[3];
        return;
    }
    if (wo.x == 0.0 && wo.y == 0.0 && !(path.cos == 1.0 && path.sin == 0.0)) {
        turn_light(job, light, axes_turned(wo.z, path.cos, -path.sin));
    }
    measures[0] = 1.0;
    for (int k = 0; k < N; k++) {
        measures[k + 1] = light.numbers[k];
    }
}

// Tallies a segment that leaves.
template <int N>
DEVICE void leave(const Job &job, const Path &path, const PolarisedSegment<N> &segment) {
    Exit exit = exit_of(job, path, segment);
    double measures[MAX_MEASURES];
    if (N > 3) {
        measure(job, path, segment.light, exit.wo, measures);
        exit.measures = measures;
    }
    add_to_apertures(job, exit);
    add_exit(job, exit);
}

// Tallies that a segment would have left if nothing were in its way, under a control variate.
DEVICE_CALL void tally_masked(const Job &job, const Path &path, const Segment &segment) {
    if (job.fractions && segment.order == 1) {
        Exit exit = exit_of(job, path, segment);
        exit.is_masked = true;
        add_exit(job, exit);
    }
}

// Tallies flux that ends on a side that is not recorded.
DEVICE void end_unrecorded(const Job &job, const Path &path, const Segment &segment) {
    add_flux(job, job.truncated, path.batch, segment.flux);
    add_flux(job, job.not_recorded, path.batch, segment.flux);
    tally_masked(job, path, segment);
}

// Tallies that a facet is shadowed: light `at` it, which has not interacted yet, would be scattered there. `m`: its normal, upwards.
DEVICE_CALL void tally_shadowed(const Job &job, const Path &path, const Segment &at, Vec3 m) {
    if (!job.fractions) {
        return;
    }
    const Arrival facet = arrival_of(job, at.k, m, at.q, false);
    Segment branch = at;
    branch.order = 1;
    for (int is_transmitted = 0; is_transmitted < 2; is_transmitted++) {
        const double fraction = is_transmitted ? facet.transmitted.m00 : facet.reflected.m00;
        if (fraction > 0.0) {
            branch.k = is_transmitted ? refract(facet.wi, facet.m, facet.eta, facet.cos_theta_t) : reflected_along(job, facet, {0.0, 0.0});
            branch.q = is_transmitted ? -at.q : at.q;
            branch.events = is_transmitted;
            branch.flux = at.flux * fraction;
            tally_masked(job, path, branch);
        }
    }
    if (job.material != DIELECTRIC) {
        const double absorbed = at.flux * (1.0 - facet.reflected.m00 - facet.transmitted.m00);
        add_flux(job, job.absorbed, path.batch, -job.absorbed_fraction * absorbed);
    }
}

// Apertures: adds light that leaves to the narrow windows that it falls into, by the part of it that each takes.
#pragma once

#include "bins.h"

DEVICE double along_axis(Vec3 wo, const double axis[3]) { return wo.x * axis[0] + wo.y * axis[1] + wo.z * axis[2]; }

// Part of an interval of width `widths[0]` that lies in one of width `widths[1]`, whose middles are `offset` apart.
DEVICE double part_taken(double offset, const double widths[2]) {
    const double overlap = least(0.5 * (widths[0] + widths[1]) - fabs(offset), widths[1]);
    return unit_interval(overlap / widths[0]);
}

DEVICE void add_to_apertures(const Job &job, const Exit &exit) {
    for (u32 number = 0; number < job.aperture_count; number++) {
        const Aperture &aperture = job.apertures[number];
        if (!(along_axis(exit.wo, aperture.centre) >= aperture.cos_reach) || aperture.side != exit.side) {
            continue;
        }
        double weight = 1.0;
        if (aperture.is_receptor != 0.0) {
            const double polar = arc_tangent(along_axis(exit.wo, job.along), exit.wo.z);
            const double sine = along_axis(exit.wo, job.across);
            const double aside = arc_sine(greatest(least(sine, 1.0), -1.0));
            weight = part_taken(polar - aperture.theta, aperture.in_plane) * part_taken(aside, aperture.across);
        }
        add_flux(job, job.of_apertures + number, exit.batch, weight * exit.flux);
    }
}

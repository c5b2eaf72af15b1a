// Path: follows one path from its start to the end of all its branches.
#pragma once

#include "apertures.h"
#include "bins.h"
#include "scatter.h"
#include "traversal.h"

// Branches that wait while others are followed. The weaker branch is followed first, so that those that wait at one time halve in flux
// down to the threshold of roulette, and seldom more wait. A branch without room is counted, and the host traces the call.
#define MAX_WAITING 32

// The ray of a segment in tile coordinates.
DEVICE Ray ray_of(const Surface &s, const Segment &segment) {
    return {segment.o, {segment.k.x, segment.k.y * s.aspect, segment.k.z}, segment.q};
}

DEVICE u32 side_of(const Job &job, const Segment &segment) { return segment.q == job.incident ? 0 : 1; }

// The exit of a segment that leaves, with +z on the side of the light and its azimuth turned back.
DEVICE Exit exit_of(const Job &job, const Path &path, const Segment &segment) {
    Vec3 wo = {segment.k.x, segment.k.y, segment.k.z * job.incident};
    wo = job.turns ? turned(wo, path.cos, path.sin) : wo;
    return {wo, segment.flux, side_of(job, segment), segment.order, segment.events, path.batch};
}

// Begins a segment that leaves a facet: OPEN if it is to be searched.
DEVICE Outcome leave_facet(const Job &job, Segment &segment, Work &work) {
    const Surface &s = *job.surface;
    Ray ray = ray_of(s, segment);
    const Outcome outcome = begin(s, ray, work);
    segment.o = ray.o;
    return outcome;
}

template <class Cells>
DEVICE void follow(const Job &job, u64 number, Work &work) {
    const Surface &s = *job.surface;
    Segment waiting[MAX_WAITING];
    int count = 0;
    Path path;
    Segment segment = start(job, number, path);
    Outcome outcome = OPEN;
    for (;;) {
        // Find what the segment meets
        Vec3 p, m;
        if (outcome == OPEN) {
            outcome = search<Cells>(s, ray_of(s, segment), p, m, work);
        }
        if (outcome == ESCAPED) {
            const Exit exit = exit_of(job, path, segment);
            add_to_apertures(job, exit);
            add_exit(job, exit);
        } else if (outcome == LOST) {
            add_flux(job, job.lost, path.batch, segment.flux);
        } else if (segment.order >= job.max_order) {
            add_flux(job, job.truncated, path.batch, segment.flux);
        } else {
            // Scatter there, and keep the branches that live
            segment.o = p;
            Segment branches[2];
            scatter(job, path, segment, m, branches[0], branches[1]);
            const bool reflection_is_weaker = branches[0].flux < branches[1].flux;
            for (int k = 0; k < 2; k++) {
                const Segment &branch = branches[reflection_is_weaker ? 1 - k : k];
                if (!(branch.flux > 0.0)) {
                    continue;
                }
                if (count == MAX_WAITING) {
                    work.add(WITHOUT_ROOM);
                    continue;
                }
                waiting[count++] = branch;
            }
        }
        // Take the next branch; one that can only end on a side that is not recorded is not followed
        for (;;) {
            if (count == 0) {
                return;
            }
            segment = waiting[--count];
            if (segment.order < job.max_order || job.records[side_of(job, segment)]) {
                break;
            }
            add_flux(job, job.truncated, path.batch, segment.flux);
            add_flux(job, job.not_recorded, path.batch, segment.flux);
            work.add(NOT_RECORDED);
        }
        outcome = leave_facet(job, segment, work);
    }
}

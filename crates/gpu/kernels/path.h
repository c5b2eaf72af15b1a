// Path: follows one path from its start to the end of all its branches.
#pragma once

#include "exits.h"
#include "scatter.h"
#include "traversal.h"

// Branches that wait while others are followed. The weaker branch is followed first, so that those that wait at one time halve in flux
// down to the threshold of roulette, and seldom more wait. A branch without room is counted, and the host traces the call.
#define MAX_WAITING 32

// The ray of a segment in tile coordinates.
DEVICE Ray ray_of(const Surface &s, const Segment &segment) {
    return {segment.o, {segment.k.x, segment.k.y * s.aspect, segment.k.z}, segment.q, 0};
}

// Finds what a segment meets that begins anywhere.
template <class Cells>
DEVICE_CALL Outcome meet(const Surface &s, const Segment &segment, Meeting &at_facet, Work &work) {
    Ray ray = ray_of(s, segment);
    const Outcome outcome = begin<Cells>(s, ray, work);
    return outcome == OPEN ? search<Cells>(s, ray, at_facet, work) : outcome;
}

// Moves a segment to the facet that it meets, in the orientation of the tile there.
DEVICE void move_to(const Meeting &at_facet, Segment &segment) {
    segment.o = at_facet.p;
    segment.k = mirrored(segment.k, at_facet.flips);
    segment.mirrored ^= at_facet.flips;
}

// Starts a path at the point of the surface below or above it, if the light reaches that: MET, or ENDED.
template <class Cells>
DEVICE Outcome start_on_surface(const Job &job, const Path &path, Segment &segment, Meeting &at_facet, Work &work) {
    const Surface &s = *job.surface;
    at_facet.p = segment.o;
    at_facet.facet = Cells::facet_over(s, segment.o.x, segment.o.y);
    at_facet.flips = 0;
    at_facet.is_far = false;
    at_facet.template arrive_again<Cells>(s);
    // The flux that falls there. Source: Xu and Sun 2008, the weight of Eq. 26
    const Vec3 m = job.incident * at_facet.m;
    const double facing = dot(-segment.k, m);
    if (!(facing > 0.0)) {
        return ENDED;
    }
    segment.flux = facing / (m.z * job.wi[2]);
    segment.o = at_facet.p;
    Segment towards_light = segment;
    towards_light.k = -segment.k;
    Meeting other;
    const Outcome outcome = meet<Cells>(s, towards_light, other, work);
    if (outcome == ESCAPED) {
        at_facet.template arrive_again<Cells>(s);
        return MET;
    }
    tally_shadowed(job, path, segment, at_facet.m);
    if (outcome == LEFT || outcome == LOST) {
        add_flux(job, job.lost, path.batch, segment.flux);
    }
    return ENDED;
}

// Follows the straight line of light behind the first facet that it has met, and tallies the facets there that it would light.
template <class Cells>
DEVICE void trace_shadows(const Job &job, const Path &path, Segment light, Work &work) {
    const Surface &s = *job.surface;
    const double u = random_pair(job, path.ray, light.order, light.events, USE_SHADOW, 0).first;
    if (u >= job.shadow_probability) {
        return;
    }
    light.flux /= job.shadow_probability;
    for (;;) {
        light.q = -light.q;
        Meeting at_facet;
        if (meet<Cells>(s, light, at_facet, work) != MET) {
            return;
        }
        move_to(at_facet, light);
        if (light.q == job.incident) {
            tally_shadowed(job, path, light, at_facet.m);
        }
    }
}

// `N`: numbers of polarisation that the path carries.
template <class Cells, int N>
DEVICE void follow(const Job &job, u64 number, Work &work) {
    const Surface &s = *job.surface;
    PolarisedSegment<N> waiting[MAX_WAITING];
    int count = 0;
    Path path;
    PolarisedSegment<N> segment = start<N>(job, number, path);
    Meeting at_facet;
    Outcome outcome;
    if (job.on_surface) {
        outcome = start_on_surface<Cells>(job, path, segment, at_facet, work);
    } else {
        outcome = meet<Cells>(s, segment, at_facet, work);
    }
    for (;;) {
        // Tally what has ended
        if (outcome == ESCAPED) {
            leave(job, path, segment);
        } else {
            tally_masked(job, path, segment);
        }
        if (outcome == LOST) {
            add_flux(job, job.lost, path.batch, segment.flux);
        } else if (outcome == LEFT) {
            add_flux(job, job.truncated, path.batch, segment.flux);
            add_flux(job, job.left_patch, path.batch, segment.flux);
        } else if (outcome == MET && segment.order >= job.max_order) {
            add_flux(job, job.truncated, path.batch, segment.flux);
        } else if (outcome == MET) {
            // Scatter what has met a facet, and keep the branches that live
            if (at_facet.is_far) {
                at_facet.template arrive_again<Cells>(s);
            }
            move_to(at_facet, segment);
            if (job.fractions && !job.on_surface && segment.order == 0) {
                trace_shadows<Cells>(job, path, segment, work);
            }
            PolarisedSegment<N> branches[2];
            scatter(job, path, segment, at_facet.m, branches[0], branches[1]);
            const bool reflection_is_weaker = branches[0].flux < branches[1].flux;
            for (int k = 0; k < 2; k++) {
                const PolarisedSegment<N> &branch = branches[reflection_is_weaker ? 1 - k : k];
                if (!(branch.flux > 0.0)) {
                    continue;
                }
                if (count == MAX_WAITING) {
                    work.add(LEFT_TO_CPU);
                    continue;
                }
                waiting[count++] = branch;
            }
        }
        // Follow the next branch, unless it can only end on a side that is not recorded
        for (;;) {
            if (count == 0) {
                return;
            }
            segment = waiting[--count];
            if (segment.order < job.max_order || job.records[side_of(job, segment)]) {
                break;
            }
            end_unrecorded(job, path, segment);
            work.add(NOT_RECORDED);
        }
        outcome = meet<Cells>(s, segment, at_facet, work);
    }
}

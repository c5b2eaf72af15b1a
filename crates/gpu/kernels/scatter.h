// Scatter: reflects and transmits light at a facet, picks or splits branches, and plays Russian roulette.
#pragma once

#include "fresnel.h"
#include "random.h"
#include "starts.h"
#include "sums.h"

// Russian roulette over a branch: what is left of its flux, by the random number u. The difference is tallied as truncated.
DEVICE double roulette(const Job &job, const Path &path, double flux, double u) {
    if (!(flux > 0.0 && flux < job.roulette)) {
        return flux;
    }
    const double kept = u * job.roulette < flux ? job.roulette : 0.0;
    add_flux(job, job.truncated, path.batch, flux - kept);
    return kept;
}

// The transmitted branch of a segment that has arrived.
DEVICE Segment transmitted_branch(const Segment &at, Vec3 k, double flux) {
    const u32 bit = at.order < 32 ? 1u << at.order : 0;
    return {at.o, k, -at.q, flux, at.order + 1, at.events | bit};
}

// Scatters light that has arrived at a facet of the unit normal `m`, upwards. A branch that ends has no flux.
DEVICE void scatter(const Job &job, const Path &path, const Segment &at, Vec3 m, Segment &reflected, Segment &transmitted) {
    m = at.q * m;
    const Vec3 wi = -at.k;
    const double cos_theta_i = unit_interval(dot(wi, m));
    Fresnel fresnel = {1.0, 0.0, 0.0};
    double eta = 1.0;
    if (job.material == DIELECTRIC) {
        eta = at.q == job.incident ? job.eta : 1.0 / job.eta;
        fresnel = dielectric(cos_theta_i, eta);
    } else {
        if (job.material == CONDUCTOR) {
            fresnel.reflected = conductor(cos_theta_i, job.eta, job.kappa);
        }
        add_flux(job, job.absorbed, path.batch, at.flux * (1.0 - fresnel.reflected - fresnel.transmitted));
    }
    const bool picks = job.picks && job.material == DIELECTRIC;
    double flux_reflected = fresnel.reflected * at.flux, flux_transmitted = fresnel.transmitted * at.flux;
    const double weak = job.roulette;
    const bool is_decided = !picks && (flux_reflected >= weak || flux_reflected == 0.0) && (flux_transmitted >= weak || flux_transmitted == 0.0);
    if (!is_decided) {
        const Pair numbers = random_pair(job, path.ray, at.order, at.events, USE_INTERACTION, 0);
        if (picks) {
            const double flux = roulette(job, path, at.flux, numbers.second);
            const bool is_reflected = numbers.first < fresnel.reflected;
            flux_reflected = is_reflected ? flux : 0.0;
            flux_transmitted = is_reflected ? 0.0 : flux;
        } else {
            flux_transmitted = roulette(job, path, flux_transmitted, numbers.first);
            flux_reflected = roulette(job, path, flux_reflected, numbers.second);
        }
    }
    reflected = {at.o, reflect(wi, m), at.q, flux_reflected, at.order + 1, at.events};
    transmitted.flux = 0.0;
    if (flux_transmitted > 0.0) {
        transmitted = transmitted_branch(at, refract(wi, m, eta, fresnel.cos_theta_t), flux_transmitted);
    }
}

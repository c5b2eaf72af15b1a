// Scatter: reflects and transmits light at a facet, picks or splits branches, and plays Russian roulette.
#pragma once

#include "fresnel.h"
#include "random.h"
#include "starts.h"
#include "sums.h"

// A facet and the light that arrives at it.
struct Arrival {
    // Towards the light, unit normal on its side, and index of the other medium relative to its own.
    Vec3 wi, m;
    double eta;
    double cos_theta_t;
    FacetMueller reflected, transmitted;
};

// The facet of the unit normal `m`, upwards, and light along `k` in the half space of the sign `q`.
DEVICE_CALL Arrival arrival_of(const Job &job, Vec3 k, Vec3 m, double q, bool is_polarised) {
    Arrival at = {-k, q * m, 1.0, 0.0, {1.0, 0.0, -1.0, 0.0}, {0.0, 0.0, 0.0, 0.0}};
    const double cos_theta_i = unit_interval(dot(at.wi, at.m));
    if (job.material == DIELECTRIC) {
        at.eta = q == job.incident ? job.eta : 1.0 / job.eta;
        const Fresnel fresnel = dielectric(cos_theta_i, at.eta);
        at.cos_theta_t = fresnel.cos_theta_t;
        at.reflected.m00 = fresnel.reflected;
        at.transmitted.m00 = fresnel.transmitted;
        if (is_polarised) {
            polarise_dielectric(cos_theta_i, at.eta, at.reflected, at.transmitted);
        }
    } else if (job.material == CONDUCTOR) {
        at.reflected = conductor(cos_theta_i, job.eta, job.kappa);
    } else if (job.material == LAMBERTIAN) {
        at.reflected.m00 = job.reflectance;
    }
    return at;
}

// A direction in the cosine distribution about a unit normal, from two random numbers.
DEVICE Vec3 diffuse_direction(Vec3 m, const Pair &numbers) {
    const double mu = sqrt(1.0 - numbers.first);
    // Two unit vectors across the normal. Source: Duff et al. 2017, as `around` of `asperity_optics`
    const double sign = bits_of(m.z) >> 63 ? -1.0 : 1.0;
    const double a = -1.0 / (sign + m.z);
    const double b = m.x * m.y * a;
    const Vec3 s = {1.0 + sign * m.x * m.x * a, sign * b, -sign * m.x}, t = {b, sign + m.y * m.y * a, -m.y};
    double sin_phi, cos_phi;
    sin_cos_of_turn(numbers.second, sin_phi, cos_phi);
    const double sin_theta = sqrt(greatest((1.0 - mu) * (1.0 + mu), 0.0));
    const Vec3 w = sin_theta * (cos_phi * s + sin_phi * t) + mu * m;
    return (1.5 - 0.5 * dot(w, w)) * w;
}

// The direction of reflected light. `numbers`: random numbers of diffuse facets.
DEVICE Vec3 reflected_along(const Job &job, const Arrival &at, const Pair &numbers) {
    return job.material == LAMBERTIAN ? diffuse_direction(at.m, numbers) : reflect(at.wi, at.m);
}

// Russian roulette over a branch: what is left of its flux, by the random number u. The difference is tallied as truncated.
DEVICE double roulette(const Job &job, const Path &path, double flux, double u) {
    if (!(flux > 0.0 && flux < job.roulette)) {
        return flux;
    }
    const double kept = u * job.roulette < flux ? job.roulette : 0.0;
    add_flux(job, job.truncated, path.batch, flux - kept);
    return kept;
}

// Scatters light that has arrived at a facet of the unit normal `m`, upwards. A branch that ends has no flux.
template <int N>
DEVICE void scatter(const Job &job, const Path &path, const PolarisedSegment<N> &at, Vec3 m, PolarisedSegment<N> &reflected,
                    PolarisedSegment<N> &transmitted) {
    const Arrival facet = arrival_of(job, at.k, m, at.q, job.polarisation != AVERAGED);
    const u32 bit = at.order < 32 ? 1u << at.order : 0;
    Pair diffuse = {0.0, 0.0};
    if (job.material == LAMBERTIAN) {
        diffuse = random_pair(job, path.ray, at.order, at.events, USE_DIFFUSE, 0);
    }
    reflected = at;
    reflected.k = reflected_along(job, facet, diffuse);
    reflected.flux = facet.reflected.m00;
    reflected.order++;
    transmitted = reflected;
    transmitted.q = -at.q;
    transmitted.flux = facet.transmitted.m00;
    transmitted.events |= bit;
    if (job.material == DIELECTRIC) {
        transmitted.k = refract(facet.wi, facet.m, facet.eta, facet.cos_theta_t);
    }
    if (job.material == LAMBERTIAN) {
        reflected.light.depolarise();
    } else if (job.polarisation != AVERAGED) {
        const Vec3 axis = incidence_axis(at.k, facet.m);
        // Images that are mirrored along both axes are turned, not mirrored
        const double handedness = at.mirrored == 1 || at.mirrored == 2 ? -job.incident : job.incident;
        reflected.flux = pass(job, reflected.light, at.k, reflected.k, axis, facet.reflected, handedness);
        transmitted.flux = pass(job, transmitted.light, at.k, transmitted.k, axis, facet.transmitted, handedness);
    }
    if (job.material != DIELECTRIC) {
        const double absorbed = at.flux * (1.0 - reflected.flux - transmitted.flux);
        add_flux(job, job.absorbed, path.batch, at.order == 0 ? (1.0 - job.absorbed_fraction) * absorbed : absorbed);
    }
    // Under a control variate first branches cancel exactly, and roulette spares them
    const bool is_spared = job.fractions && at.order == 0;
    if (job.picks && job.material == DIELECTRIC) {
        const Pair numbers = random_pair(job, path.ray, at.order, at.events, USE_INTERACTION, 0);
        const bool is_reflected = numbers.first < reflected.flux;
        const double flux = is_spared ? at.flux : roulette(job, path, at.flux, numbers.second);
        reflected.flux = is_reflected ? flux : 0.0;
        transmitted.flux = is_reflected ? 0.0 : flux;
        return;
    }
    reflected.flux *= at.flux;
    transmitted.flux *= at.flux;
    const bool is_weak = (reflected.flux > 0.0 && reflected.flux < job.roulette) || (transmitted.flux > 0.0 && transmitted.flux < job.roulette);
    if (is_weak && !is_spared) {
        const Pair numbers = random_pair(job, path.ray, at.order, at.events, USE_INTERACTION, 0);
        transmitted.flux = roulette(job, path, transmitted.flux, numbers.first);
        reflected.flux = roulette(job, path, reflected.flux, numbers.second);
    }
}

// Fresnel: fractions that an interface reflects and transmits of unpolarised light, and the directions.
//
// Source: Born and Wolf, Principles of Optics, Secs. 1.5 and 14.2, rearranged as in `asperity_optics`.
#pragma once

#include "vectors.h"

struct Fresnel {
    double reflected, transmitted, cos_theta_t;
};

// Dielectric interface of relative index eta.
DEVICE Fresnel dielectric(double cos_theta_i, double eta) {
    const double delta = (eta - 1.0) * (eta + 1.0);
    if (delta == 0.0) {
        return {0.0, 1.0, cos_theta_i};
    }
    // g = eta cos_theta_t by Snell's law; total reflection leaves no real root
    const double g_squared = delta + cos_theta_i * cos_theta_i;
    const bool is_total = g_squared <= 0.0;
    const double g = sqrt(is_total ? 0.0 : g_squared);
    const double cos_theta_t = g / eta;
    const double capped = cos_theta_t > 1.0 ? 1.0 : cos_theta_t;
    if (is_total || cos_theta_i <= 0.0) {
        return {1.0, 0.0, capped};
    }
    const double eta2 = eta * eta;
    const double s_sum = cos_theta_i + g;
    const double p_sum = eta2 * cos_theta_i + g;
    const double s_squared = s_sum * s_sum, p_squared = p_sum * p_sum;
    const double r_s = -delta / s_squared;
    const double r_p = delta * ((eta2 + 1.0) * cos_theta_i * cos_theta_i - 1.0) / p_squared;
    const double reflected = 0.5 * (r_s * r_s + r_p * r_p);
    // The smaller fraction keeps its relative accuracy, and both add to one
    const double t_s = 4.0 * cos_theta_i * g / s_squared;
    const double t_p = 4.0 * eta2 * cos_theta_i * g / p_squared;
    const double transmitted = 0.5 * (t_s + t_p);
    if (reflected < 0.5) {
        return {reflected, 1.0 - reflected, capped};
    }
    return {1.0 - transmitted, transmitted, capped};
}

// Fraction that an absorbing conductor of relative index eta + i kappa reflects.
DEVICE double conductor(double cos_theta_i, double eta, double kappa) {
    // g, the root of g^2 = m^2 - 1 + c^2 in the first quadrant
    const double re = (eta - 1.0) * (eta + 1.0) - kappa * kappa + cos_theta_i * cos_theta_i;
    const double im = 2.0 * eta * kappa;
    const double larger = sqrt(0.5 * (sqrt(re * re + im * im) + fabs(re)));
    const double smaller = 0.5 * im / (larger > 0.0 ? larger : 1.0);
    const double g_re = re < 0.0 ? smaller : larger, g_im = re < 0.0 ? larger : smaller;
    // Reflectance for s light, |m^2 - 1|^2 / |c + g|^4
    const double kappa2 = kappa * kappa;
    const double delta_squared = ((eta - 1.0) * (eta - 1.0) + kappa2) * ((eta + 1.0) * (eta + 1.0) + kappa2);
    const double s_sum = cos_theta_i + g_re;
    const double s_squared = s_sum * s_sum + g_im * g_im;
    const double reflectance_s = delta_squared == 0.0 ? 0.0 : delta_squared / (s_squared * s_squared);
    // Mean of s and p, and half their difference, by the ratio (sin2 - c g) / (sin2 + c g)
    const double sin2 = (1.0 - cos_theta_i) * (1.0 + cos_theta_i);
    const double cg_re = cos_theta_i * g_re, cg_im = cos_theta_i * g_im;
    const double sum = sin2 + cg_re;
    const double scale = reflectance_s / (sum * sum + cg_im * cg_im);
    const double mean = scale * (sin2 * sin2 + (cg_re * cg_re + cg_im * cg_im));
    const double difference = scale * (2.0 * sin2 * cg_re);
    const double absorbed = 4.0 * cos_theta_i * g_re / s_squared + difference;
    return mean < 0.5 ? mean : 1.0 - absorbed;
}

// The mirrored direction 2 (wi . m) m - wi, renormalised.
DEVICE Vec3 reflect(Vec3 wi, Vec3 m) {
    const Vec3 wo = 2.0 * dot(wi, m) * m - wi;
    return (1.5 - 0.5 * dot(wo, wo)) * wo;
}

// The refracted direction (cos_theta_i / eta - cos_theta_t) m - wi / eta, renormalised.
DEVICE Vec3 refract(Vec3 wi, Vec3 m, double eta, double cos_theta_t) {
    if (eta == 1.0) {
        return -wi;
    }
    const double eta_inverse = 1.0 / eta;
    const Vec3 wt = (dot(wi, m) * eta_inverse - cos_theta_t) * m - eta_inverse * wi;
    return 1.0 / sqrt(dot(wt, wt)) * wt;
}

// Fresnel: fractions that an interface reflects and transmits, their matrices for polarised light, and the directions.
//
// Source: Born and Wolf, Principles of Optics, Secs. 1.5 and 14.2, rearranged as in `asperity_optics`.
#pragma once

#include "polarisation.h"

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

// The elements of both matrices of a dielectric interface that are not fractions of unpolarised light.
DEVICE void polarise_dielectric(double cos_theta_i, double eta, FacetMueller &reflected, FacetMueller &transmitted) {
    const double delta = (eta - 1.0) * (eta + 1.0);
    // g is imaginary under total reflection
    const double g_squared = delta + cos_theta_i * cos_theta_i;
    const bool is_total = g_squared <= 0.0, is_matched = delta == 0.0;
    const double root = sqrt(fabs(g_squared));
    const double g_re = is_total ? 0.0 : root, g_im = is_total ? root : 0.0;
    const double s_sum = cos_theta_i + g_re;
    const double s_squared = s_sum * s_sum;
    const double r_s = -delta / s_squared;
    const double reflectance_s = is_matched ? 0.0 : (is_total ? 1.0 : r_s * r_s);
    const FacetMueller of = reflection(reflectance_s, cos_theta_i, g_re, g_im);
    reflected = {reflected.m00, of.m01, of.m22, of.m23};
    // Transmitted light of both polarisations is in phase
    const double t_s = 4.0 * cos_theta_i * g_re / s_squared;
    const double sin2 = (1.0 - cos_theta_i) * (1.0 + cos_theta_i);
    const double product = t_s * eta / (sin2 + cos_theta_i * g_re);
    transmitted = {transmitted.m00, 0.0 - of.m01, is_matched ? 1.0 : (is_total ? 0.0 : product), 0.0};
}

// Reflection by an absorbing conductor of relative index eta + i kappa.
DEVICE FacetMueller conductor(double cos_theta_i, double eta, double kappa) {
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
    FacetMueller reflected = reflection(reflectance_s, cos_theta_i, g_re, g_im);
    // The smaller fraction keeps its relative accuracy
    const double absorbed = 4.0 * cos_theta_i * g_re / s_squared + reflected.m01;
    reflected.m00 = reflected.m00 < 0.5 ? reflected.m00 : 1.0 - absorbed;
    return reflected;
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

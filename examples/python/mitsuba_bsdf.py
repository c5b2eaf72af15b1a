"""BSDF of Mitsuba 3 from a result of `gonio`, without a file between: reflection of one isotropic sample, grey.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import mitsuba_bsdf
    mitsuba_bsdf.register("rough_gold", result)       # of asp.gonio(..., theta=[0, 15, ..., 88], bins="36x72")
    gold = mi.load_dict({"type": "rough_gold"})

Samples have the weight of the directional albedo that was measured, and the density of the measured lobe: their mean is
`result.reflected`. The BRDF is constant in each cell and linear between polar angles of the light. For colour, export to
`rgl-rgb` and load it with Mitsuba's `measured`; for transmission see `examples/mitsuba/asperity_bsdf.py`.

Needs `mitsuba` and `xarray` besides `asperity`.
"""

import os

import drjit as dr
import mitsuba as mi
import numpy as np

import asperity as asp

RAYS = int(os.environ.get("ASPERITY_RAYS", 200_000))

if mi.variant() is None:
    mi.set_variant("scalar_rgb")


def cells_of(result, rows=128):
    """Flux density over the unit square, `[theta_i][row][sector]`, of rows of equal projected solid angle in `sin^2(theta_o)`."""
    edges = result.bins["theta"]
    if edges.ndim != 2 or result.brdf.ndim != 3:
        raise ValueError('needs several polar angles of the light, one setting and common bins, such as bins="36x72"')
    lower, upper = np.sin(np.radians(edges.T)) ** 2
    border = np.linspace(0, 1, rows + 1)
    overlap = np.minimum.outer(border[1:], upper) - np.maximum.outer(border[:-1], lower)
    # A control variate may leave small negative values
    return np.maximum(rows * np.maximum(overlap, 0) @ result.brdf, 0) * np.pi


class RoughSurface(mi.BSDF):
    """Reflection as measured; `wi` in the medium above, nothing below. Mitsuba's `twosided` serves both sides."""

    def __init__(self, props, result):
        mi.BSDF.__init__(self, props)
        density = cells_of(result).astype(np.float32)
        theta = np.radians(result.to_xarray().theta_i.values).tolist()
        self.lobe = mi.MarginalDiscrete2D1(np.ascontiguousarray(density), [theta])
        self.reflected = mi.IrregularContinuousDistribution(theta, np.maximum(result.reflected, 1e-12).tolist())
        self.range = theta[0], theta[-1]
        self.m_components = [mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide]
        self.m_flags = self.m_components[0]

    def incident(self, si):
        """Polar angle of `wi` within those that were measured, and its azimuth."""
        theta = dr.clip(dr.safe_acos(mi.Frame3f.cos_theta(si.wi)), *self.range)
        return theta, dr.atan2(si.wi.y, si.wi.x)

    def sample(self, ctx, si, sample1, sample2, active=True):
        theta, azimuth = self.incident(si)
        position, density = self.lobe.sample(sample2, [theta], active)
        sine, phi = dr.safe_sqrt(position.y), 2 * dr.pi * position.x + azimuth
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = mi.Vector3f(sine * dr.cos(phi), sine * dr.sin(phi), dr.safe_sqrt(1 - position.y))
        bs.pdf = density * bs.wo.z / dr.pi
        bs.eta = 1.0
        bs.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
        active &= (mi.Frame3f.cos_theta(si.wi) > 0) & (bs.pdf > 0)
        return bs, mi.Spectrum(dr.select(active, self.reflected.eval_pdf(theta), 0))

    def eval_pdf(self, ctx, si, wo, active=True):
        theta, azimuth = self.incident(si)
        turn = (dr.atan2(wo.y, wo.x) - azimuth) / (2 * dr.pi)
        position = mi.Point2f(turn - dr.floor(turn), dr.clip(1 - wo.z * wo.z, 0, 1))
        pdf = self.lobe.eval(position, [theta], active) * wo.z / dr.pi
        active &= (mi.Frame3f.cos_theta(si.wi) > 0) & (wo.z > 0)
        value = self.reflected.eval_pdf(theta) * pdf
        return mi.Spectrum(dr.select(active, value, 0)), dr.select(active, pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def to_string(self):
        return "RoughSurface[]"


def register(name, result):
    """Registers the BSDF of a result with the variant of Mitsuba that is set."""
    mi.register_bsdf(name, lambda props: RoughSurface(props, result))


def rendered(name, theta, pixels=8, spp=256):
    """Mean and standard error of a square under an even sky of radiance 1, seen from a polar angle in degrees: its directional albedo."""
    x, z = np.sin(np.radians(theta)), np.cos(np.radians(theta))
    scene = mi.load_dict({
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 2},
        "sky": {"type": "constant"},
        "square": {"type": "rectangle", "bsdf": {"type": name}},
        "camera": {
            "type": "orthographic",
            "to_world": mi.ScalarTransform4f().look_at([5 * x, 0, 5 * z], [0, 0, 0], [0, 1, 0]).scale(0.02),
            "film": {"type": "hdrfilm", "width": pixels, "height": pixels, "rfilter": {"type": "box"}},
        },
    })  # fmt: skip
    image = np.array(mi.render(scene, spp=spp, seed=int(theta)))[..., 0]
    return image.mean(), image.std() / pixels


if __name__ == "__main__":
    light = dict(theta=[0, 15, 30, 45, 60, 75, 85], bins="36x72", rays=RAYS, realisations=8, seed=1)
    result = asp.gonio(smoothness=3, size=128, tau=8, material="gold", wavelength=550, **light)
    register("rough_gold", result)
    rows = []
    for angle, measured, error in zip(light["theta"], result.reflected, result.reflected_se):
        rows.append((angle, measured, error, *rendered("rough_gold", angle)))
        print("{:2} degrees: measured {:.5f} +- {:.5f}, rendered {:.5f} +- {:.5f}".format(*rows[-1]))

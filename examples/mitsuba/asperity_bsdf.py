"""BSDFs for Mitsuba 3: tables of `asperity export --format netcdf`, and the model of Xu and Sun.

    import mitsuba as mi
    mi.set_variant("llvm_ad_rgb")
    import asperity_bsdf      # registers the plugins; after another set_variant, importlib.reload(asperity_bsdf)
    glass = mi.load_dict({"type": "asperity_table", "filename": "glass.nc"})
    model = mi.load_dict({"type": "xu_sun", "s": 3.0, "eta": 1.4})

The interior of an object is below its surface, as in Mitsuba's `dielectric`: light *from above* comes from outside. `eta` is the index of
the interior over that of the exterior. Both plugins have the conventions of `roughdielectric`: `eval` returns the BSDF times the cosine of `wo`, and with
`TransportMode.Radiance` transmission is multiplied by the square of the index on the side of `wi` over that on the side of `wo`, since radiance scales by
the square of the index. They are grey, and take all unpolarised variants.

Needs numpy and scipy.
"""

import warnings

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy.io import netcdf_file

DIMENSIONS = ("from", "theta_i", "phi_i", "side", "theta_o", "phi_o")


class Measurement:
    """The file of an isotropic sample that was lit from both sides.

    `theta_i`: polar angles of the light, radians, ascending. `flux`: fractions of the incident flux, `[from][side][theta_i]`.
    `bsdf`: 1/sr, `[from][side][theta_i][theta_o][phi_o]`, over bins of equal angles; azimuths are relative to that towards the light.
    `eta`: index behind the sample over index above it.
    """

    def __init__(self, filename):
        with netcdf_file(filename, mmap=False) as file:
            variables = {name: one.data for name, one in file.variables.items()}
            attributes = {name: one.decode() for name, one in file._attributes.items()}
            dimensions = file.variables["bsdf"].dimensions

        def require(holds, reason):
            if not holds:
                raise ValueError(f"{filename}: {reason}")

        measured, planned = attributes["completeness"].split()[:3:2]
        require(measured == planned, f"{attributes['completeness']}: give the command of gonio again to resume it")
        require("index_behind" in attributes, "no light leaves behind the sample: Mitsuba has `measured` for reflection (--format rgl)")
        require(dimensions == DIMENSIONS, f"dimensions {dimensions}: must be {DIMENSIONS}, one setting lit by --from both")
        require("bsdf_exact" not in variables, "bins differ between directions: measure with --bins, such as --bins 60x90")
        require(attributes["azimuths"] == "random", "of one azimuth: measure with --light-azimuth random, which takes the mean")
        require(attributes["light"] == "unpolarised", "of polarised light: measure without --stokes")
        require("light_spread" not in variables, "of light over patches: measure without --light-spread")
        require(len(variables["theta_i"]) >= 2, "one polar angle of the light: needs two or more, up to about 88 degrees")
        bsdf = np.maximum(variables["bsdf"], 0)
        require(np.isfinite(bsdf).all(), "a side was not recorded: measure with --side both")
        turn = variables["phi_i"][0] / 360 * bsdf.shape[-1]
        require(bsdf.shape[2] == 1 and turn == round(turn), "one azimuth of the light on an edge of bins: measure with --phi 0")
        turned = np.roll(bsdf, -round(turn), axis=-1)
        if variables["theta_i"][0] > 5 or variables["theta_i"][-1] < 80:
            warnings.warn(f"{filename}: constant below the first polar angle of the light and above the last: measure from 0 to 88 degrees")
        self.theta_i = np.radians(variables["theta_i"])
        self.flux = np.maximum(variables["flux"][:, :, 0], 0).swapaxes(1, 2)
        self.bsdf = turned[:, :, 0].swapaxes(1, 2)
        self.eta = float(attributes["index_behind"])

    def on_square(self, nodes):
        """The BSDF at `nodes` by `nodes` points of the unit square, which the concentric map takes to projected directions."""
        # All sectors meet at the normal, and beyond the last ring the BSDF is constant
        inner, outer = self.bsdf[..., :1, :], self.bsdf[..., -1:, :]
        pole = np.broadcast_to(inner.mean(-1, keepdims=True), inner.shape)
        rings = np.concatenate([pole, self.bsdf, outer], axis=-2)
        bins, sectors = self.bsdf.shape[-2:]
        x, y = disk(nodes)
        theta = np.arcsin(np.minimum(np.hypot(x, y), 1)) / (np.pi / 2) * bins
        ring = np.interp(theta, [0, 0.5, bins + 0.5], [0, 1, bins + 1])
        sector = np.arctan2(y, x) / (2 * np.pi) * sectors - 0.5
        result = np.zeros((*self.bsdf.shape[:3], *x.shape), np.float32)
        for i in (0, 1):
            for j in (0, 1):
                weight = (1 - np.abs(ring - np.floor(ring) - i)) * (1 - np.abs(sector - np.floor(sector) - j))
                of_bins = rings[..., np.floor(ring).astype(int) + i, (np.floor(sector).astype(int) + j) % sectors]
                result += of_bins * weight
        return result


def disk(nodes):
    """Points of the unit disk at nodes of the unit square, by the area-preserving map of Shirley and Chiu: arrays of x and of y."""
    a, b = np.meshgrid(*2 * [np.linspace(-1, 1, nodes)])
    is_steep = np.abs(a) < np.abs(b)
    radius, other = np.where(is_steep, (b, a), (a, b))
    angle = np.pi / 4 * np.divide(other, radius, out=np.zeros_like(a), where=radius != 0)
    angle = np.where(is_steep, np.pi / 2 - angle, angle)
    return radius * np.cos(angle), radius * np.sin(angle)


class AsperityTable(mi.BSDF):
    """BSDF of all orders of scattering, as it was measured on explicit surfaces.

    `filename`: a NetCDF file of one isotropic sample, lit by `gonio --from both --bins THETAxPHI`: a half space or a slab. `eta`: index of the interior
    over that of the exterior, by default that of the file: 1 for a slab between equal media. `nodes`: per axis of a hemisphere, 129 by default.

    The BSDF is interpolated linearly between nodes of equal projected solid angle and between polar angles of the light, and scaled to the
    flux that was measured. The table stands at `wi`, also where `wi` is the direction of the view: by reciprocity, the light that a direction receives
    is divided among directions of `wo` as the light that it sends. Sampling is exact: the weight of a sample is the reflectance plus the transmittance, times the scale of radiance.
    """

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        file = Measurement(props["filename"])
        self.eta = float(props.get("eta", file.eta))
        values = file.on_square(int(props.get("nodes", 129)))
        # The distribution refuses zeros everywhere: a constant, of which the flux is zero
        values[values.sum((-2, -1)) == 0] = 1
        theta = file.theta_i.tolist()
        # By number of the lobe and polar angle of `wi`
        self.lobes = mi.MarginalContinuous2D2(values.reshape(4, *values.shape[2:]), [list(range(4)), theta])
        self.fluxes = [[Curve(theta, one) for one in of_source] for of_source in file.flux]
        both = mi.BSDFFlags.FrontSide | mi.BSDFFlags.BackSide
        self.m_components = [
            mi.BSDFFlags.GlossyReflection | both,
            mi.BSDFFlags.GlossyTransmission | both | mi.BSDFFlags.NonSymmetric,
        ]
        self.m_flags = self.m_components[0] | self.m_components[1]

    def sides(self, ctx, si):
        """Polar angle of `wi`, whether it is above, fluxes reflected and transmitted, probability to sample reflection."""
        cosine = mi.Frame3f.cos_theta(si.wi)
        theta, above = dr.safe_acos(dr.abs(cosine)), cosine > 0
        fluxes = [dr.select(above, self.fluxes[0][side].at(theta), self.fluxes[1][side].at(theta)) for side in (0, 1)]
        is_on = [
            ctx.is_enabled(mi.BSDFFlags.GlossyReflection, 0),
            ctx.is_enabled(mi.BSDFFlags.GlossyTransmission, 1),
        ]
        fluxes = [flux if on else flux * 0 for flux, on in zip(fluxes, is_on)]
        total = fluxes[0] + fluxes[1]
        return theta, above, fluxes, dr.select(total > 0, fluxes[0] / dr.maximum(total, 1e-20), 0)

    def radiance_scale(self, ctx, above):
        """Square of the index on the side of `wi` over that on the side of `wo`, if radiance is transported."""
        if ctx.mode != mi.TransportMode.Radiance:
            return 1
        return dr.square(dr.select(above, 1 / self.eta, self.eta))

    def lobe(self, theta, above, reflected):
        """Parameters of one of the four lobes."""
        return [dr.select(above, 0.0, 2.0) + dr.select(reflected, 0.0, 1.0), theta]

    def sample(self, ctx, si, sample1, sample2, active=True):
        theta, above, fluxes, probability = self.sides(ctx, si)
        reflected = sample1 < probability
        position, density = self.lobes.sample(sample2, self.lobe(theta, above, reflected), active)
        projected = mi.warp.square_to_uniform_disk_concentric(position)
        cosine = dr.safe_sqrt(1 - dr.squared_norm(projected))
        # About the azimuth of wi
        tangent = rotated(mi.Vector2f(projected), azimuth(si.wi))
        bs = dr.zeros(mi.BSDFSample3f)
        bs.wo = mi.Vector3f(tangent.x, tangent.y, dr.select(above == reflected, cosine, -cosine))
        bs.pdf = dr.select(reflected, probability, 1 - probability) * density * cosine / dr.pi
        bs.eta = dr.select(reflected, 1.0, dr.select(above, self.eta, 1 / self.eta))
        bs.sampled_type = dr.select(
            reflected, mi.UInt32(+mi.BSDFFlags.GlossyReflection), mi.UInt32(+mi.BSDFFlags.GlossyTransmission)
        )
        bs.sampled_component = dr.select(reflected, mi.UInt32(0), mi.UInt32(1))
        active &= (mi.Frame3f.cos_theta(si.wi) != 0) & (bs.pdf > 0)
        weight = (fluxes[0] + fluxes[1]) * dr.select(reflected, 1, self.radiance_scale(ctx, above))
        return bs, mi.Spectrum(dr.select(active, weight, 0))

    def eval_pdf(self, ctx, si, wo, active=True):
        theta, above, fluxes, probability = self.sides(ctx, si)
        cosine = mi.Frame3f.cos_theta(wo)
        reflected = (cosine > 0) == above
        position = mi.warp.uniform_disk_to_square_concentric(rotated(mi.Vector2f(wo.x, wo.y), -azimuth(si.wi)))
        density = self.lobes.eval(position, self.lobe(theta, above, reflected), active) * dr.abs(cosine) / dr.pi
        active &= (mi.Frame3f.cos_theta(si.wi) != 0) & (cosine != 0)
        value = dr.select(reflected, fluxes[0], fluxes[1] * self.radiance_scale(ctx, above)) * density
        pdf = dr.select(reflected, probability, 1 - probability) * density
        return mi.Spectrum(dr.select(active, value, 0)), dr.select(active, pdf, 0)

    def eval(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[0]

    def pdf(self, ctx, si, wo, active=True):
        return self.eval_pdf(ctx, si, wo, active)[1]

    def to_string(self):
        return f"AsperityTable[eta = {self.eta}]"


class Curve:
    """A function of the polar angle, linear between nodes, constant beyond them."""

    def __init__(self, nodes, values):
        # The distribution refuses zeros everywhere
        self.curve = mi.IrregularContinuousDistribution(nodes, np.maximum(values, 1e-12).tolist())
        self.first, self.last = nodes[0], nodes[-1]

    def at(self, angle):
        return self.curve.eval_pdf(dr.clip(angle, self.first, self.last))


def azimuth(w):
    return dr.atan2(w.y, w.x)


def rotated(point, angle):
    sine, cosine = dr.sincos(angle)
    return mi.Point2f(cosine * point.x - sine * point.y, sine * point.x + cosine * point.y)


class XuSun(mi.BSDF):
    """Single scattering by the model of H. Xu and Y. Sun.

    `s`: smoothness, correlation length over root mean square height (convention `exp(-r^2 / tau^2)`). `eta`: index of the interior over that of the
    exterior.

    Transmission is Eq. 25 of *A physically based transmission model of rough surfaces* (JVRB 5, 2008), reflection its counterpart (Y. Sun, JOSA A 24,
    2007). Both are a Beckmann microfacet BSDF of `alpha = 2 / s` in which the visibility `V` of Eq. 24 (`k0 = 0.7`) stands in place of Smith's masking:
    Mitsuba's `roughdielectric`, which is the single scattering of Heitz et al. too, times `V(wi) V(wo) / (G1(wi) G1(wo))`. Light is lost
    where facets are masked, and not scattered again.
    """

    def __init__(self, props):
        mi.BSDF.__init__(self, props)
        self.s = float(props["s"])
        eta = float(props["eta"])
        smith = {"type": "roughdielectric", "distribution": "beckmann", "alpha": 2 / self.s, "int_ior": eta, "ext_ior": 1.0}
        self.smith = mi.load_dict(smith)
        self.facets = mi.MicrofacetDistribution(mi.MicrofacetType.Beckmann, 2 / self.s)
        self.m_components = [self.smith.flags(i) for i in range(self.smith.component_count())]
        self.m_flags = self.smith.flags()

    def gain(self, w):
        """Visibility of Eq. 24, over Smith's masking."""
        tangent = dr.maximum(dr.abs(mi.Frame3f.tan_theta(w)), 1e-6)
        exponent = 0.7 * tangent / self.s * dr.exp(-dr.square(self.s / (2 * tangent)))
        # Not rounded to zero near the horizon: a sample without weight counts as none
        visibility = dr.exp(-dr.minimum(exponent, 60))
        masking = self.facets.smith_g1(w, mi.Vector3f(0, 0, 1))
        return dr.select(masking > 0, visibility / dr.maximum(masking, 1e-20), 0)

    def sample(self, ctx, si, sample1, sample2, active=True):
        bs, weight = self.smith.sample(ctx, si, sample1, sample2, active)
        return bs, weight * self.gain(si.wi) * self.gain(bs.wo)

    def eval(self, ctx, si, wo, active=True):
        return self.smith.eval(ctx, si, wo, active) * self.gain(si.wi) * self.gain(wo)

    def pdf(self, ctx, si, wo, active=True):
        return self.smith.pdf(ctx, si, wo, active)

    def eval_pdf(self, ctx, si, wo, active=True):
        value, pdf = self.smith.eval_pdf(ctx, si, wo, active)
        return value * self.gain(si.wi) * self.gain(wo), pdf

    def to_string(self):
        return f"XuSun[s = {self.s}]"


mi.register_bsdf("asperity_table", AsperityTable)
mi.register_bsdf("xu_sun", XuSun)

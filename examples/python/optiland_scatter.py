"""Scatter of optiland by a result of `gonio`: rough mirrors of one isotropic sample in a sequential lens system.

    bsdf = MeasuredBSDF(result)                       # of asp.gonio(..., theta=[0, 15, ..., 85], bins="36x72")
    optic.surfaces.add(index=1, material="mirror", bsdf=bsdf)

Each ray leaves in a direction drawn from the measured lobe, and its intensity is multiplied by the measured reflectance.
Between polar angles of the light one of the two is picked, so that means are linear. NumPy backend of optiland.

Needs `optiland` and `xarray` besides `asperity`.
"""

import os

import numpy as np
from optiland.optic import Optic
from optiland.scatter import BaseBSDF

import asperity as asp

RAYS = int(os.environ.get("ASPERITY_RAYS", 200_000))


class MeasuredBSDF(BaseBSDF):
    """Reflection as measured."""

    def __init__(self, result, seed=1):
        edges = result.bins
        if edges["theta"].ndim != 2 or result.brdf.ndim != 3:
            raise ValueError('needs several polar angles of the light, one setting and common bins, such as bins="36x72"')
        self.theta_i = result.to_xarray().theta_i.values
        self.reflected = result.reflected
        # Per bin: edges of sin^2(theta), of phi, and flux
        self.rows, self.sectors = np.sin(np.radians(edges["theta"])) ** 2, np.radians(edges["phi"])
        flux = np.maximum(result.brdf, 0) * (np.diff(self.rows) * np.diff(self.sectors).T)
        flux = flux.reshape(len(flux), -1)
        self.cumulative = np.cumsum(flux, 1) / flux.sum(1, keepdims=True)
        self.rng = np.random.default_rng(seed)

    def scatter(self, rays, nx, ny, nz):
        """Turns rays, which optiland has reflected as by a smooth mirror, into those of the rough one."""
        before = np.stack([rays.L0, rays.M0, rays.N0], -1)
        normal = np.broadcast_to(np.stack(np.broadcast_arrays(nx, ny, nz), -1), before.shape)
        cosine = -np.sum(before * normal, -1, keepdims=True)
        normal, cosine = np.where(cosine < 0, -normal, normal), np.abs(cosine)
        # Pick a measured direction of the light, then a bin, then a direction in it
        theta = np.degrees(np.arccos(np.minimum(cosine[:, 0], 1)))
        at = np.interp(theta, self.theta_i, np.arange(len(self.theta_i)))
        u = self.rng.random((4, len(at)))
        light = np.floor(at + u[0]).astype(int).clip(max=len(self.theta_i) - 1)
        bins = np.array([np.searchsorted(self.cumulative[k], v) for k, v in zip(light, u[1])])
        row, sector = np.divmod(bins.clip(max=self.cumulative.shape[1] - 1), len(self.sectors))
        square = self.rows[row, 0] + u[2] * np.diff(self.rows)[row, 0]
        phi = self.sectors[sector, 0] + u[3] * np.diff(self.sectors)[sector, 0]
        # Azimuth 0 is that towards the light
        across = -before - cosine * normal
        length = np.linalg.norm(across, axis=-1, keepdims=True)
        other = np.cross(normal, np.where(np.abs(normal[:, :1]) < 0.9, [1.0, 0, 0], [0, 1.0, 0]))
        other /= np.linalg.norm(other, axis=-1, keepdims=True)
        x = np.where(length > 1e-9, across / np.maximum(length, 1e-9), other)
        y = np.cross(normal, x)
        sine = np.sqrt(square)[:, None]
        after = sine * (np.cos(phi)[:, None] * x + np.sin(phi)[:, None] * y) + np.sqrt(1 - square)[:, None] * normal
        rays.L, rays.M, rays.N = after.T
        rays.i = rays.i * self.reflected[light]
        return rays


def mirror_system(bsdf, tilt):
    """A tilted rough mirror in collimated light."""
    optic = Optic()
    optic.set_aperture(aperture_type="EPD", value=10)
    optic.fields.set_type("angle")
    optic.fields.add(y=0)
    optic.wavelengths.add(value=0.55, is_primary=True)
    optic.surfaces.add(index=0, thickness=np.inf)
    optic.surfaces.add(index=1, thickness=0, is_stop=True, rx=np.radians(tilt), material="mirror", bsdf=bsdf)
    optic.surfaces.add(index=2)
    return optic


if __name__ == "__main__":
    light = dict(theta=[0, 15, 30, 45, 60, 75, 85], bins="36x72", rays=RAYS, realisations=8, seed=1)
    result = asp.gonio(smoothness=12, size=128, tau=8, material="gold", wavelength=550, **light)
    optic = mirror_system(MeasuredBSDF(result), tilt=30)
    rays = optic.trace(Hx=0, Hy=0, wavelength=0.55, num_rays=100, distribution="hexapolar")
    # The normal of the mirror faces the light, which travels along +z
    normal = np.array([0, np.sin(np.radians(30)), -np.cos(np.radians(30))])
    cosine = np.stack([rays.L, rays.M, rays.N], -1) @ normal
    mean, error = cosine.mean(), cosine.std() / len(cosine) ** 0.5
    # Of the measurement: the BRDF over the integrals of cos and cos^2 of its bins
    edges = np.cos(np.radians(result.bins["theta"]))
    rings = result.brdf[2].sum(1)
    measured = (rings @ -np.diff(edges**3) / 3).item() / (rings @ -np.diff(edges**2) / 2).item()
    print(f"reflected {rays.i.mean():.5f}, measured {result.reflected[2]:.5f} +- {result.reflected_se[2]:.5f}")
    print(f"mean cosine of the directions {mean:.4f} +- {error:.4f}, measured {measured:.4f}")

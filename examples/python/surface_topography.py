"""Topographies of SurfaceTopography as surfaces: from its readers, corrections and containers to a BRDF.

    from SurfaceTopography import read_topography
    surface = asp.Surface(read_topography("scan.opd").detrend("curvature"))

A topography brings its heights, spacing, unit, periodicity and undefined points along. Its line scans have no surface.

Needs `SurfaceTopography` besides `asperity`.
"""

import os

import numpy as np
from SurfaceTopography import Topography
from SurfaceTopography.Container import SurfaceContainer
from SurfaceTopography.Generation import fourier_synthesis

import asperity as asp

RAYS = int(os.environ.get("ASPERITY_RAYS", 200_000))


def surfaces(container):
    """Level surfaces without missing points, of all maps of a container; its line scans are left out."""
    maps = [topography for topography in container if topography.dim == 2]
    return [asp.Surface(one).filter(missing="fill", remove="plane") for one in maps]


def measured_container(maps=4):
    """Self-affine maps in micrometres that stand in for scans: tilted, not periodic, with undefined points."""
    rng = np.random.default_rng(7)
    scans = []
    for _ in range(maps):
        parameters = dict(hurst=0.8, rms_height=0.6, short_cutoff=4, long_cutoff=20)
        drawn = fourier_synthesis((128, 96), (64.0, 48.0), periodic=False, unit="µm", rng=rng, **parameters)
        heights = np.ma.array(drawn.heights() + 0.01 * np.arange(128)[:, None], mask=rng.random((128, 96)) < 0.002)
        scans.append(Topography(heights, drawn.physical_sizes, unit="µm"))
    return SurfaceContainer.InMemorySurfaceContainer(scans)


if __name__ == "__main__":
    container = measured_container()
    scans = surfaces(container)
    heights = []
    for topography, surface in zip(container, scans):
        # Both by the mean plane of points that were measured
        height = topography.detrend("height").Sq()
        heights.append((height, surface.parameters()["sq"]))
        print(f"{surface}: Sq {heights[-1][1]:.4f} um, by SurfaceTopography {height:.4f} um")
    result = asp.trace(scans, material="aluminium", wavelength=550, theta=30, rays=RAYS, seed=1)
    print(f"reflected {result.reflected:.5f} +- {result.reflected_se:.5f}, by the scatter between {len(scans)} maps")
    peak = np.unravel_index(np.argmax(result.brdf), result.brdf.shape)
    theta, phi = (result.bins[name][at].mean() for name, at in zip(("theta", "phi"), peak))
    print(f"BRDF at most {result.brdf[peak]:.3f} +- {result.brdf_se[peak]:.3f} 1/sr, at theta {theta:g}, phi {phi:g} degrees")

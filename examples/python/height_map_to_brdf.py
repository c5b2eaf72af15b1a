# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # From a measured height map to a BRDF
#
# A height map of an instrument has a tilt, missing points and noise. This page levels and filters it, computes
# parameters of ISO 25178, traces light on it, plots the BRDF with error bars, and writes a file for OpticStudio.
#
# Needs `matplotlib` and `pandas` besides `asperity`.

# %%
import os
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import asperity as asp

RAYS = int(os.environ.get("ASPERITY_RAYS", 400_000))
FOLDER = Path("height_map_to_brdf")
FOLDER.mkdir(exist_ok=True)

# %% [markdown]
# ## The scan
#
# A random surface stands in for the measurement, with a tilt of 1 %, noise of 20 nm and 300 missing points. With a
# file of your own the whole cell is `scan = asp.read("scan.sur")`: X3P, Digital Surf, MetroPro, Sensofar, Wyko, Alicona,
# SDF and other formats state their spacing and unit. A bare array does not.

# %%
drawn = asp.Surface.gaussian(sigma="0.8um", tau="8um", spacing="0.5um", size=256, seed=7)
rng = np.random.default_rng(7)
heights = drawn.heights + 0.005 * np.arange(256) + rng.normal(scale=0.02, size=drawn.shape)
heights.flat[rng.choice(heights.size, 300, replace=False)] = np.nan
np.save(FOLDER / "scan.npy", heights)

scan = asp.Surface(asp.read(FOLDER / "scan.npy"), spacing=0.5, unit="um")
scan

# %% [markdown]
# ## Form, noise and roughness
#
# Missing points are interpolated and the tilt is removed. An S-filter then removes waves shorter than 2.5 µm. That is
# noise of the instrument, which has little height but steep slopes: `Sq` stays, and the root mean square gradient `Sdq`
# falls. Geometric optics sees slopes, so the cut-off matters more for light than for heights.

# %%
level = scan.filter(missing="fill", remove="plane")
surface = level.filter(s=2.5)
table = pd.DataFrame({"level": level.parameters(), "S-filter 2.5 µm": surface.parameters()})
table.loc[["sq", "sa", "sz", "ssk", "sku", "sdq", "sal", "str"]].astype(float).round(3)

# %%
figure, axes = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
for ax, shown, title in [(axes[0], scan, "as measured"), (axes[1], surface, "level and filtered")]:
    shown.plot(ax)
    ax.set_title(title)
plt.show()

# %% [markdown]
# ## Light
#
# Aluminium at 550 nm, lit from 30 degrees. A note at the end of the text judges whether lengths of the surface are large against
# the wavelength, so that rays suffice.

# %%
LIGHT = dict(material="aluminium", wavelength="550nm", theta=30, rays=RAYS, seed=1)
result = surface.trace(**LIGHT)
print(result)

# %% [markdown]
# `result.reflected`, `result.brdf` and the others are arrays, each with its standard error in `..._se`. These errors are
# those of the rays: they hold for this map, and another spot of the same sample would differ by more. Several maps of one
# sample, traced as an ensemble, tell by how much. Here they are the quarters of the map. Four surfaces tell an error no better than
# within 40 %, so that error bars of neighbouring bins differ.

# %%
quarters = [
    asp.Surface(surface.heights[i : i + 128, j : j + 128], surface.spacing, surface.unit) for i in (0, 128) for j in (0, 128)
]
sample = asp.trace(quarters, **LIGHT)
print(f"reflected by the map      {result.reflected:.6f} +- {result.reflected_se:.6f}, by rays")
print(f"reflected by its quarters {sample.reflected:.6f} +- {sample.reflected_se:.6f}, by their scatter")

# %% [markdown]
# The table `in_plane` has the light within 5 degrees of the plane of incidence, over polar angles that are positive on
# the side of the mirror direction. Its intensity is the BRDF times the cosine of the polar angle.

# %%
figure, ax = plt.subplots(figsize=(6.5, 4.2), layout="constrained")
for lobe, label, style in [
    (result, "map, errors of rays", dict(color="tab:blue", marker="o", markersize=7, markerfacecolor="none")),
    (sample, "quarters, errors of the sample", dict(color="tab:orange", marker="s", markersize=3)),
]:
    plane = lobe.to_dataframe("in_plane").query("side == 'reflected' and flux > 0")
    theta = (plane.theta_min_deg + plane.theta_max_deg) / 2
    cosine = np.cos(np.radians(theta))
    brdf, error = plane.intensity / cosine, plane.intensity_se / cosine
    ax.errorbar(theta, brdf, error, linestyle="none", capsize=2.5, label=label, **style)
ax.axvline(30, color="0.6", linewidth=0.8, linestyle="--", label="mirror direction")
ax.set(xlabel="polar angle in the plane of incidence (degrees)", ylabel="BRDF (1/sr)", yscale="log")
ax.set(xlim=(-45, 90), ylim=(1e-3, 10))
ax.legend(fontsize=8)
plt.show()

# %% [markdown]
# ## Files for other programs
#
# `gonio` measures several directions of the light, here for a table of OpticStudio. The text compares the flux that
# the file integrates to with what was measured. `report` writes one page that needs no network, with lobes to turn.

# %%
data = surface.gonio(**{**LIGHT, "theta": [0, 20, 40, 60]})
print(data.export(FOLDER / "aluminium_brdf.bsdf", "zemax"))
data.report(FOLDER / "aluminium.html")

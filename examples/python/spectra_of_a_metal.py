# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Spectra of a rough metal
#
# Gold is yellow because it reflects little blue light. Rough gold is darker, since light that meets several facets is
# absorbed several times, and of a deeper colour, since that takes most where the metal reflects least. This page measures both
# with one call over a list of wavelengths.
#
# Needs `matplotlib`, `pandas` and `xarray` besides `asperity`.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

RAYS = int(os.environ.get("ASPERITY_RAYS", 100_000))
WAVELENGTHS = np.arange(400, 701, 20)
THETA = 30

# %% [markdown]
# ## One call
#
# Random surfaces of gold with a root mean square height of 8 µm and a correlation length of 12 µm: steep, and large against
# the wavelength. Optical constants come with the package, from Johnson and Christy for gold.

# %%
result = asp.gonio(
    sigma="8um",
    tau="12um",
    size=128,
    material="gold",
    wavelength=WAVELENGTHS,
    theta=THETA,
    rays=RAYS,
    realisations=16,
    seed=1,
)
data = result.to_xarray().squeeze(["theta_i", "phi_i"])
data

# %% [markdown]
# ## Reflectance of a flat surface
#
# Fresnel's equations for unpolarised light, from the optical constants that were traced. They are coordinates of the data
# set over the wavelength.

# %%
index = data.eta + 1j * data.kappa
cosine = np.cos(np.radians(THETA))
inside = np.sqrt(1 - (np.sin(np.radians(THETA)) / index) ** 2)
r_s = (cosine - index * inside) / (cosine + index * inside)
r_p = (index * cosine - inside) / (index * cosine + inside)
flat = (np.abs(r_s) ** 2 + np.abs(r_p) ** 2) / 2

# %% [markdown]
# ## Rough against flat
#
# Standard errors come from the scatter between surfaces. All wavelengths share surfaces and rays, so their errors are
# correlated: the curve as a whole may be high or low, while its shape is known far better.

# %%
light, error = data.flux.sel(side="reflected"), data.flux_se.sel(side="reflected")
figure, (upper, lower) = plt.subplots(
    2, 1, figsize=(6.5, 5.5), sharex=True, layout="constrained", gridspec_kw={"height_ratios": [2, 1]}
)
upper.plot(data.wavelength, flat, color="0.3", linewidth=1.2, label="flat, Fresnel's equations")
points = dict(color="goldenrod", marker="o", markersize=4, linestyle="none", capsize=3)
upper.errorbar(data.wavelength, light, error, **points, label="rough, smoothness 1.5")
upper.set(ylabel="reflectance", ylim=(0, 1))
upper.legend()
lower.errorbar(data.wavelength, light / flat, error / flat, **points)
lower.set(xlabel="wavelength (nm)", ylabel="rough over flat")
plt.show()

# %% [markdown]
# ## Light of several facets
#
# The first facet scatters a part of the light that all wavelengths share. What two and more facets reflect grows with
# reflectance: it is redder. The main table of a study, here a row per wavelength, has both parts of the flux with their errors.

# %%
table = result.to_dataframe().set_index("wavelength_nm")
figure, ax = plt.subplots(figsize=(6.5, 4), layout="constrained")
for name, label, colour, marker in [
    ("reflected_single", "one facet", "goldenrod", "o"),
    ("reflected_multiple", "several facets", "firebrick", "s"),
]:
    relative = table[[name, f"{name}_se"]] / table[name].iloc[-1]
    style = dict(color=colour, marker=marker, markersize=4, capsize=3, linewidth=0.8)
    ax.errorbar(table.index, *relative.to_numpy().T, **style, label=f"{label}: {table[name].iloc[-1]:.3f} at 700 nm")
ax.set(xlabel="wavelength (nm)", ylabel="reflected flux, relative to 700 nm", ylim=(0, 1.1))
ax.legend(loc="upper left")
plt.show()

# %% [markdown]
# ## Direction and colour
#
# The data set has labels, so that one line picks a direction. Here the colour of the lobe is the ratio of its BRDF at 460 nm to that
# at 640 nm, beside the plane of incidence. Azimuth 0 is that of the light and 180 that of the mirror direction. Light that is sent back
# at steep angles has mostly met one facet, and has a ratio near that of flat gold; light about the normal has met more.

# %%
brdf = data.bsdf.sel(side="reflected").sel(theta_o=[12.5, 42.5, 72.5], phi_o=[5, 175])
ratio = brdf.sel(wavelength=460) / brdf.sel(wavelength=640)
print(f"flat: {float(flat.sel(wavelength=460) / flat.sel(wavelength=640)):.3f}")
ratio.round(3).to_pandas()

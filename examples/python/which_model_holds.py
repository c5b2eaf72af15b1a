# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # Which scattering model holds?
#
# Microfacet models predict the BRDF of a random rough surface from its slopes. This page draws such surfaces, traces light
# on them, and tests two models bin by bin: Smith's masking, which describes light that meets one facet, and the
# random walk of Heitz et al., which describes light of all orders.
#
# Needs `matplotlib`, `pandas` and `xarray` besides `asperity`.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import asperity as asp
from asperity import models

RAYS = int(os.environ.get("ASPERITY_RAYS", 400_000))
SMOOTHNESS = [2, 4, 8]
THETA, ETA = 60, 1.5

# %% [markdown]
# ## One call
#
# Smoothness is the correlation length over the root mean square height; Beckmann's roughness is `alpha = 2 / smoothness`.
# All three cases are drawn and traced by one call, on 32 surfaces each.

# %%
study = asp.verify(
    **dict(smoothness=SMOOTHNESS, tau=8, size=128, eta=ETA, theta=THETA),
    **dict(models=["smith", "heitz"], rays=RAYS, model_rays=RAYS, realisations=32, seed=1),
)

# %% [markdown]
# ## Verdicts
#
# A model is rejected where its deviation is larger than chance allows, at a level that accounts for all tests. Given enough
# rays every model is rejected somewhere. The total variation distance says how wrong it is: the fraction of the light that
# the model sends elsewhere, next to what noise alone would cause.

# %%
rows = []
for smoothness, case in zip(SMOOTHNESS, study.summary["cases"]):
    for model in case["summary"]["comparison"]["models"]:
        for light, test in [("single", model["single"]), ("all orders", model["total"])]:
            verdict = test["verdict"] or "not described"
            distances = test["total_variation"], test["total_variation_noise"]
            rows.append((smoothness, model["model"], light, verdict, *distances))
verdicts = pd.DataFrame(rows, columns=["smoothness", "model", "light", "verdict", "distance", "noise"])
verdicts.round(5)

# %% [markdown]
# ## The measured lobe over the model
#
# Light that met one facet, in the plane of incidence. A model is a function of two directions; `wi` points to the light, and
# the mirror direction has the azimuth of 180 degrees. The lower panel has the deviation from the model with its error,
# where the curves above look the same.
#
# The measurement is a mean over bins of up to 5 degrees, within 5 degrees of the plane, and the model a value at their middle. Where
# the lobe falls steeply these differ, most of all towards 90 degrees. The tests above take the mean of the model over each bin instead.
#
# On the roughest surfaces Smith's masking sends too little light back to the side that it comes from, and too much past the mirror
# direction. A facet that light reaches is visible from about the same direction too, which this masking leaves out.


# %%
def plane_of(smoothness):
    """In-plane angles of the bins, and BRDF of single scattering with its error in 1/sr."""
    table = study.to_dataframe(f"s{smoothness}_n{ETA}_theta{THETA}/in_plane")
    table = table[(table.side == "reflected") & (table.flux_order_1 > 4 * table.flux_order_1_se)]
    theta = ((table.theta_min_deg + table.theta_max_deg) / 2).to_numpy()
    projected = table.solid_angle_sr * np.cos(np.radians(theta))
    return theta, (table.flux_order_1 / projected).to_numpy(), (table.flux_order_1_se / projected).to_numpy()


def smith_at(smoothness, theta):
    """BRDF of the model at in-plane angles, positive on the side of the mirror direction."""
    smith = models.smith(smoothness=smoothness, eta=ETA)
    return smith.eval(models.direction(THETA), models.direction(np.abs(theta), np.where(theta > 0, 180, 0)))


angles = np.linspace(-88, 88, 353)
figure, (upper, lower) = plt.subplots(
    2, 1, figsize=(6.5, 6), sharex=True, layout="constrained", gridspec_kw={"height_ratios": [2, 1]}
)
for smoothness, colour in zip(SMOOTHNESS, ["tab:blue", "tab:orange", "tab:green"]):
    theta, brdf, error = plane_of(smoothness)
    upper.plot(angles, smith_at(smoothness, angles), color=colour, linewidth=1, label=f"Smith, smoothness {smoothness}")
    points = dict(color=colour, linestyle="none", marker="o", markersize=3, capsize=2)
    upper.errorbar(theta, brdf, error, **points)
    model = smith_at(smoothness, theta)
    inside = np.abs(theta) < 75
    lower.errorbar(theta[inside], (100 * (brdf / model - 1))[inside], (100 * error / model)[inside], **points)
upper.errorbar([], [], [], color="0.4", linestyle="none", marker="o", markersize=3, capsize=2, label="rays")
upper.set(ylabel="BRDF, single scattering (1/sr)", yscale="log", ylim=(1e-4, 10), xlim=(-90, 90))
upper.legend(fontsize=8)
lower.axhline(0, color="0.4", linewidth=0.8)
lower.set(xlabel="polar angle in the plane of incidence (degrees)", ylabel="rays over Smith - 1 (%)", ylim=(-30, 30))
plt.show()

# %% [markdown]
# ## Energy of all orders
#
# What one facet reflects is not all. A model of single scattering misses the rest, about a tenth of the light that the two rougher
# surfaces reflect.

# %%
data = study.to_xarray().sel(side="reflected").squeeze(["theta_i", "phi_i"])
energy = pd.DataFrame(index=pd.Index(SMOOTHNESS, name="smoothness"))
energy["one facet"] = data.flux_order.sel(s=SMOOTHNESS, order=1)
energy["all"] = data.flux.sel(s=SMOOTHNESS)
energy["error of all"] = data.flux_se.sel(s=SMOOTHNESS)
energy["Smith"] = [models.smith(smoothness=s, eta=ETA).albedo(models.direction(THETA))[0] for s in SMOOTHNESS]
energy["Heitz"] = [case["summary"]["comparison"]["models"][1]["reflected"] for case in study.summary["cases"]]
energy.round(5)

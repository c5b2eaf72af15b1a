# ---
# jupyter:
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # How an error falls
#
# Every result has a standard error, and halving it takes four times the rays: on logarithmic axes the error falls with a
# slope of -1/2. This page shows where that ends, what a control variate saves, how to ask for an error instead of a number of rays,
# and how to measure the cost.
#
# Needs `matplotlib` and `pandas` besides `asperity`.

# %%
import os

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd

import asperity as asp

RAYS = int(os.environ.get("ASPERITY_RAYS", 1_000_000))
CASE = dict(smoothness=3, eta=1.5, theta=30, size=128, tau=8, bins="18x36", seed=1)

# %% [markdown]
# ## Rays, surfaces and a control variate
#
# The relative error over all bins is `sqrt(sum se^2) / sqrt(sum flux^2)`. `error_budget` divides it into the part
# of rays and the part of surfaces. Three series of runs, each with four times as many rays as the one before:
#
# - rays on 16 surfaces: the part of the rays falls, that of the surfaces stays;
# - as many surfaces as the rays take, 1024 rays on each: both parts fall;
# - the same with a control variate, which leaves only shadowing, masking and multiple scattering to sampling.
#
# Where an error falls with a slope of -1/2, error squared times seconds is constant: that is the cost of an estimator.

# %%
counts = [RAYS // 4**k for k in range(4, -1, -1)]
series = {
    "plain, 16 surfaces": lambda rays: dict(estimator="plain", realisations=16),
    "plain, 1024 rays per surface": lambda rays: dict(estimator="plain", realisations=max(rays // 1024, 4)),
    "controlled, 1024 rays per surface": lambda rays: dict(estimator="controlled", realisations=max(rays // 1024, 4)),
}
rows = []
for label, options in series.items():
    for rays in counts:
        study = asp.verify(models="none", rays=rays, **options(rays), **CASE)
        bins, work = study.summary["error_budget"]["bins"], study.summary["work"]
        rows.append((label, work["rays"], bins["total"], bins["rays"], bins["surfaces"], work["seconds"]))
runs = pd.DataFrame(rows, columns=["series", "rays", "error", "of rays", "of surfaces", "seconds"])
runs["error^2 x seconds"] = runs.error**2 * runs.seconds
runs

# %% [markdown]
# ## The slope
#
# A line through the logarithms. On 16 surfaces it is flatter: the error of the surfaces is its floor, however many rays follow.

# %%
figure, ax = plt.subplots(figsize=(6.5, 4.5), layout="constrained")
slopes = {}
for (label, run), colour, marker in zip(runs.groupby("series", sort=False), ["tab:blue", "tab:orange", "tab:green"], "osD"):
    slopes[label] = np.polyfit(np.log(run.rays), np.log(run.error), 1)[0]
    ax.loglog(run.rays, run.error, color=colour, marker=marker, markersize=5, label=f"{label}: slope {slopes[label]:.2f}")
fixed = runs[runs.series == "plain, 16 surfaces"]
ax.loglog(fixed.rays, fixed["of rays"], color="tab:blue", linewidth=1, linestyle=":", label="of it, the part of the rays")
guide = np.array([counts[0], counts[-1]])
ax.loglog(guide, 0.5 * runs.error.max() * (guide / guide[0]) ** -0.5, color="0.5", linestyle="--", label="slope -1/2")
ax.set(xlabel="rays", ylabel="relative standard error over bins", ylim=(1e-4, 1))
ax.legend(fontsize=8)
plt.show()

# %% [markdown]
# ## An error instead of a number of rays
#
# With `target_error` a pilot run plans surfaces, rays and spacing. `of` names the quantity: `bins` (the default), `rings`,
# `in-plane`, `reflected` and others.

# %%
TARGET = 1e-3 if RAYS > 100_000 else 1e-2
reached = asp.verify(models="none", target_error=TARGET, of="bins", **CASE)
error = reached.summary["error_budget"]["bins"]["total"]
work = reached.summary["work"]
print(f"asked for {TARGET}, reached {error:.5f}")
print(f"by {work['rays']} rays on {work['realisations']} surfaces, {work['estimator']}, in {work['seconds']:.1f} s")

# %% [markdown]
# ## The cost, measured
#
# A standard error is an estimate. `converge` measures the error itself, against a reference of many surfaces, and the time
# that each estimator takes to it. Few repeats and a small reference make this quick; their number limits what it can tell.

# %%
cost = asp.converge(
    **CASE, samplings="stratified", surfaces=[4, 16, 64], rays=1024, repeats=4, reference_surfaces=128, reference_rays=8192
)
table = cost.to_dataframe()[["estimator", "surfaces", "seconds", "error", "error_se", "reference_error"]]
table

# %%
figure, ax = plt.subplots(figsize=(6.5, 4), layout="constrained")
for (estimator, run), colour, marker in zip(table.groupby("estimator"), ["tab:green", "tab:orange"], "Ds"):
    ax.errorbar(run.seconds, run.error, run.error_se, color=colour, marker=marker, markersize=5, capsize=3, label=estimator)
ax.axhline(table.reference_error.iloc[0], color="0.5", linestyle="--", linewidth=1, label="error of the reference")
ax.set(xlabel="time (s)", ylabel="relative error over bins", xscale="log", yscale="log")
ax.legend()
plt.show()

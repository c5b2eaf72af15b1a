"""Which model may I use? The atlas of docs/atlas.md as a figure, a table, and CSV, from the folders of `asperity map`.

    asperity map examples/atlas.toml -o atlas
    python examples/python/atlas.py atlas gold aluminium iron -o docs/figures/atlas.png --csv docs/atlas.csv

Needs `matplotlib` and `pandas`.
"""

import argparse
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from matplotlib.colors import ListedColormap
from matplotlib.patches import Patch

# The least costly model first
MODELS = ["smith", "heitz"]
CHOICES = {
    "smith (single scattering)": "#f0c24b",
    "heitz (all orders)": "#3f8f9b",
    "none of the four": "#4a3b5c",
    "not resolved": "#d9d9d9",
}
COLUMNS = ["material", "index", "s", "theta_deg", "model", "light", "verdict", "total_variation", "total_variation_low", "total_variation_high"]
UP_TO = [0, 30, 60, 80]


def label(row):
    """Metals have the name of their folder's material, dielectrics their index, `1/n` for light from inside."""
    if row["material"] != "dielectric":
        return row["material"]
    n = row["eta"]
    return f"n = {n:g}" if n >= 1 else f"n = 1/{1 / n:.4g}"


def verdict(row):
    """Of total variation and energies. Directions of peaks are left out, since bins of 5 degrees do not resolve narrow lobes."""
    found = [row[f"{measure}_verdict"] for measure in ("total_variation", "reflected", "transmitted")]
    return next((word for word in ("beyond", "not resolved") if word in found), "within")


def read(folder):
    cells = pd.read_csv(Path(folder) / "map.csv")
    cells["index"] = cells.apply(label, axis=1)
    cells["verdict"] = cells.apply(verdict, axis=1)
    return cells


def choice(verdicts):
    """Number of the choice in a cell, from the verdicts of its models."""
    for number, model in enumerate(MODELS):
        if verdicts[model] == "within":
            return number
    return 3 if "not resolved" in list(verdicts) else 2


def grid(cells):
    """Choices over s and theta."""
    verdicts = cells.pivot_table(index=["s", "theta_deg"], columns="model", values="verdict", aggfunc="first")
    return verdicts.apply(choice, axis=1).unstack()


def largest_alpha(cells, model, theta):
    """Largest alpha from which down a model is within tolerance at all angles up to theta, as text."""
    found = cells[(cells["model"] == model) & (cells["theta_deg"] <= theta)]
    holds = (found["verdict"] == "within").groupby(found["s"]).all().sort_index(ascending=False)
    smooth = holds[: np.argmin(holds.to_numpy())] if not holds.all() else holds
    return f"{2 / smooth.index.min():.2f}" if len(smooth) else "-"


def draw(panels, path):
    columns = 5
    rows = -(-len(panels) // columns)
    figure, axes = plt.subplots(rows, columns, figsize=(10, 2.1 * rows + 0.7), sharex=True, sharey=True, layout="constrained")
    colours = ListedColormap(list(CHOICES.values()))
    for axis, (name, cells) in zip(axes.flat, panels):
        found = grid(cells)
        axis.pcolormesh(found.to_numpy().T, cmap=colours, vmin=-0.5, vmax=3.5, edgecolors="white", linewidth=0.5)
        axis.set_title(name, fontsize=9)
        axis.set_xticks(np.arange(len(found)) + 0.5, [f"{2 / s:.2g}" for s in found.index], rotation=90, fontsize=7)
        axis.set_yticks(np.arange(len(found.columns)) + 0.5, [f"{theta:g}" for theta in found.columns], fontsize=7)
        axis.tick_params(length=0)
    for axis in axes.flat[max(0, len(panels) - columns) : len(panels)]:
        axis.tick_params(labelbottom=True)
    for axis in axes.flat[len(panels) :]:
        axis.axis("off")
    if len(panels) < axes.size:
        axes.flat[len(panels)].legend(handles=[Patch(color=colour, label=name) for name, colour in CHOICES.items()], loc="center left", fontsize=8, frameon=False)
    figure.supxlabel("roughness alpha = 2 / s", fontsize=9)
    figure.supylabel("angle of incidence (degrees)", fontsize=9)
    figure.suptitle("The least costly model within 1 % of all light, by 95 % intervals", fontsize=10)
    figure.savefig(path, dpi=150)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folders", nargs="+")
    parser.add_argument("-o", "--output", required=True)
    parser.add_argument("--csv")
    arguments = parser.parse_args()
    cells = pd.concat([read(folder) for folder in arguments.folders], ignore_index=True)
    if arguments.csv:
        cells[COLUMNS].to_csv(arguments.csv, index=False, float_format="%.4g")
    light = cells[cells["light"] == "all"]
    panels = [(name, light[light["index"] == name]) for name in light["index"].unique()]
    draw(panels, arguments.output)
    print("| material | " + " | ".join(f"{model} to {theta} deg" for model in MODELS for theta in UP_TO) + " |")
    print("|---" * (1 + len(MODELS) * len(UP_TO)) + "|")
    for name, cells in panels:
        print(f"| {name} | " + " | ".join(largest_alpha(cells, model, theta) for model in MODELS for theta in UP_TO) + " |")


if __name__ == "__main__":
    main()

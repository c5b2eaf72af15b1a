"""Figures with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from asperity._result import Result
    from asperity._surface import Surface

#: Most directions of the light in one figure.
_MOST = 6

#: Decades of the colours of lobes.
_DECADES = 4


def heights(surface: Surface, ax: Axes | None) -> Axes:
    """Heights as colours over x and y."""
    import matplotlib.pyplot as plt

    if ax is None:
        _, ax = plt.subplots(layout="constrained")
    (ny, nx), (dx, dy) = surface.shape, surface.spacing
    extent = (-0.5 * dx, (nx - 0.5) * dx, -0.5 * dy, (ny - 0.5) * dy)
    image = ax.imshow(surface.heights, extent=extent, origin="lower", cmap="viridis", interpolation="nearest")
    unit = "" if surface.unit == "1" else f" ({surface.unit.replace('um', 'µm')})"
    ax.set(xlabel=f"x{unit}", ylabel=f"y{unit}")
    ax.figure.colorbar(image, ax=ax, label=f"height{unit}")
    return ax


def lobes(result: Result) -> Figure:
    """BRDF and BTDF as polar maps, a row per side and a column per case."""
    import matplotlib.pyplot as plt
    from matplotlib.colors import LogNorm

    variables = result._labelled["variables"]
    dims, bsdf, _ = variables["bsdf"]
    at = dims.index("side")
    cases = [index for index in np.ndindex(*bsdf.shape[:at]) if np.isfinite(bsdf[index]).any()]
    sides = [side for side in range(2) if np.nanmax(bsdf[(..., side, slice(None), slice(None))], initial=0.0) > 0.0]
    if not sides:
        raise ValueError("no light was recorded")
    shown = cases[:_MOST]
    theta = np.append(variables["theta_o_bounds"][1][:, 0], 90.0)
    phi = np.radians(np.append(variables["phi_o_bounds"][1][:, 0], 360.0))
    peak = np.nanmax([bsdf[index] for index in shown])
    norm = LogNorm(peak * 10.0**-_DECADES, peak)
    figure, axes = plt.subplots(
        len(sides),
        len(shown),
        subplot_kw={"projection": "polar"},
        figsize=(3.2 * len(shown) + 1, 3.2 * len(sides)),
        layout="constrained",
        squeeze=False,
    )
    mesh: Any = None
    for column, index in enumerate(shown):
        label = ", ".join(_label(dims[axis], variables, value) for axis, value in enumerate(index))
        for row, side in enumerate(sides):
            ax = axes[row][column]
            light = np.clip(bsdf[(*index, side)], norm.vmin, None)
            mesh = ax.pcolormesh(phi, theta, light, norm=norm, cmap="viridis", rasterized=True)
            ax.set_ylim(0, 90)
            ax.set_yticks([30, 60], ["30°", "60°"], color="0.85")
            ax.grid(color="0.85", linewidth=0.4)
            name = "BRDF" if side == 0 else "BTDF"
            ax.set_title(f"{name}, {label}", fontsize=9)
    figure.colorbar(mesh, ax=axes.ravel().tolist(), label="1/sr", shrink=0.8)
    if len(shown) < len(cases):
        figure.suptitle(f"the first {len(shown)} of {len(cases)} cases", fontsize=9)
    return figure


_SYMBOLS = {"theta_i": "θᵢ", "phi_i": "φᵢ"}


def _label(name: str, variables: dict[str, Any], index: int) -> str:
    _, values, attributes = variables[name]
    value = values[index]
    number = value if isinstance(value, str) else f"{value:g}"
    unit = {"degree": "°", "": "", "1": ""}.get(attributes.get("units", ""), f" {attributes.get('units')}")
    return f"{_SYMBOLS.get(name, name)} = {number}{unit}"


def first_figure(result: Result) -> Figure:
    """The first figure among the files of a result."""
    import matplotlib.pyplot as plt

    figures = [name for name in result.files if name.endswith(".png")]
    if not figures:
        raise ValueError(f"these results of {result.command} are without figures, which an unfinished run and a copy of a temporary folder lack")
    picture = plt.imread(result.folder / figures[0])
    rows, columns = picture.shape[:2]
    figure = plt.figure(figsize=(columns / 150, rows / 150))
    ax = figure.add_axes((0, 0, 1, 1))
    ax.imshow(picture)
    ax.set_axis_off()
    return figure

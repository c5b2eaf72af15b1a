"""Light on explicit rough surfaces by geometric optics, against statistical scattering models.

Surfaces are drawn or read, light is traced on them, and results come with standard errors as arrays.
Keyword arguments are the flags of the program ``asperity`` with underscores, with the same defaults,
units and error sentences. Angles are in degrees, wavelengths in nanometres, and lengths in the unit of
the surface unless a text such as ``"5um"`` has its own.

>>> import asperity as asp
>>> surface = asp.Surface.gaussian(size=128, tau=8, smoothness=3, seed=7)
>>> result = surface.trace(eta=1.5, theta=30, rays=20_000, seed=1)
>>> round(float(result.transmitted), 2)
0.96
"""

from __future__ import annotations

from asperity import models
from asperity._core import __version__, commit, results_epoch
from asperity._result import Interrupted, Result, load
from asperity._studies import (
    albedo,
    attenuation,
    converge,
    gonio,
    map,
    materials,
    merge,
    report,
    settings,
    trace,
    verify,
)
from asperity._surface import Surface, read

__all__ = [
    "Interrupted",
    "Result",
    "Surface",
    "__version__",
    "albedo",
    "attenuation",
    "commit",
    "converge",
    "gonio",
    "load",
    "map",
    "materials",
    "merge",
    "models",
    "read",
    "report",
    "results_epoch",
    "settings",
    "trace",
    "verify",
]

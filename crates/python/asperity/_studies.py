"""Studies: one function per command of the program that has results."""

from __future__ import annotations

import inspect
import json
import os
from collections.abc import Callable, Iterable
from typing import Any

from asperity._call import Call, Progress, documented, settings
from asperity._result import Result, run_study
from asperity._surface import Surface

__all__ = [
    "albedo",
    "attenuation",
    "converge",
    "gonio",
    "map",
    "materials",
    "merge",
    "report",
    "settings",
    "trace",
    "verify",
]

_Path = str | os.PathLike[str]
_Surfaces = Surface | _Path | list[Surface | _Path] | tuple[Surface | _Path, ...]

_NOTE = """
``config``: a configuration file (.toml), which the settings override.
``output``: folder for the files of the study, a temporary one unless given. A later call with the same settings resumes it;
one with others replaces complete results.
``threads``: number of threads, all cores unless given; results do not depend on it.
``progress``: a function of stage, steps done and steps in all; ``True`` for a bar, ``False`` for none.
``shard``: part of the run to trace, as ``(k, n)`` with k from 1 to n; :func:`merge` joins the folders of all.

Raises ``ValueError`` for what other settings would help, ``TypeError`` for settings that the study does not
have, ``OSError`` for files, and :class:`asperity.Interrupted` with the results so far after Ctrl-C.
"""


def _listed(surface: _Surfaces | None) -> list[Surface | _Path]:
    """Surfaces as a list."""
    if surface is None:
        return []
    if isinstance(surface, (list, tuple)) and all(isinstance(one, (Surface, str, os.PathLike)) for one in surface):
        return list(surface)
    return [surface]  # type: ignore[list-item]


def trace(
    surface: _Surfaces | None = None,
    *,
    config: _Path | None = None,
    output: _Path | None = None,
    threads: int | None = None,
    progress: Progress = None,
    **options: Any,
) -> Result:
    """Traces light on given surfaces: one, or several as an ensemble; ``flat=True`` without one.

    >>> import asperity as asp
    >>> gold = asp.trace(flat=True, material="gold", wavelength="633nm", rays=1000)
    >>> round(float(gold.reflected), 2)
    0.94
    """
    call = Call("trace", options, positional=_listed(surface), config=config, threads=threads)
    return run_study(call, output, progress)


def gonio(
    surface: Surface | _Path | None = None,
    *,
    config: _Path | None = None,
    output: _Path | None = None,
    threads: int | None = None,
    progress: Progress = None,
    **options: Any,
) -> Result:
    """Measures BRDF and BTDF by direction, of a given surface or of random ones.

    >>> import asperity as asp
    >>> surface = asp.Surface.gaussian(size=128, tau=8, smoothness=3, seed=7)
    >>> data = asp.gonio(surface, eta=1.5, theta=[0, 30], rays=20_000)
    >>> data.brdf.shape[0]
    2
    """
    options = {"surface": surface, **options}
    return run_study(Call("gonio", options, config=config, threads=threads), output, progress)


def _of_random_surfaces(name: str, about: str) -> Callable[..., Result]:
    """Function of a study whose surfaces, random ones unless settings say otherwise, are settings too."""

    def study(
        config: _Path | None = None,
        *,
        output: _Path | None = None,
        threads: int | None = None,
        progress: Progress = None,
        **options: Any,
    ) -> Result:
        return run_study(Call(name, options, config=config, threads=threads), output, progress)

    study.__name__ = study.__qualname__ = name
    study.__doc__ = about
    return study


verify = _of_random_surfaces(
    "verify",
    """Compares light on random surfaces with statistical models, by tests with error bars.

    >>> import asperity as asp
    >>> study = asp.verify(smoothness=3, eta=1.4, theta=30, models=["smith"], rays=20_000)
    >>> study.summary["comparison"]["conclusion"].partition(":")[0]
    'Single scattering, tested at level 0.01'
    """,
)
map = _of_random_surfaces(  # noqa: A001
    "map", "Maps over a grid of roughness, material and direction where each model is within tolerance."
)
albedo = _of_random_surfaces("albedo", "Tabulates directional albedos for renderers.")
converge = _of_random_surfaces("converge", "Measures run time against error of the estimators.")
attenuation = _of_random_surfaces(
    "attenuation", "Compares shadowing and masking, counted on surfaces, with Smith and V-cavities."
)

for _study in (trace, gonio, verify, map, albedo, converge, attenuation):
    _study.__doc__ = f"{inspect.cleandoc(_study.__doc__)}\n{_NOTE}" if _study.__doc__ else None
    documented(_study.__name__)(_study)


def materials(name: _Path | None = None, wavelength: Any = None) -> Any:
    """Materials that are known by name, or the optical constants of one, as ``asperity materials --json``.

    ``name``: a material of the list, or a file .yml or .csv. ``wavelength``: in nm, one or several.

    >>> import asperity as asp
    >>> gold = asp.materials("gold", wavelength=633)["constants"][0]
    >>> round(gold["n"], 2), round(gold["k"], 1)
    (0.18, 3.4)
    """
    positional = [] if name is None else [name]
    return json.loads(Call("materials", {"wavelength": wavelength}, positional=positional).run().json)


def report(results: Result | _Path | Iterable[Result | _Path], path: _Path) -> None:
    """Writes a page, .html, that compares several results; of a single one :meth:`Result.report`."""
    folders = []
    for result in [results] if isinstance(results, (Result, str, os.PathLike)) else results:
        if isinstance(result, Result):
            result._draw()
            folders.append(result.folder)
        else:
            folders.append(result)  # type: ignore[arg-type]
    Call("report", {"output": path}, positional=folders).run()


def merge(
    shards: Result | _Path | Iterable[Result | _Path],
    output: _Path | None = None,
    *,
    partial: bool = False,
    threads: int | None = None,
    progress: Progress = None,
) -> Result:
    """Merges the shards of a run into its results, byte for byte those of the run without ``shard``.

    ``shards``: the folder of each, in any order. ``output``: folder for the results, a temporary one unless given.
    ``partial``: whether shards may be missing or not finished. Raises ``RuntimeError`` if they
    may not, or are not of one run.

    >>> import asperity as asp, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     settings = {"smoothness": 3, "theta": 30, "models": "none", "rays": 2000}
    ...     shards = [asp.verify(shard=(k, 2), output=f"{folder}/{k}", **settings) for k in (1, 2)]
    ...     round(float(asp.merge(shards).transmitted), 2)
    0.96
    """
    listed = [shards] if isinstance(shards, (Result, str, os.PathLike)) else shards
    folders = [shard.folder if isinstance(shard, Result) else shard for shard in listed]
    call = Call("merge", {"partial": partial}, positional=folders, threads=threads)
    return run_study(call, output, progress)

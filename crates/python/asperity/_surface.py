"""Surfaces: heights on a grid, drawn, read or given as arrays."""

from __future__ import annotations

import json
import os
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity import _core
from asperity._call import Call, Progress, documented, refuse

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from asperity._result import Result


class Surface:
    """Heights on a regular grid, shape ``(ny, nx)``, with spacing, unit and border. It never changes.

    ``heights``: any array-like of two dimensions, of which the surface has a copy; NaN and masked points are missing. Also a
    topography of SurfaceTopography or a surface of surfalize, with their spacing and unit.
    ``spacing``: distance between samples, or a pair along x and y; 1 unless given.
    ``unit``: of heights and spacing: "nm", "um", "mm", "m", "km", or "1" without a unit.
    ``border``: continuation beyond the border: "periodic", "mirrored" or "open"; mirrored unless given.
    ``y_is_north``: ``True`` if +y is the north of a map, for directions of the sun.

    >>> import asperity as asp
    >>> surface = asp.Surface([[0, 1, 0], [0, 2, 0]], spacing=0.5, unit="um")
    >>> surface.shape, surface.spacing
    ((2, 3), (0.5, 0.5))
    """

    __slots__ = ("__weakref__", "_map")

    _map: _core.HeightMap

    def __init__(
        self,
        heights: ArrayLike | Any,
        spacing: float | tuple[float, float] | None = None,
        unit: str | None = None,
        border: str | None = None,
        *,
        y_is_north: bool = False,
    ) -> None:
        if isinstance(heights, Surface) and not (spacing or unit or border or y_is_north):
            object.__setattr__(self, "_map", heights._map)
            return
        y_is_north = y_is_north or (isinstance(heights, Surface) and heights._map.y_is_north)
        heights, own_spacing, own_unit, own_border = _of_other_package(heights)
        if isinstance(heights, np.ma.MaskedArray):
            heights = np.ma.filled(heights.astype(np.float64), np.nan)
        if hasattr(heights, "dtype") and np.iscomplexobj(heights):
            raise TypeError("heights: must be real numbers")
        if unit is not None and own_unit not in (None, "1", _unit_of(unit)):
            raise ValueError(f"unit={unit}: the heights are in {own_unit}; multiply them and their spacing by the ratio of the units")
        unit = _unit_of(unit) or own_unit or "1"
        spacing = own_spacing if spacing is None else _pair_of(spacing)
        map = _core.HeightMap(heights, spacing, unit, border or own_border, y_is_north)
        object.__setattr__(self, "_map", map)

    @classmethod
    def _of(cls, map: _core.HeightMap) -> Surface:
        surface = object.__new__(cls)
        object.__setattr__(surface, "_map", map)
        return surface

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError(f"{name}: a surface never changes")

    @classmethod
    def random(cls, **options: Any) -> Surface:
        """Random surface of any kind that ``asperity generate`` draws.

        >>> import asperity as asp
        >>> asp.Surface.random(structure="v-grooves", width=16, depth=3, size=128).shape
        (128, 128)
        """
        refuse("random", options, "output", "realisations", "format")
        map = Call("generate", options).run().height_map
        assert map is not None
        return cls._of(map)

    @classmethod
    def gaussian(cls, **options: Any) -> Surface:
        """Random surface with a Gaussian autocorrelation.

        >>> import asperity as asp
        >>> asp.Surface.gaussian(size=(128, 64), tau="8um", smoothness=2, seed=7)
        Surface(64 x 128, spacing 1 x 1 um, periodic)
        """
        return cls.random(psd="gaussian", **options)

    @classmethod
    def exponential(cls, **options: Any) -> Surface:
        """Random surface with an exponential autocorrelation, which needs ``cut_off``."""
        return cls.random(psd="exponential", **options)

    @classmethod
    def matern(cls, **options: Any) -> Surface:
        """Random surface with an autocorrelation of the Matern family, which needs ``nu``."""
        return cls.random(psd="matern", **options)

    @classmethod
    def power_law(cls, **options: Any) -> Surface:
        """Random self-affine surface, which needs ``hurst``, ``roll_off`` and ``cut_off``."""
        return cls.random(psd="power-law", **options)

    @property
    def heights(self) -> NDArray[np.float64]:
        """Heights, shape ``(ny, nx)``, read-only and without a copy; NaN where a point is missing."""
        return self._map.heights

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns, ``(ny, nx)``."""
        ny, nx = self._map.heights.shape
        return ny, nx

    @property
    def spacing(self) -> tuple[float, float]:
        """Distance between samples along x and y."""
        dx, dy = self._map.spacing
        return dx, dy

    @property
    def unit(self) -> str:
        """Unit of heights and spacing: "nm", "um", "mm", "m", "km", or "1" without a unit."""
        return self._map.unit

    @property
    def border(self) -> str | None:
        """Continuation beyond the border: "periodic", "mirrored" or "open"; ``None`` if it was not given."""
        return self._map.border

    @property
    def missing(self) -> int:
        """Number of missing points."""
        return self._map.missing

    @property
    def notes(self) -> list[str]:
        """Notes on how the file was read, one sentence each."""
        return self._map.notes

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> NDArray[Any]:
        if copy or (dtype is not None and np.dtype(dtype) != np.float64):
            return np.array(self.heights, dtype=dtype)
        return self.heights

    def __repr__(self) -> str:
        ny, nx = self.shape
        dx, dy = self.spacing
        unit = "" if self.unit == "1" else f" {self.unit}"
        border = f", {self.border}" if self.border else ""
        missing = f", {self.missing} points missing" if self.missing else ""
        return f"Surface({ny} x {nx}, spacing {dx:g} x {dy:g}{unit}{border}{missing})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Surface) and self._map.path == other._map.path

    def __hash__(self) -> int:
        return hash(self._map.path)

    def __reduce__(self) -> tuple[Any, ...]:
        map = self._map
        spacing = self.spacing if map.spacing_is_known else None
        return _rebuilt, (np.asarray(self.heights), spacing, self.unit, self.border, map.y_is_north)

    def parameters(self, **options: Any) -> dict[str, Any]:
        """Roughness, slopes and parameters of ISO 25178-2, as ``asperity inspect`` has them.

        >>> import asperity as asp
        >>> surface = asp.Surface.gaussian(size=256, tau=8, smoothness=4, seed=1)
        >>> 1.8 < surface.parameters()["sq"] < 2.2
        True
        """
        refuse("parameters", options, "output", "plot")
        found = Call("inspect", options, positional=[self]).run()
        parameters: dict[str, Any] = json.loads(found.json)
        return parameters

    def filter(
        self,
        s: float | str | None = None,
        l: float | str | None = None,  # noqa: E741
        remove: str | None = None,
        **options: Any,
    ) -> Surface:
        """Surface without waves shorter than ``s`` and longer than ``l``, Gaussian filters of ISO 16610-61.

        ``s``, ``l``: cut-off wavelengths, as numbers in the unit of the surface or texts such as "2.5um".
        ``remove``: form to remove first: "mean", "plane" or "parabola".
        ``options``: further settings of ``asperity inspect``, such as ``missing="fill"``.

        >>> import asperity as asp
        >>> surface = asp.Surface.gaussian(size=256, tau=8, smoothness=4, seed=1)
        >>> smooth = surface.filter(s=20)
        >>> bool(smooth.heights.std() < surface.heights.std())
        True
        """
        refuse("filter", options, "s_filter", "l_filter", "output", "plot")
        options = {"s_filter": s, "l_filter": l, "remove": remove, **options}
        map = Call("inspect", options, positional=[self]).run().height_map
        assert map is not None
        return Surface._of(map)

    def trace(self, **options: Any) -> Result:
        """Light traced on this surface: :func:`asperity.trace`."""
        from asperity._studies import trace

        return trace(self, **options)

    def gonio(self, **options: Any) -> Result:
        """BRDF and BTDF of this surface by direction: :func:`asperity.gonio`."""
        from asperity._studies import gonio

        return gonio(self, **options)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a height map without missing points; the ending chooses the format: .exr, .npy, .gsf, .x3p or .png."""
        self._map.write(os.fspath(path))

    def mesh(self, path: str | os.PathLike[str], **options: Any) -> str:
        """Writes a triangle mesh, .obj, .ply or .stl, as ``asperity mesh``; returns what was written in words."""
        return Call("mesh", {**options, "output": path}, positional=[self]).run().text

    def render(self, path: str | os.PathLike[str], *, progress: Progress = None, **options: Any) -> str:
        """Renders a picture, .png or .exr, as ``asperity render``; returns what was written in words."""
        return Call("render", {**options, "output": path}, positional=[self]).run(progress).text

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the heights with matplotlib, and returns the axes."""
        from asperity._plot import heights

        return heights(self, ax)

    def _repr_html_(self) -> str:
        return f"<code>{self!r}</code>"


for _name in ("random", "gaussian", "exponential", "matern", "power_law"):
    _made = Surface.__dict__[_name].__func__
    _without = ("output", "realisations", "format")
    documented("generate", without=_without if _name == "random" else (*_without, "psd"))(_made)
documented("render", without=("surface",))(Surface.render)
documented("mesh", without=("output",))(Surface.mesh)
documented("inspect", without=("output", "plot", "s_filter", "l_filter"))(Surface.filter)
documented("inspect", without=("output", "plot"))(Surface.parameters)


def _unit_of(unit: str | None) -> str | None:
    """Name of a unit; "µm" with either of its two letters is "um"."""
    if unit is not None and not isinstance(unit, str):
        raise TypeError(f"unit: {type(unit).__name__} is no name of a unit")
    return {"µm": "um", "μm": "um"}.get(unit, unit) if unit is not None else None


def _pair_of(spacing: Any) -> tuple[float, float]:
    """Spacing along x and y."""
    try:
        dx, dy = np.broadcast_to(np.asarray(spacing, dtype=np.float64), 2).tolist()
    except (TypeError, ValueError):
        raise TypeError("spacing: must be a number, or two along x and y") from None
    return dx, dy


def _rebuilt(
    heights: NDArray[np.float64],
    spacing: tuple[float, float] | None,
    unit: str,
    border: str | None,
    y_is_north: bool,
) -> Surface:
    return Surface(heights, spacing, unit, border, y_is_north=y_is_north)


def _of_other_package(source: Any) -> tuple[Any, Any, str | None, str | None]:
    """Heights, spacing, unit and border of what was given; the latter ``None`` of an array."""
    if isinstance(source, Surface):
        spacing = source.spacing if source._map.spacing_is_known else None
        return source.heights, spacing, source.unit, source.border
    if callable(getattr(source, "heights", None)) and hasattr(source, "physical_sizes"):
        # SurfaceTopography has x along its first axis
        heights = np.ma.asarray(source.heights()).T
        nx, ny = source.nb_grid_pts
        size_x, size_y = source.physical_sizes
        cells = (nx, ny) if source.is_periodic else (nx - 1, ny - 1)
        unit = _unit_of(source.unit)
        border = "periodic" if source.is_periodic else None
        spacing = source.pixel_size if hasattr(source, "pixel_size") else (size_x / cells[0], size_y / cells[1])
        return heights, tuple(float(one) for one in spacing), unit, border
    if hasattr(source, "data") and hasattr(source, "step_x") and hasattr(source, "step_y"):
        # surfalize has all lengths in micrometres
        return np.asarray(source.data), (float(source.step_x), float(source.step_y)), "um", None
    return source, None, None, None


def read(path: str | os.PathLike[str]) -> Surface:
    """Reads a height map of any format of ``asperity``; the ending chooses it. Missing points are NaN.

    ``Surface(read(path), spacing=0.5, unit="um")`` sets what a file does not state.

    Raises ``FileNotFoundError`` if there is no such file, and ``OSError`` if it cannot be read as a height map.

    >>> import asperity as asp, os, tempfile
    >>> path = os.path.join(tempfile.mkdtemp(), "surface.exr")
    >>> asp.Surface.gaussian(size=128, seed=3).save(path)
    >>> asp.read(path).border
    'periodic'
    """
    return Surface._of(_core.HeightMap.read(os.fspath(path)))

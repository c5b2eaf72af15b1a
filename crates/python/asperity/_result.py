"""Results: a result folder as arrays, tables, figures, pages and files of other programs."""

from __future__ import annotations

import html
import json
import os
import shutil
import tempfile
import weakref
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from asperity import _core
from asperity._call import Call, Progress, documented, settings

if TYPE_CHECKING:
    import pandas
    import xarray
    from matplotlib.figure import Figure

#: Studies with light by direction.
_LIGHT = ("trace", "verify", "gonio")


class Interrupted(KeyboardInterrupt):
    """Ctrl-C during a run. ``result`` has the results so far, or is ``None`` if there are none."""

    def __init__(self, result: Result | None) -> None:
        super().__init__("interrupted" if result is None else "interrupted; result has the results so far")
        self.result = result


class Result:
    """Results of a study: the files of a result folder.

    The folder is temporary unless ``output`` named one, and lasts as long as the result. Text, notes and tables are
    those of the program, with its flags; arrays are read from the result file.

    >>> import asperity as asp
    >>> surface = asp.Surface.gaussian(size=128, tau=8, smoothness=3, seed=7)
    >>> result = surface.trace(eta=1.5, theta=30, rays=20_000)
    >>> result.brdf.shape, sorted(result.bins)
    ((18, 36), ['phi', 'theta'])
    >>> bool(abs(result.orders[0].sum() - result.reflected) < 1e-12)
    True
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        *,
        text: str | None = None,
        notes: list[str] | None = None,
        call: Call | None = None,
        keeper: TemporaryFolder | None = None,
    ) -> None:
        self.folder = Path(folder)
        self._notes = list(notes or [])
        self._text = text
        self._call = call
        self._keeper = keeper
        manifest = self.folder / "manifest.json"
        if not manifest.is_file():
            raise FileNotFoundError(f"{self.folder}: is no result folder; it has no manifest.json")
        self.manifest: dict[str, Any] = _json_of(manifest)
        if not {"command", "complete", "files"} <= self.manifest.keys():
            raise OSError(f"{manifest}: is no manifest of results")

    @property
    def command(self) -> str:
        """Name of the study."""
        return str(self.manifest["command"])

    @property
    def is_complete(self) -> bool:
        """``False`` if a time limit or an interrupt stopped the run."""
        return bool(self.manifest["complete"])

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Contents of ``summary.json``."""
        return _json_of(self.folder / "summary.json")

    @property
    def files(self) -> list[str]:
        """Names of the files of the results."""
        return sorted(self.manifest["files"])

    @property
    def notes(self) -> list[str]:
        """Notes on files, units, models and validity, one sentence each."""
        cases = [case.get("summary", {}) for case in self.summary.get("cases", []) if isinstance(case, dict)]
        warnings = [note for summary in (self.summary, *cases) for note in summary.get("warnings", [])]
        return list(dict.fromkeys([*self._notes, *warnings]))

    @property
    def tables(self) -> list[str]:
        """Names of the tables."""
        return [name.removesuffix(".csv") for name in self.files if name.endswith(".csv")]

    def to_dataframe(self, table: str | None = None) -> pandas.DataFrame:
        """A table as a data frame, the main one unless ``table`` names another of :attr:`tables`.

        A table that each case has a file of is one frame, with the folder of the case in the column ``case``.
        """
        import pandas

        names = self.tables
        ends = {name.rpartition("/")[2] for name in names}
        name = table or next((main for main in _MAIN if main in ends), names[0] if names else "")
        if name in names:
            return pandas.read_csv(self.folder / f"{name}.csv")
        of_cases = [one.rpartition("/")[0] for one in names if one.endswith(f"/{name}")]
        if not of_cases:
            raise ValueError(f"table={name}: must be one of {', '.join(sorted({*names, *ends}))}")
        frames = []
        for case in of_cases:
            frame = pandas.read_csv(self.folder / case / f"{name}.csv")
            frame.insert(0, "case", case)
            frames.append(frame)
        return pandas.concat(frames, ignore_index=True)

    @cached_property
    def _labelled(self) -> dict[str, Any]:
        if self.command not in _LIGHT:
            raise ValueError(f"results of {self.command} have no light by direction; to_dataframe() has their tables")
        return _core.labelled(str(self.folder))

    def to_xarray(self) -> xarray.Dataset:
        """Labelled arrays: BSDF and fluxes with standard errors over the settings, the light and common bins.

        ``bsdf_exact`` has the bins of each direction where they differ, ``flux_order`` the flux by order of scattering,
        and ``mueller`` the Mueller matrices, if they were recorded. Of other studies the main table.
        """
        import xarray

        if self.command not in _LIGHT:
            return xarray.Dataset.from_dataframe(self.to_dataframe())
        variables = self._labelled["variables"]
        coordinates = {name for name, (dims, _, _) in variables.items() if (name,) == dims}
        for _, _, attributes in variables.values():
            coordinates.update(attributes.get("coordinates", "").split())
        arrays = {name: xarray.Variable(*variable) for name, variable in variables.items()}
        for variable in arrays.values():
            variable.attrs.pop("coordinates", None)
        return xarray.Dataset(
            {name: variable for name, variable in arrays.items() if name not in coordinates},
            {name: variable for name, variable in arrays.items() if name in coordinates},
            self._labelled["attributes"],
        )

    def _array(self, name: str, side: int | None = None) -> NDArray[np.float64]:
        """An array without the axes of a single setting, of one side or of both."""
        dims, values, _ = self._labelled["variables"][name]
        at = dims.index("side")
        if side is not None:
            values = values[(slice(None),) * at + (side,)]
        return values[tuple(0 if length == 1 else slice(None) for length in values.shape[:at])]  # type: ignore[no-any-return]

    def _bsdf(self, side: int, suffix: str = "") -> NDArray[np.float64]:
        exact = "bsdf_exact" in self._labelled["variables"]
        return self._array(f"bsdf_exact{suffix}" if exact else f"bsdf{suffix}", side)

    @property
    def axes(self) -> dict[str, NDArray[Any]]:
        """Values of the settings and directions along the leading axes of arrays, in their order: ascending, whatever the order given.

        >>> import asperity as asp
        >>> mirror = asp.gonio(smoothness=3, eta=1.5, theta=[60, 0], rays=2000, size=64, tau=8)
        >>> mirror.axes["theta_i"].tolist(), mirror.reflected.shape
        ([0.0, 60.0], (2,))
        """
        variables = self._labelled["variables"]
        dims, values, _ = variables["flux"]
        axes = zip(dims[:-1], values.shape[:-1])
        return {name: variables[name][1] for name, length in axes if length > 1}

    @property
    def reflected(self) -> NDArray[np.float64]:
        """Reflected fraction of the flux: a number, or an array over the settings and directions of the light."""
        return self._array("flux", 0)

    @property
    def reflected_se(self) -> NDArray[np.float64]:
        """Standard error of :attr:`reflected`."""
        return self._array("flux_se", 0)

    @property
    def transmitted(self) -> NDArray[np.float64]:
        """Transmitted fraction of the flux."""
        return self._array("flux", 1)

    @property
    def transmitted_se(self) -> NDArray[np.float64]:
        """Standard error of :attr:`transmitted`."""
        return self._array("flux_se", 1)

    @property
    def brdf(self) -> NDArray[np.float64]:
        """BRDF in 1/sr over the bins of the run, ``(..., n_theta, n_phi)``, from the normal outwards."""
        return self._bsdf(0)

    @property
    def brdf_se(self) -> NDArray[np.float64]:
        """Standard error of :attr:`brdf`."""
        return self._bsdf(0, "_se")

    @property
    def btdf(self) -> NDArray[np.float64]:
        """BTDF in 1/sr over the bins of the run, ``(..., n_theta, n_phi)``, from the normal below outwards."""
        return self._bsdf(1)

    @property
    def btdf_se(self) -> NDArray[np.float64]:
        """Standard error of :attr:`btdf`."""
        return self._bsdf(1, "_se")

    @property
    def bins(self) -> dict[str, NDArray[np.float64]]:
        """Edges of the bins in degrees: ``theta`` from the normal of the side and ``phi``, each ``(bins, 2)``.

        Where bins follow narrow lobes, as in ``gonio`` without ``bins``, they are those of each direction and side:
        ``(..., side, bins, 2)``. With ``bins="36x72"`` all are the same.
        """
        variables = self._labelled["variables"]
        if "theta_o_exact" in variables:
            return {"theta": self._array("theta_o_exact"), "phi": self._array("phi_o_exact")}
        return {"theta": variables["theta_o_bounds"][1], "phi": variables["phi_o_bounds"][1]}

    @property
    def orders(self) -> NDArray[np.float64]:
        """Fraction of the flux by side, reflected and transmitted, and order of scattering; the last stands for all above."""
        return self._array("flux_order")

    @property
    def orders_se(self) -> NDArray[np.float64]:
        """Standard error of :attr:`orders`."""
        return self._array("flux_order_se")

    @property
    def mueller(self) -> NDArray[np.float64]:
        """BSDF as Mueller matrices, ``(..., side, n_theta, n_phi, 4, 4)``, with ``polarisation="mueller"``.

        They are as recorded: their first elements have no control variate, and larger errors than :attr:`brdf`.
        """
        if "mueller" not in self._labelled["variables"]:
            raise ValueError('Mueller matrices were not recorded; trace with polarisation="mueller"')
        return self._array("mueller")

    @property
    def mueller_se(self) -> NDArray[np.float64]:
        """Standard error of :attr:`mueller`."""
        self.mueller  # noqa: B018
        return self._array("mueller_se")

    def export(self, path: str | os.PathLike[str], format: str, **options: Any) -> str:
        """Writes a file of another program, as ``asperity export``; returns what it holds in words.

        ``format``: "netcdf", "klems", "tensor-tree", "rgl", "rgl-rgb", "pbsdf", "zemax", "fit" or "ssdd".
        """
        options = {**options, "format": format, "output": path}
        return Call("export", options, positional=[self.folder]).run().text

    def report(self, path: str | os.PathLike[str]) -> None:
        """Writes a page of the results, .html, which needs no network. Figures of complete results are drawn first if they are missing."""
        self._draw()
        Call("report", {"output": path}, positional=[self.folder]).run()

    def _draw(self) -> None:
        """Draws the figures that a call left out, of complete results, which are resumed without tracing anything."""
        has_figures = any(name.endswith(".svg") for name in self.files)
        if self._call is None or has_figures or not self.is_complete or not (self.folder / "results.npz").is_file():
            return
        self._call.without_flag("no-plots").run()
        self.manifest = _json_of(self.folder / "manifest.json")

    def plot(self) -> Figure:
        """Draws lobes as polar maps, or the first figure of a study without light by direction; returns the figure."""
        from asperity import _plot

        if self.command in _LIGHT:
            return _plot.lobes(self)
        self._draw()
        return _plot.first_figure(self)

    def save(self, folder: str | os.PathLike[str]) -> Path:
        """Copies the results to ``folder``, which must not exist; :func:`asperity.load` reads it."""
        Path(folder).mkdir()
        _write(Path(folder), self._contents())
        return Path(folder)

    def _contents(self) -> dict[str, bytes]:
        """Contents of the files of the results, and of their manifest."""
        names = [name for name in [*self.files, "manifest.json"] if (self.folder / name).is_file()]
        return {name: (self.folder / name).read_bytes() for name in names}

    def __getstate__(self) -> dict[str, Any]:
        return {"files": self._contents(), "text": self._text, "notes": self._notes}

    def __setstate__(self, state: dict[str, Any]) -> None:
        keeper = TemporaryFolder()
        _write(Path(keeper.name), state["files"])
        self.__init__(keeper.name, text=state["text"], notes=state["notes"], keeper=keeper)  # type: ignore[misc]

    def __repr__(self) -> str:
        if self._text is not None:
            return self._text.rstrip()
        state = "" if self.is_complete else ", unfinished"
        return f"results of {self.command} in {self.folder}{state}: tables {', '.join(self.tables)}"

    def _repr_html_(self) -> str:
        return f"<pre>{html.escape(repr(self))}</pre>"


documented("export", without=("output", "format"))(Result.export)

#: Main tables of the studies.
_MAIN = ("gonio", "histogram", "map", "albedo", "convergence", "attenuation")


class TemporaryFolder:
    """Folder that lasts as long as this object, or the process that made it."""

    def __init__(self) -> None:
        self.name = tempfile.mkdtemp(prefix="asperity-")
        self._finalizer = weakref.finalize(self, _remove, self.name, os.getpid())


def _remove(folder: str, owner: int) -> None:
    # A forked process has the object too
    if os.getpid() == owner:
        shutil.rmtree(folder, ignore_errors=True)


def _json_of(file: Path) -> dict[str, Any]:
    """Contents of a JSON file of results."""
    try:
        found = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise FileNotFoundError(f"{file}: is missing from the results") from None
    except ValueError as error:
        raise OSError(f"{file}: is damaged: {error}") from None
    if not isinstance(found, dict):
        raise OSError(f"{file}: is damaged: it holds no object")
    return found


def _write(folder: Path, files: dict[str, bytes]) -> None:
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def load(folder: str | os.PathLike[str]) -> Result:
    """Results of any result folder, of the program or of a call with ``output``.

    Raises ``FileNotFoundError`` if it is none.
    """
    return Result(folder)


def run_study(call: Call, output: str | os.PathLike[str] | None, progress: Progress) -> Result:
    """Runs a study in a folder, a temporary one unless ``output`` is given."""
    keeper = TemporaryFolder() if output is None else None
    folder = os.fspath(output) if keeper is None else keeper.name  # type: ignore[arg-type]
    call = call.with_flag("output", folder)
    flags = {flag for flag, _ in call.flags}
    if keeper is not None and "no-plots" not in flags:
        if any(setting["flag"] == "no-plots" for setting in settings(call.command)):
            call = call.with_flag("no-plots")
    found = call.outcome(progress)
    result = None
    if found.has_results:
        result = Result(folder, text=found.text, notes=found.notes, call=call, keeper=keeper)
    if isinstance(found.interrupt, KeyboardInterrupt):
        raise Interrupted(result) from None
    if found.interrupt is not None:
        raise found.interrupt
    assert result is not None
    return result

"""Statistical scattering models of rough surfaces.

Each model of ``models.names()`` is a function of this module, with underscores, that takes the settings of
``asperity model``: ``models.smith(smoothness=3, eta=1.5)``, ``models.ggx(slopes="ggx", ggx_alpha=0.3, eta=1.5)``.

>>> import numpy as np
>>> from asperity import models
>>> smith = models.smith(smoothness=3, eta=1.5)
>>> wi = models.direction(30)
>>> wo = models.direction([10, 30, 50], 180)
>>> f = smith.eval(wi, wo)
>>> f.shape, bool(np.all(f > 0))
((3,), True)
"""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from asperity import _core
from asperity._call import Call

if TYPE_CHECKING:
    import pandas


class Model:
    """A statistical scattering model. Directions are unit vectors, the last axis of any array-like; ``wi`` points to the light, z > 0.

    Directions and results broadcast as NumPy has it. A direction ``wo`` with z > 0 is reflected, with z < 0 transmitted.
    """

    __slots__ = ("_call", "_model")

    def __init__(self, name: str, **options: Any) -> None:
        self._call = (name, options)
        self._model = _core.Model(Call("model", options, positional=[name]).parts())

    @property
    def name(self) -> str:
        """Name of the model."""
        return self._model.name

    @property
    def description(self) -> str:
        """Light that the model describes, with its source."""
        return self._model.description

    @property
    def valid_range(self) -> str:
        """Surfaces that the model holds for."""
        return self._model.valid_range

    @property
    def notes(self) -> list[str]:
        """Notes on the slopes, one sentence each."""
        return self._model.notes

    def eval(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """BSDF of single scattering in 1/sr, without the cosine; :func:`evaluate` has the multiple scattering of models that follow rays."""
        return self._at_pairs(self._model.eval, wi, wo)

    def pdf(self, wi: ArrayLike, wo: ArrayLike) -> NDArray[np.float64]:
        """Density of :meth:`sample` in 1/sr. Its integral is the probability that a sample is a direction."""
        return self._at_pairs(self._model.pdf, wi, wo)

    def sample(self, wi: ArrayLike, rng: np.random.Generator | int) -> NDArray[np.float64]:
        """Directions drawn by visible facets, one for each of ``wi``; NaN where a facet sends the light to the wrong side, which
        counts as zero.

        ``rng``: a generator of NumPy or a seed.
        """
        rng = np.random.default_rng(rng)
        incident, shape = _rows(wi)
        drawn = self._model.sample(incident, int(rng.integers(2**63)))
        return drawn.reshape((*shape, 3))

    def albedo(self, wi: ArrayLike) -> NDArray[np.float64]:
        """Reflected and transmitted fractions of the flux of single scattering, the last axis, by quadrature."""
        incident, shape = _rows(wi)
        return self._model.albedo(incident).reshape((*shape, 2))

    @staticmethod
    def _at_pairs(
        of: Callable[[NDArray[np.float64], NDArray[np.float64]], NDArray[np.float64]], wi: ArrayLike, wo: ArrayLike
    ) -> NDArray[np.float64]:
        first, second = np.broadcast_arrays(_directions(wi), _directions(wo))
        shape = first.shape[:-1]
        return of(np.ascontiguousarray(first).reshape(-1, 3), np.ascontiguousarray(second).reshape(-1, 3)).reshape(shape)

    def __reduce__(self) -> tuple[Any, ...]:
        return _rebuilt, self._call

    def __repr__(self) -> str:
        name, options = self._call
        settings = ", ".join(f"{key}={value!r}" for key, value in options.items())
        return f"models.{name.replace('-', '_')}({settings})"


def _rebuilt(name: str, options: dict[str, Any]) -> Model:
    return Model(name, **options)


def _directions(directions: ArrayLike) -> NDArray[np.float64]:
    array = np.asarray(directions, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ValueError(f"directions: the last axis must have three components, and the shape is {array.shape}")
    squares = np.square(array).sum(axis=-1)
    if np.any(np.abs(squares - 1.0) > 1e-6):
        raise ValueError("directions: must be unit vectors; divide them by their lengths")
    return array


def _rows(directions: ArrayLike) -> tuple[NDArray[np.float64], tuple[int, ...]]:
    array = _directions(directions)
    return np.ascontiguousarray(array).reshape(-1, 3), array.shape[:-1]


def direction(theta: ArrayLike, phi: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Unit vectors of polar angles and azimuths in degrees, which broadcast.

    >>> from asperity import models
    >>> models.direction(90).round(12).tolist()
    [1.0, 0.0, 0.0]
    """
    theta, phi = np.broadcast_arrays(np.radians(theta), np.radians(phi))
    return np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)


def names() -> list[str]:
    """Names of all models, as the program spells them."""
    return [entry["name"] for entry in describe()]


def describe() -> list[dict[str, Any]]:
    """Name, description, valid range and more of each model, as ``asperity model --list --json``."""
    return cast("list[dict[str, Any]]", json.loads(Call("model", {}).run().json))


def evaluate(name: str, **options: Any) -> pandas.DataFrame:
    """Values of any model as ``asperity model`` lists them: by direction, or over bins with ``bins`` and for models that follow rays."""
    import pandas

    return pandas.read_csv(io.StringIO(Call("model", options, positional=[name]).run().table))


def __getattr__(name: str) -> Callable[..., Model]:
    spelt = name.replace("_", "-")
    if name.startswith("_") or spelt not in names():
        raise AttributeError(f"there is no model {name}; names() lists them")

    def model(**options: Any) -> Model:
        return Model(spelt, **options)

    model.__name__ = model.__qualname__ = name
    model.__doc__ = next(entry["description"] for entry in describe() if entry["name"] == spelt)
    globals()[name] = model
    return model


def __dir__() -> list[str]:
    return sorted([*globals(), *(name.replace("-", "_") for name in names())])

"""Calls: keyword arguments as the flags of a command, and functions whose signature and documentation follow from its settings."""

from __future__ import annotations

import inspect
import os
import reprlib
import sys
from collections.abc import Callable, Iterable, Mapping
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity import _core

if TYPE_CHECKING:
    from asperity._surface import Surface

#: Progress of a call: a function of stage, steps done and steps in all; ``True`` for a bar; ``False`` for none.
Progress = bool | Callable[[str, int, int], object] | None

#: Settings of random surfaces that a given surface is a model for.
_LIKE = ("psd", "heights")


#: Names of positional arguments; those of other commands are surfaces.
_POSITIONAL = {"model": "name", "materials": "name", "export": "folder", "report": "folder", "merge": "folder"}


class Call:
    """Call of a command: positional arguments, configuration and flags, and the surfaces that they name."""

    def __init__(
        self,
        command: str,
        options: Mapping[str, object],
        *,
        positional: Iterable[object] = (),
        config: str | os.PathLike[str] | None = None,
        threads: int | None = None,
    ) -> None:
        self.command = command
        self.surfaces: list[Surface] = []
        self.configuration = None if config is None else (os.fspath(config), _text_of_file(config))
        known = {setting["name"]: setting for setting in settings(command)}
        self.positional = [self._text(_POSITIONAL.get(command, "surface"), value) for value in positional]
        self.flags: list[tuple[str, list[str]]] = []
        for name, value in {"threads": threads, **options}.items():
            setting = known.get(name)
            values = self._values(name, value, setting)
            if values is not None:
                # The core says which commands have a flag that this one lacks
                self.flags.append((setting["flag"] if setting else name.replace("_", "-"), values))

    def _values(self, name: str, value: object, setting: dict[str, Any] | None) -> list[str] | None:
        """Texts of a flag; ``None`` where it is not given."""
        if value is None:
            return None
        if setting is not None and setting["kind"] == "switch":
            if not isinstance(value, (bool, np.bool_)):
                raise TypeError(f"{name}={_shown(value)}: must be True or False")
            return [] if value else None
        if setting is not None and setting["is_repeated"] and _is_list(value):
            return [self._text(name, one) for one in value]  # type: ignore[attr-defined]
        return [self._text(name, value)]

    def _text(self, name: str, value: object) -> str:
        """Text of a value on the command line."""
        from asperity._surface import Surface

        if isinstance(value, Surface):
            self.surfaces.append(value)
            return f"like:{value._map.path}" if name in _LIKE else value._map.path
        if isinstance(value, (str, os.PathLike)):
            text = os.fsdecode(value)
            if any("\ud800" <= character <= "\udfff" for character in text):
                raise ValueError(f"{name}={_shown(text)}: must be Unicode, without bytes of another encoding")
            return text
        if name == "surface":
            raise TypeError(
                f"surface: {type(value).__name__} is neither a Surface nor a file; asp.Surface(heights, spacing, unit) is one of an array"
            )
        if isinstance(value, (bool, np.bool_)):
            raise TypeError(f"{name}={_shown(value)}: must not be True or False")
        if isinstance(value, Integral):
            return str(int(value))
        if isinstance(value, Real):
            return repr(float(value))
        if isinstance(value, np.ndarray):
            value = value.ravel().tolist()
        if name == "shard" and isinstance(value, tuple):
            return "/".join(self._text(name, one) for one in value)
        if _is_list(value):
            if not value:
                return "none"
            return ",".join(self._text(name, one) for one in value)  # type: ignore[attr-defined]
        raise TypeError(f"{name}: {type(value).__name__} is neither a number, a text nor a list of these")

    def with_flag(self, name: str, *values: str) -> Call:
        """This call with a further flag."""
        other = object.__new__(Call)
        other.__dict__.update(self.__dict__, flags=[*self.flags, (name, list(values))])
        return other

    def without_flag(self, name: str) -> Call:
        """This call without a flag."""
        other = object.__new__(Call)
        other.__dict__.update(self.__dict__, flags=[flag for flag in self.flags if flag[0] != name])
        return other

    def parts(self) -> _core._Call:
        """The call as the core takes it."""
        return {
            "positional": self.positional,
            "configuration": self.configuration,
            "flags": self.flags,
        }

    def outcome(self, progress: Progress) -> _core.Output:
        """Results, with the exception that stopped the run."""
        from asperity._progress import reporter

        with reporter(progress) as tell:
            return _core.run(self.command, self.parts(), tell)

    def run(self, progress: Progress = False) -> _core.Output:
        """Results. An interrupt is raised."""
        output = self.outcome(progress)
        if output.interrupt is not None:
            raise output.interrupt
        return output


def _shown(value: object) -> str:
    """A value as Python writes it, within a line."""
    return reprlib.repr(value)


def _is_list(value: object) -> bool:
    return isinstance(value, Iterable) and not isinstance(value, (str, bytes, Mapping))


def _text_of_file(path: str | os.PathLike[str]) -> str:
    with open(path, encoding="utf-8") as file:
        return file.read()


_SETTINGS: dict[str, list[dict[str, Any]]] = {}


def settings(command: str) -> list[dict[str, Any]]:
    """Settings of a command, one dictionary each: name, kind, default, unit, allowed values and help.

    >>> import asperity as asp
    >>> next(s for s in asp.settings("trace") if s["name"] == "theta")["unit"]
    'degrees'
    """
    if command not in _SETTINGS:
        _SETTINGS[command] = _core.settings(command)
    return [dict(setting) for setting in _SETTINGS[command]]


def refuse(function: str, options: Mapping[str, object], *names: str) -> None:
    """Refuses settings of the command that a function does not have."""
    for name in names:
        if options.get(name) is not None:
            raise TypeError(f"{function}() has no argument `{name}`")


def documented(command: str, without: tuple[str, ...] = ()) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Gives a function with ``**options`` the signature and the documentation of the settings of ``command``."""

    def decorate(function: Callable[..., Any]) -> Callable[..., Any]:
        signature = inspect.signature(function)
        own = [p for p in signature.parameters.values() if p.kind is not inspect.Parameter.VAR_KEYWORD]
        taken = {parameter.name for parameter in own} | set(without)
        offered = [setting for setting in settings(command) if setting["name"] not in taken]
        options = [
            inspect.Parameter(setting["name"], inspect.Parameter.KEYWORD_ONLY, default=None) for setting in offered
        ]
        function.__signature__ = signature.replace(parameters=[*own, *options])  # type: ignore[attr-defined]
        if sys.flags.optimize < 2:
            entries = "\n".join(_entry(setting) for setting in offered)
            function.__doc__ = f"{inspect.cleandoc(function.__doc__ or '')}\n\nSettings\n--------\n{entries}\n"
        return function

    return decorate


def _entry(setting: dict[str, Any]) -> str:
    default = setting["default"] if setting["default"] is not None else setting["otherwise"]
    kind = "True or False" if setting["kind"] == "switch" else setting["allowed"]
    usual = f"; default: {default}" if default and setting["kind"] != "switch" else ""
    return f"{setting['name']}\n    {setting['help']}: {kind}{usual}."

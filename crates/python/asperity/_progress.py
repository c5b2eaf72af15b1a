"""Progress: a bar in terminals and notebooks, or a function of the caller's."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from asperity._call import Progress

_Tell = Callable[[str, int, int], object]


@contextmanager
def reporter(progress: Progress) -> Iterator[_Tell | None]:
    """Function that is called with the progress of a run, or ``None``; a bar is closed at the end."""
    if callable(progress):
        yield progress
        return
    if progress is not None and not isinstance(progress, bool):
        raise TypeError(f"progress: {type(progress).__name__} is neither a function, True, False nor None")
    bar = _bar() if progress or (progress is None and _is_watched()) else None
    if bar is None:
        yield None
        return
    try:
        yield bar.tell
    finally:
        bar.close()


def _is_watched() -> bool:
    """``True`` on a terminal and in a notebook."""
    return "ipykernel" in sys.modules or (sys.stderr is not None and sys.stderr.isatty())


def _bar() -> _Bar | None:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return None
    return _Bar(tqdm)


class _Bar:
    """Bar of tqdm, a new one per stage."""

    def __init__(self, tqdm: Any) -> None:
        self._tqdm = tqdm
        self._stage = ""
        self._bar: Any = None

    def tell(self, stage: str, done: int, total: int) -> None:
        if total == 0:
            return
        if stage != self._stage or self._bar is None:
            self.close()
            self._stage = stage
            self._bar = self._tqdm(total=total, desc=stage, leave=False)
        self._bar.total = total
        self._bar.update(done - self._bar.n)

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None

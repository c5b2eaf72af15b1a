"""Wrong arguments: thousands at random end in an exception of Python's kinds, never in a crash or a panic."""

import random

import numpy as np
import pytest

import asperity as asp
from asperity import models
from asperity._call import settings

COUNT = 10_000
VALUES = [
    None, True, False, 0, -1, 1, 3, 2**63, 2**200, -(2**70), 1e400, 1e-320, 0.1, -0.0, float("nan"), float("inf"), 1j, "", " ", "none",
    "auto", "?!", "-", "--theta 3", "1e99um", "5 parsec", "\0", "\ud800", "ä" * 5000, "0:90:1e-9", "1/0", "../../etc/passwd", "gold",
    b"bytes", [], [[]], [1, "x"], [None], ["nan"], [1] * 1000, (1, 2), {}, {"a": 1}, object(), print, np.nan, np.float32(3),
    np.array(2), np.array([]), np.zeros((2, 2)), np.array(["a"]), np.datetime64("now"), range(3), iter([1]), Exception, ...,
]  # fmt: skip
ALLOWED = (ValueError, TypeError, OSError, RuntimeError, OverflowError, AttributeError)
SURFACE = asp.Surface.gaussian(size=64, tau=4, smoothness=3, seed=1)
RESULT = SURFACE.trace(eta=1.5, rays=1000)


def random_calls(rng):
    """Functions with arguments of which at least one is wrong."""
    studies = ["trace", "verify", "map", "gonio", "albedo", "converge", "attenuation"]
    names = {command: [s["name"] for s in settings(command)] for command in [*studies, "generate", "inspect", "model", "export"]}
    while True:
        command = rng.choice([*names, "surface", "eval"])
        if command == "surface":
            yield asp.Surface, [rng.choice(VALUES)], {name: rng.choice(VALUES) for name in rng.sample(["spacing", "unit", "border"], 2)}
        elif command == "eval":
            smith = models.smith(smoothness=3, eta=1.5)
            yield rng.choice([smith.eval, smith.pdf]), [rng.choice(VALUES), rng.choice(VALUES)], {}
        else:
            # One that no study has keeps calls from running; others of those names are read before it is refused
            chosen = {name: rng.choice(VALUES) for name in rng.sample(names[command], min(4, len(names[command])))}
            chosen.pop("output", None)
            if rng.random() < 0.5:
                chosen[rng.choice(["thta", "wrong", "__class__", "rays "])] = rng.choice(VALUES)
            else:
                chosen["seed" if "seed" in names[command] else "side"] = rng.choice(["?", -1, "x" * 100, [1, 2], 1.5])
            function = {"generate": asp.Surface.random, "inspect": SURFACE.parameters, "export": lambda **options: RESULT.export("x", "rgl", **options),
                        "model": lambda **options: models.Model("smith", **options)}.get(command) or getattr(asp, command)
            yield function, [], chosen


@pytest.mark.parametrize("seed", [1, 2])
def test_wrong_arguments_raise_exceptions(seed, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    rng = random.Random(seed)
    refused = 0
    for _, (function, arguments, options) in zip(range(COUNT // 2), random_calls(rng)):
        options.setdefault("progress", False) if function.__name__ in ("trace", "verify", "map", "gonio") else None
        try:
            function(*arguments, **options)
        except ALLOWED as error:
            refused += 1
            assert type(error).__name__ != "PanicException" and str(error), (function, options)
            assert len(str(error)) < 8000
    assert refused > 0.9 * COUNT / 2
    assert not list(tmp_path.iterdir())

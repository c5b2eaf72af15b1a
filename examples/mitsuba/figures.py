"""Figures 10 to 13 of the transmission paper of Xu and Sun, by its Eq. 25, by Smith's masking, and by explicit surfaces.

    python figures.py TABLES OUTPUT [NUMBER ...]

TABLES holds `sS.nc`, tables of rough interfaces of index 1.4 and smoothness S (docs/how_it_works/rendering.md has the commands). Panels of the models are scaled to their
largest value, as in the paper, and linear; those of the differences are to one scale. Needs numpy, scipy, matplotlib and mitsuba.
"""

import argparse
from pathlib import Path

import matplotlib
import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_mono")
mi.set_log_level(mi.LogLevel.Error)
import asperity_bsdf  # noqa: E402, F401
import meshes  # noqa: E402

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

ETA = 1.4
SIZE = 160
Transform = mi.ScalarTransform4f


def materials(tables, s):
    """A rough surface over a medium of index 1.4, by name of the model."""
    smith = {"type": "roughdielectric", "distribution": "beckmann", "alpha": 2 / s, "int_ior": ETA, "ext_ior": 1.0}
    return {
        "Eq. 25": {"type": "xu_sun", "s": s, "eta": ETA},
        "Smith": smith,
        "explicit": {"type": "asperity_table", "filename": str(tables / f"s{s:g}.nc")},
    }


def camera(distance, width, target=(0.0, 0.0, 0.0)):
    """Looks along -z at a square of `width` about `target`."""
    place = np.add(target, (0, 0, distance)).tolist()
    return {
        "type": "perspective",
        "fov": float(np.degrees(2 * np.arctan(0.5 * width / distance))),
        "to_world": Transform().look_at(place, list(target), [0, 1, 0]),
        "film": {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}},
    }


def picture(scene, depth, spp, passes=1):
    scene = mi.load_dict({"type": "scene", "integrator": {"type": "path", "max_depth": depth, "rr_depth": 100}, **scene})
    return np.mean([np.array(mi.render(scene, spp=spp, seed=seed))[..., 0] for seed in range(passes)], axis=0)


def plate(material, is_dense, light):
    """The face of an object of semi-infinite depth, one unit wide, with the light inside.

    `is_dense`: the object has index 1.4 and the eye is in air; otherwise the other way round, and the face is turned over.
    """
    turn = Transform() if is_dense else Transform().rotate([1, 0, 0], 180)
    face = {"type": "rectangle", "to_world": turn @ Transform().scale(0.5), "bsdf": material}
    return picture({"face": face, "light": light, "camera": camera(0.8, 1.0)}, 2, 16)


def sculpture(material, mesh):
    """A sculpture lit from behind, seen from three quarters of its size."""
    middle, size = mesh["middle"], mesh["size"]
    scene = {
        "sculpture": {"type": "ply", "filename": mesh["filename"], "face_normals": True, "bsdf": material},
        "light": {"type": "directional", "direction": [0, 0, 1], "irradiance": 1.0},
        "camera": camera(0.75 * size, 1.25 * size, middle),
    }
    return picture(scene, 16, 32, 8)


def figure(filename, title, rows, cases, compute, limit=0.3):
    """Panels of every model, and their differences from the explicit surfaces, one row per case.

    `limit`: end of the scale of the differences.
    """
    names = ["Eq. 25", "Smith", "explicit"]
    fig, axes = plt.subplots(len(rows), 5, figsize=(8.5, 1.68 * len(rows) + 0.75), squeeze=False, layout="constrained")
    fig.suptitle(title, fontsize=10)
    for line, (label, case) in zip(axes, zip(rows, cases)):
        images = compute(case)
        exact = images["explicit"]
        printed = [filename.name, label]
        for axis, name in zip(line, names):
            image = images[name]
            axis.imshow(image / white(image), cmap="gray", vmin=0, vmax=1)
            text = f"max {white(image) / white(exact):.2f}, sum {image.sum() / exact.sum():.3f}"
            axis.set_xlabel(text, fontsize=6, labelpad=1)
            printed.append(f"{name}: {text}")
        for axis, name in zip(line[3:], names):
            shown = axis.imshow((images[name] - exact) / white(exact), cmap="RdBu_r", vmin=-limit, vmax=limit)
            text = f"differences {np.abs(blocks(images[name]) - blocks(exact)).sum() / blocks(exact).sum():.3f}"
            axis.set_xlabel(text, fontsize=6, labelpad=1)
            printed.append(f"{name}: {text}")
        line[0].set_ylabel(label, fontsize=8)
        print(*printed, sep="; ", flush=True)
    for axis, name in zip(axes[0], [*names, "Eq. 25 less explicit", "Smith less explicit"]):
        axis.set_title(name, fontsize=8)
    for axis in axes.flat:
        axis.set(xticks=[], yticks=[])
    bar = fig.colorbar(shown, ax=axes[:, 3:], orientation="horizontal", extend="both", shrink=0.7, pad=0.01, aspect=40)
    bar.set_ticks([-limit, -limit / 2, 0, limit / 2, limit])
    bar.ax.tick_params(labelsize=6)
    bar.set_label("in units of the maximum of the explicit image", fontsize=6)
    fig.savefig(filename, dpi=110)


def blocks(image):
    """Means over blocks of 8 x 8 pixels, which noise hardly changes."""
    return image.reshape(SIZE // 8, 8, SIZE // 8, 8).mean(axis=(1, 3))


def white(image):
    """The largest value, but for one pixel in a thousand where paths are few."""
    return float(np.quantile(image, 0.999))


def main(tables, output, numbers):
    lights = {
        10: ("far light", {"type": "directional", "direction": [0, 0, 1], "irradiance": 1.0}),
        11: ("near light", {"type": "point", "position": [0, 0, -0.8], "intensity": 1.0}),
    }
    for number, (name, light) in lights.items():
        if number in numbers:
            cases = [(is_dense, s) for is_dense in (True, False) for s in (6.0, 3.0, 1.0)]
            figure(
                output / f"rendering_fig_{number}.png",
                f"Fig. {number}: a plate with a {name} inside",
                [f"n = {'1/1.4' if is_dense else '1.4'}, s = {s:g}" for is_dense, s in cases],
                cases,
                lambda case: {name: plate(one, case[0], light) for name, one in materials(tables, case[1]).items()},
                0.3 if number == 10 else 0.1,
            )
    for number, name in {12: "bust", 13: "angel"}.items():
        if number in numbers:
            vertices, triangles = meshes.sculpture(name)
            meshes.check(vertices, triangles)
            low, high = vertices.min(0), vertices.max(0)
            mesh = {"filename": str(output / f"{name}.ply"), "middle": (0.5 * (low + high)).tolist(), "size": float((high - low).max())}
            meshes.write_ply(mesh["filename"], vertices, triangles)
            figure(
                output / f"rendering_fig_{number}.png",
                f"Fig. {number}: {'a bust' if name == 'bust' else 'an angel'} of index 1.4, lit from behind",
                [f"s = {s}" for s in (2, 3, 4, 5)],
                [2.0, 3.0, 4.0, 5.0],
                lambda s: {model: sculpture(one, mesh) for model, one in materials(tables, s).items()},
            )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description="Figures 10 to 13 of the transmission paper")
    parser.add_argument("tables", type=Path, help="folder of s1.nc to s6.nc")
    parser.add_argument("output", type=Path, help="folder for pictures and meshes")
    parser.add_argument("numbers", type=int, nargs="*", default=[10, 11, 12, 13], help="figures")
    given = parser.parse_args()
    given.output.mkdir(parents=True, exist_ok=True)
    main(given.tables, given.output, given.numbers)

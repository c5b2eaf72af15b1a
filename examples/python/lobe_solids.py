"""Draws the BSDF of explicit surfaces and of a model as solids, from a result folder of `verify`.

    asperity verify --structure pyramids --width 64 --spacing 1 --size 512 --sigma 1 --tau 8 --eta 1/1.5 --theta 0 \
        --bins 36x72 --rays 2e7 --realisations 32 --models heitz,smith-slopes --model-rays 2e7 -o pyramids
    python lobe_solids.py pyramids lobe_solids.png

Radius: cosine-weighted BSDF. Blue: light scattered once, orange: more often. `asperity render` lights the solids as matt bodies.
The plane of incidence is one of symmetry here. Needs the program, numpy, scipy, pandas, pillow and matplotlib.
"""

import subprocess
import sys
import tempfile

import numpy as np
import pandas as pd
from matplotlib.font_manager import findfont
from PIL import Image, ImageDraw, ImageFont
from scipy.interpolate import RectBivariateSpline

PANELS = {"explicit surfaces": ("single", "multiple"), "model: Heitz et al. 2016": ("heitz", "multiple_heitz")}
SIZE, WIDTH, STEP, VIEW, AZIMUTH, RING = (1400, 900), 3.7, 1.72, 60, 290, 0.25  # pixels, lengths, degrees, 1/sr
ONCE, OFTEN, GREY, BACK = (np.array(c) for c in ([88, 150, 222], [246, 150, 50], [190, 195, 205], [20, 22, 27]))
THETA, PHI, FINE = np.linspace(0, np.pi / 2, 120, endpoint=False)[:, None], np.arange(288) * np.pi / 144, 3


def lobe(rows, column):
    """Flux per solid angle over THETA from the pole and PHI: smooth about the pole, where bins are narrow; 0 at the horizon."""
    low, high, start, end = np.radians(rows.filter(like="_deg").to_numpy()).T
    bins = np.unique(start).size
    values = (rows[f"flux_{column}"].to_numpy() / np.abs(np.cos(low) - np.cos(high)) / (end - start)).reshape(-1, bins)
    theta = np.arccos(np.abs(np.cos((low + high)[::bins] / 2)))
    waves = np.fft.rfft((values + values[:, ::-1]) / 2, axis=1)
    waves[np.arange(waves.shape[1]) > 2 + 24 * np.sin(theta)[:, None]] = 0
    values, theta = np.fft.irfft(waves, bins, axis=1)[np.argsort(theta)], np.sort(theta)
    values = np.vstack([np.roll(values[3::-1], bins // 2, axis=1), values, 0 * values[:1]])  # on beyond the pole
    phi, values = (np.arange(-6, bins + 6) + 0.5) * 2 * np.pi / bins, np.hstack([values[:, -6:], values, values[:, :6]])
    fine = RectBivariateSpline(np.concatenate([-theta[3::-1], theta, [np.pi / 2]]), phi, values)(THETA[:, 0], PHI).clip(0)
    return np.vstack([0 * fine[:1] + fine[0].mean(), fine[1:]])


def add(x, y, z, tint):
    """Adds a grid of points, closed along its second axis, as triangles, with the colour of each point."""
    points = np.stack(np.broadcast_arrays(x, y, z), -1)
    a = np.arange(points[..., 0].size).reshape(points.shape[:2])
    b = np.roll(a, -1, axis=1)
    corners = np.stack([a[:-1], a[1:], b[1:], a[:-1], b[1:], b[:-1]], -1).reshape(-1, 3)
    triangles.append(points.reshape(-1, 3)[corners] + panel * STEP * right)
    tints.append(np.repeat(np.broadcast_to(tint, points.shape)[:-1].reshape(-1, 3), 2, axis=0))


table = pd.read_csv(f"{sys.argv[1]}/comparison.csv")
sides = {1: table[table.side == "reflected"], -1: table[table.side == "transmitted"]}
unit = max(lobe(rows, "total").max() for rows in sides.values())
(ca, sa), (cv, sv) = ((np.cos(a), np.sin(a)) for a in np.radians([AZIMUTH + 90, VIEW]))
right, upward = np.array([ca, sa, 0]), np.array([-cv * sa, cv * ca, sv])
triangles, tints = [], []
for panel, columns in enumerate(PANELS.values()):
    for up, rows in sides.items():
        once, often = (lobe(rows, column) / unit for column in columns)
        radius = np.vstack([(once + often).clip(0.012), 0 * PHI])  # closed by a point at the horizon
        theta, fraction = np.vstack([THETA, np.pi / 2]), np.vstack([often / (once + often + 1e-9), 0 * PHI])[..., None]
        level, height = radius * np.sin(theta), up * radius * np.cos(theta)
        add(level * np.cos(PHI), up * level * np.sin(PHI), height, ONCE + fraction * (OFTEN - ONCE))
    tube = 0.005 * np.exp(2j * np.pi * np.linspace(0, 1, 9))[:, None]  # a ring as a scale, in the mean plane
    add((RING / unit + tube.real) * np.cos(PHI), -(RING / unit + tube.real) * np.sin(PHI), tube.imag, GREY)
triangles, tints = np.concatenate(triangles), np.concatenate(tints)
vertices, faces = np.unique(triangles.reshape(-1, 3).round(7) + 0.0, axis=0, return_inverse=True)
faces = faces.reshape(-1, 3)
target = 0.37 * STEP * right + [0, 0, (vertices[:, 2].min() + vertices[:, 2].max()) / 2]  # the mean plane of closed bodies
with tempfile.TemporaryDirectory() as folder:
    with open(f"{folder}/solids.obj", "w") as file:
        file.writelines("v {:.7f} {:.7f} {:.7f}\n".format(*v) for v in vertices)
        file.writelines("f {} {} {}\n".format(*f) for f in faces[(faces != np.roll(faces, 1, axis=1)).all(axis=1)] + 1)
    flags = f"--camera orthographic --view-theta {VIEW} --view-phi {AZIMUTH} --width {WIDTH} --size {SIZE[0]}x{SIZE[1]} --tone linear --exposure 1"
    flags += " --look-at {},{} ".format(*(target - vertices.min(axis=0))) + f"--sun 1.1 --sun-theta 48 --sun-phi {AZIMUTH - 50} --sun-radius 8"
    flags += " --sky 0.7 --horizon 1 --radiance-below 0.3 --material lambertian --reflectance 0.6 --samples 16 --denoise -o light.png"
    subprocess.run(["asperity", "render", "solids.obj", *flags.split()], cwd=folder, check=True)
    light = np.asarray(Image.open(f"{folder}/light.png").convert("L"), float)[..., None] / 255
colours = Image.new("RGBA", (FINE * SIZE[0], FINE * SIZE[1]))
pixels = (FINE * SIZE[0] / WIDTH * (triangles - target) @ np.stack([right, -upward], -1)) + FINE * np.array(SIZE) / 2
for k in np.argsort(triangles.mean(axis=1) @ np.cross(right, upward)):  # from the farthest to the nearest
    ImageDraw.Draw(colours).polygon(pixels[k].ravel().tolist(), fill=(*tints[k].astype(int), 255))
colours = np.asarray(colours.resize(SIZE, Image.BOX), float)
picture = Image.fromarray((BACK + colours[..., 3:] / 255 * (colours[..., :3] * light - BACK)).clip(0, 255).astype(np.uint8))
for panel, (name, columns) in enumerate(PANELS.items()):
    rim = np.array([0, RING / unit])[:, None] * right + panel * STEP * right - target  # the middle and the rim of the ring
    x, y = (np.array(SIZE) / 2 + SIZE[0] / WIDTH * rim @ np.stack([right, -upward], -1)).T
    flux = "{:.3f} reflected (up), {:.3f} transmitted (down)".format(*(sum(rows[f"flux_{c}"].sum() for c in columns) for rows in sides.values()))
    for place, size, text in (((x[0], SIZE[1] - 62), 26, name), ((x[0], SIZE[1] - 28), 19, flux), ((x[1] + 34, y[1] - 20), 16, f"{RING:g}/sr")):
        ImageDraw.Draw(picture).text(place, text, (235, 235, 235), ImageFont.truetype(findfont("DejaVu Sans"), size), "mm")
picture.quantize(palette=picture.quantize(256), dither=Image.Dither.FLOYDSTEINBERG).save(sys.argv[2], optimize=True)

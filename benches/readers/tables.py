"""NPY, GSF, PNG, text and instrument files of other programs, as asperity and independent readers read them: the rows of a table.

    cargo build --release
    target/readers-venv/bin/python benches/readers/tables.py target/tables > rows.md

NumPy, gsffile, pandas, GDAL, surfalize and SurfaceTopography write the files into the folder. PNG is written by asperity, and read by Pillow and pypng.
Heights are compared exactly, but where a file keeps them in steps or single precision.
"""

import functools
import itertools
import subprocess

import gsffile
import numpy as np
import pandas
import PIL
import png
import rasterio
import rasterio.shutil
import SurfaceTopography
from compare import METRES, Map, by_surface_topography, by_surfalize
from PIL import Image
from rasters import gdal_file, heights
from rows import SINGLE, print_rows, problem, scaled
from surfalize import Surface


def npy(folder):
    kinds = "i1 u1 i2 u2 i4 u4 i8 u8 f4 f8".split()
    for kind, order, layout, version in itertools.product(kinds, "<>", "CF", ((1, 0), (2, 0), (3, 0))):
        path = folder / f"{kind}{'le' if order == '<' else 'be'}{layout}{version[0]}.npy"
        values = heights((7, 9), kind).astype(order + kind)
        if kind[0] == "f":
            values[2, 3] = np.nan
        with path.open("wb") as file:
            np.lib.format.write_array(file, np.array(values, order=layout), version)
        yield path


def by_numpy(path):
    return scaled(np.load(path).astype(float), None)


def gsf(folder):
    units = [None, "m", "nm", "um", "µm", "mm", "pm"]
    for number, (lateral, vertical) in enumerate(itertools.product(units, units)):
        if (lateral is None) != (vertical is None):
            continue
        metadata = {"XReal": 0.7 * (number + 1), "YReal": 1.3}
        if lateral:
            metadata.update(XYUnits=lateral, ZUnits=vertical)
        if number % 2:
            metadata.update(Title="Höhe", XOffset=-1.5, YOffset=0.25, comment="x, y")
        values = heights((5, 4 + number % 5), "f4")
        values[1, 1] = np.nan
        path = folder / f"{number}.gsf"
        gsffile.write_gsf(path, values, metadata)
        yield path
    path = folder / "bare.gsf"
    gsffile.write_gsf(path, heights((5, 6), "f4"))
    yield path


def by_gsffile(path):
    values, metadata = gsffile.read_gsf(path)
    ny, nx = values.shape
    lateral, vertical = (METRES[metadata.get(key) or "1"] if metadata.get(key) != "pm" else 1e-12 for key in ("XYUnits", "ZUnits"))
    steps = (float(metadata.get("XReal", 1)) / nx * lateral, float(metadata.get("YReal", 1)) / ny * lateral)
    return scaled(values.astype(float) * vertical, steps)


def arrays(folder):
    for number, kind in enumerate(("f8", "f4", "i2", "u1")):
        path = folder / f"{number}.npy"
        np.save(path, heights((40 + number, 33), kind))
        yield path


def by_pillow(path):
    with Image.open(path) as image:
        return np.asarray(image).astype(float), {key: image.text[key] for key in ("height_min", "height_max", "unit")}


def by_pypng(path):
    _, _, rows, _ = png.Reader(filename=str(path)).read()
    return np.array([list(row) for row in rows], float), {}


def png_problem(program, path, read):
    """Greys are heights to half a step of 65535."""
    written = path.with_suffix(".png")
    command = [program, "inspect", path, "--spacing", "0.25,0.5", "--assume-unit", "um", "-o", written]
    subprocess.run(command, check=True, capture_output=True)
    grey, texts = read(written)
    expected = np.load(path).astype(float)
    low, high = expected.min(), expected.max()
    if texts and [float(texts["height_min"]), float(texts["height_max"]), texts["unit"]] != [low, high, "um"]:
        return f"{texts}"
    off = np.abs(low + grey * (high - low) / 65535 - expected).max() / (high - low) * 65535
    return None if off < 0.5 + 1e-6 else f"heights differ by {off} steps"


def text(folder):
    values = heights((11, 7), "f8")
    values[4, 4] = np.nan
    for number, (delimiter, form) in enumerate(itertools.product((" ", "\t", ",", ";", ", "), ("%.18e", "%g", "%.3f", "%r"))):
        for ending, newline in (("txt", "\n"), ("csv", "\r\n")):
            path = folder / f"numpy-{number}.{ending}"
            np.savetxt(path, values, fmt="%.17g" if form == "%r" else form, delimiter=delimiter, newline=newline)
            yield path
    for number, separator in enumerate((",", ";", "\t")):
        path = folder / f"pandas-{number}.csv"
        pandas.DataFrame(values).to_csv(path, sep=separator, index=False, header=False, na_rep="nan")
        yield path


def by_pandas(path):
    delimiter = next((mark for mark in ";,\t" if mark in path.read_text()), r"\s+")
    table = pandas.read_csv(path, sep=delimiter, header=None, float_precision="round_trip", skipinitialspace=True)
    return scaled(table.to_numpy(float), None)


def esri(folder):
    for number, (kind, options) in enumerate(
        itertools.product(("f4", "f8", "i4", "i2", "u1"), ({}, {"nodata": 37}, {"DECIMAL_PRECISION": "3"}, {"SIGNIFICANT_DIGITS": "12"}))
    ):
        values = heights((8, 9), kind)
        values[2, 3] = 37 if "nodata" in options else values[2, 3]
        source = gdal_file(folder / f"{number}.tif", values, transform=rasterio.Affine(2, 0, 3e5, 0, -2, 5e6), nodata=options.get("nodata"))
        path = folder / f"{number}.asc"
        creation = {key: value for key, value in options.items() if key != "nodata"}
        rasterio.shutil.copy(source, path, driver="AAIGrid", **creation)
        yield path


def points(folder):
    for number, (kind, separator, heading) in enumerate(itertools.product(("f4", "f8", "i2"), ("SPACE", "COMMA", "TAB", "SEMICOLON"), ("NO", "YES"))):
        source = gdal_file(folder / f"{number}.tif", heights((12, 9), kind))
        path = folder / f"{number}.xyz"
        rasterio.shutil.copy(source, path, driver="XYZ", COLUMN_SEPARATOR=separator, ADD_HEADER_LINE=heading)
        yield path


def by_points(path):
    """GDAL's own reader of the same points; the first row has the least y, as asperity has it."""
    lines = path.read_text().replace(",", " ").replace(";", " ").splitlines()
    table = np.array([line.split() for line in lines if not line[:1].isalpha()], float)
    table = table[np.lexsort((table[:, 0], table[:, 1]))]
    columns, rows = (np.unique(table[:, k]) for k in (0, 1))
    values = table[:, 2].reshape(len(rows), len(columns))
    return Map(values, (np.diff(columns)[0], np.diff(rows)[0]), 0)


def by_gdal_text(path):
    with rasterio.open(path) as file:
        values = file.read(1).astype(float)
        if file.nodata is not None:
            values[values == file.nodata] = np.nan
        return scaled(values, [abs(file.transform.a), abs(file.transform.e)])


def surface(shape, has_missing=False):
    values = heights(shape, "f8")
    if has_missing:
        values[1, 2] = values[4, 0] = np.nan
    return values


def by_surfalize_written(ending, *choices):
    """Files of an ending with every choice of options, with missing points and without."""

    def write(folder):
        shapes = [(9, 12), (17, 5), (40, 41)]
        for number, (options, shape, has_missing) in enumerate(itertools.product(choices, shapes, (False, True))):
            path = folder / f"{number}{ending}"
            Surface(surface(shape, has_missing), 0.25, 0.5).save(path, **options)
            yield path

    return write


def by_surface_topography_written(ending, *choices):
    def write(folder):
        for number, (options, shape, unit) in enumerate(itertools.product(choices, [(9, 12), (17, 5), (40, 41)], ("um", "nm", "m"))):
            ny, nx = shape
            sizes = (0.25 * nx, 0.5 * ny)
            read = SurfaceTopography.Topography(surface(shape).T, sizes, unit=unit)
            path = folder / f"{number}{ending}"
            getattr(read, f"to_{ending[1:]}")(str(path), **options)
            yield path

    return write


# Units convert in another order of multiplications
rounded = functools.partial(problem, most=1e-14)
single = functools.partial(problem, most=SINGLE)
SURFALIZE = "surfalize 0.19.2"
TOPOGRAPHY = f"SurfaceTopography {SurfaceTopography.__version__}"
FLOATS = ({"dtype": "D"}, {"dtype": "F"})
WHOLE = ({"dtype": "L"}, {"dtype": "I"})
PANDAS = f"pandas {pandas.__version__}"
ROWS = [
    ("NPY of whole numbers and single and double precision; either byte order; C and Fortran order; versions 1 to 3", npy, by_numpy, f"numpy {np.__version__}"),
    ("GSF in units from pm to m, with and without extent, title, offset and missing points", gsf, by_gsffile, f"gsffile {gsffile.__version__}", rounded),
    ("PNG as asperity writes it", arrays, by_pillow, f"Pillow {PIL.__version__}", png_problem),
    ("PNG as asperity writes it", arrays, by_pypng, "pypng 0.20220715.0", png_problem),
    ("text of numpy and pandas; spaces, tabs, commas and semicolons; missing points", text, by_pandas, PANDAS),
    ("ESRI grid of GDAL; whole numbers and digits of all kinds; missing points", esri, by_gdal_text, f"GDAL {rasterio.__gdal_version__}", single),
    ("points x, y, z of GDAL; spaces, tabs, commas and semicolons; with and without a heading", points, by_points, f"numpy {np.__version__}", rounded),
    ("X3P of surfalize", by_surfalize_written(".x3p", *FLOATS), by_surface_topography, TOPOGRAPHY, rounded),
    ("X3P of SurfaceTopography; whole numbers too", by_surface_topography_written(".x3p", *FLOATS, *WHOLE), by_surface_topography, TOPOGRAPHY, rounded),
    ("`.sur` of surfalize, plain and compressed", by_surfalize_written(".sur", {}, {"compressed": True}), by_surfalize, SURFALIZE, single),
    ("`.sdf` of surfalize, text and binary", by_surfalize_written(".sdf", {}, {"binary": False}), by_surfalize, SURFALIZE, rounded),
    ("`.al3d` of surfalize", by_surfalize_written(".al3d", {}), by_surface_topography, TOPOGRAPHY, rounded),
    ("`.gwy` of SurfaceTopography", by_surface_topography_written(".gwy", {}), by_surfalize, SURFALIZE, rounded),
]

if __name__ == "__main__":
    print_rows(__doc__, ROWS)

"""TIFF and EXR files of other programs, as asperity and independent readers read them: the rows of a table.

    cargo build --release
    target/readers-venv/bin/python benches/readers/rasters.py target/rasters > rows.md

tifffile, GDAL (by rasterio) and OpenEXR write the files into the folder, with heights of all types. Each row says how
many files of a kind were read, and whether all heights, spacings and missing points were the same. Heights are compared
exactly, but where GDAL converts units or heights have a scale: to 1e-15.
"""

import itertools

import numpy as np
import OpenEXR
import rasterio
import tifffile
from compare import METRES, Map
from rasterio.transform import Affine
from rows import print_rows, scaled

METRE = Affine(2, 0, 3e5, 0, -3, 5e6)


def heights(shape, kind, bits=None):
    """Waves with noise that fill the range of a type."""
    kind = np.dtype(kind)
    y, x = np.mgrid[: shape[0], : shape[1]]
    waves = np.sin(0.3 * x) + np.cos(0.2 * y) + 0.05 * np.random.default_rng(5).standard_normal(shape)
    if kind.kind == "f":
        return waves.astype(kind)
    # Doubles hold whole numbers up to 2^53
    bits = min(bits or 8 * kind.itemsize, 52)
    low = 0 if kind.kind == "u" else -(2 ** (bits - 1))
    return (low + (waves + 2.3) / 4.6 * (2**bits - 1)).clip(low, low + 2**bits - 1).astype(kind)


def by_tifffile_written(folder):
    kinds = "u1 i1 u2 i2 u4 i4 u8 i8 f2 f4 f8".split()
    methods = [(None, 1), ("lzw", 1), ("lzw", 2), ("lzw", 3), ("zlib", 1), ("zlib", 2), ("zlib", 3), ("packbits", 1)]
    every = itertools.product(kinds, "<>", methods, [None, (16, 16), (32, 64)])
    for number, (kind, order, (method, predictor), tile) in enumerate(every):
        if predictor == (2 if kind[0] == "f" else 3):
            continue
        path = folder / f"{number}.tif"
        tifffile.imwrite(
            path,
            heights((37, 63), kind),
            byteorder=order,
            compression=method,
            predictor=predictor if predictor > 1 else None,
            tile=tile,
            rowsperstrip=None if tile else (5, 37, 64)[number % 3],
            bigtiff=number % 3 == 0,
            photometric="miniswhite" if number % 2 else "minisblack",
        )
        yield path


def gdal_file(path, values, **options):
    height, width = values.shape
    options = {"crs": "EPSG:32633", "transform": METRE, **options}
    with rasterio.open(path, "w", "GTiff", width, height, 1, dtype=values.dtype, **options) as file:
        file.write(values, 1)
    return path


def by_gdal_written(folder):
    whole = [("u1", None), ("u2", None), ("i2", None), ("u4", None), ("i4", None)]
    odd = [("u1", bits) for bits in range(1, 8)] + [("u2", bits) for bits in range(9, 16)]
    odd += [("u4", bits) for bits in (17, 20, 24, 25, 31)]
    for kind, bits in whole + odd + [("f4", None), ("f8", None), ("f4", 16)]:
        for method, predictor in itertools.product((None, "LZW", "DEFLATE", "PACKBITS"), (1, 2, 3)):
            is_packed = method in ("LZW", "DEFLATE")
            if predictor > 1 and (not is_packed or bits or predictor == 3 and kind[0] != "f"):
                continue
            for size, tile in [(15, 16), (16, 0), (31, 32), (33, 16), (63, 0), (511, 128)]:
                if size == 511 and (bits or method != "LZW") or bits and size in (16, 31):
                    continue
                options = {"nbits": bits} if bits else {}
                if tile:
                    options.update(tiled=True, blockxsize=tile, blockysize=tile)
                if size == 15 and bits != 24:
                    options.update(endianness="BIG")
                if size == 31:
                    options.update(bigtiff="YES")
                path = folder / f"{kind}-{bits}-{method}-{predictor}-{size}.tif"
                values = heights((size, size + size % 3), kind, bits)
                yield gdal_file(path, values, compress=method or "NONE", predictor=predictor, **options)


def sparse(folder):
    for kind, method, is_marked, is_tiled in itertools.product(
        ("u1", "i2", "f4", "f8"), ("NONE", "LZW", "DEFLATE"), (False, True), (False, True)
    ):
        options = {"nodata": 255 if kind == "u1" else -9999} if is_marked else {}
        options.update(dict(tiled=True, blockxsize=16, blockysize=16) if is_tiled else dict(blockysize=7))
        path = folder / f"{kind}-{method}-{is_marked}-{is_tiled}.tif"
        window = rasterio.windows.Window(16, 16, 32, 16) if is_tiled else rasterio.windows.Window(0, 14, 70, 14)
        with rasterio.open(
            path, "w", "GTiff", 70, 50, 1, dtype=np.dtype(kind).name, crs="EPSG:32633", transform=METRE, compress=method,
            SPARSE_OK=True, **options,
        ) as file:
            file.write(heights((int(window.height), int(window.width)), kind), 1, window=window)
        yield path


def in_large_tiles(folder):
    methods = [(None, 1), ("lzw", 2), ("zlib", 3), ("packbits", 1)]
    for (method, predictor), tile, shape in itertools.product(methods, [(16, 16), (64, 256)], [(3, 5), (15, 2), (63, 65)]):
        path = folder / f"{method}-{tile[1]}-{shape[1]}.tif"
        options = {"predictor": predictor} if predictor > 1 else {}
        tifffile.imwrite(path, heights(shape, "f4" if predictor == 3 else "u2"), compression=method, tile=tile, **options)
        yield path


def with_units(folder):
    values = heights((8, 9), "f4")
    for code in (2193, 2227, 2256, 2263, 2913, 3857, 6539, 24370, 27700, 30200, 32064, 32633):
        yield gdal_file(folder / f"epsg-{code}.tif", values, crs=f"EPSG:{code}")
    for unit in ("m", "ft", "US survey foot"):
        path = gdal_file(folder / f"{unit}.tif".replace(" ", "-"), values)
        with rasterio.open(path, "r+") as file:
            file.units, file.scales, file.offsets = (unit,), (0.5,), (100.0,)
        yield path


def with_scales(folder):
    values = heights((9, 8), "f4")
    for number, unit in enumerate(["um", "\\u00B5m", "micron", "nm", "mm", "cm", "inch"]):
        path = folder / f"imagej-{number}.tif"
        tifffile.imwrite(path, values, imagej=True, resolution=(4, 2.5), metadata={"unit": unit})
        yield path
    for unit in ("µm", "nm", "mm", "m"):
        path = folder / f"{ord(unit[0])}.ome.tif"
        sizes = {"PhysicalSizeX": 0.25, "PhysicalSizeXUnit": unit, "PhysicalSizeY": 0.5, "PhysicalSizeYUnit": unit}
        tifffile.imwrite(path, values, ome=True, metadata={"axes": "YX", **sizes})
        yield path


def by_openexr_written(folder):
    methods = "NO RLE ZIPS ZIP PIZ PXR24".split()
    for method, kind, is_tiled in itertools.product(methods, ("f2", "f4", "u4"), (False, True)):
        if (method, kind) == ("PXR24", "f4"):
            continue
        header = {"compression": getattr(OpenEXR, f"{method}_COMPRESSION")}
        header["type"] = OpenEXR.tiledimage if is_tiled else OpenEXR.scanlineimage
        if is_tiled:
            header["tiles"] = OpenEXR.TileDescription()
        path = folder / f"{method}-{kind}-{is_tiled}.exr"
        OpenEXR.File(header, {"Z": heights((70, 53), kind)}).write(str(path))
        yield path


UNITS = {**METRES, "\\u00B5m": 1e-6, "micron": 1e-6, "cm": 1e-2, "inch": 0.0254, "ft": 0.3048, "US survey foot": 1200 / 3937}


def by_tifffile(path):
    with tifffile.TiffFile(path) as file:
        page = file.pages[0]
        values = page.asarray().astype(float)
        if page.nodata:
            values[values == page.nodata] = np.nan
        steps, units = None, None
        if file.is_imagej:
            steps = [below / above for above, below in (page.tags[282].value, page.tags[283].value)]
            units = [UNITS[file.imagej_metadata["unit"]]] * 2
        elif file.is_ome:
            pixels = tifffile.xml2dict(file.ome_metadata)["OME"]["Image"]["Pixels"]
            steps = [pixels["PhysicalSizeX"], pixels["PhysicalSizeY"]]
            units = [UNITS[pixels["PhysicalSizeXUnit"]], UNITS[pixels["PhysicalSizeYUnit"]]]
        if steps:
            # Heights are taken to have the unit of the grid
            return scaled(values * units[0], [step * unit for step, unit in zip(steps, units)])
        return scaled(values, None)


def by_gdal(path):
    with rasterio.open(path) as file:
        values = file.read(1).astype(float)
        if file.nodata is not None:
            values[values == file.nodata] = np.nan
        values = (values * file.scales[0] + file.offsets[0]) * UNITS[file.units[0] or "m"]
        if not file.crs:
            return scaled(values, None)
        metres = file.crs.linear_units_factor[1]
        return scaled(values, [abs(file.transform.a) * metres, abs(file.transform.e) * metres])


def by_openexr(path):
    channel = OpenEXR.File(str(path)).channels()["Z"]
    return scaled(channel.pixels.astype(float), None)


TIFFFILE = f"tifffile {tifffile.__version__}"
GDAL = f"GDAL {rasterio.__gdal_version__}"
OPENEXR = f"OpenEXR {OpenEXR.__version__}"
ROWS = [
    ("TIFF of whole numbers and half, single and double precision; strips and tiles; LZW, deflate, PackBits", by_tifffile_written, by_tifffile, TIFFFILE),
    ("GeoTIFF, 1 to 32 bits per sample, tiles that the image leaves half empty", by_gdal_written, by_gdal, GDAL),
    ("GeoTIFF with tiles or strips that are not in the file", sparse, by_gdal, GDAL),
    ("GeoTIFF in feet, links and yards by EPSG code; units, scale and offset of heights", with_units, by_gdal, GDAL),
    ("TIFF in tiles larger than the image", in_large_tiles, by_tifffile, TIFFFILE),
    ("TIFF with the scale of ImageJ or OME", with_scales, by_tifffile, TIFFFILE),
    ("EXR of half and single precision and whole numbers; scan lines and tiles", by_openexr_written, by_openexr, OPENEXR),
]

if __name__ == "__main__":
    print_rows(__doc__, ROWS)

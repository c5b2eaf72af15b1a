"""Writes crates/io/src/height_maps/tiff/epsg.txt from the EPSG data set in PROJ's database, which pyproj brings along.

    target/readers-venv/bin/python benches/readers/epsg.py > crates/io/src/height_maps/tiff/epsg.txt
"""

import sqlite3
import textwrap
from pathlib import Path

import pyproj

# US survey units rounded once; the database divides 12 by 39.37
EXACT = {9003: 1200 / 3937, 9033: 79200 / 3937, 9034: 792 / 3937, 9035: 6336000 / 3937}
SYSTEMS = """
    select system.code, axis.uom_code from {} system join axis on
    axis.coordinate_system_auth_name = system.coordinate_system_auth_name and
    axis.coordinate_system_code = system.coordinate_system_code
    where system.auth_name = 'EPSG' and axis.uom_auth_name = 'EPSG' and
    axis.coordinate_system_order = 1 and system.code < 65536 and {}"""


def ranges(codes):
    """Ascending codes as `first-last`, where no other system lies between."""
    runs = []
    for code in sorted(codes):
        if runs and runs[-1][1] == code - 1:
            runs[-1][1] = code
        else:
            runs.append([code, code])
    return " ".join(str(a) if a == b else f"{a}-{b}" for a, b in runs)


def main():
    database = sqlite3.connect(Path(pyproj.datadir.get_data_dir()) / "proj.db")
    get = lambda query: database.execute(query).fetchall()
    version = get("select value from metadata where key = 'EPSG.VERSION'")[0][0]
    print(f"# Units of length in the EPSG data set, {version}: code, metres. Then the systems with axes in each unit.")
    print("# Written by benches/readers/epsg.py.")
    for code, factor in get(
        "select code, conv_factor from unit_of_measure"
        " where auth_name = 'EPSG' and type = 'length' and name not like '% per %' order by code"
    ):
        print(f"unit {code} {EXACT.get(code, factor)!r}")
    projected = dict(get(SYSTEMS.format("projected_crs", "true")))
    vertical = dict(get(SYSTEMS.format("vertical_crs", "axis.orientation != 'down'")))
    depth = dict(get(SYSTEMS.format("vertical_crs", "axis.orientation = 'down'")))
    # Compound systems have the units of their parts
    pairs = get("select code, horiz_crs_code, vertical_crs_code from compound_crs where auth_name = 'EPSG'")
    for code, horizontal, upward in pairs:
        for part, table in [(horizontal, projected), (upward, vertical), (upward, depth)]:
            if horizontal in projected and part in table:
                table[code] = table[part]
    for kind, table in [("projected", projected), ("vertical", vertical), ("depth", depth)]:
        for unit in sorted(set(table.values())):
            codes = ranges(code for code, of in table.items() if of == unit)
            for line in textwrap.wrap(codes, 140):
                print(kind, unit, line)


if __name__ == "__main__":
    main()

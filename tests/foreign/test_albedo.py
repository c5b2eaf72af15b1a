"""Tables of `asperity albedo`, read by programs that are not ours. ASPERITY names the program."""

import csv
import os
import subprocess
from pathlib import Path

import numpy as np
import OpenEXR
import pytest

ALPHAS = [0.3, 0.8]
COSINES = [0.25, 0.75]
CHANNELS = ["E_R", "E_R_se", "E_T", "E_T_se", "single_R", "single_T", "ratio_R", "ratio_T"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("albedo")
    program = Path(os.environ["ASPERITY"]).resolve()
    line = "albedo --alpha 0.3,0.8 --cosines 2 --eta 1.33,2 --realisations 4 --rays 2e3 --no-plots --quiet -o ."
    subprocess.run([program, *line.split()], cwd=folder, check=True)
    return folder


@pytest.fixture(scope="module")
def table(folder):
    """Array [material, alpha, cos, channel] of the CSV."""
    with open(folder / "albedo.csv", newline="") as file:
        rows = [[float(row[name]) for name in CHANNELS] for row in csv.DictReader(file)]
    return np.array(rows).reshape(2, 2, 2, len(CHANNELS))


def test_numpy_reads_the_array(folder, table):
    assert np.array_equal(np.load(folder / "albedo.npy"), table)


def test_openexr_reads_a_part_per_material(folder, table):
    parts = OpenEXR.File(str(folder / "albedo.exr"), separate_channels=True).parts
    assert [part.header["name"] for part in parts] == ["n = 1.33", "n = 2"]
    for part, values in zip(parts, table):
        for channel, name in enumerate(CHANNELS):
            assert np.array_equal(part.channels[name].pixels, values[..., channel].astype(np.float32))


LOOKUP = """
#include <stdio.h>
#include "albedo.h"
int main(void)
{
    float alpha, cosine;
    while (scanf("%f %f", &alpha, &cosine) == 2)
        printf("%.9g %.9g\\n", albedo_lookup(albedo_E_R[1], alpha, cosine), albedo_lookup(albedo_ratio_T[0], alpha, cosine));
    return 0;
}
"""


@pytest.mark.parametrize("language", [["-x", "c", "-std=c99"], ["-x", "c++"]])
def test_c_looks_up_bilinearly(folder, table, language):
    (folder / "lookup.c").write_text(LOOKUP)
    compiler = ["cc", *language, "-Wall", "-Wextra", "-Werror", "-Wno-unused", "lookup.c", "-o", "lookup"]
    subprocess.run(compiler, cwd=folder, check=True)
    places = [(alpha, cosine) for alpha in (0.1, 0.3, 0.5, 0.8, 2) for cosine in (0, 0.25, 0.4, 0.75, 1)]
    text = "".join(f"{alpha} {cosine}\n" for alpha, cosine in places)
    done = subprocess.run(folder / "lookup", input=text, capture_output=True, text=True, check=True)
    found = np.array([line.split() for line in done.stdout.splitlines()], dtype=float)
    for number, (material, channel) in enumerate([(1, "E_R"), (0, "ratio_T")]):
        values = table[material, ..., CHANNELS.index(channel)]
        over_cosine = [[np.interp(cosine, COSINES, row) for row in values] for _, cosine in places]
        expected = [np.interp(alpha, ALPHAS, row) for (alpha, _), row in zip(places, over_cosine)]
        # Single precision of values of about one, over a few operations
        assert np.allclose(found[:, number], expected, rtol=1e-6, atol=0)

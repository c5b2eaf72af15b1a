#!/usr/bin/env python3
"""Light paths on tiles of a height field, traced by Mitsuba 3 in its LLVM variant: counts segments and times them.

    mitsuba_paths.py HEIGHTS.npy SEED SIDE THETA...     SIDE x SIDE rays; one line of JSON per angle of incidence

The same light as `asperity trace --branching pick`: one ray per stratum of the middle one of 3 x 3 tiles, started at the
height of the highest point in Morton order; the dielectric BSDF picks reflection or refraction by Fresnel's equations; a
path ends when it meets nothing. One thread. The loop over interactions is evaluated with compression: each round is one
launch of a kernel over the paths that continue. This is faster here than one kernel for the whole loop.

`build_seconds` is making the mesh and its search structure. `compile_seconds` is a first launch with few rays, which
compiles the kernels or loads them from the cache of Dr.Jit.
"""

import json
import sys
import time
from collections import Counter

try:
    import drjit as dr
    import mitsuba as mi
    import numpy as np
except ImportError as error:
    sys.exit(f"{error}: install requirements.txt")

VARIANT = "llvm_ad_mono"
MIN_LLVM = (19,)
TILES = 3  # per side of the scene
MAX_ORDER = 1000
MAX_TOGETHER = 2**18  # paths; more take longer, since their states leave the cache


def load_tiles(heights):
    """Scene of TILES x TILES copies of a periodic height field; each cell is divided along the diagonal from its corner 00."""
    cells = TILES * heights.shape[0]
    side = np.arange(cells + 1)
    iy, ix = np.meshgrid(side, side, indexing="ij")
    z = heights[iy % heights.shape[0], ix % heights.shape[0]]
    v00 = (iy * (cells + 1) + ix)[:-1, :-1].ravel()
    v10, v01, v11 = v00 + 1, v00 + cells + 1, v00 + cells + 2
    faces = np.stack([v00, v10, v11, v00, v11, v01], axis=1)

    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict({"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0})
    properties["face_normals"] = True
    mesh = mi.Mesh("tiles", z.size, 2 * cells * cells, props=properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = mi.Float(np.stack([ix, iy, z], axis=-1).ravel().astype(np.float32))
    parameters["faces"] = mi.UInt32(faces.ravel().astype(np.uint32))
    parameters.update()
    scene = mi.load_dict({"type": "scene", "surface": mesh})
    dr.sync_thread()
    return scene


def even_bits(i):
    """Packs the bits at even places: one coordinate of the i-th place in Morton order."""
    for shift, mask in (0, 0x55555555), (1, 0x33333333), (2, 0x0F0F0F0F), (4, 0x00FF00FF), (8, 0x0000FFFF):
        i = (i | i >> shift) & mask
    return i


@dr.syntax
def follow(scene, ray, sampler):
    """Follows paths to their ends. Returns the numbers of segments and the last directions."""
    context = mi.BSDFContext(mi.TransportMode.Importance)
    segments = mi.UInt32(0)
    active = dr.full(mi.Bool, True, dr.width(ray))
    while dr.hint(active, mode="evaluated", compress=True):
        segments += 1
        hit = scene.ray_intersect(ray, mi.RayFlags.All, coherent=segments == 1, active=active)
        active &= hit.is_valid()
        sample, _ = hit.bsdf().sample(context, hit, sampler.next_1d(active), sampler.next_2d(active), active)
        ray[active] = hit.spawn_ray(hit.to_world(sample.wo))
        active &= segments <= MAX_ORDER
    return segments, ray.d


def launch(scene, size, light, first, sampler):
    """Traces one path in each of some strata of the middle tile, from number `first` on in Morton order. Returns counts."""
    theta, stratum, high = light
    index = first + dr.arange(mi.UInt32, sampler.wavefront_size())
    corner = mi.Point2f(even_bits(index), even_bits(index >> 1)) * stratum + TILES // 2 * size
    place = corner + sampler.next_2d() * stratum
    direction = mi.Vector3f(-dr.sin(theta), 0, -dr.cos(theta))
    segments, last = follow(scene, mi.Ray3f(mi.Point3f(place.x, place.y, high), direction), sampler)
    is_truncated = segments > MAX_ORDER
    counts = {
        "segments": dr.sum(segments),
        "reflected": dr.count(~is_truncated & (last.z > 0)),
        "transmitted": dr.count(~is_truncated & (last.z <= 0)),
        "truncated": dr.count(is_truncated),
    }
    return {name: int(dr.slice(count)) for name, count in counts.items()}


def trace(scene, heights, theta_deg, side, seed):
    """Traces one path in each of `side` x `side` strata of the middle tile. Returns counts and seconds."""
    rays = side * side
    together = min(rays, MAX_TOGETHER)
    # Opaque numbers are arguments of the kernels, which would be compiled anew for each number otherwise
    light = [dr.opaque(mi.Float, x) for x in (np.deg2rad(theta_deg), len(heights) / side, heights.max())]
    sampler = mi.load_dict({"type": "independent"})
    sampler.seed(seed, together)
    dr.eval(sampler)
    dr.sync_thread()
    begin = time.perf_counter()
    total = Counter()
    for first in range(0, rays, together):
        total.update(launch(scene, len(heights), light, dr.opaque(mi.UInt32, first), sampler))
    return dict(total) | {"rays": rays, "trace_seconds": time.perf_counter() - begin}


def main():
    path, seed, side, *thetas = sys.argv[1:]
    if VARIANT not in mi.variants() or dr.detail.llvm_version() < MIN_LLVM:
        sys.exit(f"Dr.Jit finds no LLVM library of version {MIN_LLVM[0]} or later: install it (Debian: libllvm19)")
    dr.set_thread_count(1)
    heights = np.load(path)
    begin = time.perf_counter()
    scene = load_tiles(heights)
    built = time.perf_counter()
    trace(scene, heights, 0.0, 32, 0)
    once = {
        "version": f"{mi.__version__}, {VARIANT}, LLVM {'.'.join(map(str, dr.detail.llvm_version()))}",
        "build_seconds": built - begin,
        "compile_seconds": time.perf_counter() - built,
    }
    for theta in thetas:
        print(json.dumps(once | trace(scene, heights, float(theta), int(side), int(seed))))


if __name__ == "__main__":
    mi.set_variant(VARIANT)
    main()

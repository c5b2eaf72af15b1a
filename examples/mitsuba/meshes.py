"""Closed meshes by code: the bust of a woman and an angel, as PLY files.

    python meshes.py bust bust.ply
    python meshes.py angel angel.ply

A sculpture is a smooth function of position that is negative inside: ellipsoids and cones, blended. Its surface is found by surface nets on a regular
grid, and vertices are then moved onto it. +y is up, +z towards the viewer, a sculpture is about two units tall. Needs numpy.
"""

import sys

import numpy as np

# Blends, near to far, and primitives: approximate distances, negative inside


def join(first, second, blend=0.0):
    """Smooth union of two shapes; `blend`: width of the fillet."""
    if blend == 0:
        return np.minimum(first, second)
    part = np.maximum(blend - np.abs(first - second), 0) / blend
    return np.minimum(first, second) - part**3 * blend / 6


def cut(shape, tool, blend=0.0):
    """A shape less another."""
    return -join(-shape, tool, blend)


def ellipsoid(p, centre, radii):
    scaled = [(x - c) / r for x, c, r in zip(p, centre, radii)]
    inner = np.sqrt(sum(x**2 for x in scaled))
    slope = np.sqrt(sum((x / r) ** 2 for x, r in zip(scaled, radii)))
    return inner * (inner - 1) / np.maximum(slope, 1e-9)


def ball(p, centre, radius):
    return np.sqrt(sum((x - c) ** 2 for x, c in zip(p, centre))) - radius


def limb(p, start, end, thick, thin):
    """A cone with round ends, of radius `thick` at `start` and `thin` at `end`."""
    axis = np.subtract(end, start)
    along = sum((x - c) * a for x, c, a in zip(p, start, axis)) / (axis @ axis)
    along = np.clip(along, 0, 1)
    distance = np.sqrt(sum((x - c - along * a) ** 2 for x, c, a in zip(p, start, axis)))
    return distance - (thick + (thin - thick) * along)


def bust(p):
    """Head with hair, neck and shoulders on a foot."""
    x, y, z = p
    side = (np.abs(x), y, z)
    head = ellipsoid(p, (0, 1.60, -0.06), (0.36, 0.41, 0.45))
    head = join(head, ellipsoid(p, (0, 1.37, 0.11), (0.265, 0.40, 0.275)), 0.16)
    head = join(head, ellipsoid(p, (0, 1.05, 0.27), (0.10, 0.075, 0.08)), 0.12)
    head = join(head, ellipsoid(side, (0.19, 1.36, 0.22), (0.09, 0.08, 0.10)), 0.12)
    head = cut(head, ellipsoid(side, (0.145, 1.475, 0.43), (0.10, 0.065, 0.10)), 0.06)
    head = join(head, ball(side, (0.138, 1.475, 0.295), 0.072), 0.012)
    head = join(head, limb(side, (0.05, 1.565, 0.375), (0.235, 1.56, 0.26), 0.032, 0.022), 0.05)
    head = join(head, limb(p, (0, 1.57, 0.365), (0, 1.335, 0.47), 0.030, 0.048), 0.05)
    head = join(head, ball(side, (0.047, 1.315, 0.415), 0.034), 0.03)
    head = join(head, ellipsoid(p, (0, 1.212, 0.375), (0.105, 0.024, 0.05)), 0.02)
    head = join(head, ellipsoid(p, (0, 1.162, 0.365), (0.080, 0.030, 0.05)), 0.02)
    head = join(head, ellipsoid(side, (0.325, 1.41, -0.03), (0.045, 0.11, 0.065)), 0.06)
    # Hair: a wavy cap above a line from the forehead to the nape, and a knot behind
    hair = ellipsoid(p, (0, 1.66, -0.10), (0.41, 0.42, 0.48))
    strands = 0.014 * np.sin(34 * np.arctan2(x, y - 1.1) + 6 * np.sin(5 * z))
    front = 0.55 * (z + 0.02) - (y - 1.56)
    hair = -join(-(hair + strands), -front, 0.08)
    hair = join(hair, ellipsoid(p, (0, 1.55, -0.60), (0.19, 0.18, 0.17)) + 0.6 * strands, 0.08)
    head = join(head, hair, 0.03)
    body = limb(p, (0, 1.25, -0.10), (0, 0.72, -0.13), 0.17, 0.20)
    shoulders = limb(side, (0.0, 0.60, -0.13), (0.60, 0.42, -0.13), 0.20, 0.19)
    body = join(body, shoulders, 0.26)
    body = join(body, ellipsoid(p, (0, 0.22, -0.04), (0.56, 0.50, 0.27)), 0.14)
    body = join(body, ellipsoid(side, (0.22, 0.12, 0.12), (0.20, 0.18, 0.16)), 0.10)
    # Folds of a robe, from the shoulders to the middle
    body = body - 0.012 * np.sin(26 * (0.8 * np.abs(x) + y)) * np.clip((0.50 - y) / 0.1, 0, 1)
    body = np.maximum(body, 0.03 - y - 0.10 * x**2)
    foot = limb(p, (0, 0.06, -0.05), (0, -0.22, -0.05), 0.16, 0.12)
    plinth = np.maximum(np.sqrt(x**2 + (z + 0.05) ** 2) - 0.30, np.abs(y + 0.27) - 0.06)
    foot = join(foot, plinth - 0.02, 0.08)
    return join(join(head, body, 0.10), foot, 0.06)


def angel(p):
    """A figure in a robe with thin wings."""
    x, y, z = p
    side = (np.abs(x), y, z)
    # Robe: a bell with folds
    height = np.clip(y, 0, 1.25)
    radius = 0.15 + 0.27 * (1 - height / 1.25) ** 1.6
    around = np.arctan2(x, z)
    folds = 0.035 * (1 - height / 1.25) * np.cos(13 * around + 3 * height)
    robe = 0.8 * (np.sqrt(x**2 + (1.15 * z) ** 2) - radius - folds)
    robe = np.maximum(robe, np.abs(y - 0.625) - 0.625)
    torso = ellipsoid(p, (0, 1.28, 0), (0.19, 0.30, 0.14))
    figure = join(robe, torso, 0.12)
    figure = join(figure, limb(side, (0.0, 1.46, -0.01), (0.18, 1.44, -0.01), 0.08, 0.075), 0.08)
    # Arms, with wide sleeves, and hands joined in front
    figure = join(figure, limb(side, (0.20, 1.42, 0.0), (0.25, 1.14, 0.10), 0.062, 0.070), 0.05)
    figure = join(figure, limb(side, (0.25, 1.14, 0.10), (0.045, 1.26, 0.27), 0.075, 0.055), 0.04)
    figure = join(figure, limb(side, (0.018, 1.26, 0.28), (0.014, 1.40, 0.29), 0.028, 0.014), 0.03)
    head = ellipsoid(p, (0, 1.78, 0.03), (0.115, 0.155, 0.13))
    head = join(head, ellipsoid(p, (0, 1.70, 0.07), (0.08, 0.09, 0.08)), 0.05)
    head = join(head, limb(p, (0, 1.80, 0.15), (0, 1.745, 0.172), 0.012, 0.018), 0.02)
    head = cut(head, ball(side, (0.047, 1.795, 0.165), 0.026), 0.02)
    hair = ellipsoid(p, (0, 1.80, -0.02), (0.14, 0.165, 0.145)) + 0.005 * np.sin(22 * np.arctan2(np.abs(x), y - 1.55) + 8 * z)
    hair = np.maximum(hair, 0.7 * (z - 0.035) - 0.5 * (y - 1.82))
    hair = join(hair, limb(p, (0, 1.74, -0.08), (0, 1.50, -0.11), 0.12, 0.07), 0.08)
    figure = join(figure, limb(p, (0, 1.70, 0.0), (0, 1.50, -0.01), 0.058, 0.07), 0.06)
    figure = join(join(figure, head, 0.04), hair, 0.02)
    # Wings: feathers that overlap like a fan, bent backwards
    span = np.abs(x)
    bent = (span, y, z + 0.17 + 0.30 * np.clip(span - 0.1, 0, None) - 0.12 * np.clip(span - 0.1, 0, None) ** 2)
    wing = limb(bent, (0.07, 1.34, 0.02), (0.42, 1.86, 0.0), 0.060, 0.050)
    wing = join(wing, limb(bent, (0.42, 1.86, 0.0), (0.74, 1.80, 0.0), 0.050, 0.04), 0.06)
    bones = np.array([(0.07, 1.34), (0.42, 1.86), (0.74, 1.80)])
    roots = np.array([np.interp(np.linspace(0.15, 2, 9), range(3), bones[:, k]) for k in (0, 1)]).T
    tips = np.array([(0.18, 0.95), (0.27, 0.80), (0.37, 0.68), (0.48, 0.62), (0.60, 0.62), (0.72, 0.70), (0.83, 0.84), (0.93, 1.03), (1.01, 1.25)])
    for number, (root, tip) in enumerate(zip(roots, tips)):
        wing = join(wing, feather(bent, root, tip, 0.075, 0.018, 0.012 * (number % 2)), 0.03)
    for root, tip in zip(roots[1:], 0.55 * roots[1:] + 0.45 * tips[1:]):
        wing = join(wing, feather(bent, root, tip, 0.075, 0.020, -0.022), 0.03)
    figure = join(figure, wing, 0.03)
    base = np.maximum(np.sqrt(x**2 + z**2) - 0.50, np.abs(y + 0.05) - 0.06) - 0.015
    return join(figure, base, 0.04)


def feather(p, root, tip, width, thickness, behind):
    """A flat ellipsoid from `root` to `tip`, in the plane of x and y."""
    root, tip = np.asarray(root), np.asarray(tip)
    length = np.linalg.norm(tip - root)
    along, across = (tip - root) / length, np.array([root[1] - tip[1], tip[0] - root[0]]) / length
    middle = 0.5 * (root + tip)
    dx, dy = p[0] - middle[0], p[1] - middle[1]
    local = (dx * along[0] + dy * along[1], dx * across[0] + dy * across[1], p[2] + behind)
    return ellipsoid(local, (0, 0, 0), (0.5 * length + 0.02, width, thickness))


# Shape, lowest and highest corner of the grid, its step
SCULPTURES = {
    "bust": (bust, (-0.95, -0.45, -0.95), (0.95, 2.25, 0.70), 0.018),
    "angel": (angel, (-1.20, -0.20, -0.70), (1.20, 2.15, 0.62), 0.0125),
}


def sculpture(name):
    """Vertices and triangles of a sculpture."""
    shape, low, high, step = SCULPTURES[name]
    vertices, triangles = surface_net(shape, low, high, step)
    for _ in range(4):
        value, gradient = shape(vertices.T), slope(shape, vertices)
        move = -value[:, None] * gradient / np.maximum((gradient**2).sum(1), 0.1)[:, None]
        vertices += np.clip(move, -0.3 * step, 0.3 * step)
    return vertices, triangles


def slope(shape, points, step=1e-4):
    columns = []
    for axis in np.eye(3) * step:
        columns.append((shape((points + axis).T) - shape((points - axis).T)) / (2 * step))
    return np.array(columns).T


def surface_net(shape, low, high, step):
    """One vertex per cell of the grid that the surface crosses, one quadrilateral, as two triangles, per edge that it crosses."""
    axes = [np.arange(a, b, step) for a, b in zip(low, high)]
    values = shape(np.meshgrid(*axes, indexing="ij"))
    join_corners(values)
    inside = values < 0
    cells = np.array(values.shape) - 1
    corner = lambda array, offset: array[tuple(slice(o, o + n) for o, n in zip(offset, cells))]
    # Each vertex is the mean of the crossings of the twelve edges of its cell
    total, count = np.zeros((3, *cells)), np.zeros(cells)
    for axis in range(3):
        for offset in np.ndindex(2, 2, 2):
            if offset[axis]:
                continue
            end = tuple(o + (k == axis) for k, o in enumerate(offset))
            first, last = corner(values, offset), corner(values, end)
            crossed = (first < 0) != (last < 0)
            part = np.where(crossed, first / np.where(crossed, first - last, 1), 0)
            for k in range(3):
                total[k] += crossed * (offset[k] + (part if k == axis else 0))
            count += crossed
    active = count > 0
    number = np.full(cells, -1)
    number[active] = np.arange(active.sum())
    places = np.array(np.nonzero(active))
    vertices = (np.array(low)[:, None] + step * (places + total[:, active] / count[active])).T
    quadrilaterals = []
    for axis in range(3):
        ahead = np.roll(np.arange(3), -axis)[1:]
        edges = np.diff(inside.astype(int), axis=axis)
        for sign in (1, -1):
            at = np.array(np.nonzero(edges == sign)).T
            around = []
            for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)):
                cell = at.copy()
                cell[:, ahead[0]] -= a
                cell[:, ahead[1]] -= b
                around.append(number[tuple(cell.T)])
            # Outwards is where the function grows
            quadrilaterals.append(np.array(around if sign == -1 else around[::-1]).T)
    quadrilaterals = np.concatenate(quadrilaterals)
    return vertices, np.concatenate([quadrilaterals[:, [0, 1, 2]], quadrilaterals[:, [0, 2, 3]]])


def join_corners(values):
    """Fills corners of the grid between which two parts of the surface would share an edge: where signs around a face alternate."""
    is_done = False
    while not is_done:
        is_done = True
        for axes in ((0, 1), (1, 2), (2, 0)):
            face = np.moveaxis(values, axes, (0, 1))
            corners = np.array([face[:-1, :-1], face[1:, :-1], face[1:, 1:], face[:-1, 1:]])
            first, second, third, fourth = corners < 0
            at = np.array(np.nonzero((first == third) & (second == fourth) & (first != second)))
            outside = np.where(corners < 0, np.inf, corners)[:, *at].argmin(0)
            at[0] += np.isin(outside, (1, 2))
            at[1] += np.isin(outside, (2, 3))
            face[tuple(at)] = -1e-6
            is_done &= at.shape[1] == 0


def check(vertices, triangles):
    """Raises `ValueError` unless the mesh is closed, every edge belongs to two triangles of opposite sense, and the inside is inside."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    directed = edges[:, 0].astype(np.int64) * len(vertices) + edges[:, 1]
    opposite = edges[:, 1].astype(np.int64) * len(vertices) + edges[:, 0]
    if len(np.unique(directed)) != len(directed) or not np.isin(directed, opposite).all():
        raise ValueError("the mesh is not closed, or not a manifold")
    if volume(vertices, triangles) <= 0:
        raise ValueError("the mesh is inside out")


def volume(vertices, triangles):
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def write_ply(filename, vertices, triangles):
    header = ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
    header += [f"property float {name}" for name in ("x", "y", "z")]
    header += [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header\n"]
    faces = np.zeros(len(triangles), dtype=[("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    with open(filename, "wb") as file:
        file.write("\n".join(header).encode())
        file.write(vertices.astype("<f4").tobytes())
        file.write(faces.tobytes())


if __name__ == "__main__":
    name, filename = sys.argv[1:]
    mesh = sculpture(name)
    check(*mesh)
    write_ply(filename, *mesh)
    print(f"{name}: {len(mesh[0])} vertices, {len(mesh[1])} triangles, volume {volume(*mesh):.4f}")

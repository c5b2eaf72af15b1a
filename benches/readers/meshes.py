"""PLY, OBJ and STL files of other programs, as asperity and independent readers read them: the rows of a table.

    cargo build --release
    target/readers-venv/bin/python benches/readers/meshes.py target/meshes > rows.md

plyfile, trimesh, meshio and numpy-stl write the files into the folder, and all but numpy-stl read them. What they read is written as an OBJ with all digits, and light on it must
give the numbers that light on the file gives, to the last digit: so all vertices and faces are the same.
"""

import itertools
import json
import subprocess

import meshio
import numpy as np
import plyfile
import stl
import trimesh
from rows import print_rows

TRIANGLES, QUADS = "triangle", "quad"


def sheet(kind, faces=TRIANGLES):
    """Vertices of a rough sheet in the digits of a type, and faces of three or four corners each."""
    y, x = np.mgrid[:7, :6]
    z = np.random.default_rng(3).uniform(-0.3, 0.3, x.shape)
    vertices = np.stack([0.3 * x + 0.1 * z, 0.4 * y, z], axis=-1).reshape(-1, 3).astype(kind)
    corners = np.array([6 * j + i for j in range(6) for i in range(5)])
    cells = np.stack([corners, corners + 1, corners + 7, corners + 6], axis=-1)
    if faces == QUADS:
        return vertices, cells
    return vertices, np.concatenate([cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]])


def by_plyfile_written(folder):
    layouts = itertools.product(("f4", "f8", "i4", "u2"), (TRIANGLES, QUADS), ("text", "<", ">"), ("u1", "i4", "u2"), ("i4", "u4", "u1"), (False, True))
    for number, (kind, faces, order, length, index, has_more) in enumerate(layouts):
        vertices, cells = sheet("f8", faces)
        if kind[0] != "f":
            vertices = np.round(1000 * (vertices + 1))
        fields = [("x", kind), ("y", kind), ("z", kind)]
        if has_more:
            fields = [("nx", "f4"), *fields[:2], ("red", "u1"), fields[2], ("quality", "f8")]
        vertex = np.zeros(len(vertices), fields)
        for name, column in zip("xyz", vertices.T):
            vertex[name] = column
        face = np.zeros(len(cells), [("vertex_indices" if number % 2 else "vertex_index", index, (cells.shape[1],))] + [("flags", "u1")] * has_more)
        face[face.dtype.names[0]] = cells
        elements = [
            plyfile.PlyElement.describe(vertex, "vertex"),
            plyfile.PlyElement.describe(face, "face", len_types={face.dtype.names[0]: length}, val_types={face.dtype.names[0]: index}),
        ]
        if has_more:
            edges = np.zeros(3, [("vertex1", "i4"), ("vertex2", "i4")])
            elements.insert(1, plyfile.PlyElement.describe(edges, "edge"))
        path = folder / f"{number}.ply"
        comments = ["written by plyfile", "x y z"] if has_more else []
        plyfile.PlyData(elements, text=order == "text", byte_order="<" if order == "text" else order, comments=comments).write(str(path))
        yield path


def by_plyfile(path):
    read = plyfile.PlyData.read(str(path))
    vertex, face = read["vertex"], read["face"]
    name = next(one for one in ("vertex_indices", "vertex_index") if one in face.data.dtype.names)
    return np.stack([np.asarray(vertex[k], float) for k in "xyz"], axis=-1), [list(map(int, corners)) for corners in face[name]]


def by_trimesh_written(ending, *choices):
    def write(folder):
        for number, (options, kind, has_normals) in enumerate(itertools.product(choices, ("f4", "f8"), (False, True))):
            mesh = trimesh.Trimesh(*sheet(kind), process=False)
            if has_normals:
                mesh.vertex_normals
                mesh.visual.vertex_colors = [200, 100, 0, 255]
            path = folder / f"{number}.{ending}"
            written = trimesh.exchange.export.export_mesh(mesh, file_obj=None, file_type=options.get("type", ending), **options.get("more", {}))
            path.write_bytes(written if isinstance(written, bytes) else written.encode())
            yield path

    return write


def by_meshio_written(ending, *choices):
    def write(folder):
        faces = (TRIANGLES,) if ending == "stl" else (TRIANGLES, QUADS)
        for number, (options, kind, shape) in enumerate(itertools.product(choices, ("f4", "f8"), faces)):
            vertices, cells = sheet(kind, shape)
            path = folder / f"{number}.{ending}"
            meshio.Mesh(vertices, [(shape, cells)]).write(path, **options)
            yield path

    return write


def by_meshio(path):
    read = meshio.read(path)
    return read.points.astype(float), [list(map(int, corners)) for block in read.cells for corners in block.data]


def by_trimesh(path):
    read = trimesh.load(str(path), process=False, force="mesh")
    return np.asarray(read.vertices, float), read.faces.tolist()


def by_numpy_stl_written(folder):
    vertices, cells = sheet("f4")
    for number, (mode, name) in enumerate(itertools.product((stl.Mode.ASCII, stl.Mode.BINARY), ("", "sheet", "solid of one"))):
        mesh = stl.mesh.Mesh(np.zeros(len(cells), stl.mesh.Mesh.dtype))
        mesh.vectors = vertices[cells]
        mesh.name = name.encode()
        path = folder / f"{number}.stl"
        mesh.save(str(path), mode=mode)
        yield path


def traced(program, path):
    command = [program, "trace", path, "--theta", "30", "--eta", "1.5", "--rays", "500", "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise ValueError(" ".join(done.stderr.split()))
    summary = json.loads(done.stdout)
    surface = summary["config"]["surface"]
    return [surface[key] for key in ("vertices", "triangles", "extent")], summary["energy"]


def mesh_problem(program, path, read):
    vertices, faces = read(path)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["f " + " ".join(str(k + 1) for k in corners) for corners in faces]
    same = path.parent / "same.obj"
    same.write_text("\n".join(lines))
    ours, theirs = traced(program, path), traced(program, same)
    return None if ours == theirs else f"{ours}: {theirs}"


PLYFILE = "plyfile 1.1.5"
TRIMESH = f"trimesh {trimesh.__version__}"
MESHIO = f"meshio {meshio.__version__}"
BOTH = ({"binary": True}, {"binary": False})
ROWS = [
    ("PLY of plyfile: text and either byte order; coordinates and corners of all types; other properties and elements", by_plyfile_written, by_plyfile, PLYFILE, mesh_problem),
    ("PLY of trimesh: text and binary, with normals and colours", by_trimesh_written("ply", {}, {"more": {"encoding": "ascii"}}), by_plyfile, PLYFILE, mesh_problem),
    ("PLY of meshio: text and binary, triangles and quads", by_meshio_written("ply", *BOTH), by_meshio, MESHIO, mesh_problem),
    ("OBJ of trimesh: with normals and colours", by_trimesh_written("obj", {}, {"more": {"include_normals": True}}), by_trimesh, TRIMESH, mesh_problem),
    ("OBJ of meshio: triangles and quads", by_meshio_written("obj", {}), by_meshio, MESHIO, mesh_problem),
    ("STL of numpy-stl: text and binary, with names that begin with `solid`", by_numpy_stl_written, by_trimesh, TRIMESH, mesh_problem),
    ("STL of trimesh: text and binary", by_trimesh_written("stl", {}, {"type": "stl_ascii"}), by_trimesh, TRIMESH, mesh_problem),
    ("STL of meshio: text and binary", by_meshio_written("stl", *BOTH), by_trimesh, TRIMESH, mesh_problem),
]

if __name__ == "__main__":
    print_rows(__doc__, ROWS)

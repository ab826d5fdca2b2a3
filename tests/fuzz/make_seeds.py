#!/usr/bin/env python3
"""Writes the seed corpora of the fuzz targets: make_seeds.py FOLDER makes FOLDER/readers, FOLDER/search, FOLDER/worlds,
FOLDER/overlaps, FOLDER/features.

The seeds of the readers are small files, valid and invalid, of every format and variant in docs/input.md. Byte 0 of such
an input chooses the file's name (`kinds` in readers.cpp), and byte 1 the options. The other seeds are scenes
(seed_searches.py).
"""

import base64
import gzip
import io
import itertools
import json
import struct
import sys
import zipfile
import zlib
from pathlib import Path

from seed_searches import feature_inputs, overlap_inputs, search_inputs, world_inputs

# Indices of `kinds` in readers.cpp.
MESH, PLY, OBJ, STL, OFF, STL_MENDED, TXT, CSV, JSON, NPZ, NPZ_MENDED, NPY = range(12)
GLTF, GLB, GLB_MENDED, WORLD, POSES_TEXT, POSES_NPY, POSES_MENDED = range(12, 19)
FEATURES_TXT, FEATURES_CSV, FEATURES_JSON, FEATURES_NPZ, FEATURES_MENDED = range(19, 24)
THREEMF, MODEL, MODEL_AS_MESH, GZIP, GZIP_MENDED, PAIRS_GZIP = range(24, 30)
CANDIDATES, IMPACTS, NEAR = range(3)  # content of a list of features
FLOAT32, FLOAT64, UNWELDED, WELDED, GROUP, LABEL, FAN, STRICT = 2, 3, 4, 8, 32, 48, 64, 128  # options in readers.cpp

BOM = b"\xef\xbb\xbf"
TETRAHEDRON = ([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)])
# Concave: an arrow, an L, and a comb whose teeth a fan crosses.
ARROW = [(0, 0, 0), (2, 1, 0), (0, 2, 0), (0.5, 1, 0)]
L_SHAPE = [(0, 0, 0), (2, 0, 0), (2, 1, 0), (1, 1, 0), (1, 2, 0), (0, 2, 0)]
COMB = [(0, 0, 1), (7, 0, 1)] + [(7 - i, 3 - 2 * (i % 2), 1) for i in range(8)]


def ply_header(encoding, vertices, faces, scalar="float", index="int", count="uchar", extra_vertex=(), extra_face=(),
               before=(), after=(), name="vertex_indices"):
    lines = ["ply", f"format {encoding} 1.0", "comment made by hand", *before, f"element vertex {vertices}"]
    lines += [f"property {scalar} {axis}" for axis in "xyz"] + [f"property {p}" for p in extra_vertex]
    lines += [f"element face {faces}", f"property list {count} {index} {name}"] + [f"property {p}" for p in extra_face]
    return ("\n".join([*lines, *after, "end_header"]) + "\n").encode()


def ply_ascii(points, faces, groups=(), **header):
    if groups:
        header["extra_face"] = ["int group"]
    text = "".join(" ".join(map(str, p)) + "\n" for p in points)
    for face, group in itertools.zip_longest(faces, groups):
        text += " ".join(map(str, (len(face), *face))) + (f" {group}" if groups else "") + "\n"
    return ply_header("ascii", len(points), len(faces), **header) + text.encode()


FORMATS = {"char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "int64": "q", "uint64": "Q",
           "float": "f", "double": "d"}


def ply_binary(order, points, faces, groups=(), scalar="float", index="int", count="uchar", **header):
    encoding = "binary_little_endian" if order == "<" else "binary_big_endian"
    if groups:
        header["extra_face"] = ["int group"]
    data = b"".join(struct.pack(order + "3" + FORMATS[scalar], *(x if scalar in ("float", "double") else int(x)
                                                                for x in p)) for p in points)
    for face, group in itertools.zip_longest(faces, groups):
        data += struct.pack(order + FORMATS[count], len(face))
        data += struct.pack(f"{order}{len(face)}{FORMATS[index]}", *face)
        data += struct.pack(order + "i", group) if groups else b""
    return ply_header(encoding, len(points), len(faces), scalar, index, count, **header) + data


def ply_files():
    points, faces = TETRAHEDRON
    polygons = [(0, 1, 2, 3), (3, 2, 1, 0), (0, 1, 2)]
    yield ply_ascii(points, faces)
    yield ply_ascii(points, faces, groups=[3, -1, 3, 2147483647])
    yield ply_ascii(ARROW, [range(4)], groups=[5])
    yield ply_ascii(COMB, [range(10)])
    yield ply_ascii(L_SHAPE, [range(6), (0, 1, 2)], scalar="double", name="vertex_index")
    yield ply_ascii([], [])
    yield ply_ascii(points, faces).replace(b"\n", b"\r\n")
    yield ply_ascii(points, faces).replace(b"\n", b"\r")
    yield BOM + ply_ascii(points, faces)
    for order in "<>":
        for scalar, index, count in (("float", "int", "uchar"), ("double", "uint", "int"),
                                     ("short", "ushort", "ushort"), ("uchar", "uchar", "char"),
                                     ("int64", "uint64", "uint64"), ("float", "short", "short")):
            yield ply_binary(order, points, polygons, groups=[1, 1, 2], scalar=scalar, index=index, count=count)
        yield ply_binary(order, COMB, [range(10)])
    mixed = ply_header("ascii", 3, 1, extra_vertex=["float nx", "uchar red", "list uchar float weights"],
                       extra_face=["uchar red", "list uchar float texcoord", "int label"],
                       before=["element camera 1", "property float fov"], after=["obj_info none", "element edge 2",
                                                                                "property int vertex1"])
    rows = "90\n0 0 0 1 9 0\n1 0 0 1 9 2 .5 .5\n0 1e-400 0 1 9 1 7\n3 0 1 2 200 2 0 1 -4\n0\n1\n"
    yield mixed + rows.encode()
    strips = ply_header("ascii", 4, 0).replace(b"element face 0\nproperty list uchar int vertex_indices\n",
                                               b"element tristrips 2\nproperty list int int vertex_indices\n")
    corners = "".join("%g %g %g\n" % tuple(p) for p in points).encode()
    yield strips + corners + b"8 0 1 2 3 -1 1 2 3\n4 3 3 2 1\n"
    yield strips[:strips.index(b"element tristrips")] + b"end_header\n" + corners
    yield ply_ascii(points, [(0, 1), (0, 1, 2), (), (3,), (0, 1, 2, 3), (1, 2)], groups=range(6))
    yield ply_header("ascii", 1, 1, after=["element tristrips 1", "property list int int vertex_indices"])
    yield ply_header("ascii", 0, 0, extra_face=["float group"]) + b"\n"
    yield ply_header("ascii", 0, 0).replace(b"element face", b"element tristrips")
    yield ply_header("ascii", 1000000, 1) + b"0 0 0\n"
    yield ply_header("binary_little_endian", 2**40, 2**62) + bytes(40)
    yield ply_ascii(points, faces) + b"0 0 0\n"
    yield ply_binary("<", [(1, float("nan"), 2)], [])
    yield ply_ascii([(1e39, 0, 0)], [], scalar="double")
    yield ply_ascii(points, [(0, 1)])
    yield ply_ascii(points, [(0, 1, 4)])


def obj_text(points, faces):
    return ("".join(f"v {x} {y} {z}\n" for x, y, z in points) +
            "".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces)).encode()


def obj_files():
    points, faces = TETRAHEDRON
    text = obj_text(points, faces)
    yield text
    yield text.replace(b"\n", b"\r\n")
    yield text.replace(b"\n", b"\r")
    yield BOM + text
    yield b"v 1e9223372036854775807 0 0\n"
    yield obj_text(ARROW, [range(4)])
    yield obj_text(COMB, [range(10), (0, 1, 2, 3)])
    yield obj_text([(f"{x}e{y % 2 * 250}", f"{y}e200", 0) for x, y, z in COMB], [range(10)])
    yield obj_text([(i, i * i, 0) for i in range(300)], [range(300)])
    yield obj_text([(0, 0, 0), (2, 2, 0), (2, 0, 0), (0, 2, 0)], [range(4)])
    yield obj_text([(0, 0, 0), (4, 0, 0), (4, 4, 0), (1, 1, 0), (2, 1, 0), (1, 2, 0), (1, 1, 0)], [range(7)])
    yield (b"# comment\nmtllib a.mtl\no body\ng one two\nv 0 0 0 1.0\nv 1 0 0 .5 .5 .5\nv 0 1 0\nvt 0 0\nvn 0 0 1\n"
           b"usemtl red\ns off\nf 1/1/1 2//1 3/1\nf -3 -2 -1\nfo 1 2 3\nl 1 2\np 1\n")
    yield b"v 0 0 0\nv 1 \\\n 0 0\nv 0 1 0\nf 1 \\\r\n2 3\n"
    yield b"f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n"
    yield b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1// 2/1/ 3/\nf 1 2\nf\nf 1//1 2/-1 3//\n"
    yield b"v +1e0 -0 4.9e-324\nv 1e308 -1e308 1e-400\nv 0.1 .2 3.\nf 1 2 3 # end"
    yield b"v 1 2 3\nvp 1\ncstype bezier\ndeg 3\nsurf 0 1 0 1 1 2 3\nend\n"
    yield b"call other.obj\nv 0 0 0\nsubdiv 2\n"
    yield b"v 0 0 0\nf 0 1 2\n"
    yield b"v 0 0 0\nf 1 2 99999999999999999999\n"
    yield b"v 0 0 nan\n"


def stl_ascii(triangles, name="cube", upper=False):
    text = f"solid {name}\n"
    for triangle in triangles:
        text += " facet normal 0 0 1\n  outer loop\n"
        text += "".join(f"   vertex {x} {y} {z}\n" for x, y, z in triangle) + "  endloop\n endfacet\n"
    text += f"endsolid {name}\n"
    return (text.upper() if upper else text).encode()


def stl_binary(triangles, count=None, title=b"binary"):
    data = title.ljust(80) + struct.pack("<I", len(triangles) if count is None else count)
    for triangle in triangles:
        data += struct.pack("<12fH", 0, 0, 1, *itertools.chain(*triangle), 0)
    return data


def stl_files():
    points, faces = TETRAHEDRON
    triangles = [[points[i] for i in face] for face in faces]
    yield stl_ascii(triangles)
    yield stl_ascii(triangles, upper=True)
    yield stl_ascii(triangles).replace(b"\n", b"\r\n")
    yield stl_ascii(triangles).replace(b"\n", b"\r")
    yield BOM + stl_ascii(triangles)
    yield stl_ascii(triangles[:1], "a") + stl_ascii(triangles[1:], "")
    yield stl_ascii([ARROW, L_SHAPE])
    yield stl_ascii(triangles).replace(b"endloop", b"end loop of it").replace(b"endfacet", b"END FACET")
    yield stl_ascii(triangles).replace(b"  outer", b"  color 1 0 0\n  outer").rsplit(b"endsolid")[0]
    yield stl_ascii([])
    yield stl_binary(triangles)
    yield stl_binary(triangles, title=b"solid but binary")
    yield stl_binary([[(0.0, -0.0, 0.0), (-0.0, 0.0, 0.0), (1e-45, 3e38, 1)]])
    yield stl_binary([])
    yield stl_binary(triangles) + b"trailing"
    yield stl_binary(triangles, count=5)
    yield stl_binary(triangles, count=0x7fffffff)
    yield stl_binary([[(float("inf"), 0, 0)] * 3])


def off_text(points, faces, header="OFF"):
    text = f"{header}\n{len(points)} {len(faces)} 0\n" + "".join(f"{x} {y} {z}\n" for x, y, z in points)
    return (text + "".join(" ".join(map(str, (len(f), *f))) + "\n" for f in faces)).encode()


def off_files():
    points, faces = TETRAHEDRON
    text = off_text(points, faces)
    yield text
    yield text.replace(b"\n", b"\r\n")
    yield text.replace(b"\n", b"\r")
    yield BOM + text
    yield text[4:]
    yield off_text(COMB, [range(10)])
    yield b"STOFF # with texture\n3 1 3\n\n0 0 0 0 0\n1 0 0 1 0\n# between\n0 1 0 0 1\n3 0 1 2 255 0 0\n"
    yield b"COFF 3 1\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2 7\n"
    yield b"NOFF\n1 0 0\n0 0 0 0 0 1\n"
    yield b"NCOFF3 4 0\n0 0 0 1\n1 0 0\n0 1 0\n2 0 1\n3 0 # next line\n1\n2\n0\n4 0 1\n 2 1 9 9\n"
    yield "\ufeffOFF\n0 0 0\n".encode("utf-16-le")
    yield b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 1\n"
    yield b"STCNOFF\n0 0 0\n"
    yield b"4OFF\n1 0 0\n0 0 0 1\n"
    yield b"nOFF\n2\n1 0 0\n0 0\n"
    yield b"OFF BINARY\n\0\0\0\1"
    yield b"OFF\n1000000 1000000 0\n0 0 0\n"
    yield b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"
    yield text + b"3 0 1 2\n"


def npy(dtype, shape, data, fortran=False, version=1):
    header = f"{{'descr': '{dtype}', 'fortran_order': {fortran}, 'shape': {shape}, }}"
    header = header.ljust(63 - 10) + "\n"
    length = struct.pack("<H" if version == 1 else "<I", len(header))
    return b"\x93NUMPY" + bytes([version, 0]) + length + header.encode() + data


def npy_files():
    pairs = [0, 1, 0, 5, 2, 3]
    for code, dtype in (("<6i", "<i4"), (">6i", ">i4"), ("<6I", "<u4"), ("<6q", "<i8"), (">6Q", ">u8")):
        yield npy(dtype, "(3, 2)", struct.pack(code, *pairs))
    yield npy("<i4", "(3, 2)", struct.pack("<6i", *pairs), fortran=True)
    yield npy("<i4", "(3,2)", struct.pack("<6i", *pairs), version=2)
    yield npy("<i4", "(0, 2)", b"")
    yield npy("<i4", "(2, 2)", struct.pack("<6i", *pairs))
    yield npy("<i8", "(1, 2)", struct.pack("<2q", -1, 1 << 40))
    yield npy("<f8", "(1, 2)", bytes(16))
    yield npy("<i4", "(4611686018427387904, 2)", bytes(16))


def npz(content, method=zipfile.ZIP_STORED, name="pairs.npy"):
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", method) as archive:
        archive.writestr(zipfile.ZipInfo(name), content, method)
        archive.writestr(zipfile.ZipInfo("hit.npy"), npy("|u1", "(2,)", b"\1\0"), method)
    return out.getvalue()


def pair_files():
    text = b"0 1\n0 5\n2 3\n"
    for kind, file in ((TXT, text), (TXT, b"# pairs\n\n 0 1 point 0 0 0\r\n0 5 x\n+2 3"), (TXT, BOM + text),
                       (TXT, text.replace(b"\n", b"\r")), (TXT, b"0, 1\n2 ,3\n"), (TXT, b"0\n1\n"), (TXT, b"-1 2\n"),
                       (TXT, b"0 4294967296\n"), (TXT, b"")):
        yield kind, file
    for file in (b"a,b\n0,1\n0,5\n", b"a,b,kind,points,x0,y0,z0\n0,1,point,1,0.5,1e-3,2\n", b"0, 1\r\n2 ,3\r\n",
                 BOM + b"a,b\n0,1\n", b"a,b\r0,1\r", b"a,b\n0\n", b"a,b\n0,x\n", b"\"0\",\"1\"\n", b"a,b\n"):
        yield CSV, file
    document = {"pairs": [[0, 1], [0, 5]], "contacts": [{"kind": "point", "points": [[0.5, 1, 2]]}],
                "statistics": {"milliseconds": 0.1, "backend": "cpu", "pairs": 2}}
    for file in (json.dumps(document), json.dumps(document, indent=2), '{"pairs":[]}', '{"a":{"pairs":[[1,2]]}}',
                 '{"pairs":[[0,1,2]]}', '{"pairs":[[0,-1]]}', '{"pairs":[[0,1e3]]}', '[[0,1]]', '{"pairs":[[0,1]',
                 '{"x":"\\u00e9\\n","pairs":[[1,2]],"pairs":[[3,4]]}', '{"pairs":null}', '{"a":true,"pairs":[]}', "[" * 200):
        yield JSON, file.encode()
    for kind, file in itertools.product((NPZ_MENDED, NPY), npy_files()):
        yield kind, file
    for method in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        yield NPZ, npz(npy("<i4", "(3, 2)", struct.pack("<6i", 0, 1, 0, 5, 2, 3)), method)
    yield NPZ, npz(npy("<i4", "(20000, 2)", bytes(160000)), zipfile.ZIP_DEFLATED)
    yield NPZ, npz(b"", name="other.npy")
    yield NPZ, npz(npy("<i4", "(0, 2)", b""))[:-10]


def scene(nodes, primitive=(), binary=None, **more):
    """Returns a glTF document with one mesh, a tetrahedron, and the bytes of its buffer.

    `primitive` adds to the primitive and `more` to the document.
    """
    points, faces = TETRAHEDRON
    corners = list(itertools.chain(*faces))
    if binary is None:
        binary = struct.pack("<12f", *itertools.chain(*points)) + struct.pack("<12H", *corners)
    positions = {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"}
    indices = {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}
    views = [{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 24}]
    document = {"asset": {"version": "2.0"}, "nodes": nodes, "accessors": [positions, indices], "bufferViews": views,
                "buffers": [{"byteLength": len(binary)}],
                "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, **dict(primitive)}]}], **more}
    return document, binary


def scenes():
    half = 0.7071067811865476
    two = [{"name": "a", "mesh": 0}, {"name": "a", "mesh": 0, "translation": [0.5, 0, 0]}]
    chain = [{"mesh": 0, "children": [1], "rotation": [0, 0, half, half]},
             {"mesh": 0, "scale": [1, -2, 0.5], "children": [2]}, {"translation": [1e300, 0, 0], "mesh": 0}]
    yield scene(two)
    yield scene(chain, scene=0, scenes=[{"nodes": [0]}])
    yield scene([{"children": [1]}, {"children": [0]}], scenes=[{"nodes": [0]}])
    yield scene([{"mesh": 0, "matrix": [0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 1, 2, 3, 1]}])
    for mode in (0, 5, 6):
        yield scene(two, {"mode": mode})
    # Quantised positions between other data, indices of one byte, two primitives over the same positions.
    binary = b"".join(struct.pack("<3h2x", *(100 * x for x in p)) for p in TETRAHEDRON[0]) + bytes([0, 1, 2, 3])
    yield scene(two, binary=binary, extensionsRequired=["KHR_mesh_quantization"],
                meshes=[{"name": "small", "primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 6},
                                                         {"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}]}],
                accessors=[{"bufferView": 0, "componentType": 5122, "count": 4, "type": "VEC3", "normalized": True},
                           {"bufferView": 1, "componentType": 5121, "count": 4, "type": "SCALAR"}],
                bufferViews=[{"buffer": 0, "byteLength": 32, "byteStride": 8},
                             {"buffer": 0, "byteOffset": 32, "byteLength": 4}])
    # Thirty primitives, all of the same strip.
    strip = {"attributes": {"POSITION": 0}, "indices": 1, "mode": 5}
    yield scene([{"mesh": 0}], binary=bytes(48) + bytes(i % 3 for i in range(1500)),
                meshes=[{"primitives": [strip] * 30}],
                accessors=[{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                           {"bufferView": 1, "componentType": 5121, "count": 1500, "type": "SCALAR"}],
                bufferViews=[{"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 1500}])
    sparse = {"count": 2, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 0}}
    positions = {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": sparse}
    indices = {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"}
    yield scene(two, accessors=[positions, indices])
    yield scene(two, accessors=[{**positions, "bufferView": 0}, {**indices, "sparse": {}}])
    yield scene([{"mesh": 0}], meshes=[{"primitives": [{"attributes": {"NORMAL": 0}},
                                                       {"attributes": {"POSITION": 0}, "indices": 1}]}])
    yield scene([{"mesh": 0, "skin": 0, "weights": [1]}], {"targets": [{"POSITION": 0}]})
    yield scene([{"mesh": 1}])
    yield scene([])
    yield scene(two, asset={"version": "1.0"})


def world_files():
    for document, binary in scenes():
        text = json.dumps(document, separators=(",", ":")).encode()
        yield GLB_MENDED, text + b"\0" + binary
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I", len(text)) + b"JSON" + text + struct.pack("<I", len(binary)) + b"BIN\0" + binary
        yield GLB, b"glTF" + struct.pack("<II", 2, 12 + len(chunks)) + chunks
        document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
        yield GLTF, json.dumps(document, indent=1).encode()
        yield WORLD, json.dumps(document).encode()
    yield WORLD, off_text(*TETRAHEDRON)
    yield WORLD, stl_binary([[(0, 0, 0), (1, 0, 0), (0, 1, 0)]])


def pose_files():
    row = [0.1, 0, 1, -2.5, 1e300, -0.0, 4.9e-324, 3, 1, 0, 1 / 3, 7]
    text = ",".join(map(repr, row)) + "\n"
    yield POSES_TEXT, text.encode() * 6
    yield POSES_TEXT, b"# poses\nr00 r01 and so on\n" + text.replace(",", " ").encode() + b"\r\n"
    yield POSES_TEXT, BOM + text.strip().encode() + b", 0 0 0 +1"
    yield POSES_TEXT, b"1,2,3\n"
    yield POSES_TEXT, b"1,1e999,nan,4,5,6,7,8,9,10,11,12\n"
    square = [*row, 0, 0, 0, 1]
    for code, dtype in (("<{}d", "<f8"), (">{}f", ">f4")):
        small = [min(x, 9.0) for x in row]
        data = struct.pack(code.format(24), *small, *small)
        for shape in ("(2, 12)", "(2, 3, 4)", "(2, 1, 3, 4)", "(2, 4)", "(3, 12)"):
            yield POSES_NPY, npy(dtype, shape, data)
        yield POSES_NPY, npy(dtype, "(3, 4, 2)", data, fortran=True)
    yield POSES_NPY, npy("<f8", "(1, 4, 4)", struct.pack("<16d", *square))
    for kind in range(16):
        numbers = row if kind < 8 else square
        code = "<>"[kind % 4 // 2] + str(len(numbers)) + "df"[kind % 2]
        yield POSES_MENDED, bytes([kind]) + 6 * struct.pack(code, *(min(x, 9.0) for x in numbers))


KIND_NAMES = {"vf": "vertex_face", "ee": "edge_edge", "ef": "edge_face", "ff": "face_face", "ve": "vertex_edge",
              "vv": "vertex_vertex"}


def archive_of_arrays(arrays):
    """Returns a zip archive of arrays of pairs and of numbers by name."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name, rows in arrays.items():
            if isinstance(rows[0], list):
                data = struct.pack(f"<{2 * len(rows)}i", *itertools.chain(*rows))
                file = npy("<i4", f"({len(rows)}, 2)", data)
            else:
                file = npy("<f8", f"({len(rows)},)", struct.pack(f"<{len(rows)}d", *rows))
            archive.writestr(zipfile.ZipInfo(name + ".npy"), file)
    return out.getvalue()


def feature_files():
    """Yields (kind of file, content of the list, file)."""
    ids = {"vf": "7 1", "ee": "0 7 2 9", "ef": "9 2 3", "ff": "5 4", "ve": "8 0 7", "vv": "3 4"}
    of_files = {"vf": "0:7 1:1", "ee": "1:0 1:7 0:2 0:9", "ef": "0:9 0:2 1:3", "ff": "1:5 0:4", "ve": "1:8 0:0 0:7",
                "vv": "1:3 1:4"}
    cells = {"vf": "7,1,,,,", "ee": ",,0,7,2,9", "ef": ",3,2,9,,", "ff": ",5,4,,,", "ve": "8,,0,7,,", "vv": "3,,4,,,"}
    for list_of, end, array in ((CANDIDATES, "", ""), (IMPACTS, " 0.5 0", "toi"), (NEAR, " inf", "squared_distance")):
        without = {CANDIDATES: (), IMPACTS: ("ef",), NEAR: ("ef", "ff")}[list_of]
        kinds = [kind for kind in ids if kind not in without]
        for row in (ids, of_files):
            yield FEATURES_TXT, list_of, "\n".join(["# theirs", *(f"{k} {row[k]}{end}" for k in kinds)]).encode()
        for file in (b"", b"vf 1\n", b"ee 1 1 2 3\n", b"ff 1 2\n", b"vf 0 0 0 1\nvf 0 1 0 0 0\n"):
            yield FEATURES_TXT, list_of, file
        numbers = "" if list_of == CANDIDATES else ",0,1"
        rows = "\n".join(f"{kind},{cells[kind]}{numbers}" for kind in kinds).encode()
        for file in (rows, b"kind,vertex,face\n" + rows, b"vf,1,2\n"):
            yield FEATURES_CSV, list_of, file
        arrays = {"edges": [[0, 7], [2, 9]]}
        for kind in kinds:
            name = KIND_NAMES[kind]
            arrays["vertex_vertices" if kind == "vv" else name + "s"] = [[0, 1]]
            if array:
                arrays[f"{name}_{array}"] = [0.5]
        for more in ({}, {"edges": []}, {"vertex_faces": [[1, -1]]}, {"face_faces": [[0, 1.5]]}, {"first_edge": [0]}):
            yield FEATURES_JSON, list_of, json.dumps({**arrays, **more}).encode()
        yield FEATURES_NPZ, list_of, archive_of_arrays(arrays)
    for file in npy_files():
        yield FEATURES_MENDED, CANDIDATES, file


CORE = b"http://schemas.microsoft.com/3dmanufacturing/core/2015/02"
PRODUCTION = b"http://schemas.microsoft.com/3dmanufacturing/production/2015/06"
MODEL_TYPE = b"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"


def models():
    """Yields the children of a 3MF model part and its attributes."""
    points, faces = TETRAHEDRON
    mesh = b"<mesh><vertices>" + b"".join(b'<vertex x="%g" y="%g" z="%g"/>' % p for p in points)
    mesh += b"</vertices><triangles>" + b"".join(b'<triangle v1="%d" v2="%d" v3="%d"/>' % f for f in faces)
    part = b'<object id="1" name="part" type="support">' + mesh + b"</triangles></mesh></object>"
    pair = (b'<object id="2"><components><component objectid="1" transform="2 0 0 0 1 0 0 0 1 5 6 7"/>'
            b'<component objectid="1"/></components></object>')
    turned = b'<item objectid="2" transform="0 1 0 -1 0 0 0 0 1 1 2 3"/>'
    yield b"<resources>" + part + b'</resources><build><item objectid="1"/></build>', b' unit="inch"'
    yield b"<resources>" + part + pair + b"</resources><build>" + turned + turned + b"</build>", b""
    yield (b'<resources><object id="1"><components><component p:path="/m" objectid="1"/></components></object>'
           b'</resources><build><item objectid="1"/></build>'), b' requiredextensions="p"'
    yield b'<metadata name="a">&amp;</metadata><resources/><build/>', b""


def compressed_files():
    for children, attributes in models():
        root = b'<model xmlns="' + CORE + b'" xmlns:p="' + PRODUCTION + b'"' + attributes + b">"
        model = root + children + b"</model>"
        yield MODEL, model
        yield MODEL_AS_MESH, model
        relations = (b'<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">'
                     b'<Relationship Target="/m" Type="' + MODEL_TYPE + b'"/></Relationships>')
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, content in (("_rels/.rels", relations), ("m", model)):
                archive.writestr(zipfile.ZipInfo(name), content, zipfile.ZIP_DEFLATED)
        yield THREEMF, out.getvalue()
    text = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    for names in (["a.obj"], ["readme", "__MACOSX/a.obj", "a.OBJ"], ["a.obj", "b.obj"], []):
        out = io.BytesIO()
        with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
            for name in names:
                with archive.open(zipfile.ZipInfo(name), "w", force_zip64=True) as entry:
                    entry.write(text)
        yield OBJ, out.getvalue()
    yield GZIP_MENDED, text
    yield PAIRS_GZIP, b"a,b\n0,1\n"
    yield GZIP, gzip.compress(text, mtime=0)
    yield GZIP, gzip.compress(text[:9], mtime=0) + gzip.compress(text[9:], mtime=0)


def reader_inputs():
    for kind, files in ((PLY, ply_files()), (OBJ, obj_files()), (STL, stl_files()), (OFF, off_files())):
        for number, file in enumerate(files):
            yield bytes([kind, 0]), file
            some = (FLOAT32, WELDED, FLOAT64 | UNWELDED, FAN, STRICT, FAN | STRICT | WELDED)
            yield bytes([MESH, some[number % len(some)]]), file
            if kind == PLY:
                yield bytes([kind, GROUP]), file
            if kind == STL:
                yield bytes([STL_MENDED, 0]), file
    yield from ((bytes([PLY, LABEL]), file) for file in ply_files() if b"label" in file)
    for kind, file in pair_files():
        yield bytes([kind, 0]), file
    for kind, file in world_files():
        for options in (0, FLOAT64, STRICT | UNWELDED, WELDED):
            yield bytes([kind, options]), file
    for kind, file in compressed_files():
        for options in (0, FLOAT32, STRICT, WELDED):
            yield bytes([kind, options]), file
    for kind, list_of, file in feature_files():
        yield bytes([kind, list_of]), file
    for kind, file in pose_files():
        for bodies in range(4):
            yield bytes([kind, bodies]), file


def write(folder, inputs):
    folder.mkdir(parents=True, exist_ok=True)
    for content in inputs:
        (folder / f"seed-{zlib.crc32(content):08x}").write_bytes(content)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    write(folder / "readers", (options + file for options, file in reader_inputs()))
    write(folder / "search", search_inputs())
    write(folder / "worlds", world_inputs())
    write(folder / "overlaps", overlap_inputs())
    write(folder / "features", feature_inputs())


if __name__ == "__main__":
    main()

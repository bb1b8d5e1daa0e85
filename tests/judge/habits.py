"""What programs write: one small film each, in which a spear passes through a floor, or what a reader must say of it."""

import base64
import struct
import zlib
from xml.sax.saxutils import quoteattr

import numpy as np

FLOOR = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
SPEAR = np.array([[0.2, 0.2, -0.5], [0.2, 0.2, 0.5], [0.9, 0.9, 0.5]])  # passes through FLOOR
CROSSED = np.vstack([FLOOR, SPEAR])
APART = np.vstack([FLOOR, SPEAR + [0, 0, 2]])
FACES = [[0, 1, 2], [3, 4, 5]]
TETRAHEDRA = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.2, 1.5], [1.2, 0.2, 1.5], [0.2, 1.2, 1.5], [0.2, 0.2, 2.5]], float)
FALL = np.array([[0, 0, 0]] * 4 + [[0, 0, -1.0]] * 4)  # the second tetrahedron, into the first


def text(folder, name, content):
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# --- OBJ


def obj_lines(x):
    return "".join("v %.9g %.9g %.9g\n" % tuple(p) for p in x)


def blender_obj(folder):
    """Names, normals, textures, a material, colours behind the coordinates."""
    vertices = "".join("v %.6f %.6f %.6f 0.8 0.8 0.8\n" % tuple(p) for p in CROSSED)
    head = "# Blender 4.2.0\n# www.blender.org\nmtllib cloth.mtl\no Cloth\n"
    return text(folder, "cloth_0001.obj", head + vertices + "vn 0 0 1\nvt 0 0\ns 0\nusemtl None\nf 1/1/1 2/1/1 3/1/1\nf 4/1/1 5/1/1 6/1/1\n")


def windows_obj(folder):
    """A byte order mark and carriage returns."""
    lines = "\ufeff" + obj_lines(CROSSED) + "f 1 2 3\nf 4 5 6\n"
    return text(folder, "f.obj", lines.replace("\n", "\r\n"))


def relative_blocks(folder):
    """Each block counts back from its own vertices."""
    return text(folder, "f.obj", f"o a\n{obj_lines(FLOOR)}f -3 -2 -1\no b\n{obj_lines(SPEAR)}f -3 -2 -1\n")


def tabbed_obj(folder):
    return text(folder, "f.obj", (obj_lines(CROSSED) + "f 1 2 3\nf 4 5 6\n").replace(" ", "\t"))


def continued_obj(folder):
    """Long faces go on in the next line, with a blank before the backslash or none."""
    return text(folder, "f.obj", obj_lines(CROSSED) + "f 1 2 \\\n3\nf 4 5\\\r\n 6\n")


def backslash_comment(folder):
    """The folder of Windows in a comment is no continuation."""
    return text(folder, "f.obj", "# C:\\scenes\\\n" + obj_lines(CROSSED) + "f 1 2 3 # floor\nf 4 5 6\n")


def faces_first(folder):
    return text(folder, "f.obj", "f 1 2 3\nf 4 5 6\n" + obj_lines(CROSSED))


def rods_of_houdini(folder):
    """A polyline through the floor, spaces in front of the keyword."""
    return text(folder, "f.obj", obj_lines(CROSSED) + "g floor\n  f 1 2 3\n  l 4 5 6\n")


def concave_obj(folder):
    """An L and a needle through its notch, which a fan from the first corner of the L would cover."""
    corners = [(2, 0), (2, 1), (1, 1), (1, 2), (0, 2), (0, 0)]
    needle = [(1.2, 1.2, -1), (1.2, 1.2, 1), (1.25, 1.2, 1)]
    return text(folder, "f.obj", obj_lines([(*c, 0) for c in corners] + needle) + "f 1 2 3 4 5 6\nf 7 8 9\n")


# --- PLY


def ply(head, body):
    return f"ply\nformat {head}\nend_header\n".encode() + body


def meshlab_ply(folder):
    """Colours at vertices, flags and texture coordinates at faces."""
    body = b"".join(struct.pack("<3f4B", *p, 255, 255, 255, 255) for p in CROSSED)
    body += b"".join(struct.pack("<B3iB6fi", 3, *f, 6, *[0.5] * 6, 0) for f in FACES)
    head = "binary_little_endian 1.0\ncomment VCGLIB generated\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
    head += "".join(f"property uchar {c}\n" for c in ("red", "green", "blue", "alpha"))
    head += "element face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int flags"
    return text(folder, "f.ply", ply(head, body))


def wide_indices(kind):
    """Counts and corners of other integer types."""
    count, corner = kind

    def write(folder):
        code = {"uchar": "B", "ushort": "H", "int": "i", "uint": "I"}
        body = b"".join(struct.pack(">3d", *p) for p in CROSSED)
        body += b"".join(struct.pack(f">{code[count]}3{code[corner]}", 3, *f) for f in FACES)
        head = "binary_big_endian 1.0\nelement vertex 6\nproperty double x\nproperty double y\nproperty double z\n"
        return text(folder, "f.ply", ply(f"{head}element face 2\nproperty list {count} {corner} vertex_indices", body))

    return write


def stanford_strips(folder):
    """All faces in one list of strips, -1 between two."""
    head = "ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement tristrips 1\nproperty list int int vertex_indices"
    rows = "".join("%g %g %g\n" % tuple(p) for p in CROSSED) + "7 0 1 2 -1 3 4 5\n"
    return text(folder, "f.ply", ply(head, rows.encode()))


def blender_ply_edges(folder):
    """Lone edges as an element."""
    head = "ascii 1.0\ncomment Created in Blender version 4.2.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
    head += "element face 1\nproperty list uchar uint vertex_indices\nelement edge 2\nproperty int vertex1\nproperty int vertex2"
    rows = "".join("%g %g %g\n" % tuple(p) for p in CROSSED) + "3 0 1 2\n3 4\n4 5\n"
    return text(folder, "f.ply", ply(head, rows.encode()))


# --- STL


def capital_stl(folder):
    rows = "".join(
        "FACET NORMAL 0 0 0\nOUTER LOOP\n" + "".join("VERTEX %g %g %g\n" % tuple(CROSSED[v]) for v in f) + "ENDLOOP\nENDFACET\n" for f in FACES
    )
    return text(folder, "f.stl", f"SOLID CAD\n{rows}ENDSOLID CAD\n")


def solid_binary_stl(folder):
    """A binary file whose comment begins as a text does."""
    body = b"".join(struct.pack("<12fH", 0, 0, 0, *CROSSED[f].ravel(), 0) for f in FACES)
    return text(folder, "f.stl", b"solid made by CAD".ljust(80) + struct.pack("<I", 2) + body)


# --- Gmsh


def gmsh_41(folder):
    """Names of groups, entities, points of the geometry, node numbers with holes."""
    nodes = "\n".join(str(10 * (k + 1)) for k in range(6)) + "\n" + "\n".join("%g %g %g" % tuple(p) for p in CROSSED)
    body = '$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 "skin"\n$EndPhysicalNames\n$Entities\n0 0 1 0\n1 0 0 0 1 1 1 1 1 0\n$EndEntities\n'
    body += f"$Nodes\n1 6 10 60\n2 1 0 6\n{nodes}\n$EndNodes\n"
    return text(folder, "f.msh", body + "$Elements\n2 3 1 3\n0 1 15 1\n1 10\n2 1 2 2\n2 10 20 30\n3 40 50 60\n$EndElements\n")


def gmsh_22_binary(folder):
    nodes = b"".join(struct.pack("<i3d", k + 1, *p) for k, p in enumerate(CROSSED))
    elements = struct.pack("<3i", 2, 2, 2) + b"".join(struct.pack("<6i", k + 1, 1, 1, *(v + 1 for v in f)) for k, f in enumerate(FACES))
    head = b"$MeshFormat\n2.2 1 8\n" + struct.pack("<i", 1) + b"\n$EndMeshFormat\n"
    return text(folder, "f.msh", head + b"$Nodes\n6\n" + nodes + b"\n$EndNodes\n$Elements\n2\n" + elements + b"\n$EndElements\n")


def gmsh_huge_numbers(folder):
    """Node numbers say nothing of how many there are."""
    numbers = [1, 2, 3, 4, 5, 2_000_000_000]
    nodes = "".join("%d %g %g %g\n" % (n, *p) for n, p in zip(numbers, CROSSED))
    elements = "1 2 2 1 1 1 2 3\n2 2 2 1 1 4 5 2000000000\n"
    return text(folder, "f.msh", f"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n6\n{nodes}$EndNodes\n$Elements\n2\n{elements}$EndElements\n")


# --- VTK


def array(values, kind, name="", components=1, encode=None):
    """A <DataArray>; encode: of bytes, to what stands in the file."""
    values = np.asarray(values).ravel()
    attributes = f"type={quoteattr(kind)} Name={quoteattr(name)} NumberOfComponents=\"{components}\""
    if encode is None:
        return f'<DataArray {attributes} format="ascii">{" ".join(map(repr, values.tolist()))}</DataArray>'
    types = {"Float64": "<f8", "Float32": "<f4", "Int64": "<i8", "Int32": "<i4", "UInt8": "u1"}
    return f"<DataArray {attributes} {encode(values.astype(types[kind]).tobytes())}</DataArray>"


def piece(x, cells, types, fields=None, encode=None):
    """fields: name -> [n, components] at the points."""
    data = "".join(array(v, "Float64", n, np.atleast_2d(np.asarray(v).T).shape[0], encode) for n, v in (fields or {}).items())
    ends = np.cumsum([len(c) for c in cells])
    return (
        f'<Piece NumberOfPoints="{len(x)}" NumberOfCells="{len(cells)}"><PointData>{data}</PointData>'
        f"<Points>{array(x, 'Float64', 'Points', 3, encode)}</Points><Cells>{array(np.concatenate(cells), 'Int64', 'connectivity', 1, encode)}"
        f"{array(ends, 'Int64', 'offsets', 1, encode)}{array(types, 'UInt8', 'types', 1, encode)}</Cells></Piece>"
    )


def vtu(pieces, more="", appended=""):
    head = f'<?xml version="1.0"?><VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" {more}>'
    return f"{head}<UnstructuredGrid>{pieces}</UnstructuredGrid>{appended}</VTKFile>"


def two_pieces(folder):
    """Domains of a parallel program."""
    return text(folder, "f.vtu", vtu(piece(FLOOR, [[0, 1, 2]], [5]) + piece(SPEAR, [[0, 1, 2]], [5])))


def strips_and_pixels(folder):
    """As filters of VTK leave them: the spear as a strip, the floor as a pixel."""
    pixel = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], float)
    return text(folder, "f.vtu", vtu(piece(np.vstack([pixel, SPEAR]), [[0, 1, 2, 3], [4, 5, 6]], [8, 6])))


def compressed_vtu(folder):
    """base64 and zlib, as meshio and VTK do by default."""

    def encode(data):
        packed = zlib.compress(data)
        head = struct.pack("<4I", 1, len(data), 0, len(packed))
        return f'format="binary">{base64.b64encode(head).decode()}{base64.b64encode(packed).decode()}'

    return text(folder, "f.vtu", vtu(piece(CROSSED, FACES, [5, 5], None, encode), 'compressor="vtkZLibDataCompressor"'))


def appended_vtu(folder):
    """Raw bytes behind the XML, with lengths of 64 bits, as ParaView writes them."""
    data = bytearray()

    def encode(values):
        start = len(data)
        data.extend(struct.pack("<Q", len(values)) + values)
        return f'format="appended" offset="{start}">'

    xml = vtu(piece(CROSSED, FACES, [5, 5], None, encode), 'header_type="UInt64"', '<AppendedData encoding="raw">_MARK</AppendedData>')
    before, after = xml.split("MARK")
    return text(folder, "f.vtu", before.encode() + bytes(data) + after.encode())


def fenicsx(folder):
    """A collection of .pvtu of .vtu, cells of Lagrange of first order, the displacement as u."""
    files = []
    for k, share in enumerate((0, 1)):
        cells = [[0, 1, 2, 3], [4, 5, 6, 7]]
        text(folder, f"u_p0_{k:06}.vtu", vtu(piece(TETRAHEDRA, cells, [71, 71], {"u": share * FALL})))
        text(folder, f"u{k:06}.pvtu", f'<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid><Piece Source="u_p0_{k:06}.vtu"/></PUnstructuredGrid></VTKFile>')
        files.append(f'<DataSet timestep="{k}" part="0" file="u{k:06}.pvtu"/>')
    return text(folder, "u.pvd", f'<VTKFile type="Collection"><Collection>{"".join(files)}</Collection></VTKFile>')


def frames_of(folder, write):
    """Two frames by write(folder, number, share of the fall)."""
    for k, share in enumerate((0.0, 1.0)):
        write(folder, k, share)
    return folder


def fenics(folder):
    cells = [[0, 1, 2, 3], [4, 5, 6, 7]]
    return frames_of(folder, lambda f, k, s: text(f, f"displacement{k:06}.vtu", vtu(piece(TETRAHEDRA, cells, [10, 10], {"displacement": s * FALL}))))


def moose(folder):
    """Three fields of one component."""
    cells = [[0, 1, 2, 3], [4, 5, 6, 7]]

    def write(f, k, s):
        fields = {f"disp_{axis}": s * FALL[:, i] for i, axis in enumerate("xyz")}
        return text(f, f"out_{k}.vtu", vtu(piece(TETRAHEDRA, cells, [10, 10], fields)))

    return frames_of(folder, write)


def polyfem(folder):
    """A collection of .vtm: volume, surface and contact of one body; points at rest, the motion as `solution`."""
    files = []
    faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3], [4, 6, 5], [4, 5, 7], [4, 7, 6], [5, 6, 7]]
    for k, share in enumerate((0, 1)):
        text(folder, f"step_{k}.vtu", vtu(piece(TETRAHEDRA, [[0, 1, 2, 3], [4, 5, 6, 7]], [10, 10], {"solution": share * FALL})))
        for part in ("surf", "surf_contact"):
            text(folder, f"step_{k}_{part}.vtu", vtu(piece(TETRAHEDRA, faces, [5] * 8, {"solution": share * FALL})))
        blocks = {"Volume": f"step_{k}.vtu", "Surface": f"step_{k}_surf.vtu", "Contact": f"step_{k}_surf_contact.vtu"}
        rows = "".join(f'<Block name="{name}" index="{i}"><DataSet index="0" file="{file}" name="data"/></Block>' for i, (name, file) in enumerate(blocks.items()))
        text(folder, f"step_{k}.vtm", f'<VTKFile type="vtkMultiBlockDataSet" version="1.0"><vtkMultiBlockDataSet>{rows}</vtkMultiBlockDataSet></VTKFile>')
        files.append(f'<DataSet timestep="{0.1 * k}" group="" part="0" file="step_{k}.vtm"/>')
    return text(folder, "sim.pvd", f'<VTKFile type="Collection"><Collection>{"".join(files)}</Collection></VTKFile>')


def moved_and_displacement(folder):
    """Points that move and a displacement beside them, which must not be added once more: nothing crosses."""
    cells = [[0, 1, 2, 3], [4, 5, 6, 7]]
    return frames_of(folder, lambda f, k, s: text(f, f"f_{k}.vtu", vtu(piece(TETRAHEDRA + 0.4 * s * FALL, cells, [10, 10], {"displacement": 0.4 * s * FALL}))))


def legacy(x, cells, kind, more="", version="3.0"):
    rows = "\n".join(f"{len(c)} " + " ".join(map(str, c)) for c in cells)
    types = "\n".join([str(kind)] * len(cells))
    points = "\n".join("%r %r %r" % tuple(p) for p in np.asarray(x).tolist())
    return (
        f"# vtk DataFile Version {version}\nstep\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {len(x)} double\n{points}\n"
        f"CELLS {len(cells)} {sum(map(len, cells)) + len(cells)}\n{rows}\nCELL_TYPES {len(cells)}\n{types}\n{more}"
    )


def sfepy(folder):
    """A film of .vtk with the vectors u, and scalars before them."""

    def write(f, k, s):
        vectors = "\n".join("%r %r %r" % tuple(v) for v in (s * FALL).tolist())
        more = f"CELL_DATA 2\nSCALARS mat_id int 1\nLOOKUP_TABLE default\n1\n1\nPOINT_DATA 8\nSCALARS node_groups int 1\nLOOKUP_TABLE default\n{'0 ' * 8}\nVECTORS u double\n{vectors}\n"
        return text(f, f"cube.{k:02}.vtk", legacy(TETRAHEDRA, [[0, 1, 2, 3], [4, 5, 6, 7]], 10, more, "2.0"))

    return frames_of(folder, write)


def paraview_polydata(folder):
    """Binary, version 5.1: lists of offsets, blocks of METADATA."""
    head = b"# vtk DataFile Version 5.1\nvtk output\nBINARY\nDATASET POLYDATA\nPOINTS 6 float\n"
    body = np.asarray(CROSSED, ">f4").tobytes() + b"\nMETADATA\nINFORMATION 1\nNAME L2_NORM_RANGE LOCATION vtkDataArray\nDATA 2 0 1\n\n"
    body += b"POLYGONS 3 6\nOFFSETS vtktypeint64\n" + np.array([0, 3, 6], ">i8").tobytes()
    return text(folder, "f.vtk", head + body + b"\nCONNECTIVITY vtktypeint64\n" + np.array(FACES, ">i8").tobytes() + b"\n")


def surface_vtp(folder):
    """The surface that a filter of ParaView extracts."""
    cells = f"<Polys>{array([0, 1, 2], 'Int64', 'connectivity')}{array([3], 'Int64', 'offsets')}</Polys>"
    cells += f"<Strips>{array([3, 4, 5], 'Int64', 'connectivity')}{array([3], 'Int64', 'offsets')}</Strips>"
    points = f"<Points>{array(CROSSED, 'Float32', 'Points', 3)}</Points>"
    body = f'<Piece NumberOfPoints="6" NumberOfVerts="0" NumberOfLines="0" NumberOfStrips="1" NumberOfPolys="1">{points}{cells}</Piece>'
    return text(folder, "f.vtp", f'<VTKFile type="PolyData" version="1.0" byte_order="LittleEndian"><PolyData>{body}</PolyData></VTKFile>')


def windows_pvd(folder):
    """Backslashes in the paths of a collection."""
    (folder / "out").mkdir()
    text(folder / "out", "f_0.vtu", vtu(piece(CROSSED, FACES, [5, 5])))
    return text(folder, "all.pvd", '<VTKFile type="Collection"><Collection><DataSet timestep="0" file="out\\f_0.vtu"/></Collection></VTKFile>')


# --- folders and caches


def mac_folder(folder):
    """Side files of macOS and numbers between dots, as $F4 of Houdini gives them."""
    for k, x in enumerate((APART, CROSSED)):
        text(folder, f"cloth.{k:04}.obj", obj_lines(x) + "f 1 2 3\nf 4 5 6\n")
        text(folder, f"._cloth.{k:04}.obj", b"\0\5\x16\7")
    return folder


def stl_film(folder):
    for k, x in enumerate((APART, CROSSED)):
        body = b"".join(struct.pack("<12fH", 0, 0, 0, *x[f].ravel(), 0) for f in FACES)
        text(folder, f"f_{k}.stl", b"binary".ljust(80) + struct.pack("<I", 2) + body)
    return folder


def mdd(folder):
    """Times in seconds, big-endian, and the mesh beside it."""
    frames = np.array([APART, CROSSED], ">f4")
    text(folder, "film.mdd", struct.pack(">ii", 2, 6) + np.array([0, 0.04], ">f4").tobytes() + frames.tobytes())
    text(folder, "film.obj", obj_lines(APART) + "f 1 2 3\nf 4 5 6\n")
    return folder


def bedlam_npz(folder):
    """Other names, and a pickled array that nobody needs."""
    arrays = {"vertices_seq": np.array([APART, CROSSED]), "faces": np.array(FACES), "faces_uv": np.array(FACES)}
    np.savez(folder / "f.npz", metadata=np.array({"fps": 30}, object), **arrays)
    return folder / "f.npz"


def newton_npz(folder):
    """Wide types without a sign, and all edges of the mesh, which are no rods."""
    edges = np.array([[0, 1], [1, 2], [0, 2], [3, 4], [4, 5], [3, 5]])
    np.savez(folder / "f.npz", particle_q=np.array([APART, CROSSED], "f4"), tri_indices=np.array(FACES, "u4"), edges=edges, time=[0, 0.1])
    return folder / "f.npz"


CROSSES = {
    f.__name__: f
    for f in (
        blender_obj, windows_obj, relative_blocks, tabbed_obj, continued_obj, backslash_comment, faces_first, rods_of_houdini, meshlab_ply,
        stanford_strips, blender_ply_edges, capital_stl, solid_binary_stl, gmsh_41, gmsh_22_binary, gmsh_huge_numbers, two_pieces, strips_and_pixels,
        compressed_vtu, appended_vtu, fenicsx, fenics, moose, polyfem, sfepy, paraview_polydata, surface_vtp, windows_pvd, mac_folder, stl_film, mdd, bedlam_npz, newton_npz,
    )
} | {f"ply_{count}_{corner}": wide_indices((count, corner)) for count, corner in (("ushort", "uint"), ("int", "int"), ("uchar", "uint"))}  # fmt: skip
CLEAN = {f.__name__: f for f in (concave_obj, moved_and_displacement)}

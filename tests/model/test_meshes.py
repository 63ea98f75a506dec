"""Meshes of every format Coal reads: their hulls, and what cannot be one."""

from __future__ import annotations

import struct
from itertools import product

import coal
import numpy as np
import pytest

from hitjoints.model.meshes import FLAT, MeshError, convex_hull, find_mesh, read_mesh

ONE = (1.0, 1.0, 1.0)
TETRAHEDRON = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
FACES = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]


def obj(points, faces):
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points]
    return "\n".join(lines + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]) + "\n"


def stl(points, faces):
    text = ["solid s"]
    for face in faces:
        text += ["facet normal 0 0 0", "outer loop"]
        text += ["vertex {!r} {!r} {!r}".format(*points[i]) for i in face]
        text += ["endloop", "endfacet"]
    return "\n".join([*text, "endsolid s\n"])


def binary_stl(points, faces):
    rows = [struct.pack("<12fH", 0, 0, 0, *(v for i in f for v in points[i]), 0) for f in faces]
    return bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows)


def ply(points, faces):
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\n"
    head += "".join(f"property float {axis}\n" for axis in "xyz")
    head += f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    body = [f"{x!r} {y!r} {z!r}" for x, y, z in points] + [f"3 {a} {b} {c}" for a, b, c in faces]
    return head + "\n".join(body) + "\n"


def off(points, faces):
    body = [f"{x!r} {y!r} {z!r}" for x, y, z in points] + [f"3 {a} {b} {c}" for a, b, c in faces]
    return "\n".join(["OFF", f"{len(points)} {len(faces)} 0", *body]) + "\n"


def dae(points, faces):
    numbers = " ".join(repr(v) for point in points for v in point)
    indices = " ".join(str(i) for face in faces for i in face)
    return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="meter" meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p">
<float_array id="a" count="{3 * len(points)}">{numbers}</float_array><technique_common>
<accessor source="#a" count="{len(points)}" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="{len(faces)}"><input semantic="VERTEX" source="#v" offset="0"/>
<p>{indices}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node>
</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>"""


FORMATS = {"obj": obj, "stl": stl, "b.stl": binary_stl, "ply": ply, "off": off, "dae": dae}


@pytest.fixture
def write(tmp_path):
    def call(ending, points, faces=FACES):
        text = FORMATS[ending]([tuple(map(float, p)) for p in points], faces)
        path = tmp_path / f"mesh.{ending}"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return call


def distance(hull, point):
    """Distance of a solid from a point, by Coal."""
    at = coal.Transform3s(np.eye(3), np.array(point, float))
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    radius = 1e-3
    ball = coal.Sphere(radius)
    return coal.distance(hull, coal.Transform3s(), ball, at, request, result) + radius


@pytest.mark.parametrize("ending", FORMATS)
def test_a_tetrahedron_in_every_format(write, ending):
    hull = convex_hull(read_mesh(write(ending, TETRAHEDRON), (2.0, 2.0, -2.0)))
    assert hull.num_points == 4
    assert distance(hull, (0.3, 0.3, 0.5)) == pytest.approx(0.5, abs=1e-6)
    assert distance(hull, (2, 2, 0)) == pytest.approx(np.sqrt(2), abs=1e-6)


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize("thickness", [0, 1e-12, 1e-9, 1e-7, 1e-5])
def test_a_flat_mesh_has_a_thickness(write, ending, thickness):
    sheet = [(0, 0, 3), (1, 0, 3), (0, 1, 3), (1, 1, 3 + thickness)]
    hull = convex_hull(read_mesh(write(ending, sheet, [(0, 1, 2), (1, 3, 2)]), ONE))
    half = 1 - distance(hull, (0.5, 0.5, 4))
    assert 0.45 * FLAT < half < 0.8 * FLAT  # the sheet is 1 m long, and 1.4 m corner to corner
    assert distance(hull, (2, 0.5, 3)) == pytest.approx(1, abs=1e-6)


@pytest.mark.parametrize("ending", FORMATS)
def test_a_triangle_is_flat_too(write, ending):
    hull = convex_hull(read_mesh(write(ending, TETRAHEDRON[:3], [(0, 1, 2)]), ONE))
    assert distance(hull, (0.2, 0.2, 1)) == pytest.approx(1, abs=FLAT)


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize(
    "points",
    [
        [(0, 0, 0), (np.nan, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 0, 0), (np.inf, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 0, 0), (3e38, 0, 0), (0, 1, 0), (0, 0, 1)],
        [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)],
        [(0.1, 0.2, 0.3)] * 4,
        [(1e-9, 0, 0), (0, 1e-9, 0), (0, 0, 1e-9), (0, 0, 0)],
        [(1000, 0, 0), (1000, 1e-4, 0), (1000, 0, 1e-4), (1000, 1e-4, 1e-4)],
    ],
)
def test_what_is_no_surface_is_refused_in_one_line(write, ending, points, capfd):
    with pytest.raises(MeshError, match=r"mesh mesh\.\S+ (has|is|cannot)") as error:
        read_mesh(write(ending, points), ONE)
    assert "\n" not in str(error.value)
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("content", [b"", b"solid s\nendsolid s\n", b"\0" * 84, b"garbage\n" * 9])
@pytest.mark.parametrize("ending", ["obj", "stl", "ply", "off", "dae", "3ds", "glb", "bt", "x"])
def test_empty_and_broken_files(tmp_path, ending, content, capfd):
    path = tmp_path / f"mesh.{ending}"
    path.write_bytes(content)
    with pytest.raises(MeshError, match=r"cannot be read: .|no surface") as error:
        read_mesh(path, ONE)
    assert "\n" not in str(error.value)
    assert capfd.readouterr() == ("", "")


def test_hulls_of_random_clouds_hold_every_point():
    """Thin, small, large, far, doubled, gridded: none ends the process, none loses a point."""
    rng = np.random.default_rng(0)
    for case, kind in product(range(150), range(4)):
        n = int(rng.integers(4, 40))
        points = [
            rng.normal(size=(n, 3)) * 10.0 ** rng.uniform(-12, 0, 3),
            rng.integers(0, 3, (n, 3)).astype(float),
            np.column_stack([rng.normal(size=(n, 2)), np.zeros(n)]),
            rng.integers(0, 2, (n, 3)) * [1, 1, 10.0 ** rng.uniform(-12, 0)],
        ][kind]
        points = points @ np.linalg.qr(rng.normal(size=(3, 3)))[0] * 10.0 ** rng.uniform(-4, 2)
        points += rng.normal(size=3) * 10.0 ** rng.uniform(-3, 1)
        lengths = np.sort(np.linalg.svd(points - points.mean(0), compute_uv=False))
        if lengths[1] < 1e-3 * lengths[2] or lengths[2] < 1e-4:
            continue
        hull = convex_hull(cloud_of(points))
        corners = np.array([hull.point(i) for i in range(hull.num_points)])
        for axis in rng.normal(size=(5, 3)):
            support, wanted = (corners @ axis).max(), (points @ axis).max()
            slack = np.linalg.norm(axis) * np.ptp(points, axis=0).max()
            assert -1e-9 * slack < support - wanted < FLAT * slack, (case, kind)


def cloud_of(points):
    cloud = coal.BVHModelOBBRSS()
    cloud.beginModel(0, len(points))
    cloud.addVertices(np.asarray(points, float))
    cloud.endModel()
    return cloud


@pytest.mark.parametrize("corners", [100, 300, 2000])
def test_round_faces_of_many_corners(corners):
    angle = np.linspace(0, 2 * np.pi, corners, endpoint=False)
    rim = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    hull = convex_hull(cloud_of(np.concatenate([rim, rim + np.eye(3)[2]])))
    assert hull.num_points == 2 * corners
    assert distance(hull, (0.2, 0.1, 2)) == pytest.approx(1, abs=1e-8)
    cone = cloud_of(np.concatenate([rim, [[0, 0, 1.0]]]))
    if corners > 255:
        with pytest.raises(MeshError, match="a corner with more than 255 neighbours"):
            convex_hull(cone)
    else:
        assert convex_hull(cone).num_points == corners + 1


PACKAGE_LAYOUTS = {
    "the description inside its package": ("ws/arm/urdf", "ws/arm", {}),
    "packages side by side": ("ws/descr/urdf", "ws/arm", {}),
    "a package folder of another name": ("ws/arm-main/urdf", "ws/arm-main", {}),
    "a folder given": ("elsewhere", "ws/arm", {"package_dirs": ["ws"]}),
    "the package given": ("elsewhere", "ws/arm-2", {"package_dirs": ["ws/arm-2"]}),
    "ROS_PACKAGE_PATH": ("elsewhere", "ws/arm", {"ROS_PACKAGE_PATH": "none:ws"}),
    "AMENT_PREFIX_PATH": ("elsewhere", "ws/share/arm", {"AMENT_PREFIX_PATH": "none:ws"}),
}


@pytest.mark.parametrize("layout", PACKAGE_LAYOUTS)
@pytest.mark.parametrize("scheme", ["package", "model"])
def test_layouts_of_package_folders(tmp_path, monkeypatch, layout, scheme):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("ROS_PACKAGE_PATH", raising=False)
    folder, package, more = PACKAGE_LAYOUTS[layout]
    mesh = tmp_path / package / "meshes" / "a.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_text("")
    (tmp_path / package / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / folder).mkdir(parents=True, exist_ok=True)
    name = f"{scheme}://arm/meshes/a.stl"
    dirs = more.get("package_dirs", ())
    if more:
        with pytest.raises(MeshError, match=r"a\.stl not found in a folder above"):
            find_mesh(name, folder)
    for key in more.keys() - {"package_dirs"}:
        monkeypatch.setenv(key, more[key])
    assert find_mesh(name, folder, dirs).resolve() == mesh
    with pytest.raises(MeshError, match=r"b\.stl not found"):
        find_mesh(f"{scheme}://arm/meshes/b.stl", folder, dirs)


def test_files_relative_absolute_and_hostile(tmp_path):
    (tmp_path / "a.stl").write_text("")
    for name in ("a.stl", "./a.stl", str(tmp_path / "a.stl"), f"file://{tmp_path}/a.stl"):
        assert find_mesh(name, str(tmp_path)).samefile(tmp_path / "a.stl")
    for name in ("b.stl", "", "x" * 5000, "a\0.stl", "package://", "package://a\0/b"):
        with pytest.raises(MeshError, match="not found"):
            find_mesh(name, str(tmp_path))


def test_a_linked_description_finds_the_package_it_comes_from(tmp_path):
    mesh = tmp_path / "src" / "arm" / "meshes" / "a.stl"
    mesh.parent.mkdir(parents=True)
    mesh.write_text("")
    (tmp_path / "install").symlink_to(tmp_path / "src" / "arm")
    assert find_mesh("package://arm/meshes/a.stl", str(tmp_path / "install")).samefile(mesh)

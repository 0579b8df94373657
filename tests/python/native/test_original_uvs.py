"""The export's own texture coordinates and materials on the rebuilt mesh."""

import numpy as np
import pytest
import snowbough_native as native
from test_read_tree import one_branch

HEIGHT, RINGS = 6.0, 13


def tube(
    sides,
    turns=1.0,
    lean=0.0,
    first=1,
    materials=("bark",),
    split=True,
    base=(0, 0, 0),
    radius=0.4,
    rings=RINGS,
):
    """Text of a tube along Z: u runs `turns` times around, v from 0 to HEIGHT. Its seam is at angle 0.

    split: the seam's coordinates differ by `turns` and do not close. materials: one for each part of its
    length. Vertices are numbered from `first`, coordinates likewise.
    """
    lines = []
    z = np.linspace(0, HEIGHT, rings)
    across = radius * np.linspace(1, 0.3, rings)
    for ring in range(rings):
        for k in range(sides):
            angle = 2 * np.pi * k / sides
            x = across[ring] * np.cos(angle) + lean * z[ring]
            lines.append(f"v {x + base[0]} {across[ring] * np.sin(angle) + base[1]} {z[ring] + base[2]}")
        lines += [f"vt {turns * k / sides} {z[ring]}" for k in range(sides + 1)]
    for ring in range(rings - 1):
        lines.append(f"usemtl {materials[ring * len(materials) // (rings - 1)]}")
        for k in range(sides):
            corners = ((ring, k), (ring, k + 1), (ring + 1, k + 1), (ring + 1, k))
            lines.append(
                "f "
                + " ".join(
                    f"{first + r * sides + c % sides}/{first + r * (sides + 1) + c}" for r, c in corners
                )
            )
    return "\n".join(lines) + "\n"


def rebuilt(tmp_path, text, detail="DEFAULT"):
    """detail "BASE of DEFAULT": the base, looked up on the mesh that was refined from it."""
    path = tmp_path / "tree.obj"
    path.write_text("g trunk\n" + text)
    skeleton = native.read_tree(path, up_axis="Z")
    mesh = native.build_tree_mesh(skeleton, detail=detail.split()[-1])
    found = native.original_uvs(skeleton, mesh)
    if detail.split()[-1] != detail:
        mesh, found = native.build_tree_mesh(skeleton), native.base_uvs(mesh, *found)
    return skeleton, mesh, *found


def walls(mesh):
    """Faces of the limb's side, away from its ends."""
    z = mesh.vertices[mesh.quads][..., 2]
    return (mesh.face_part == 0) & (z.min(1) > 0.1) & (z.max(1) < HEIGHT - 0.1)


def angles(points, lean=0.0):
    return np.arctan2(points[..., 1], points[..., 0] - lean * points[..., 2]) / (2 * np.pi) % 1.0


@pytest.mark.parametrize("sides", [3, 4, 8])
@pytest.mark.parametrize("detail", ["BASE", "DEFAULT", "FILM", "BASE of DEFAULT", "BASE of FILM"])
def test_coordinates_are_those_of_the_same_direction_and_height(tmp_path, sides, detail):
    _, mesh, uv, _ = rebuilt(tmp_path, tube(sides), detail)
    points = mesh.vertices[mesh.quads]
    side = walls(mesh)
    off = (uv[..., 0] - angles(points) + 0.5) % 1.0 - 0.5
    assert np.abs(off[side]).max() < 0.01
    assert np.abs(uv[..., 1] - points[..., 2])[side].max() < 0.05


def test_a_limb_that_leans_keeps_its_texture_upright(tmp_path):
    _, mesh, uv, _ = rebuilt(tmp_path, tube(8, lean=0.5))
    side = walls(mesh)
    points = mesh.vertices[mesh.quads]
    # The rings lie level, ours across the limb: what is compared is where each point is seen from outside.
    off = (uv[..., 0] - angles(points, lean=0.5) + 0.5) % 1.0 - 0.5
    assert np.median(np.abs(off[side])) < 0.02 and np.abs(off[side]).max() < 0.08
    assert np.median(np.abs(uv[..., 1] - points[..., 2])[side]) < 0.2


@pytest.mark.parametrize("sides", [3, 8])
@pytest.mark.parametrize("detail", ["BASE", "DEFAULT", "BASE of DEFAULT"])
@pytest.mark.parametrize("turns", [1.0, 3.0, 0.7, 3.33])
def test_no_face_runs_back_over_the_whole_texture_at_the_seam(tmp_path, sides, detail, turns):
    _, mesh, uv, _ = rebuilt(tmp_path, tube(sides, turns), detail)
    side = walls(mesh)
    across = np.ptp(uv[..., 0], axis=1)[side]
    around = np.ptp(np.unwrap(2 * np.pi * angles(mesh.vertices[mesh.quads]), axis=1), axis=1)[side]
    assert (across <= 1.2 * turns * around / (2 * np.pi) + 1e-3).all()
    if turns == int(turns):  # a tiled texture shows no seam: every face has its full part of it
        assert (across >= 0.8 * turns * around / (2 * np.pi)).all()
    else:  # coordinates on the other side of the seam are not used
        assert uv[side][..., 0].min() >= -1e-4 and uv[side][..., 0].max() <= turns + 1e-4


@pytest.mark.parametrize("detail", ["DEFAULT", "BASE of DEFAULT"])
def test_each_face_has_the_material_of_its_place(tmp_path, detail):
    skeleton, mesh, _, material = rebuilt(tmp_path, tube(6, materials=("rough", "smooth")), detail)
    names = np.array([m.name for m in skeleton.wood_materials])
    assert list(names) == ["rough", "smooth"]
    z = mesh.vertices[mesh.quads][..., 2].mean(1)
    side = walls(mesh)
    assert (names[material[side & (z < 0.48 * HEIGHT)]] == "rough").all()
    assert (names[material[side & (z > 0.52 * HEIGHT)]] == "smooth").all()


def test_a_branch_is_looked_up_on_its_own_tube(tmp_path):
    """A twin stands so near that half of each tube lies inside the other."""
    count = RINGS * 6
    one, two = tube(6, materials=("one",)), tube(6, materials=("two",), base=(0.3, 0, 0), radius=0.3, first=0)
    moved = []
    for line in two.splitlines():
        if line.startswith("f "):
            pairs = [corner.split("/") for corner in line[2:].split()]
            line = "f " + " ".join(f"{int(v) + count + 1}/{int(t) + RINGS * 7 + 1}" for v, t in pairs)
        moved.append(line)
    skeleton, mesh, _, material = rebuilt(tmp_path, one + "g branch\n" + "\n".join(moved) + "\n")
    assert len(skeleton.branches) == 2
    names = np.array([m.name for m in skeleton.wood_materials])[material]
    of_branch = [set(names[mesh.face_branch == b]) for b in range(2)]
    assert of_branch == [{"one"}, {"two"}]


def test_simplified_limbs_find_their_polygons_too(tmp_path):
    path = tmp_path / "tree.obj"
    path.write_text("g trunk\n" + tube(8))
    skeleton = native.read_tree(path, up_axis="Z", simplify="THESIS")
    mesh = native.build_tree_mesh(skeleton, detail="DEFAULT")
    uv, _ = native.original_uvs(skeleton, mesh)
    off = uv[..., 1] - mesh.vertices[mesh.quads][..., 2]
    assert np.abs(off[walls(mesh)]).max() < 0.1


def test_long_faces_find_their_corners_on_a_fine_original(tmp_path):
    path = tmp_path / "fine.obj"
    # A twig near the top, so that the trunk keeps no joints but there.
    twig = "g twig\n"
    for x in np.linspace(0, 0.6, 4):
        twig += "".join(f"v {x} {0.02 * y} {5.5 + 0.02 * z}\n" for y, z in ((1, 0), (0, 1), (-1, 0), (0, -1)))
    for k in (*range(-16, -13), *range(-12, -9), *range(-8, -5)):
        twig += f"f {k} {k + 1} {k + 5} {k + 4}\n"
    twig += "f -13 -16 -12 -9\nf -9 -12 -8 -5\nf -5 -8 -4 -1\n"
    path.write_text("g trunk\n" + tube(32, rings=600) + twig)
    skeleton = native.read_tree(path, up_axis="Z", simplify="TOLERANCE")
    mesh = native.build_tree_mesh(skeleton)
    uv, _ = native.original_uvs(skeleton, mesh)
    z = mesh.vertices[mesh.quads][..., 2]
    side = (mesh.face_part == 0) & (mesh.face_branch == 0)
    # From the middle of a face to its end it is more than a hundred of the original's rings.
    assert np.ptp(z, axis=1)[side].max() > 2.1
    assert np.abs(uv[..., 1] - z)[side].max() < 0.02


def test_without_coordinates_there_are_none_but_materials_stay(tmp_path):
    text = "\n".join(line for line in tube(6).splitlines() if not line.startswith("vt "))
    text = "\n".join(
        " ".join(c.split("/")[0] for c in line.split()) if line.startswith("f ") else line
        for line in text.splitlines()
    )
    skeleton, mesh, uv, material = rebuilt(tmp_path, text)
    assert uv is None
    assert [m.name for m in skeleton.wood_materials] == ["bark"]
    assert (material == 0).all()


def test_a_skeleton_from_no_file_has_neither():
    skeleton = native.Skeleton.from_branches([one_branch()])
    mesh = native.build_tree_mesh(skeleton)
    uv, material = native.original_uvs(skeleton, mesh)
    assert uv is None and (material == -1).all()


def test_coordinates_do_not_depend_on_threads(tmp_path):
    skeleton, mesh, uv, material = rebuilt(tmp_path, tube(5, materials=("a", "b")), "FILM")
    again = native.original_uvs(skeleton, mesh, threads=1)
    assert np.array_equal(uv, again[0]) and np.array_equal(material, again[1])


@pytest.mark.parametrize("settings, factor", [({"unit": 0.01}, 0.01), ({"height": 12.0}, 2.0)], ids=str)
def test_a_tree_comes_in_its_units_or_to_a_height(tmp_path, settings, factor):
    path = tmp_path / "tree.obj"
    path.write_text("g trunk\n" + tube(8))
    plain, scaled = native.read_tree(path, up_axis="Z"), native.read_tree(path, up_axis="Z", **settings)
    assert scaled.height == pytest.approx(factor * plain.height, rel=1e-5)
    for one, other in zip(plain.branches, scaled.branches):
        assert np.allclose(other.points, factor * one.points, rtol=1e-5)
        assert np.allclose(other.radii, factor * one.radii, rtol=1e-5)
        assert np.allclose(other.areas, factor**2 * one.areas, rtol=1e-5)
    meshes = [native.build_tree_mesh(skeleton) for skeleton in (plain, scaled)]
    uvs = [native.original_uvs(*pair)[0][walls(meshes[0])] for pair in zip((plain, scaled), meshes)]
    assert np.abs((uvs[0] - uvs[1] + 0.5) % 1.0 - 0.5).max() < 1e-3


@pytest.mark.parametrize("settings", [{"unit": 0.0}, {"unit": float("nan")}, {"height": -1.0}], ids=str)
def test_sizes_that_make_no_sense_are_refused(tmp_path, settings):
    path = tmp_path / "tree.obj"
    path.write_text("g trunk\n" + tube(8))
    with pytest.raises(ValueError, match="metres"):
        native.read_tree(path, **settings)


def branch(name, parent, points, radii):
    points, radii = np.array(points, float), np.array(radii, float)
    return {
        "name": name,
        "level": 0 if parent < 0 else 1,
        "parent": parent,
        "attach_point": points[0],
        "points": points,
        "radii": radii,
        "areas": np.pi * radii**2,
    }


def test_a_welded_tree_is_looked_up_across_its_forks(tmp_path):
    """Its coordinates are its x and z, so they name the place on it that a rebuilt face was looked up at."""
    height = np.linspace(0, 8, 17)
    along = np.linspace(0, 1, 13)[:, None]
    grown = native.Skeleton.from_branches(
        [
            branch("trunk", -1, np.c_[0 * height, 0 * height, height], np.linspace(0.4, 0.08, 17)),
            branch("left", 0, (0, 0, 3) + along * (-4, 0.5, 3), np.linspace(0.2, 0.05, 13)),
            branch("right", 0, (0, 0, 4.5) + along * (3, -1, 3), np.linspace(0.15, 0.04, 13)),
        ]
    )
    whole = native.build_tree_mesh(grown, detail="GAME")
    path = tmp_path / "welded.obj"
    lines = ["g tree", *("v %.6f %.6f %.6f" % tuple(p) for p in whole.vertices)]
    lines += ["vt %.6f %.6f" % (p[0], p[2]) for p in whole.vertices]
    lines += ["f " + " ".join(f"{v + 1}/{v + 1}" for v in quad) for quad in whole.quads]
    path.write_text("\n".join(lines) + "\n")
    skeleton = native.read_tree(path, up_axis="Z", levels="")
    assert skeleton.report["form"] == "WELDED" and len(skeleton.branches) == 3
    mesh = native.build_tree_mesh(skeleton, detail="DEFAULT")
    uv, _ = native.original_uvs(skeleton, mesh)
    off = np.linalg.norm(uv - mesh.vertices[mesh.quads][..., [0, 2]], axis=2).max(axis=1)
    assert np.median(off) < 0.02 and np.percentile(off, 95) < 0.1
    # In crotches, whose fillet is ours alone, no face is looked up far along the other limb.
    assert off[mesh.face_part < 2].max() < 2 * 0.4

# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a tree's junctions: the export's own polygons against the remodelled surface.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/tree/junctions.py -- FILE.obj [FOLDER]

Writes FOLDER/<file>_junctions.png (default build/junctions). One column per junction: the thickest limb on the trunk,
the thickest twig on a limb, and the place where most limbs leave a parent close together. Three rows: the export, the
four-sided base (flat, so that every face is visible) and level of detail 2. The thesis (D. T. Reynolds, 2014) shows the
same pairs in its appendix B.
"""

import sys
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(Path(__file__).resolve().parent))
import sheets  # noqa: E402

SIZE = 420
SAMPLES = 8
# Half the picture's width, in the parent's radii at the junction.
VIEW_RADII = 3.2


def parent_frame(branches, child):
    """(attach point, unit tangent of the parent there, parent's radius there) as numpy."""
    parent = branches[child.parent]
    points, radii = np.asarray(parent.points, float), np.asarray(parent.radii, float)
    at = np.asarray(child.attach_point, float)
    if len(points) < 2:
        return at, np.array((0.0, 0.0, 1.0)), max(float(radii[0]), 1e-6)
    along = np.diff(points, axis=0)
    share = np.einsum("ij,ij->i", at - points[:-1], along) / np.maximum((along**2).sum(axis=1), 1e-30)
    share = np.clip(share, 0, 1)
    nearest = np.linalg.norm(points[:-1] + share[:, None] * along - at, axis=1).argmin()
    tangent = along[nearest] / max(np.linalg.norm(along[nearest]), 1e-30)
    radius = radii[nearest] + share[nearest] * (radii[nearest + 1] - radii[nearest])
    return at, tangent, float(max(radius, 1e-6))


def choose(branches):
    """Three children: thickest on the trunk, thickest on a limb, and the one with most neighbours."""
    children = [b for b in branches if b.parent >= 0 and len(b.points) > 1]
    frames = [parent_frame(branches, child) for child in children]

    def thickest(level):
        ranked = [
            (max(child.radii[:2]), number)
            for number, child in enumerate(children)
            if branches[child.parent].level == level
        ]
        return max(ranked)[1] if ranked else None

    crowd = []
    for number, child in enumerate(children):
        at, _tangent, radius = frames[number]
        close = sum(
            1
            for other, frame in zip(children, frames)
            if other.parent == child.parent and np.linalg.norm(frame[0] - at) < 3 * radius
        )
        crowd.append((close, radius, number))
    chosen = [thickest(0), thickest(1)]
    # Not the thickest limb's own neighbours: another parent, deeper in the crown.
    shown = {children[number].parent for number in chosen if number is not None}
    rest = sorted((row for row in crowd if children[row[2]].parent not in shown), reverse=True)
    chosen.append(rest[0][2] if rest else None)
    return [(children[number], frames[number]) for number in chosen if number is not None]


def look_at(camera, child, frame):
    """Orthographic, across the plane of parent and child; clips everything in front of and behind them."""
    at, tangent, radius = frame
    points = np.asarray(child.points, float)
    reach = points[np.linalg.norm(points - points[0], axis=1) > 0]
    out = (reach[min(2, len(reach) - 1)] - at) if len(reach) else np.array((1.0, 0.0, 0.0))
    out -= tangent * (out @ tangent)
    if np.linalg.norm(out) < 1e-9:
        out = np.cross(tangent, (0.3, 0.8, 0.5))
    right = Vector(out).normalized()
    up = Vector(tangent).normalized()
    back = right.cross(up)
    distance = 20.0 * radius
    # Towards the child, the subject of the picture.
    center = Vector(at) + right * (0.3 * VIEW_RADII * radius)
    camera.matrix_world = (
        Matrix.Translation(center + back * distance) @ Matrix((right, up, back)).transposed().to_4x4()
    )
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 2 * VIEW_RADII * radius
    depth = 2 * VIEW_RADII * radius
    camera.data.clip_start, camera.data.clip_end = distance - depth, distance + depth


def clay(name, color):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    surface = next(node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    surface.inputs["Base Color"].default_value = (*color, 1)
    surface.inputs["Roughness"].default_value = 1.0
    return material


def set_up(scene):
    """Camera with a lamp of its own; a plain grey world."""
    scene.render.engine = "CYCLES"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("grey")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.45, 0.47, 0.5, 1)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    sun.data.energy = 3.0
    sun.parent = camera
    sun.rotation_euler = (-0.5, -0.7, 0.0)
    for obj in (camera, sun):
        scene.collection.objects.link(obj)
    scene.camera = camera
    return camera


def picture(scene, path):
    """Renders to `path` and returns the pixels, float (SIZE, SIZE, 4), first row at the bottom."""
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(SIZE * SIZE * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    path.unlink()
    return pixels.reshape(SIZE, SIZE, 4)


def import_rows(path, snowbough):
    """[(objects of a row, ...)]: export, base, level of detail 2; and the skeleton's branches."""
    export, skeleton = sheets.import_export(path, snowbough.base.native.load())
    rows = [export]
    for lod, smooth in ((0, False), (2, True)):
        before = set(bpy.data.objects)
        bpy.ops.import_scene.xfrog_tree(filepath=str(path), lod=lod)
        row = [
            obj
            for obj in bpy.data.objects
            if obj not in before and obj.type == "MESH" and "_bark" in obj.name
        ]
        for obj in row:
            obj.data.polygons.foreach_set("use_smooth", np.full(len(obj.data.polygons), smooth))
        rows.append(row)
    return rows, skeleton.branches


def main(path, folder):
    sys.path.insert(0, str(ROOT / "addon"))
    import snowbough
    import snowbough.base.native

    bpy.ops.wm.read_homefile(use_empty=True)
    snowbough.register()
    scene = bpy.context.scene
    camera = set_up(scene)
    rows, branches = import_rows(path, snowbough)
    materials = [
        clay("export", (0.55, 0.36, 0.22)),
        clay("base", (0.3, 0.42, 0.55)),
        clay("level 2", (0.3, 0.5, 0.32)),
    ]
    for row, material in zip(rows, materials):
        for obj in row:
            obj.data.materials.clear()
            obj.data.materials.append(material)
    folder.mkdir(parents=True, exist_ok=True)
    junctions = choose(branches)
    sheet = np.ones((SIZE * len(rows), SIZE * len(junctions), 4), np.float32)
    for column, (child, frame) in enumerate(junctions):
        print(
            f"junction {column + 1}: {child.name} on {branches[child.parent].name}, parent's radius {frame[2]:.4g}"
        )
        look_at(camera, child, frame)
        for number, row in enumerate(rows):
            sheets.show_only(row)
            low = SIZE * (len(rows) - 1 - number)
            part = picture(scene, folder / "part.png")
            sheet[low : low + SIZE, SIZE * column : SIZE * (column + 1)] = part
    sheets.save_sheet(sheet, folder / f"{path.stem}_junctions.png")


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if not given:
        sys.exit(__doc__)
    main(
        Path(given[0]).resolve(), Path(given[1] if len(given) > 1 else ROOT / "build" / "junctions").resolve()
    )

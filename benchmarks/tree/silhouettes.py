# SPDX-License-Identifier: GPL-3.0-or-later
"""Change of a tree's outline from one level of detail to another.

    blender -b --factory-startup --python-exit-code 1 -P benchmarks/tree/silhouettes.py -- FILE.obj [SAMPLES]

Samples levels 0 to 3 along X and along Y with the same SAMPLES x SAMPLES (default 2400) rays, one per pixel with the
same jitter for all levels, so that twigs thinner than a pixel count by their area. Prints, as shares of level 3's area:
the area of each level, and for pairs of levels the area that only one of them covers. Wanted: levels 1 to 3 differ by
less than 3 %, level 0 from level 3 by less than 12 %.
"""

import sys
import tempfile
from pathlib import Path

import bpy
import numpy as np
from mathutils import Matrix, Vector

ROOT = Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(Path(__file__).resolve().parent))
import sheets  # noqa: E402

VIEWS = {"X": (1, 0, 0), "Y": (0, -1, 0)}
PAIRS = ((0, 3), (1, 3), (2, 3), (1, 2))


def set_up(samples):
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.film_transparent = True
    scene.render.resolution_x = scene.render.resolution_y = samples
    scene.render.image_settings.color_mode = "RGBA"
    cycles = scene.cycles
    cycles.samples, cycles.seed, cycles.max_bounces = 1, 3, 0
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    scene.camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    scene.camera.data.type = "ORTHO"
    scene.collection.objects.link(scene.camera)
    return scene


def look(scene, view, low, high):
    back, up, size = Vector(view), Vector((0, 0, 1)), float((high - low).max())
    axes = Matrix((up.cross(back), up, back)).transposed().to_4x4()
    scene.camera.matrix_world = Matrix.Translation(Vector((low + high) / 2) + 3 * size * back) @ axes
    scene.camera.data.ortho_scale, scene.camera.data.clip_end = 1.02 * size, 10 * size


def covered(scene, path, samples):
    scene.render.filepath = str(path)
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(str(path))
    pixels = np.empty(samples * samples * 4, np.float32)
    image.pixels.foreach_get(pixels)
    bpy.data.images.remove(image)
    return pixels[3::4] > 0.5


def main(path, samples):
    sys.path.insert(0, str(ROOT / "build" / "python"))
    import snowbough_native as native

    scene = set_up(samples)
    skeleton = native.read_tree(str(path))
    masks = {}
    with tempfile.TemporaryDirectory() as folder:
        for lod in range(4):
            mesh = native.build_tree_mesh(skeleton, lod=lod)
            if lod == 0:
                low, high = mesh.vertices.min(axis=0).astype(float), mesh.vertices.max(axis=0).astype(float)
            level = sheets.add_mesh("level", mesh.vertices, mesh.quads)
            for name, view in VIEWS.items():
                look(scene, view, low, high)
                masks[name, lod] = covered(scene, Path(folder) / "view.png", samples)
            data = level.data
            bpy.data.objects.remove(level)
            bpy.data.meshes.remove(data)
    for name in VIEWS:
        whole = masks[name, 3].sum()
        areas = ", ".join(f"{100 * masks[name, lod].sum() / whole:.2f}" for lod in range(4))
        apart = ", ".join(
            f"{a} and {b}: {100 * (masks[name, a] ^ masks[name, b]).sum() / whole:.2f} %" for a, b in PAIRS
        )
        print(
            f"{path.name} along {name}: areas {areas} %; apart {apart}; {whole} rays hit level 3", flush=True
        )


if __name__ == "__main__":
    given = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []
    if not given:
        sys.exit(__doc__)
    main(Path(given[0]).resolve(), int(given[1]) if len(given) > 1 else 2400)

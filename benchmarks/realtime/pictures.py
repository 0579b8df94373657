"""A tree from far and near, shaded and as a wireframe: docs/images/realtime.png.

PYTHONPATH=build/python /usr/bin/python3 benchmarks/realtime/pictures.py [TREE.obj] [--out PICTURE.png]
"""

import argparse
from pathlib import Path

import numpy as np
import snowbough_native as native

ROOT = Path(__file__).resolve().parents[2]
#: Edge of each of the four pictures in pixels.
SIZE = 420
GROUND = (0.32, 0.3, 0.27)


def leaves_of(renderer, skeleton, mesh):
    """Gives the tree the export's leaves, in their materials' colours."""
    foliage = skeleton.foliage
    if not len(foliage.face_leaf):
        return
    begin, end = np.asarray(foliage.face_begin[:-1]), np.asarray(foliage.face_begin[1:])
    # A fan of triangles a polygon: its first corner, and each two that follow one another.
    count = end - begin - 2
    face = np.repeat(np.arange(len(count)), count)
    step = np.arange(len(face)) - np.repeat(np.cumsum(count) - count, count)
    corners = np.stack([begin[face], begin[face] + step + 1, begin[face] + step + 2], axis=1)
    materials = list(foliage.materials)
    material = np.clip(np.asarray(foliage.face_material)[face], 0, max(len(materials) - 1, 0))
    colors = [tuple(float(c) ** 2.2 for c in m.diffuse) for m in materials] or [(0.1, 0.25, 0.05)]
    bones = np.asarray(native.leaf_bones(skeleton, mesh))[np.asarray(foliage.face_leaf)[face]]
    renderer.set_leaves(
        "tree",
        np.asarray(foliage.vertices)[np.asarray(foliage.corner_vertex)[corners]],
        bones,
        np.asarray(foliage.corner_uv)[corners],
        material,
        colors,
    )


def picture(path):
    skeleton = native.read_tree(path)
    mesh = native.build_tree_mesh(skeleton)
    height = float(mesh.vertices[:, 2].max())
    with native.Renderer() as renderer:
        renderer.add_tree("tree", mesh)
        leaves_of(renderer, skeleton, mesh)
        g = 20 * height
        renderer.add_mesh(
            "ground", [(-g, -g, 0), (g, -g, 0), (g, g, 0), (-g, g, 0)], [(0, 1, 2), (0, 2, 3)], GROUND
        )
        rows = []
        for away, level in ((0.35, 0.33), (2.0, 0.5)):
            at = np.array((0, 0, level * height))
            camera = native.Camera(
                eye=at + np.array((0.6, -0.8, 0.12)) * away * height, target=at, width=SIZE, height=SIZE
            )
            both = []
            for wire in (False, True):
                settings = native.RenderSettings(wireframe=wire, antialias=not wire, shadow_resolution=2048)
                both.append(renderer.render(camera, settings))
            rows.append(np.concatenate(both, axis=1))
            print({key: value for key, value in renderer.statistics().items() if key != "passes"})
    return np.concatenate(rows)[..., :3]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("tree", nargs="?", default=ROOT / "tests" / "data" / "small_maple.obj")
    parser.add_argument("--out", default=ROOT / "docs" / "images" / "realtime.png")
    arguments = parser.parse_args()
    native.write_png(str(arguments.out), picture(arguments.tree))


if __name__ == "__main__":
    main()

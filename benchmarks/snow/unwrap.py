# SPDX-License-Identifier: GPL-3.0-or-later
"""Gives a mesh without UVs a Smart UV layout: OBJ -> NPZ with positions, triangles and uv.

blender -b --factory-startup --python-exit-code 1 -P benchmarks/snow/unwrap.py -- IN.obj OUT.npz
"""

import sys

import bpy
import numpy as np

source, target = sys.argv[sys.argv.index("--") + 1 :]
bpy.ops.wm.read_homefile(use_empty=True)
if hasattr(bpy.ops.wm, "obj_import"):
    bpy.ops.wm.obj_import(filepath=source)
else:
    bpy.ops.import_scene.obj(filepath=source, split_mode="OFF")
thing = next(thing for thing in bpy.data.objects if thing.type == "MESH")
bpy.context.view_layer.objects.active = thing
thing.select_set(True)
bpy.ops.object.transform_apply(rotation=True)
bpy.ops.object.mode_set(mode="EDIT")
bpy.ops.mesh.select_all(action="SELECT")
bpy.ops.uv.smart_project(angle_limit=1.15, island_margin=0.004)
bpy.ops.object.mode_set(mode="OBJECT")
mesh = thing.data
mesh.calc_loop_triangles()
positions = np.empty(len(mesh.vertices) * 3, np.float32)
mesh.vertices.foreach_get("co", positions)
loops = np.empty(len(mesh.loop_triangles) * 3, np.int32)
vertices = np.empty_like(loops)
mesh.loop_triangles.foreach_get("loops", loops)
mesh.loop_triangles.foreach_get("vertices", vertices)
uv = np.empty(len(mesh.loops) * 2, np.float32)
mesh.uv_layers.active.data.foreach_get("uv", uv)
np.savez_compressed(
    target,
    positions=positions.reshape(-1, 3),
    triangles=vertices.reshape(-1, 3),
    uv=uv.reshape(-1, 2)[loops].reshape(-1, 3, 2),
)
print(f"{target}: {len(vertices) // 3} triangles")

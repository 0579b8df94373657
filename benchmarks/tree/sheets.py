# SPDX-License-Identifier: GPL-3.0-or-later
"""Shared by the pictures of trees: meshes in the scene, exports shaded as they are, and sheets of pictures."""

import bpy
import numpy as np


def add_mesh(name, vertices, quads, smooth=True):
    """A new object of float (V, 3) vertices and int (F, 4) quads in Blender's scene."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(vertices))
    mesh.vertices.foreach_set("co", vertices.ravel())
    mesh.loops.add(quads.size)
    mesh.loops.foreach_set("vertex_index", quads.ravel())
    mesh.polygons.add(len(quads))
    mesh.polygons.foreach_set("loop_start", np.arange(0, quads.size, 4))
    mesh.polygons.foreach_set("loop_total", np.full(len(quads), 4))
    mesh.polygons.foreach_set("use_smooth", np.full(len(quads), smooth))
    mesh.update()
    added = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(added)
    return added


def import_export(path, native):
    """(objects of the export's own polygons, shaded flat; the skeleton)."""
    skeleton = native.read_tree(str(path))
    axes = ("NEGATIVE_Z", "Y") if skeleton.report["up_axis"] == "Y" else ("Y", "Z")
    bpy.ops.wm.obj_import(filepath=str(path), forward_axis=axes[0], up_axis=axes[1])
    objects = [obj for obj in bpy.context.selected_objects if obj.type == "MESH"]
    for obj in objects:
        # Normals of exports are unreliable; flat shading shows the polygons themselves.
        bpy.context.view_layer.objects.active = obj
        bpy.ops.mesh.customdata_custom_splitnormals_clear()
        obj.data.polygons.foreach_set("use_smooth", np.zeros(len(obj.data.polygons), bool))
    return objects, skeleton


def show_only(objects):
    """Of all meshes."""
    for obj in bpy.data.objects:
        if obj.type == "MESH":
            obj.hide_render = obj not in objects


def save_sheet(pixels, path):
    """pixels: float (H, W, 4), first row at the bottom."""
    image = bpy.data.images.new("sheet", pixels.shape[1], pixels.shape[0])
    image.pixels.foreach_set(pixels.reshape(-1))
    image.filepath_raw, image.file_format = str(path), "PNG"
    image.save()
    print(image.filepath_raw)

# SPDX-License-Identifier: GPL-3.0-or-later
"""All differences between the Blender versions that the add-on supports (3.4 to 5.x).

The rest of the add-on calls the functions below, which test for the feature itself where possible. Nodes have
compat_nodes.
"""

from pathlib import Path

import bpy
import numpy as np

VERSION = bpy.app.version

# --------------------------------------------------------------------------------------------------
# Properties

# From 4.5 on, a property needs this option if its path may begin with // (the folder of the .blend).
BLEND_RELATIVE = {"PATH_SUPPORTS_BLEND_RELATIVE"} if VERSION >= (4, 5, 0) else set()

# --------------------------------------------------------------------------------------------------
# Mesh data


def set_indices(elements, name, values):
    """Writes a property that holds indices: integers, none negative, of any shape.

    Blender copies unsigned numbers at once, others one by one: 1 ms instead of 12 for 300,000.
    """
    elements.foreach_set(name, np.ascontiguousarray(values, dtype=np.uint32).reshape(-1))


def set_polygons(mesh, loop_start, loop_total):
    """Writes the corner ranges of polygons that are already added: one entry per polygon."""
    set_indices(mesh.polygons, "loop_start", loop_start)
    # From 4.1 on, the total follows from the next polygon's start and is read-only.
    if VERSION < (4, 1, 0):
        set_indices(mesh.polygons, "loop_total", loop_total)


def set_uv(layer, uv):
    """Writes float32 (L, 2) coordinates, one a corner, into a UV layer."""
    flat = np.ascontiguousarray(uv, dtype=np.float32).reshape(-1)
    if hasattr(layer, "uv"):  # 3.5 on: a plain attribute, several times faster than `data`
        layer.uv.foreach_set("vector", flat)
    else:
        layer.data.foreach_set("uv", flat)


def set_corner_normals(mesh, normals):
    """Writes unit normals (L, 3), one a corner, as custom normals; zero: Blender's own. Shades the mesh smooth."""
    mesh.polygons.foreach_set("use_smooth", np.ones(len(mesh.polygons), dtype=bool))
    if hasattr(mesh, "use_auto_smooth"):  # before 4.1 custom normals need it
        mesh.use_auto_smooth = True
    mesh.normals_split_custom_set(np.asarray(normals, dtype=np.float32).tolist())


# --------------------------------------------------------------------------------------------------
# Armatures


def assign_bone_level_groups(armature, levels, names):
    """Groups the bones of an armature by branch level, outside edit mode.

    levels: one int per bone, in the order of `armature.bones`. names: one per level. Uses bone collections from 4.0 on;
    before, bone layer n for level n (32 at most; deeper levels share the last), and shows all layers with bones.
    """
    bones = armature.bones
    if hasattr(armature, "collections"):
        groups = [armature.collections.new(name) for name in names]
        for bone, level in zip(bones, levels):
            groups[level].assign(bone)
        return
    of_layers = np.arange(32) == np.minimum(levels, 31)[:, None]
    bones.foreach_set("layers", of_layers.reshape(-1))
    armature.layers = [index <= min(max(levels, default=0), 31) for index in range(32)]


def hide_bones(armature):
    """Hides all bones that assign_bone_level_groups has grouped; the armature object stays visible."""
    if hasattr(armature, "collections"):
        for group in armature.collections:
            group.is_visible = False
        return
    # One layer must be visible: the last, which is empty unless there are more levels than layers.
    armature.layers = [index == 31 for index in range(32)]


# --------------------------------------------------------------------------------------------------
# Animation


def action_curves(datablock, name):
    """Gives `datablock` a new action with that name; returns (action, new_curve).

    new_curve(data_path, index, group) adds an F-curve that animates the datablock. Actions have slots and layers from
    4.4 on, and `action.fcurves` is gone in 5.0.
    """
    action = bpy.data.actions.new(name)
    animation = datablock.animation_data or datablock.animation_data_create()
    animation.action = action
    if not hasattr(action, "slots"):
        return action, lambda path, index, group: action.fcurves.new(path, index=index, action_group=group)

    slot = action.slots.new(id_type=datablock.id_type, name=datablock.name)
    animation.action_slot = slot
    strip = action.layers.new("Layer").strips.new(type="KEYFRAME")
    bag = strip.channelbag(slot, ensure=True)

    groups = {}

    def new_curve(path, index, group):
        curve = bag.fcurves.new(path, index=index)
        if group not in groups:
            groups[group] = bag.groups.new(group)
        curve.group = groups[group]
        return curve

    return action, new_curve


def curves_of(datablock):
    """The F-curves that currently animate `datablock`, as a list."""
    animation = datablock.animation_data
    return curves_in(animation.action, animation) if animation is not None else []


def curves_in(action, user):
    """The F-curves of an action for its user, animation data or a strip of the NLA, as a list."""
    if action is None:
        return []
    if not hasattr(action, "slots"):
        return list(action.fcurves)
    slot = user.action_slot
    if slot is None:
        return []
    bags = (strip.channelbag(slot) for layer in action.layers for strip in layer.strips)
    return [curve for bag in bags if bag is not None for curve in bag.fcurves]


def frame_length(scene):
    """Frames of animation per rendered frame: other than 1 with Render > Time Stretching."""
    return scene.render.frame_map_old / scene.render.frame_map_new


def strips_of(scene):
    """All strips of a scene's sequencer, in meta strips, too."""
    editor = scene.sequence_editor
    if editor is None:
        return []
    return list(editor.strips_all if hasattr(editor, "strips_all") else editor.sequences_all)


# --------------------------------------------------------------------------------------------------
# Materials


def use_material_nodes(material):
    """Enables the node tree. From 5.0 on it is always enabled and the switch is deprecated."""
    if VERSION < (5, 0, 0):
        material.use_nodes = True


def set_alpha_clipping(material):
    """Makes real-time views show the material's alpha (EEVEE before 4.2 and after)."""
    if hasattr(material, "surface_render_method"):
        material.surface_render_method = "DITHERED"
    else:
        material.blend_method = "HASHED"
        material.shadow_method = "HASHED"


def specular_input(principled):
    """The strength of a Principled BSDF's reflection, 0.5 by default (renamed in 4.0)."""
    inputs = principled.inputs
    return inputs["Specular IOR Level"] if "Specular IOR Level" in inputs else inputs["Specular"]


# --------------------------------------------------------------------------------------------------
# Add-on services


def register_file_handler(idname, label, operator, extensions, view_types=("VIEW_3D", "OUTLINER")):
    """Registers drag and drop of files onto the window (4.1 on); returns the class, or None in older versions.

    extensions: ".obj;.txt", as Blender writes them. Undone by unregister_file_handler.
    """
    if not hasattr(bpy.types, "FileHandler"):
        return None

    def poll_drop(_cls, context):
        return context.area is not None and context.area.type in view_types

    handler = type(
        idname,
        (bpy.types.FileHandler,),
        {
            "bl_idname": idname,
            "bl_label": label,
            "bl_import_operator": operator,
            "bl_file_extensions": extensions,
            "poll_drop": classmethod(poll_drop),
        },
    )
    bpy.utils.register_class(handler)
    return handler


def unregister_file_handler(handler):
    if handler is not None:
        bpy.utils.unregister_class(handler)


def register_presets(folder, operator):
    """Shows the presets `folder`/operator/`operator`/*.py in the operator's menu; returns a token for
    unregister_presets.

    `folder` must be named `presets`. Blender versions without register_preset_path find presets of add-ons only in the
    user's own folder, which all running Blenders share. There, nothing is copied: the menu gets further entries.
    """
    if hasattr(bpy.utils, "register_preset_path"):
        bpy.utils.register_preset_path(str(Path(folder).parent))  # expects a subfolder `presets`
        return None
    subfolder = f"operator/{operator}"
    user_folder = Path(bpy.utils.user_resource("SCRIPTS", path="presets")) / subfolder
    try:
        user_folder.mkdir(parents=True, exist_ok=True)  # without any folder the menu says "Missing Paths"
    except OSError as error:  # a read-only home folder must not stop the add-on
        print(f"Snowbough: the folder {user_folder} for presets could not be made ({error.strerror})")

    def draw(menu, _context):
        if menu.preset_subdir == subfolder:
            own = {path.name for shown in bpy.utils.preset_paths(subfolder) for path in Path(shown).iterdir()}
            menu.path_menu(
                [str(Path(folder) / subfolder)],
                menu.preset_operator,
                filter_path=lambda name: name not in own,  # a preset that the user has saved by that name
                display_name=lambda path: bpy.path.display_name(path, title_case=False),
            )

    bpy.types.WM_MT_operator_presets.append(draw)
    return draw


def unregister_presets(folder, token):
    """Reverts register_presets."""
    if token is None:
        bpy.utils.unregister_preset_path(str(Path(folder).parent))
    else:
        bpy.types.WM_MT_operator_presets.remove(token)


def register_command(name, run):
    """Registers `blender -c name ARGS` (4.2 on). run: list of arguments -> exit code. Returns the handle or None."""
    if not hasattr(bpy.utils, "register_cli_command"):
        return None
    return bpy.utils.register_cli_command(name, run)


def unregister_command(handle):
    if handle is not None:
        bpy.utils.unregister_cli_command(handle)


# --------------------------------------------------------------------------------------------------
# Displacement


def set_displacement_method(material, method):
    """BUMP, DISPLACEMENT or BOTH. The property moved from Cycles to the material in 4.1."""
    owner = material if hasattr(material, "displacement_method") else getattr(material, "cycles", None)
    if owner is not None:
        owner.displacement_method = method


def cycles_feature_set(scene):
    """The scene's Cycles feature set; None without Cycles, and in 5.x, which has only one."""
    return getattr(getattr(scene, "cycles", None), "feature_set", None)


def set_adaptive_subdivision(scene, obj, modifier, use):
    """Makes Cycles dice the mesh to pixels: on the modifier from 5.0 on; before, on the object, which also needs the
    experimental feature set. Returns False without Cycles."""
    if hasattr(modifier, "use_adaptive_subdivision"):
        modifier.use_adaptive_subdivision = use
        return True
    if not hasattr(obj, "cycles"):
        return False
    obj.cycles.use_adaptive_subdivision = use
    if use:
        scene.cycles.feature_set = "EXPERIMENTAL"
    return True


def eevee_displaces():
    """Whether EEVEE moves vertices by a material's displacement (4.2 on). Older versions only bump."""
    return VERSION >= (4, 2, 0)


# --------------------------------------------------------------------------------------------------
# Evaluated meshes


def read_positions(mesh):
    """Vertex positions as float32 (V, 3)."""
    positions = np.empty((len(mesh.vertices), 3), dtype=np.float32)
    attribute = mesh.attributes.get("position")
    if attribute is not None:  # 3.5 on: plain memory; reading vertices is many times slower from 4.3 on
        attribute.data.foreach_get("vector", positions.ravel())
    else:
        mesh.vertices.foreach_get("co", positions.ravel())
    return positions


def read_corner_vertices(mesh):
    """Vertex index of every corner as int32 (L,)."""
    corners = np.empty(len(mesh.loops), dtype=np.int32)
    attribute = mesh.attributes.get(".corner_vert")
    if attribute is not None:
        attribute.data.foreach_get("value", corners)
    else:
        mesh.loops.foreach_get("vertex_index", corners)
    return corners


def read_uv(layer, corner_count):
    """UV coordinates of every corner as float32 (L, 2)."""
    uv = np.empty((corner_count, 2), dtype=np.float32)
    if hasattr(layer, "uv"):
        layer.uv.foreach_get("vector", uv.ravel())
    else:
        layer.data.foreach_get("uv", uv.ravel())
    return uv


def read_corner_normals(mesh):
    """The shading normal of every corner as float32 (L, 3), with flat faces, sharp edges, Auto Smooth and custom
    normals."""
    normals = np.empty((len(mesh.loops), 3), dtype=np.float32)
    if hasattr(mesh, "corner_normals"):  # 4.1 on
        mesh.corner_normals.foreach_get("vector", normals.ravel())
    else:
        mesh.calc_normals_split()
        mesh.loops.foreach_get("normal", normals.ravel())
        mesh.free_normals_split()
    return normals


def ensure_triangles(mesh):
    """Makes mesh.loop_triangles valid; from 4.1 on Blender does it by itself."""
    if hasattr(mesh, "calc_loop_triangles"):
        mesh.calc_loop_triangles()


# --------------------------------------------------------------------------------------------------
# Rendered pixels


def set_pass_pixels(render_pass, pixels):
    """Writes (height, width, channels) float32 into a render pass of that size."""
    try:
        # 3.4 crashes on a flat array; 5.0 refuses any other.
        render_pass.rect.foreach_set(pixels.reshape(-1, pixels.shape[2]))
    except TypeError:
        render_pass.rect.foreach_set(pixels.reshape(-1))


# --------------------------------------------------------------------------------------------------
# Panels


def draw_progress(layout, fraction, text):
    """A progress bar from 4.0 on; before, the text."""
    if hasattr(layout, "progress"):
        layout.progress(factor=fraction, text=text)
    else:
        layout.label(text=text, icon="BLANK1")


def section(layout, identifier, text):
    """A collapsible part of a dialog; returns its layout, or None if the user has closed it.

    Before 4.1 it is a box, always open. identifier: the name under which Blender stores the state.
    """
    if hasattr(layout, "panel"):
        header, body = layout.panel(identifier)
        header.label(text=text)
        return body
    box = layout.box()
    box.label(text=text)
    return box.column()

# SPDX-License-Identifier: GPL-3.0-or-later
"""Operator `import_scene.xfrog_tree`: an OBJ tree as one rigged, weighted, unwrapped mesh.

First everything native is computed (:func:`read_native`; it can run on another thread and be stopped),
only then Blender's data-blocks are made (:func:`create_tree`): bad input or Esc leaves Blender as it was.
"""

import json
import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path

import bpy
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from . import compat, native, tree_armature, tree_material, tree_objects

REPORT_PROPERTY = "snowbough_report"
LOD_PROPERTY = "snowbough_lod"
LOD_COUNT = 4


@dataclass
class ImportOptions:
    """What the operator's properties of the same names say."""

    up_axis: str = "AUTO"
    levels: str = ""
    simplify: str = "TOLERANCE"
    tolerance: float = 0.5
    width: str = "ORIGINAL"
    species: str = "BROADLEAF"
    lod: int = 0
    lod_chain: bool = False
    max_bones: int = 1000
    max_bone_level: int = -1
    foliage: bool = True
    foliage_names: str = ""
    snow_resolution: int = 1024


@dataclass
class NativeTree:
    """Everything an import needs, before Blender hears of it. Meshes share their bones."""

    skeleton: object
    meshes: list  # (level of detail, native mesh with reduced bones)
    leaf_bones: object
    leaf_layout: dict  # the leaves' UV map `snow` and the resolution it is for; None without leaves
    report: dict


def _build_meshes(module, skeleton, options, progress):
    """(the first mesh with all bones, [(lod, mesh with reduced bones), ...]).

    progress(share 0..1) -> False stops: KeyboardInterrupt. The native module works outside Python's
    lock: the finest level of a chain takes as long as all others together, which a second thread makes
    meanwhile.
    """
    lods = list(range(LOD_COUNT)) if options.lod_chain else [options.lod]
    shares = dict.fromkeys(lods, 0.0)
    stopped = threading.Event()

    def build(lod):
        def step(share):
            shares[lod] = share
            return not stopped.is_set() and progress(sum(shares.values()) / len(shares))

        whole = module.build_tree_mesh(
            skeleton,
            options.width,
            options.species,
            lod=lod,
            snow_resolution=options.snow_resolution,
            progress=step,
        )
        reduced = module.reduce_bones(whole, options.max_bones, options.max_bone_level)
        return (whole if lod == lods[0] else None), (lod, reduced)

    if len(lods) == 1:
        whole, mesh = build(lods[0])
        return whole, [mesh]
    built = {}
    with ThreadPoolExecutor(2, "snowbough-lod") as workers:
        futures = {workers.submit(build, lod): lod for lod in reversed(lods)}
        try:
            for future in as_completed(futures):
                built[futures[future]] = future.result()
        except BaseException:
            stopped.set()
            workers.shutdown(wait=True, cancel_futures=True)
            raise
    return built[lods[0]][0], [built[lod][1] for lod in lods]


def _lay_out_leaves(module, skeleton, options, stopped):
    """The leaves' UV map `snow`; None without leaves. stopped: an event that ends it."""
    if not len(skeleton.foliage.vertices):
        return None

    def go_on(_share):
        return not stopped.is_set()

    return module.layout_leaf_uvs(skeleton, options.snow_resolution, progress=go_on)


def read_native(path, options, progress=None):
    """Reads `path` and computes the tree. Touches no Blender data; raises ValueError for bad input.

    progress(share 0..1) -> False stops: KeyboardInterrupt.
    """
    path = Path(path)
    if not path.name or path.is_dir():
        raise ValueError(f"{path} is a folder: choose an OBJ file")
    if not path.is_file():
        raise ValueError(f"{path} was not found")
    module = native.load()
    started = time.perf_counter()

    def part(begin, end):
        """Reports the shares of a stage as those of the whole."""
        return lambda share: progress is None or progress(begin + (end - begin) * share)

    skeleton = module.read_tree(
        str(path),
        up_axis=options.up_axis,
        levels=options.levels,
        simplify=options.simplify,
        tolerance=options.tolerance,
        foliage=(options.foliage_names or "AUTO") if options.foliage else "NONE",
        progress=part(0.0, 0.4),
    )
    if not skeleton.branches:
        raise ValueError(f"{path} holds no branches: there is no tree to import")
    # The leaves' charts need the skeleton alone: a second thread lays them out beside the mesh.
    stopped = threading.Event()
    with ThreadPoolExecutor(1, "snowbough-leaves") as worker:
        try:
            leaf_charts = worker.submit(_lay_out_leaves, module, skeleton, options, stopped)
            whole, meshes = _build_meshes(module, skeleton, options, part(0.4, 0.95))
            leaf_layout = leaf_charts.result()
        except BaseException:
            stopped.set()
            raise
    warnings = list(whole.warnings)
    leaf_bones = None
    if leaf_layout is not None:
        bone_map = meshes[0][1].bone_map
        leaf_bones = module.leaf_bones(skeleton, whole)
        leaf_bones = leaf_bones if bone_map is None else bone_map[leaf_bones]
        if leaf_layout["resolution"] > options.snow_resolution:
            warnings.append(
                f"the leaves' snow UV map needs a resolution of {leaf_layout['resolution']}, "
                f"not {options.snow_resolution}"
            )
    if part(0.95, 1.0)(1.0) is False:
        raise KeyboardInterrupt("cancelled")

    report = dict(skeleton.report)
    report["file"] = path.name
    report["height"] = float(skeleton.height)
    report["branches"] = len(skeleton.branches)
    report["bones_found"] = len(whole.bone_parents)
    report["bones"] = len(meshes[0][1].bone_parents)
    report["meshes"] = [
        {"lod": lod, "vertices": len(mesh.vertices), "faces": len(mesh.quads)} for lod, mesh in meshes
    ]
    report["leaves"] = 0 if leaf_bones is None else len(leaf_bones)
    report["surface"] = {key: whole.report[key] for key in ("components", "closed", "crossing_junctions")}
    report["warnings"] = list(report["warnings"]) + warnings
    report["native_seconds"] = round(time.perf_counter() - started, 4)
    return NativeTree(skeleton, meshes, leaf_bones, leaf_layout, report)


def _lod_suffix(lod, chain):
    # Game engines call the finest level LOD0; ours counts up from the four-sided base.
    return f"_LOD{LOD_COUNT - 1 - lod}" if chain else ""


def create_tree(context, title, tree, options):
    """Makes collection, armature, bark and leaves; returns the collection. On an error nothing stays."""
    with tree_objects.Ledger():
        if context.object is not None and context.object.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")
        name = tree_objects.file_title(title, len("_leaves_LOD0"))
        collection = bpy.data.collections.new(name)
        # The scene's own collection cannot be hidden or excluded: the armature needs edit mode there.
        context.scene.collection.children.link(collection)

        bones = tree_armature.bone_arrays(tree.meshes[0][1])
        rig = tree_armature.create_armature(context, name, bones, collection)
        made = [rig]
        bark_material = tree_material.bark_material(f"{name}_bark")
        for lod, mesh in reversed(tree.meshes):
            bark_name = f"{name}_bark{_lod_suffix(lod, options.lod_chain)}"
            bark = tree_objects.create_bark(bark_name, mesh, bones.names, bark_material)
            bark[LOD_PROPERTY] = lod
            bark[tree_objects.SNOW_RESOLUTION_PROPERTY] = options.snow_resolution
            made.append(bark)
        if tree.leaf_bones is not None:
            foliage = tree.skeleton.foliage
            materials = [tree_material.leaf_material(source) for source in foliage.materials]
            materials.append(tree_material.leaf_material(name=f"{name}_leaf"))
            leaves = tree_objects.create_leaves(
                f"{name}_leaves", foliage, tree.leaf_layout["uv"], tree.leaf_bones, bones.names, materials
            )
            leaves[tree_objects.SNOW_RESOLUTION_PROPERTY] = int(tree.leaf_layout["resolution"])
            made.append(leaves)
        for obj in made[1:]:
            collection.objects.link(obj)
            tree_objects.bind(obj, rig)
            # Of a chain only the finest is shown: the others lie in the same place.
            if options.lod_chain and obj.get(LOD_PROPERTY, LOD_COUNT - 1) != LOD_COUNT - 1:
                obj.hide_render = True
                obj.hide_set(True)
        collection[REPORT_PROPERTY] = json.dumps(tree.report)
        for other in context.view_layer.objects.selected:
            other.select_set(False)
        for obj in made:
            if not obj.hide_get():
                obj.select_set(True)
        context.view_layer.objects.active = rig
        return collection


def import_file(context, path, options, progress=None):
    """Imports `path` into the scene; returns (collection, report). ValueError for bad input."""
    started = time.perf_counter()
    tree = read_native(path, options, progress)
    collection = create_tree(context, Path(path).stem, tree, options)
    tree.report["seconds"] = round(time.perf_counter() - started, 4)
    collection[REPORT_PROPERTY] = json.dumps(tree.report)
    return collection, tree.report


def summary(report):
    """The report in one line."""
    levels = "/".join(str(count) for count in report["branches_per_level"])
    faces = " + ".join(str(mesh["faces"]) for mesh in report["meshes"])
    text = (
        f"{report['file']}: {report['form']}, {report['up_axis']} up, {report['branches']} branches ({levels}), "
        f"{report['bones']} of {report['bones_found']} bones, {faces} faces, {report['leaves']} leaves"
    )
    for count, what in (
        (len(report["skipped_parts"]), "parts skipped"),
        (len(report["extra_roots"]), "extra roots"),
        (len(report["warnings"]), "warnings"),
    ):
        text += f", {count} {what}" if count else ""
    return text


def message(error):
    """What is told of an error; a MemoryError says nothing of its own."""
    if isinstance(error, MemoryError):
        return "The tree does not fit into memory: choose a lower level of detail, or simplify it"
    return str(error)


def _tell(operator, report):
    for text in report["warnings"][:5]:
        operator.report({"WARNING"}, text)
    if len(report["warnings"]) > 5:
        operator.report(
            {"WARNING"}, f"and {len(report['warnings']) - 5} more: see the collection's custom property"
        )
    operator.report({"INFO"}, summary(report))


class _Job:
    """read_native on a thread of its own: it gets plain values and gives back native data only."""

    def __init__(self, path, options):
        self.share, self.tree, self.error = 0.0, None, None
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(path, options), daemon=True)
        native.load()  # on the main thread: a missing module is told at once
        self._thread.start()

    def _progress(self, share):
        self.share = share
        return not self._stop.is_set()

    def _run(self, path, options):
        try:
            self.tree = read_native(path, options, self._progress)
        except (ValueError, RuntimeError, OSError, MemoryError, KeyboardInterrupt) as error:
            self.error = error

    def running(self):
        return self._thread.is_alive()

    def stop(self):
        self._stop.set()
        self._thread.join()


class IMPORT_SCENE_OT_xfrog_tree(bpy.types.Operator, ImportHelper):
    """Import a tree that Xfrog or a similar modeller exported, as one continuous, rigged mesh"""

    bl_idname = "import_scene.xfrog_tree"
    bl_label = "Import Xfrog Tree"
    bl_options = {"PRESET", "UNDO"}

    filename_ext = ".obj"
    filter_glob: StringProperty(
        name="File Names", description="Files that the browser shows", default="*.obj", options={"HIDDEN"}
    )
    up_axis: EnumProperty(
        name="Up Axis",
        description="Which of the file's axes points up",
        items=(
            ("AUTO", "Automatic", "Found from the tree's shape"),
            ("Y", "Y", "The file's Y axis points up"),
            ("Z", "Z", "The file's Z axis points up"),
        ),
        default="AUTO",
    )
    levels: StringProperty(
        name="Level Names",
        description="Names of groups from the trunk on, separated by commas; empty: found from the names themselves",
    )
    simplify: EnumProperty(
        name="Simplify",
        description="Which points of a branch become joints",
        items=(
            ("NONE", "Keep All", "Every point of the export becomes a joint"),
            ("THESIS", "Attach Points", "Straight bones between a branch's children"),
            ("TOLERANCE", "Tolerance", "As Attach Points, and what it takes to stay close to the original"),
        ),
        default="TOLERANCE",
    )
    tolerance: FloatProperty(
        name="Tolerance",
        description="How far a limb may stray from the original (radii of the limb)",
        default=0.5,
        min=0.0,
        soft_max=4.0,
    )
    width: EnumProperty(
        name="Width",
        description="How thick branches are along their way",
        items=(
            ("ORIGINAL", "Original", "The export's own radii"),
            ("INVERSE", "Flare", "Radii that flare towards each branch's root"),
        ),
        default="ORIGINAL",
    )
    species: EnumProperty(
        name="Species",
        description="How branches of the first level flare, where Width is Flare",
        items=(
            ("BROADLEAF", "Broad-leaf", "Branches of all levels flare alike"),
            ("EVERGREEN", "Evergreen", "First branches are thin and straight with a short flare"),
        ),
        default="BROADLEAF",
    )
    lod: IntProperty(
        name="Level of Detail",
        description="0: four-sided limbs; each level doubles the sides and rounds them (levels)",
        default=0,
        min=0,
        max=LOD_COUNT - 1,
    )
    lod_chain: BoolProperty(
        name="Import LOD Chain",
        description="All four levels of detail on one armature, named as game engines expect: _LOD0 is the finest",
        default=False,
    )
    max_bones: IntProperty(
        name="Max Bones",
        description="Bone budget, 0 = all; the deepest bones hand their weights to their ancestors (bones)",
        default=1000,
        min=0,
    )
    max_bone_level: IntProperty(
        name="Max Bone Level",
        description="Last branch level that gets bones, -1 = all (levels)",
        default=-1,
        min=-1,
    )
    foliage: BoolProperty(
        name="Foliage", description="Keep leaves, needles and flowers as a second object", default=True
    )

    foliage_names: StringProperty(
        name="Foliage Names",
        description="What is foliage: starts of the names of groups, objects or materials, separated by "
        "commas; empty: told by usual names and by shape",
    )
    snow_resolution: IntProperty(
        name="Snow Resolution",
        description="Side of the accumulation map that the UV maps `snow` are laid out for (texels)",
        default=1024,
        min=64,
        max=8192,
    )

    def _options(self):
        return ImportOptions(**{name: getattr(self, name) for name in ImportOptions.__dataclass_fields__})

    def invoke(self, context, event):
        # A file dropped onto the window comes with its path: only the options are asked for.
        self._in_window = True
        if self.properties.is_property_set("filepath") and Path(self.filepath).is_file():
            return context.window_manager.invoke_props_dialog(self)
        return ImportHelper.invoke(self, context, event)

    def execute(self, context):
        if getattr(self, "_in_window", False) and context.window is not None and not bpy.app.background:
            # A job of its own keeps the window alive and listens to Esc.
            values = asdict(self._options())
            bpy.ops.snowbough.import_tree_job("INVOKE_DEFAULT", filepath=self.filepath, **values)
            return {"FINISHED"}
        try:
            _collection, report = import_file(context, self.filepath, self._options())
        except KeyboardInterrupt:
            self.report({"WARNING"}, "The import was stopped; nothing was changed")
            return {"CANCELLED"}
        except (ValueError, RuntimeError, OSError, MemoryError) as error:
            self.report({"ERROR"}, message(error))
            return {"CANCELLED"}
        _tell(self, report)
        return {"FINISHED"}


class SNOWBOUGH_OT_import_tree_job(bpy.types.Operator):
    """Read a tree while the window stays alive; Esc stops it and leaves everything as it was"""

    bl_idname = "snowbough.import_tree_job"
    bl_label = "Import Xfrog Tree"
    bl_options = {"INTERNAL", "UNDO"}

    # The import operator's own settings, checked there.
    filepath: StringProperty(options={"SKIP_SAVE"})
    up_axis: StringProperty(default="AUTO")
    levels: StringProperty()
    simplify: StringProperty(default="TOLERANCE")
    tolerance: FloatProperty(default=0.5)
    width: StringProperty(default="ORIGINAL")
    species: StringProperty(default="BROADLEAF")
    lod: IntProperty()
    lod_chain: BoolProperty()
    max_bones: IntProperty(default=1000)
    max_bone_level: IntProperty(default=-1)
    foliage: BoolProperty(default=True)
    foliage_names: StringProperty()
    snow_resolution: IntProperty(default=1024)

    def invoke(self, context, _event):
        self._options = ImportOptions(
            **{name: getattr(self, name) for name in ImportOptions.__dataclass_fields__}
        )
        try:
            self._job = _Job(self.filepath, self._options)
        except RuntimeError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        manager = context.window_manager
        self._timer = manager.event_timer_add(0.05, window=context.window)
        manager.progress_begin(0, 100)
        context.workspace.status_text_set(f"Reading {Path(self.filepath).name} (Esc: stop)")
        manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC" and event.value == "PRESS":
            self.cancel(context)
            self.report({"WARNING"}, "The import was stopped; nothing was changed")
            return {"CANCELLED"}
        if event.type != "TIMER":
            return {"RUNNING_MODAL"}
        context.window_manager.progress_update(100 * self._job.share)
        if self._job.running():
            return {"RUNNING_MODAL"}
        self._end(context)
        if self._job.error is not None:
            self.report({"ERROR"}, message(self._job.error))
            return {"CANCELLED"}
        try:
            create_tree(context, Path(self.filepath).stem, self._job.tree, self._options)
        except (ValueError, RuntimeError, OSError, MemoryError) as error:
            self.report({"ERROR"}, message(error))
            return {"CANCELLED"}
        _tell(self, self._job.tree.report)
        return {"FINISHED"}

    def cancel(self, context):
        self._job.stop()
        self._end(context)

    def _end(self, context):
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)


def _draw_menu(self, _context):
    self.layout.operator(IMPORT_SCENE_OT_xfrog_tree.bl_idname, text="Xfrog Tree (.obj)")


CLASSES = (IMPORT_SCENE_OT_xfrog_tree, SNOWBOUGH_OT_import_tree_job)
_file_handlers = []


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)
    bpy.types.TOPBAR_MT_file_import.append(_draw_menu)
    _file_handlers.append(
        compat.register_file_handler(
            "SNOWBOUGH_FH_xfrog_tree", "Xfrog Tree", IMPORT_SCENE_OT_xfrog_tree.bl_idname, ".obj"
        )
    )


def unregister():
    compat.unregister_file_handler(_file_handlers.pop())
    bpy.types.TOPBAR_MT_file_import.remove(_draw_menu)
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)

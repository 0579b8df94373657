import bpy

op = bpy.context.active_operator

op.simplify = "TOLERANCE"
op.tolerance = 1.0
op.width = "ORIGINAL"
op.species = "BROADLEAF"
op.lod = 0
op.lod_chain = True
op.max_bones = 250
op.max_bone_level = 2
op.foliage = True

import bpy

op = bpy.context.active_operator

op.simplify = "TOLERANCE"
op.tolerance = 0.5
op.width = "INVERSE"
op.species = "EVERGREEN"
op.lod = 1
op.lod_chain = False
op.max_bones = 1000
op.max_bone_level = -1
op.foliage = True

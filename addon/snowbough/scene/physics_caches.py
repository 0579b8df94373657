# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's physics simulations, and whether they move in a bake.

A bake reads the scene as a render does. There, rigid bodies and soft bodies move only if their cache is baked; cloth
and particles also play from frame to frame, from the first frame of their cache on. So a baked cache is always right.
Without one, simulations that cannot play are an error, and the others are a warning: cloth does not move between whole
frames, and a resumed bake must play all frames before.
"""

BAKE_ALL = "bake the simulations (Physics properties, Cache, Bake All Dynamics)"


def _caches(scene):
    """(object's name, kind, point cache, whether it plays in a render) of the rendered simulations."""
    world = scene.rigidbody_world
    if world is not None and world.enabled and world.collection is not None:
        for obj in world.collection.objects:
            body = obj.rigid_body
            if body is not None and body.type == "ACTIVE" and not body.kinematic and not obj.hide_render:
                yield obj.name, "rigid body", world.point_cache, False
    for obj in scene.objects:
        if obj.hide_render:
            continue
        for modifier in obj.modifiers:
            if not modifier.show_render:
                continue
            if modifier.type == "CLOTH":
                yield obj.name, "cloth", modifier.point_cache, True
            elif modifier.type == "SOFT_BODY":
                yield obj.name, "soft body", modifier.point_cache, False
            elif modifier.type == "PARTICLE_SYSTEM" and _has_instances(modifier.particle_system):
                yield obj.name, "particle", modifier.particle_system.point_cache, True


def _has_instances(system):
    settings = system.settings
    moves = settings.type == "EMITTER" or system.use_hair_dynamics
    return moves and settings.render_type in ("OBJECT", "COLLECTION")


def issues(scene):
    """[(severity, text, object's name, fix)], the arguments of preflight's Issue, one for each object."""
    found = {}
    for name, kind, cache, plays in _caches(scene):
        if cache.is_baked or name in found:
            continue
        if not plays:
            found[name] = (
                "ERROR",
                f"'{name}' is a {kind} whose simulation is not baked, so it does not move in a render: {BAKE_ALL}",
            )
        elif cache.frame_start < scene.snowbough.frame_start:
            found[name] = (
                "ERROR",
                f"'{name}' is a {kind} simulation that starts at frame {cache.frame_start}, before the snow's "
                f"first frame, and is not baked: {BAKE_ALL}",
            )
        else:
            found[name] = (
                "WARNING",
                f"'{name}' is a {kind} simulation that is not baked: it does not move between whole frames, and may "
                f"differ on other machines: {BAKE_ALL}",
            )
    return [(severity, text, name, "BAKE_SIMULATIONS") for name, (severity, text) in found.items()]


def require_cached(scene):
    """Raises ValueError for a simulation that would be in a wrong pose during a bake."""
    for severity, text, _, _ in issues(scene):
        if severity == "ERROR":
            raise ValueError(text)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's own simulations and whether a bake sees them move.

A bake looks at the scene as a render does. There, rigid bodies and soft bodies only move where their cache
is filled; cloth and particles also play as the frames pass, from the first frame of their cache on. So a
baked cache is always right; without one, what cannot play is refused and what can is warned about: cloth
then stands still between whole frames, and a bake that goes on replays all frames before.
"""

BAKE_ALL = "bake the simulations (Physics properties, Cache, Bake All Dynamics)"


def _caches(scene):
    """(object's name, what it is, its point cache, whether it plays in a render) of what the render shows."""
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


def troubles(scene):
    """[(severity, text, object's name, fix)] as preflight's Issue takes them, one for each object."""
    found = {}
    for name, kind, cache, plays in _caches(scene):
        if cache.is_baked or name in found:
            continue
        if not plays:
            found[name] = (
                "ERROR",
                f"'{name}' is a {kind} whose simulation is not baked, so a render does not see it move: {BAKE_ALL}",
            )
        elif cache.frame_start < scene.snowbough.frame_start:
            found[name] = (
                "ERROR",
                f"'{name}' is a {kind} simulation that begins at frame {cache.frame_start}, before the snow's "
                f"first frame, and is not baked: {BAKE_ALL}",
            )
        else:
            found[name] = (
                "WARNING",
                f"'{name}' is a {kind} simulation that is not baked: it plays along, but stands still between "
                f"whole frames, and other machines may see another one: {BAKE_ALL}",
            )
    return [(severity, text, name, "BAKE_SIMULATIONS") for name, (severity, text) in found.items()]


def require_cached(scene):
    """Raises ValueError for a simulation that a bake would see in a wrong pose."""
    for severity, text, _, _ in troubles(scene):
        if severity == "ERROR":
            raise ValueError(text)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings for what people do with snow: presets of several settings at once, which can be changed afterwards."""

PRESETS = (
    ("WALK", "Walk", "Make the selected objects press snow as boots do"),
    ("DRIVE", "Drive", "Make the selected objects press snow as tyres do"),
    ("THAW", "Thaw", "Let the snow of the shot thaw in the sun, and wet the ground"),
)

# Pressures of some 30 kPa under boots and 200 kPa under tyres pack snow to about these densities (A. Abele and A. Gow,
# Compressibility Characteristics of Undisturbed Snow, CRREL Research Report 336, 1975).
_PRESSED = {
    "WALK": {"packed_density": 400.0, "pushed_aside": 0.25, "rim_width": 0.05, "walls_stand": 0.3},
    "DRIVE": {"packed_density": 500.0, "pushed_aside": 0.15, "rim_width": 0.08, "walls_stand": 0.3},
}
# Metres of snow that a thaw begins with at least.
THAW_DEPTH = 0.1


def apply(name, scene, objects):
    """Sets a preset; objects: those that press. Raises ValueError if there are none."""
    if name in _PRESSED:
        if not objects:
            raise ValueError("Select the objects that press the snow: boots, wheels")
        for obj in objects:
            obj.snowbough.press = "PRESS"
            for setting, value in _PRESSED[name].items():
                setattr(obj.snowbough, setting, value)
        return
    settings = scene.snowbough
    settings.start_depth = max(settings.start_depth, settings.end_depth, THAW_DEPTH)
    settings.end_depth = 0.0
    settings.wet = True
    settings.density = max(settings.density, 250.0)
    suns = [obj for obj in scene.objects if obj.type == "LIGHT" and obj.data.type == "SUN"]
    if settings.sun is None and suns:
        settings.sun = suns[0]

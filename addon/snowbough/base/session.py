# SPDX-License-Identifier: GPL-3.0-or-later
"""State that lives as long as Blender's session: a running bake or preview, and what panels show.

Nothing of it is saved. Other modules read and write it as ``session.bake``. It survives reloading of the add-on, since
a bake may still be ending.
"""


def _persistent(name, initial):
    """The value from before a reload, or else `initial`."""
    return globals().get(name, initial)


# Whether the add-on is enabled.
enabled = _persistent("enabled", False)

# The bake.engine.Session that runs, or None.
bake = _persistent("bake", None)

# The preview.live.Preview that is drawn over the viewport, or None.
preview = _persistent("preview", None)

NO_OUTCOME = ("INFO", "")

# (severity, text): the result of the last bake in this Blender, for the panel.
last_outcome = _persistent("last_outcome", NO_OUTCOME)

# Measured time of the surfaces of the last bake as a multiple of the expected one.
surface_pace = _persistent("surface_pace", 1.0)

# Scene name -> findings of the last check (bake.preflight.Issue), for the panel.
issues = _persistent("issues", {})

# Scene name -> identity of its cache, set when the file was saved.
cache_identities = _persistent("cache_identities", {})

# Path of a manifest or a ledger -> (its modification time, its content), for panels that redraw often.
manifests = _persistent("manifests", {})

# Cache folder -> (time of the last look, whether it has an unfinished bake).
unfinished_bakes = _persistent("unfinished_bakes", {})

# Receiver's folder -> (inputs of its surface, surface.compute.Surface), for sliders.
surfaces = _persistent("surfaces", {})

# Scene name -> its compat.frame_length that the modifiers of its surfaces have.
frame_lengths = _persistent("frame_lengths", {})

# Name of a surface whose modifier reads a single frame, made for a slider -> its receiver's folder.
shown_surfaces = _persistent("shown_surfaces", {})

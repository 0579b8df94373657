# SPDX-License-Identifier: GPL-3.0-or-later
"""What lives as long as Blender's session, in one place: a running bake or preview, and what panels show.

Nothing of it is saved. Other modules read and set these as ``session.bake``. When the add-on is switched off
and on again its modules are loaded anew; this one keeps what it holds, since a bake may still be ending.
"""


def _kept(name, fresh):
    """What the session holds under that name since before a reload, else `fresh`."""
    return globals().get(name, fresh)


# Whether the add-on is switched on.
enabled = _kept("enabled", False)

# The bake.engine.Session that runs, or None.
bake = _kept("bake", None)

# The preview.live.Preview that is drawn over the viewport, or None.
preview = _kept("preview", None)

NO_OUTCOME = ("INFO", "")

# How the last bake in this Blender went, for the panel: (severity, text).
last_outcome = _kept("last_outcome", NO_OUTCOME)

# Scene name -> issues that the last check found (bake.preflight.Issue), for the panel.
issues = _kept("issues", {})

# Scene name -> the identity of its cache that the file has been given by saving it.
cache_identities = _kept("cache_identities", {})

# Manifest's path -> (time of its last change, manifest), for panels that redraw often.
manifests = _kept("manifests", {})

# Cache folder -> (when it was looked at, whether an unfinished bake was there).
unfinished_bakes = _kept("unfinished_bakes", {})

# Folder of a receiver -> (what its surface was made with, surface.compute.Surface), for sliders.
surfaces = _kept("surfaces", {})

# Name of a surface whose modifier reads one frame made for a slider -> its receiver's folder.
shown_surfaces = _kept("shown_surfaces", {})

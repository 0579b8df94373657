# SPDX-License-Identifier: GPL-3.0-or-later
"""The live preview: snow that falls as the timeline plays, drawn over the viewport. Nothing of it is in the scene."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""The live preview: snow falls as the timeline plays, and is drawn over the viewport. The scene stays unchanged."""

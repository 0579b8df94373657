# SPDX-License-Identifier: GPL-3.0-or-later
"""The live preview: it simulates snow while the timeline plays and draws it over the viewport. The scene stays
unchanged."""

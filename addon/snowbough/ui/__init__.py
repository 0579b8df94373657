# SPDX-License-Identifier: GPL-3.0-or-later
"""The user interface: operators, panels, and handles in the 3D view."""

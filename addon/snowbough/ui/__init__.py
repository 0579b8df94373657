# SPDX-License-Identifier: GPL-3.0-or-later
"""What an artist sees and presses: operators, panels, and handles in the 3D view."""

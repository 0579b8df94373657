# SPDX-License-Identifier: GPL-3.0-or-later
"""Boughs bend under snow: the load of the bones, their bend, and its keyframes."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""Baked maps in the scene: images, snow material, displacement, and surfaces."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""Imports OBJ files as rigged trees, and animates them in the wind."""

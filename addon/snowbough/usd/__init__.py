# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes trees as USD: skeleton, skinned bark, instanced leaves, materials, snow, and Unreal's wind data."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""From an artist's settings to baked maps: the request, the job, the engine it runs in, and what is told about it."""

# SPDX-License-Identifier: GPL-3.0-or-later
"""From settings to baked maps: the request, the job, the render engine that runs it, and its messages."""

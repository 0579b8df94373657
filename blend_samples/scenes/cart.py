# SPDX-License-Identifier: GPL-3.0-or-later
"""A cart that waits in the snow and then drives off: its snow travels with it, and the ground where it stood is dry."""

import demo_scene
import sample


def build():
    boards = sample.painted("old boards", (0.23, 0.115, 0.05), mottle=0.4, scale=7.0, stretch=(0.5, 4.0, 4.0))
    return demo_scene.make_cart(boards, sample.painted("iron", (0.055, 0.045, 0.04), roughness=0.55))


sample.run(
    build,
    eye=(3.2, -7.2, 2.6),
    target=(2.0, -1.6, 0.45),
    frames=demo_scene.FRAMES,
    depth=0.10,
    resolution=1024,
)

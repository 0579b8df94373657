"""Snow in real time: the pictures snow_close, snow_garden and snow_tree of docs/images.

    PYTHONPATH=build/python /usr/bin/python3 benchmarks/realtime/snow_pictures.py [--only NAME,..] [--out FOLDER]

snow_close   an urn and a bench from near, shaded and as wireframes (the thesis's figures 4.7 and 4.8)
snow_garden  a garden while it snows (its figure 4.19)
snow_tree    a tree that carries snow, whole and from near (its figure 4.20)
"""

import argparse
from pathlib import Path

import numpy as np
import scenes
import snowbough_native as native

NAMES = ("snow_close", "snow_garden", "snow_tree")


def garden():
    tree, mesh = scenes.maple()
    things = {
        "ground": scenes.ground(),
        "bench": scenes.bench().moved((0.9, -0.6, 0.0), -20),
        "urn": scenes.urn().moved((-1.3, -0.9, 0)),
        "stone": scenes.boxes([((0, 0, 0.16), (0.5, 0.36, 0.34))], 256, (0.3, 0.29, 0.27)).moved(
            (1.75, -1.75, 0), 35
        ),
        "tree": tree,
    }
    return things, {"tree": mesh}


def drawn(renderer, eye, target, size, field_of_view=0.55, **options):
    camera = native.Camera(eye=eye, target=target, width=size[0], height=size[1], field_of_view=field_of_view)
    settings = native.RenderSettings(
        **{**scenes.LIGHT, "antialias": not options.get("wireframe", False), **options}
    )
    return renderer.render(camera, settings)[..., :3]


def both(renderer, eye, target, size, **options):
    """A picture and its wireframe beside it."""
    views = [drawn(renderer, eye, target, size, **options, wireframe=wire) for wire in (False, True)]
    return np.concatenate(views, axis=1)


def snow_close(renderer):
    urn = both(renderer, (-1.7, -1.85, 1.22), (-1.3, -0.9, 0.76), (600, 450), target_pixels=16.0)
    bench = both(renderer, (-0.15, -1.2, 0.95), (0.45, -0.5, 0.5), (600, 450), target_pixels=16.0)
    return np.concatenate([bench, urn])


def snow_garden(renderer):
    flakes = native.Snowfall(rate=4e-6, direction=scenes.FALL, radius=0.004, time=1.0, seed=3)
    return drawn(renderer, (0.3, -5.6, 1.55), (0.2, 0, 1.05), (960, 600), snowfall=flakes)


def snow_tree(renderer):
    whole = drawn(renderer, (1.6, -6.0, 1.9), (0, 0, 1.5), (480, 600))
    near = drawn(renderer, (-0.75, -1.1, 1.75), (0, 0, 1.45), (480, 600), 0.6)
    return np.concatenate([whole, near], axis=1)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default=",".join(NAMES))
    parser.add_argument("--out", default=scenes.ROOT / "docs" / "images")
    arguments = parser.parse_args()
    names = arguments.only.split(",")
    if not set(names) <= set(NAMES):
        parser.error(f"--only takes some of {', '.join(NAMES)}")
    things, trees = garden()
    heights = scenes.fallen(things, 0.09)
    with native.Renderer() as renderer:
        # Cut less finely than the maps would have it, so that wireframes show what the tessellator does.
        scenes.show(renderer, things, heights, trees, cut=0.25)
        for name in names:
            native.write_png(str(Path(arguments.out) / f"{name}.png"), globals()[name](renderer))
            print({key: value for key, value in renderer.statistics().items() if key != "passes"})


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Grows a tree and writes it in the form of Xfrog's square export.

    grow_tree.py [--species maple|spruce] [--seed N] [--height METRES] [--levels N] [--leaves] OUT.obj

The file has one group per branch (`g trunk1`, `g branch7`, `g limb31`, `g twig205`). Each is a row of disconnected
squares across the limb from its root to its tip. Y is up, one unit is a metre. With `--leaves` a last group `leaves`
contains the foliage, and a material library is written beside the file. The same species, seed and height give the same
bytes.

A shoot grows in short steps. Its heading wanders (a first-order random walk: crookedness), bends towards the light or
with its weight (tropism), and yields a little to the other side at each lateral, which makes the zigzag of real twigs.
Laterals stand on their parent at divergence angles: the golden angle on a spiral, or pairs turned by a right angle; a
spruce's trunk has whorls. Their length is a share of the remaining parent, limited by the crown's outline. Thickness is
computed last, from the tips down, by Leonardo's rule: the wood above a fork has the cross-section of the wood below it,
r^n = sum of r_i^n, with n a little over 2 as measured on real trees. Every metre of shoot also adds the wood of small
twigs that are not drawn.

Sources: J. P. Richter (ed.), The Literary Works of Leonardo da Vinci, 1883, paragraph 394 (the rule);
C. Eloy, Leonardo's rule, self-similarity, and wind-induced stresses in trees, Physical Review Letters 107,
2011 (the exponent); P. Prusinkiewicz, A. Lindenmayer, The Algorithmic Beauty of Plants, 1990, chapters 2
and 4 (tropism, phyllotaxis).
"""

import argparse
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

GOLDEN_ANGLE = np.pi * (3.0 - np.sqrt(5.0))
UP = np.array([0.0, 0.0, 1.0])
LEVEL_NAMES = ("trunk", "branch", "limb", "twig")


@dataclass
class Level:
    """How the shoots of one level grow."""

    # Distance between two squares, and how far the heading wanders in a metre, in radians.
    step: float
    crookedness: float
    # Bend per metre towards straight up; negative sinks.
    tropism: float
    # Number of laterals on the shoot, and the part of its length that bears them.
    laterals: int = 0
    bearing_from: float = 0.2
    bearing_to: float = 0.95
    # SPIRAL, OPPOSITE or WHORL (of five).
    phyllotaxis: str = "SPIRAL"
    # Angle between lateral and parent at the first and at the last lateral, in radians.
    angle_low: float = 1.0
    angle_high: float = 0.6
    # Length of a lateral over the length of the parent (below the trunk) and its spread.
    length_ratio: float = 0.5
    length_spread: float = 0.25
    # How far the shoot yields to the other side at a lateral, in radians.
    yielding: float = 0.0
    # 0 = laterals all around the limb, 1 = they lie in the plane that is level across it.
    flatness: float = 0.0


@dataclass
class Species:
    """The shape of a kind of tree at 6 m height."""

    levels: tuple
    trunk_radius: float
    tip_radius: float
    # Half width of the crown over the tree's height, by the height of the lateral in the bearing part.
    crown: tuple
    # Exponent of Leonardo's rule, and undrawn twigs per metre, each of the tip's radius.
    exponent: float = 2.2
    undrawn_twigs: float = 1.0
    leaf: str = "maple"


MAPLE = Species(
    levels=(
        Level(
            step=0.22,
            crookedness=0.10,
            tropism=0.12,
            laterals=17,
            bearing_from=0.24,
            bearing_to=0.95,
            angle_low=1.12,
            angle_high=0.50,
            yielding=0.05,
            length_spread=0.15,
        ),
        Level(
            step=0.14,
            crookedness=0.32,
            tropism=0.17,
            laterals=6,
            bearing_from=0.22,
            bearing_to=0.94,
            angle_low=0.80,
            angle_high=0.60,
            length_ratio=0.52,
            yielding=0.08,
            flatness=0.30,
        ),
        Level(
            step=0.10,
            crookedness=0.50,
            tropism=0.30,
            laterals=2,
            bearing_from=0.30,
            bearing_to=0.80,
            phyllotaxis="OPPOSITE",
            angle_low=0.75,
            angle_high=0.65,
            length_ratio=0.55,
            yielding=0.06,
            flatness=0.3,
        ),
        Level(step=0.07, crookedness=0.8, tropism=0.5),
    ),
    trunk_radius=0.15,
    tip_radius=0.0045,
    crown=((0.0, 0.42), (0.25, 0.45), (0.5, 0.38), (0.8, 0.23), (1.0, 0.11)),
    undrawn_twigs=2.0,
)

SPRUCE = Species(
    levels=(
        Level(
            step=0.16,
            crookedness=0.03,
            tropism=0.3,
            laterals=75,
            bearing_from=0.08,
            bearing_to=0.985,
            phyllotaxis="WHORL",
            angle_low=1.75,
            angle_high=0.80,
            length_spread=0.12,
        ),
        Level(
            step=0.10,
            crookedness=0.18,
            tropism=0.14,
            laterals=4,
            bearing_from=0.30,
            bearing_to=0.95,
            phyllotaxis="OPPOSITE",
            angle_low=0.95,
            angle_high=0.80,
            length_ratio=0.45,
            length_spread=0.15,
            yielding=0.02,
            flatness=1.0,
        ),
        Level(step=0.08, crookedness=0.3, tropism=-0.15),
    ),
    trunk_radius=0.10,
    tip_radius=0.005,
    crown=((0.0, 0.27), (0.15, 0.26), (0.5, 0.16), (0.8, 0.075), (1.0, 0.025)),
    exponent=2.1,
    undrawn_twigs=1.0,
    leaf="needle",
)

SPECIES = {"maple": MAPLE, "spruce": SPRUCE}


@dataclass
class Shoot:
    """A grown branch: points (N, 3) from root to tip in metres, Z up, and a radius for each."""

    level: int
    points: np.ndarray
    # Point of the parent that a child stands on -> the child, in the order of growth.
    children: list = field(default_factory=list)
    radii: np.ndarray = None


def normalised(vector):
    return vector / max(np.linalg.norm(vector), 1e-12)


def turned(vector, axis, angle):
    """The vector turned around a unit axis (Rodrigues' formula)."""
    return (
        vector * np.cos(angle)
        + np.cross(axis, vector) * np.sin(angle)
        + axis * np.dot(axis, vector) * (1.0 - np.cos(angle))
    )


def across(heading):
    """A unit vector across the heading: level where there is one."""
    side = np.cross(heading, UP)
    if np.linalg.norm(side) < 1e-3:
        side = np.cross(heading, [0.0, 1.0, 0.0])
    return normalised(side)


def lateral_places(rules, length, rng):
    """Returns the distances along a shoot at which its laterals stand, and their azimuths."""
    if rules.laterals == 0:
        return []
    low, high = rules.bearing_from * length, rules.bearing_to * length
    start = rng.uniform(0.0, 2.0 * np.pi)
    places = []
    for number in range(rules.laterals):
        if rules.phyllotaxis == "WHORL":
            whorl, place = divmod(number, 5)
            whorls = (rules.laterals + 4) // 5
            # Whorls close up towards the top, as yearly growth slows down.
            along = low + (high - low) * (1.0 - (1.0 - whorl / whorls) ** 1.1)
            along += rng.uniform(-0.15, 0.25) * (high - low) / whorls
            azimuth = start + whorl * GOLDEN_ANGLE + (place + rng.uniform(-0.2, 0.2)) * 2.0 * np.pi / 5.0
        elif rules.phyllotaxis == "OPPOSITE":
            # Partners of a pair stand a little apart, as where one bud was late.
            pair, partner = divmod(number, 2)
            pairs = (rules.laterals + 1) // 2
            along = low + (high - low) * (pair + 0.5 + 0.22 * partner) / pairs
            azimuth = start + pair * np.pi / 2.0 + partner * np.pi + rng.uniform(-0.3, 0.3)
        else:
            along = low + (high - low) * (number + rng.uniform(0.2, 0.8)) / rules.laterals
            azimuth = start + number * GOLDEN_ANGLE + rng.uniform(-0.25, 0.25)
        places.append((float(np.clip(along, 0.0, 0.985 * length)), azimuth))
    return sorted(places)


def flattened(azimuth, flatness, number):
    """Draws an azimuth towards the level plane, alternating left and right."""
    level_side = 0.0 if number % 2 == 0 else np.pi
    difference = (azimuth - level_side + np.pi) % (2.0 * np.pi) - np.pi
    return level_side + difference * (1.0 - 0.85 * flatness)


def grow_shoot(species, level, root, heading, length, height, rng):
    """Grows one shoot and, where it bears them, its laterals."""
    rules = species.levels[level]
    steps = max(3, int(round(length / (rules.step * height / 6.0))))
    step = length / steps
    places = lateral_places(rules, length, rng) if level + 1 < len(species.levels) else []
    points, wander, born = [np.asarray(root, float)], np.zeros(3), []
    for number in range(steps):
        # Half of the deviation carries over to the next step, which makes bends instead of jitter.
        wander = 0.5 * wander + rng.normal(size=3) * rules.crookedness * np.sqrt(step) * 0.5
        pull = UP - heading * np.dot(UP, heading)
        heading = normalised(
            heading
            + (wander - heading * np.dot(wander, heading))
            + pull * rules.tropism * step * 6.0 / height
        )
        yielded = np.zeros(3)
        while places and places[0][0] < (number + 1) * step:
            along, azimuth = places.pop(0)
            azimuth = flattened(azimuth, rules.flatness, len(born)) if rules.flatness else azimuth
            out = turned(across(heading), heading, azimuth)
            share = along / length
            angle = rules.angle_low + (rules.angle_high - rules.angle_low) * share + rng.normal() * 0.08
            born.append(
                (
                    points[-1] + heading * (along - number * step),
                    normalised(heading * np.cos(angle) + out * np.sin(angle)),
                    share,
                )
            )
            yielded = yielded - out * rules.yielding
        points.append(points[-1] + heading * step)
        heading = normalised(heading + yielded)
    shoot = Shoot(level, np.array(points))
    for at, outward, share in born:
        spread = 1.0 + rng.uniform(-rules.length_spread, rules.length_spread)
        if level == 0:
            place = (share - rules.bearing_from) / (rules.bearing_to - rules.bearing_from)
            lateral = height * np.interp(place, *zip(*species.crown)) * spread
            # The outline is measured level; a steep branch reaches it later.
            lateral /= max(0.55, np.hypot(outward[0], outward[1]))
        else:
            lateral = length * rules.length_ratio * (1.0 - 0.55 * share) * spread
        child = grow_shoot(species, level + 1, at, outward, lateral, height, rng)
        shoot.children.append((share * length, child))
    return shoot


def thicken(shoot, species):
    """Gives the shoot and its laterals their radii, from the tips down (Leonardo's rule)."""
    power = species.exponent
    along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(shoot.points, axis=0), axis=1))])
    undrawn = species.undrawn_twigs * 4.0 ** (2 - min(shoot.level, 2))
    wood = species.tip_radius**power * (1.0 + undrawn * (along[-1] - along))
    for at, child in shoot.children:
        thicken(child, species)
        # Wood passes from below a fork to above it over about a step, not at once.
        step = along[1]
        wood += child.radii[0] ** power * np.clip((at + step - along) / (2.0 * step), 0.0, 1.0)
    shoot.radii = wood ** (1.0 / power)


def each_shoot(shoot):
    yield shoot
    for _, child in shoot.children:
        yield from each_shoot(child)


def grow_tree(species, seed=1, height=6.0, levels=4):
    """Returns the trunk as a Shoot, with everything that grows on it, `levels` orders of branching deep."""
    species = replace(species, levels=species.levels[:levels])
    rng = np.random.default_rng(seed)
    trunk = grow_shoot(
        species, 0, (0.0, 0.0, 0.0), normalised(UP + rng.normal(size=3) * 0.03), height, height, rng
    )
    shoots = list(each_shoot(trunk))
    # Upright limbs may overtop the trunk: the requested height is that of the whole tree.
    top = max(shoot.points[:, 2].max() for shoot in shoots)
    for shoot in shoots:
        shoot.points *= height / top
        shoot.children = [(at * height / top, child) for at, child in shoot.children]
    thicken(trunk, species)
    # The rule fixes ratios; one scale then gives the trunk its size, with thin twigs held back from
    # vanishing, and the root collar widens into the ground.
    scale = species.trunk_radius * height / 6.0 / trunk.radii[0]
    thinnest = 0.55 * species.tip_radius * height / 6.0
    for shoot in shoots:
        shoot.radii = np.maximum(shoot.radii * scale, thinnest)
        shoot.radii[-1] *= 0.6
    rise = trunk.points[:, 2] / (0.05 * height)
    trunk.radii = trunk.radii * (1.0 + 0.45 * np.exp(-rise))
    return trunk


def square_frames(points):
    """Per point the two half diagonals' directions: across the limb, turned as little as possible."""
    tangents = np.gradient(points, axis=0)
    side = across(normalised(tangents[0]))
    frames = []
    for tangent in tangents:
        tangent = normalised(tangent)
        side = normalised(side - tangent * np.dot(side, tangent))
        frames.append((side, np.cross(tangent, side)))
    return frames


def leaf_shapes(trunk, species, height, rng):
    """Yields a leaf as (vertices (N, 3), texture coordinates (N, 2), quads (M, 4))."""
    size = height / 6.0
    last = max(shoot.level for shoot in each_shoot(trunk))
    for shoot in each_shoot(trunk):
        if shoot.level < last:
            continue
        length = np.linalg.norm(np.diff(shoot.points, axis=0), axis=1).sum()
        spacing = (0.055 if species.leaf == "maple" else 0.022) * size
        for number in range(max(2, int(length / spacing))):
            place = (0.15 + 0.85 * (number + 0.5) * spacing / length) * (len(shoot.points) - 1)
            index = min(int(place), len(shoot.points) - 2)
            heading = normalised(shoot.points[index + 1] - shoot.points[index])
            at = shoot.points[index] + (shoot.points[index + 1] - shoot.points[index]) * (place - index)
            out = turned(across(heading), heading, number * GOLDEN_ANGLE)
            if species.leaf == "maple":
                yield maple_leaf(at, normalised(out + 0.5 * heading - 0.25 * UP), size, rng)
            else:
                yield needle(at, normalised(out + 0.8 * heading), size, rng)


def maple_leaf(at, axis, size, rng):
    """Three lobes, each a kite, on a short stalk."""
    length = 0.11 * size * rng.uniform(0.8, 1.2)
    side = across(axis)
    base = at + axis * 0.3 * length
    # The lobes share the vertex at the stalk, so that a leaf is one piece.
    vertices, uv, quads = [base], [(0.5, 0.1)], []
    for lobe, reach in ((-0.95, 0.75), (0.0, 1.0), (0.95, 0.75)):
        along = axis * np.cos(lobe) + side * np.sin(lobe)
        beside = np.cross(np.cross(axis, side), along)
        quads.append([0, *range(len(vertices), len(vertices) + 3)])
        for forward, sideways in ((0.55, -0.22), (1.0, 0.0), (0.55, 0.22)):
            vertices.append(base + (along * forward + beside * sideways) * length * reach)
            place = np.array([np.sin(lobe) * forward, np.cos(lobe) * forward]) * reach
            uv.append((0.5 + 0.5 * (place[0] + np.cos(lobe) * sideways), 0.1 + 0.8 * place[1]))
    return np.array(vertices), np.clip(uv, 0.0, 1.0), np.array(quads)


def needle(at, axis, size, rng):
    """One flat needle."""
    length, half = 0.028 * size * rng.uniform(0.8, 1.2), 0.0016 * size
    side = across(axis) * half
    vertices = np.array(
        [at - side, at + axis * length - side * 0.3, at + axis * length + side * 0.3, at + side]
    )
    return vertices, np.array([(0, 0), (0, 1), (1, 1), (1, 0)], float), np.array([[0, 1, 2, 3]])


def y_up(points):
    return np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)


def write_squares(trunk, path, leaves=()):
    """Writes the tree and returns the number of branches and of leaves."""
    path = Path(path)
    lines = ["# square cross-sections, one group a branch; Y up, metres"]
    if leaves:
        lines += [f"mtllib {path.stem}.mtl", "usemtl bark"]
    numbers = [0] * len(LEVEL_NAMES)
    vertex_count = 0
    for shoot in each_shoot(trunk):
        numbers[shoot.level] += 1
        lines.append(f"g {LEVEL_NAMES[shoot.level]}{numbers[shoot.level]}")
        for point, radius, (u, v) in zip(shoot.points, shoot.radii, square_frames(shoot.points)):
            corners = y_up(point + radius * np.array([u, v, -u, -v]))
            lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in corners]
            lines.append("f {} {} {} {}".format(*range(vertex_count + 1, vertex_count + 5)))
            vertex_count += 4
    uv_count = 0
    if leaves:
        lines += ["usemtl leaf", "g leaves"]
    for vertices, uv, quads in leaves:
        lines += [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in y_up(vertices)]
        lines += [f"vt {u:.4f} {v:.4f}" for u, v in uv]
        for quad in quads:
            lines.append("f " + " ".join(f"{vertex_count + i + 1}/{uv_count + i + 1}" for i in quad))
        vertex_count += len(vertices)
        uv_count += len(uv)
    path.write_text("\n".join(lines) + "\n")
    return sum(numbers), len(leaves)


def write_materials(path, species):
    colour = "0.45 0.16 0.04" if species.leaf == "maple" else "0.05 0.13 0.06"
    Path(path).write_text(f"newmtl bark\nKd 0.21 0.16 0.12\n\nnewmtl leaf\nKd {colour}\n")


def main(arguments):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("output", type=Path)
    parser.add_argument("--species", choices=sorted(SPECIES), default="maple")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--height", type=float, default=6.0, help="metres")
    parser.add_argument("--levels", type=int, choices=(1, 2, 3, 4), default=4, help="1 = the trunk alone")
    parser.add_argument("--leaves", action="store_true")
    options = parser.parse_args(arguments)
    species = SPECIES[options.species]
    trunk = grow_tree(species, options.seed, options.height, options.levels)
    leaves = []
    if options.leaves:
        leaves = list(leaf_shapes(trunk, species, options.height, np.random.default_rng(options.seed + 1)))
        write_materials(options.output.with_suffix(".mtl"), species)
    branches, leaf_count = write_squares(trunk, options.output, leaves)
    print(f"{options.output}: {options.species}, {branches} branches, {leaf_count} leaves")


if __name__ == "__main__":
    main(sys.argv[1:])

# SPDX-License-Identifier: GPL-3.0-or-later
"""How the limbs of a tree swing in the wind: from their lengths and radii to bone angles over a loop.

Pure numpy, no Blender. A limb is the chain of bones of one branch, treated as a cantilever that its parent limb
carries.

- Frequency: first bending mode of a uniform round cantilever, f = 1.875^2 / (2 pi) * r / (2 L^2) *
  sqrt(E / rho) (W. T. Thomson, Theory of Vibration with Applications, table 9.5-1: 3.52 = 1.875^2 for a
  cantilever; r / 2 is a round section's radius of gyration): long thin limbs swing slowly.
- Amplitude: a share of the limb's length by which its tip swings, the same for all trees and numbers of bones
  (`SWING`), so that one strength suits any tree. Stubs are stiffer.
- Angle for engines, `tip_angles`: at the tip under an even load, q L^3 / (6 E I) (any table of beam slopes and
  deflections) with I = pi r^4 / 4 and the wind's drag q = rho_air / 2 * v^2 * c_d * 2 r: proportional to
  (L / r)^3. It is limited to `LARGEST_ANGLE`, since slender plants bend out of the wind and feel less of it (E. de
  Langre, A. Gutierrez, J. Cosse, On the scaling of drag reduction by reconfiguration in plants, Comptes Rendus
  Mecanique 340, 2012, pages 35-40); the form of the limit is our choice.
- Share of each bone: curvature of that cantilever, M / (E I) with M ~ (1 - s)^2 and the bone's own radius.
"""

from dataclasses import dataclass

import numpy as np

# Living wood: Young's modulus 7 GPa, density 900 kg/m3. These are our round numbers; species differ by a factor of two,
# which the operator's strength covers.
WOOD_SPEED = (7.0e9 / 900.0) ** 0.5
WOOD_MODULUS = 7.0e9
AIR_DENSITY = 1.2
# Twigs and leaves catch far more wind than the limb's silhouette. Chosen by eye, so that a fresh breeze moves small
# trees as a whole.
CROWN_DRAG = 40.0
# Metres per second at strength 1: a fresh breeze, Beaufort 5 (8.0 to 10.7 m/s).
WIND_SPEED = 9.0
# Largest swing of a limb's tip in still gusts at strength 1, as a share of the limb's length. Branches with a smaller
# ratio of length and radius than SLENDER swing less, in proportion.
SWING, SLENDER = 0.05, 20.0
# Largest angle in radians between a limb's tip and its base.
LARGEST_ANGLE = np.radians(22.0)
# A sine curve needs four keys per cycle.
KEYS_PER_CYCLE = 4
# Lower limit for radius / length; a thinner limb would have almost no stiffness.
SLENDEREST = 1.0 / 400.0


@dataclass
class Chains:
    """Limbs as chains of bones. Rows are bones, parents before children, except where noted.

    limb int32 (B,): index of a bone's limb; position float (B,): the bone's middle along its limb, 0 at the base, 1 at
    the tip; limb_length, limb_radius float (limbs,): metres; limb_level int (limbs,).
    """

    limb: np.ndarray
    position: np.ndarray
    limb_length: np.ndarray
    limb_radius: np.ndarray
    limb_level: np.ndarray


def find_chains(parents, connected, lengths, radii):
    """Groups bones into limbs: a connected bone continues its parent's limb, any other bone starts one.

    parents int (B,), -1 for roots, parents first; connected bool (B,); lengths, radii float (B,), metres.
    """
    count = len(parents)
    limb = np.zeros(count, dtype=np.int32)
    start = np.zeros(count)
    first, level = [], []
    continued = np.zeros(count, dtype=bool)
    for bone, parent in enumerate(np.asarray(parents).tolist()):
        # A second connected child is a fork: it starts its own limb.
        if parent >= 0 and connected[bone] and not continued[parent]:
            continued[parent] = True
            limb[bone] = limb[parent]
            start[bone] = start[parent] + lengths[parent]
        else:
            limb[bone] = len(first)
            level.append(level[limb[parent]] + 1 if parent >= 0 else 0)
            first.append(bone)
    length = np.bincount(limb, weights=lengths, minlength=len(first))
    length = np.maximum(length, 1e-6)
    radius = np.maximum(np.asarray(radii, dtype=float)[first], SLENDEREST * length)
    position = (start + 0.5 * np.asarray(lengths)) / length[limb]
    return Chains(limb, position, length, radius, np.array(level, dtype=np.int32))


def natural_frequencies(length, radius):
    """Frequency in Hz of the first bending mode of each limb; arrays in metres."""
    return 1.875**2 / (2 * np.pi) * radius / (2 * length**2) * WOOD_SPEED


def tip_angles(length, radius, speed):
    """Angle in radians by which wind of `speed` m/s bends the tip of each limb."""
    load = 0.5 * AIR_DENSITY * speed**2 * CROWN_DRAG * 2 * radius
    stiffness = WOOD_MODULUS * np.pi * radius**4 / 4
    return LARGEST_ANGLE * np.tanh(load * length**3 / (6 * stiffness) / LARGEST_ANGLE)


def swing_angles(chains, shares, lengths, strength):
    """Angle in radians of the whole bend of each limb (limbs,) by which its tip swings by SWING * strength of the
    limb's length. shares (B,): see bone_shares; lengths (B,): of the bones, in metres."""
    limb, count = chains.limb, len(chains.limb_length)
    # A bone turns what lies beyond its head.
    beyond = 1.0 - (chains.position - 0.5 * lengths / chains.limb_length[limb])
    lever = np.bincount(limb, weights=shares * beyond, minlength=count)
    stiff = np.minimum(chains.limb_length / (SLENDER * chains.limb_radius), 1.0)
    stiff[chains.limb_level == 0] = 1.0
    return SWING * strength * stiff / np.maximum(lever, 0.1)


def loop_cycles(frequency, seconds, keys):
    """Number of whole cycles of each limb in the loop, at least 1, at most keys / KEYS_PER_CYCLE.

    If the fastest limb exceeds the limit, all are compressed logarithmically between the slowest and the limit, which
    keeps their order.
    """
    most = max(1, keys // KEYS_PER_CYCLE)
    cycles = np.asarray(frequency) * seconds
    if len(cycles) and cycles.max() > most:
        low, high = np.log(cycles.min()), np.log(cycles.max())
        least = np.clip(cycles.min(), 1.0, most)
        share = (np.log(cycles) - low) / (high - low) if high > low else np.ones_like(cycles)
        cycles = least + (most - least) * share
    return np.clip(np.rint(cycles), 1, most).astype(np.int32)


def bone_shares(chains, lengths, radii):
    """Share of each bone in the bend of its limb; the shares of a limb sum to 1."""
    at_least = 0.5 * chains.limb_radius[chains.limb]
    curvature = (1.02 - np.minimum(chains.position, 1.0)) ** 2 / np.maximum(radii, at_least) ** 4
    share = curvature * np.maximum(lengths, 1e-9)
    return share / np.bincount(chains.limb, weights=share)[chains.limb]


def gust_curve(phases, gusts, generator):
    """1 + gusts * (three slow waves that close over the loop); phases (..., T) in [0, 1) of the loop."""
    waves = sum(
        weight * np.sin(2 * np.pi * (cycle * phases + generator.random()))
        for cycle, weight in ((1, 0.6), (2, 0.3), (3, 0.15))
    )
    return 1.0 + gusts * waves


def sway_vectors(chains, shares, lengths, axes, roots, wind, strength, gusts, seed, keys, seconds):
    """Rotation vectors of every bone at `keys` moments of the loop: float (B, keys, 3), radians.

    lengths float (B,): of the bones, in metres; axes float (B, 3): unit vectors along the bones at rest; roots
    (limbs, 3): base of each limb in metres; wind: unit vector of the wind's direction, in the same space; strength: see
    swing_angles; gusts 0 to 1; seconds: length of the loop. Moment k is at k / keys of the loop, and the curve is
    periodic, so moment `keys` is moment 0. A rotation vector is perpendicular to its bone: limbs bend and do not twist.
    """
    generator = np.random.default_rng(seed)
    limbs = len(chains.limb_length)
    moments = np.arange(keys) / keys
    frequency = natural_frequencies(chains.limb_length, chains.limb_radius)
    cycles = loop_cycles(frequency, seconds, keys)[:, None]
    angle = swing_angles(chains, shares, lengths, strength)[:, None]

    # Gusts travel with the wind: limbs further downwind feel them later.
    delay = (roots @ wind)[:, None] / (max(WIND_SPEED * strength, 1e-6) * seconds)
    gust = gust_curve(moments - delay, gusts, generator)
    phase = chains.limb_level[:, None] / 3.0 + 0.35 * generator.random((limbs, 1))
    swing = np.sin(2 * np.pi * (cycles * moments - phase))
    across_phase = generator.random((limbs, 1))
    across = np.sin(2 * np.pi * (cycles * moments - across_phase))
    # The wind pushes in one direction: a constant lean with a swing around it.
    downwind = angle * gust * (0.45 + 0.55 * swing)
    crosswind = 0.3 * angle * gust * across

    side = np.cross((0.0, 0.0, 1.0), wind)
    bend = np.cross(axes, wind)[:, None, :] * downwind[chains.limb][:, :, None]
    bend += np.cross(axes, side)[:, None, :] * crosswind[chains.limb][:, :, None]
    return bend * shares[:, None, None]

# SPDX-License-Identifier: GPL-3.0-or-later
"""Whether snow lies exactly where rays arrive: the part "place" of acceptance.py.

Rays start from sub-samples of every texel's own surface (tests/python/native/snow_rays.py): a texel at an edge has
parts that see the sky and parts that do not, and its one sample point would be misleading.
"""

import numpy as np
from meshes import box, bunny, grid, native, rotated, sphere, spot, texel_size, tree, wind
from rows import row
from snow_meshes import STAYS
from snow_rays import first_hits, lit_shares, near_any, plane_axes, texel_points

DOWN = (0.0, 0.0, -1.0)


def reached_texels(table, mesh, resolution, snowed, scene, direction, margin):
    """For every owned texel: the share of its surface that rays reach, and whether no ray reaches it.

    3 x 3 rays per texel. Texels with snow that none of them reaches are tested again with 16 x 16: an edge that
    cuts off a texel's corner passes between nine rays."""
    share, _ = lit_shares(table, mesh, resolution, np.arange(len(snowed)), scene, direction, margin, 3)
    doubtful = np.flatnonzero(snowed & (share == 0.0))
    finer, _ = lit_shares(table, mesh, resolution, doubtful, scene, direction, margin, 16)
    return share, (share == 0.0) & (finer == 0.0)


def facing_slopes(table, mesh, which, direction):
    """Cosines to the sky of texels `which`: of the sample point if it faces the fall, otherwise of the part of the
    texel that faces it most, because that part alone may gain snow."""
    positions, triangles, _ = mesh
    corners = positions[triangles].astype(np.float64)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    cosine = -(normals @ np.asarray(direction)) / (np.linalg.norm(normals, axis=1) + 1e-300)
    point = cosine[table["triangle"][which]]
    most = np.maximum.reduceat(cosine[table["fragment_triangle"]], table["fragment_begin"][:-1])[which]
    return np.clip(np.where(point > 0.0, point, most), 1e-9, 1.0)


def far_from_light(points, facing, lit, direction, pixel_size, texel):
    """Mask of points that are further than a pixel's footprint from all of `lit`: across the fall, a pixel plus a
    texel; along it, the rise of the point's own slope over that width (with a cosine of at least 0.02)."""
    x, y, d = (np.asarray(axis) for axis in plane_axes(direction))
    reach = pixel_size + texel
    far = np.zeros(len(points), bool)
    for low, high in ((0.5, 1.0), (0.2, 0.5), (0.1, 0.2), (0.05, 0.1), (0.02, 0.05), (0.0, 0.02)):
        own = (facing > low) & (facing <= high)
        if own.any():
            basis = np.stack([x, y, d * max(low, 0.02)], axis=1) / reach
            far[own] = ~near_any(points[own] @ basis, lit @ basis, 1.0)
    return far


def light_beside(points, normals, scene, direction, reach):
    """Whether a ray passes a point within `reach`, across the fall, in the plane of the point's surface: beside the
    occluder, whether the ray meets a surface there or not, as on a limb that is narrower than its occluder."""
    x, y, d = (np.asarray(axis) for axis in plane_axes(direction))
    places = np.linspace(-1.0, 1.0, 17)
    across = np.stack([axis.ravel() for axis in np.meshgrid(places, places)], axis=1)
    across = across[np.linalg.norm(across, axis=1) <= 1.0] * reach
    passed = np.zeros(len(points), bool)
    for u, v in across:
        way = u * x + v * y
        along = -(normals @ way) / np.minimum(normals @ d, -0.02)
        beside = points + way + along[:, None] * d
        passed |= np.isinf(first_hits(beside, scene, direction, margin=0.05 * reach))
    return passed


def agreement(name, meshes, receiver, direction, resolution, pixel_size, steps=16, flutter=0.0):
    """Whether snow lies exactly where rays arrive. A texel should hold snow if a ray reaches any part of it, and none
    if no ray does: intersection over union of the two sets, by area. Also, by exact area: the share of the lit
    surface with snow, and the snow on texels that no ray reaches, near the light and beyond a pixel's footprint."""
    positions, triangles, uv = meshes[receiver]
    with native.SnowSimulation(repose=STAYS, pixel_size=pixel_size, max_depth=1e6, flutter=flutter) as sim:
        for key, (_, faces, corners) in meshes.items():
            sim.add_object(key, faces, corners, resolution=resolution, receive=key == receiver)
        sim.step({key: mesh[0] for key, mesh in meshes.items()}, 0.001, direction, 0.0)
        for _ in range(steps - 1):
            sim.step({}, 0.001, direction, 0.0)
        height, area = sim.height(receiver).ravel(), sim.texel_area(receiver).ravel()
    points, normals, texel, table = texel_points(native, positions, triangles, uv, resolution)
    scene = np.concatenate([mesh[0][mesh[1]] for mesh in meshes.values()])
    snowed, weight = height[texel] > 0.0, area[texel]
    share, dark = reached_texels(
        table, meshes[receiver], resolution, snowed, scene, direction, 0.05 * pixel_size
    )
    lit = share > 0.0
    wrong, missing = weight[snowed & dark].sum(), weight[lit & ~snowed].sum()
    both = weight[snowed & lit].sum()
    union = both + wrong + missing
    row(
        f"3 {name}, {resolution}",
        "IoU >= 0.97",
        f"{both / union:.4f} (snow, no ray {wrong / union:.4f}, ray, no snow {missing / union:.4f}; "
        f"lit area with snow {(weight * share)[snowed].sum() / (weight * share).sum():.4f})",
        both / union >= 0.97,
    )
    leaking = snowed & dark
    amount = height[texel] * weight
    if leaking.any():
        facing = facing_slopes(table, meshes[receiver], np.flatnonzero(leaking), direction)
        reached = lit | (snowed & ~dark)  # some are reached by a finer ray only
        texel_edge = weight.max() ** 0.5
        far = far_from_light(points[leaking], facing, points[reached], direction, pixel_size, texel_edge)
        if far.any():
            own = np.flatnonzero(leaking)[far]
            far[far] = ~light_beside(points[own], normals[own], scene, direction, pixel_size + texel_edge)
        leaked = amount[leaking][far].sum() / amount.sum()
        row(
            f"3 {name}: beyond a pixel's footprint",
            "nothing",
            f"{leaked:.2e} of the snow on {far.sum()} texels; nearer, where no ray reaches: "
            f"{amount[leaking].sum() / amount.sum() - leaked:.2e}",
            leaked == 0.0,
        )
    else:
        row(f"3 {name}: where no ray reaches", "nothing", "nothing", True)
    return height.reshape(resolution, resolution)


def place():
    ground = grid(4.0, 4.0)
    thing = box(1.0, 0.8)
    plate = grid(0.8, 0.8)
    lifted = (rotated(plate[0], "y", 20.0) + np.float32((0.3, 0.4, 1.4)), *plate[1:])
    for angle in (0, 30, 60):
        agreement(
            f"ground under box and plate, wind {angle}",
            {"box": thing, "ground": ground, "plate": lifted},
            "ground",
            wind(angle, 20.0),
            1024,
            0.004,
        )
        agreement(
            f"box under a plate, wind {angle}",
            {"box": thing, "plate": lifted},
            "box",
            wind(angle, 20.0),
            1024,
            0.002,
        )
    agreement("ball, wind 30", {"ball": sphere()}, "ball", wind(30.0, 20.0), 1024, 0.002)
    for name, mesh in (("bunny", bunny()), ("spot", spot()), ("AL06a", tree())):
        if mesh is not None:
            for angle in (0, 45):
                agreement(
                    f"{name}, wind {angle}, pixel 1 texel",
                    {"it": mesh},
                    "it",
                    wind(angle, 20.0),
                    1024,
                    texel_size(mesh, 1024),
                )
    mesh = tree()
    if mesh is not None:
        agreement(
            "AL06a, wind 0, pixel half a texel", {"it": mesh}, "it", DOWN, 1024, 0.5 * texel_size(mesh, 1024)
        )

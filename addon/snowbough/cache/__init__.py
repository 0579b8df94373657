# SPDX-License-Identifier: GPL-3.0-or-later
"""The bake's files on disk: where they lie, which are whole, who may write them. No ``bpy``.

::

    <cache>/<scene>-<id>/v001/<safe object name>-<id>/height_0001.exr   metres
                                                      normal_0001.exr   only with normals
                                                      ever_covered.exr  1 where snow lay on any frame
                                                      inputs.json       fingerprints of what it was baked from
                                                      object.json       the manifest (read_manifest)
                                                      state_0010        checkpoint: the simulation's own file
                                                      state_0010.json   what belongs to it: inputs, coverage
                                                      lock              while a bake writes here
    <cache>/<scene>-<id>/owner.json                                     the .blend that bakes here (owner)
    <cache>/<scene>-<id>/logs/                                          times and the engine, one file a bake

The scene's <id> is the identity that a .blend carries; one that was never saved has ``<scene>`` alone. The manifest
lists the files of its bake (files.bake_files): nothing else is ever removed. JSON files have checksums (sealed).

A version is a folder per receiver, so several machines fill one version together without a shared
file. A finished receiver is never written again: the next bake takes the next version. Every file is
written under a temporary name and renamed, and a checkpoint counts only when ``state_NNNN`` itself is
there, which is written last. The manifest holds no times, so equal bakes are equal bytes.

On resume a checkpoint that a stop left between the regular ones goes as soon as the bake has passed
it, so that the folder ends as if the bake had never stopped.
"""

# SPDX-License-Identifier: GPL-3.0-or-later
"""The files of a bake: their layout, completeness and locks. No ``bpy``.

::

    <cache>/<scene>-<id>/v001/<safe object name>-<id>/height_0001.exr   metres
                                                      normal_0001.exr   and other maps on request (map_kinds)
                                                      ever_covered.exr  1 where snow lay in any frame
                                                      frames.tsv        a line for each frame (journal)
                                                      object.json       the manifest (read_manifest)
                                                      state_0010        checkpoint: the simulation's own file
                                                      state_0010.json   other data of the checkpoint: coverage
    <cache>/<scene>-<id>/v001/lock-0123abcd                             while a bake writes there (lock)
    <cache>/<scene>-<id>/v001/ledger.json                               the balance of all snow (ledger)
    <cache>/<scene>-<id>/owner.json                                     the .blend that bakes here (owner)
    <cache>/<scene>-<id>/logs/                                          times and the engine, one file per bake

The scene's <id> is the identity stored in the .blend; files that were never saved have ``<scene>`` alone. The manifest
lists the files of its bake (files.bake_files); only listed files are ever removed. JSON files have checksums (sealed).

Each receiver has its own folder in a version, so several machines can fill one version without a shared file. A
finished receiver is never written again; the next bake uses the next version. Every file is written under a temporary
name and renamed, except that lines are appended to ``frames.tsv``. ``state_NNNN`` is written last, and a checkpoint is
valid only with it. The manifest and the lines contain no times, so equal bakes give equal bytes.

A checkpoint that a stop left between the regular ones is removed when the resumed bake has passed it, so the folder
ends as if the bake had never stopped.
"""

# SPDX-License-Identifier: GPL-3.0-or-later
"""Free Bake removes only the files in its own manifests; the owner of a cache folder (without Blender)."""

import os

import pytest
from cache_files import write_bake, write_manifest, written
from snowbough.cache import errors, files, folder, lock, manifest, owner, sealed, versions


def baked(path, cache="me", frames=(1, 2)):
    """A finished bake in a receiver's folder; returns the names of its files."""
    path.mkdir(parents=True)
    for name in ("height_0001.exr", "height_0002.exr", "state_0001", "state_0001.json", "ever_covered.exr"):
        (path / name).write_bytes(b"data")
    write_manifest(path, frames=frames, cache=cache)
    return path


def left(root):
    return sorted(
        path.relative_to(root).as_posix()
        for path in root.rglob("*")
        if not path.is_dir() or path.is_symlink()
    )


def free(root, *identities, **options):
    return versions.free(versions.find_bakes(root, identities or ("me",), **options))


def test_what_the_bake_made_goes_and_what_lies_beside_it_stays(tmp_path):
    own = baked(tmp_path / "v001" / "a")
    others = (
        "notes.txt",
        "height_0003.exr",
        "height_0001.exr.bak",
        "old.tmp.blend",
        "lock.txt",
        "height_1.exr",
    )
    for name in others:
        (own / name).write_text("mine")
    assert free(tmp_path) == 6
    assert left(tmp_path) == sorted(f"v001/a/{name}" for name in others)


def test_a_folder_without_a_manifest_of_ours_is_left_alone(tmp_path):
    names = ["height_0001.exr", "lock", "object.json.tmp", "scratch.tmp", "state_0001"]
    for place in ("v001/renders", "v002/a"):
        (tmp_path / place).mkdir(parents=True)
        for name in names:
            (tmp_path / place / name).write_text("mine")
    (tmp_path / "v001" / "empty").mkdir()
    before = left(tmp_path)
    assert free(tmp_path) == 0
    assert left(tmp_path) == before and (tmp_path / "v001" / "empty").is_dir()


def test_the_bake_of_another_file_is_left_alone(tmp_path):
    baked(tmp_path / "v001" / "a")
    theirs = baked(tmp_path / "v001" / "b", cache="another")
    free(tmp_path)
    assert not (tmp_path / "v001" / "a").exists() and folder.baked_frames(theirs) == [1, 2]


def test_of_bakes_without_an_identity_only_the_versions_shown_go(tmp_path):
    for number in ("v001", "v002"):
        baked(tmp_path / number / "a", cache="")
    assert free(tmp_path, "me") == 0
    assert free(tmp_path, "", shown={"v002"}) == 6
    assert not (tmp_path / "v002").exists() and folder.baked_frames(tmp_path / "v001" / "a") == [1, 2]


def test_only_the_receivers_named_go(tmp_path):
    baked(tmp_path / "v001" / "a")
    kept = baked(tmp_path / "v001" / "b")
    assert free(tmp_path, keys=["a"]) == 6
    assert not (tmp_path / "v001" / "a").exists() and folder.baked_frames(kept) == [1, 2]


@pytest.mark.skipif(os.name != "posix", reason="needs symbolic links")
def test_links_are_not_followed(tmp_path):
    elsewhere, root = tmp_path / "elsewhere", tmp_path / "root"
    for place in ("v003/a", "b"):
        baked(elsewhere / place)
    (elsewhere / "picture.exr").write_text("mine")
    (elsewhere / "20260101T000000-host-1.log").write_text("mine")
    own = baked(root / "v001" / "a")
    (root / "v001" / "b").symlink_to(elsewhere / "b")
    (root / "v003").symlink_to(elsewhere / "v003")
    (root / "logs").symlink_to(elsewhere)
    (own / "height_0002.exr").unlink()
    (own / "height_0002.exr").symlink_to(elsewhere / "picture.exr")
    (own / "blender_tx").symlink_to(elsewhere)
    before = left(elsewhere)
    assert free(root) == 5
    assert left(elsewhere) == before
    assert left(root) == ["logs", "v001/a/blender_tx", "v001/a/height_0002.exr", "v001/b", "v003"]


def test_half_written_files_of_the_bake_go_too(tmp_path):
    own = baked(tmp_path / "v001" / "a")
    for name in ("height_0002.exr.4711.3.tmp", "object.json.0123abcd.tmp", "state_0002.4711.0.tmp"):
        (own / name).write_bytes(b"half")
    assert free(tmp_path) == 9 and left(tmp_path) == []


def test_cycles_copies_of_our_images_go_and_others_stay(tmp_path):
    own = baked(tmp_path / "v001" / "a")
    textures = own / files.TEXTURE_CACHE
    textures.mkdir()
    for name in (
        "height_0001_4f2c.tx",
        "height_0001.exr.tx",
        "height_00012.tx",
        "height_0009_4f.tx",
        "bark.tx",
    ):
        (textures / name).write_bytes(b"tx")
    assert free(tmp_path) == 8
    assert left(tmp_path) == [
        f"v001/a/blender_tx/{n}" for n in ("bark.tx", "height_00012.tx", "height_0009_4f.tx")
    ]


def test_logs_of_the_bakes_go_and_other_files_in_their_folder_stay(tmp_path):
    baked(tmp_path / "v001" / "a")
    (tmp_path / "logs").mkdir()
    (tmp_path / "logs" / "20260101T000000-host-1.log").write_text("log")
    (tmp_path / "logs" / "render.log").write_text("mine")
    assert free(tmp_path) == 7 and left(tmp_path) == ["logs/render.log"]


def test_a_manifest_that_lists_other_peoples_files_removes_none_of_them(tmp_path):
    own = baked(tmp_path / "v001" / "a")
    (tmp_path / "v001" / "secret").write_text("mine")
    (own / "notes.txt").write_text("mine")
    manifest.write_manifest(own, {**written(cache="me"), "files": ["../secret", "notes.txt", files.MANIFEST]})
    free(tmp_path)
    assert {"v001/secret", "v001/a/notes.txt", "v001/a/height_0001.exr"} <= set(left(tmp_path))


def test_a_file_with_a_listed_name_and_another_content_stays(tmp_path):
    own = baked(tmp_path / "v001" / "a")
    (own / "surface.pc2").write_bytes(b"data")
    data = files.file_digest(own / "height_0001.exr")
    entries = [
        {"frame": frame, "depth": 0.1, "checksums": {f"height_{frame:04d}.exr": data}} for frame in (1, 2)
    ]
    write_bake(own, {**written(cache="me"), "checksums": {"ever_covered.exr": data}}, entries)
    sealed.write_sealed(own / files.SURFACE, {"checksums": {"surface.pc2": data}})
    for name in ("height_0002.exr", "ever_covered.exr", "surface.pc2"):
        (own / name).write_bytes(b"mine")
    found = versions.find_bakes(tmp_path, ("me",))
    assert (found.count, versions.free(found)) == (9, 6)
    assert left(tmp_path) == [
        f"v001/a/{name}" for name in ("ever_covered.exr", "height_0002.exr", "surface.pc2")
    ]
    assert sorted(found.kept) == sorted(tmp_path / name for name in left(tmp_path))
    assert versions.choose_version(tmp_path, ["a"], "s") == 2


def test_what_is_baked_just_now_is_not_freed(tmp_path):
    own = baked(tmp_path / "v001" / "a")
    with lock.lock_receivers(own.parent, [own.name]), pytest.raises(errors.CacheBusy):
        free(tmp_path)
    assert folder.baked_frames(own) == [1, 2]


def test_folder_count_and_size_are_known_before(tmp_path):
    own = baked(tmp_path / "v001" / "a")
    (own / "notes.txt").write_text("mine" * 1000)
    found = versions.find_bakes(tmp_path, ("me",))
    written = (own / files.MANIFEST).stat().st_size
    assert (found.root, found.count, found.size) == (tmp_path, 6, 5 * 4 + written)


def test_a_new_bake_goes_round_what_no_bake_has_made(tmp_path):
    (tmp_path / "v001" / "a").mkdir(parents=True)
    assert versions.choose_version(tmp_path, ["a"], "s") == 1
    (tmp_path / "v001" / "a" / "height_0001.exr").write_text("mine")
    assert versions.choose_version(tmp_path, ["a"], "s") == 2
    assert versions.choose_version(tmp_path, ["b"], "s") == 1
    assert versions.resumable_version(tmp_path, ["a"]) == (None, [])


# -- owners --------------------------------------------------------------------------------------------


@pytest.fixture
def project(tmp_path):
    """A .blend and its cache beside it, which it owns: (file, scene's folder)."""
    blend, root = tmp_path / "project" / "shot.blend", tmp_path / "project" / "snowbough_cache" / "Scene-1"
    root.mkdir(parents=True)
    blend.write_text("blend")
    owner.claim(root, blend)
    return blend, root


def test_the_first_file_owns_the_folder_and_a_copy_beside_it_does_not(project):
    blend, root = project
    copy = blend.with_name("copy.blend")
    copy.write_text("blend")
    assert owner.is_owner(root, blend) and not owner.is_owner(root, copy)
    with pytest.raises(errors.CacheBusy, match="bake again"):
        owner.claim(root, copy)
    assert owner.copy_identity("me", copy, root) not in ("me", owner.copy_identity("me", blend, root))


def test_a_renamed_file_keeps_its_folder(project):
    blend, root = project
    renamed = blend.rename(blend.with_name("shot_final.blend"))
    assert owner.is_owner(root, renamed)
    owner.claim(root, renamed)
    blend.write_text("a new file of the old name")
    assert owner.is_owner(root, renamed) and not owner.is_owner(root, blend)


def test_a_project_moved_or_copied_with_its_cache_keeps_it(project, tmp_path):
    blend, root = project
    (tmp_path / "project").rename(tmp_path / "moved")
    assert owner.is_owner(
        tmp_path / "moved" / root.relative_to(tmp_path / "project"), tmp_path / "moved" / blend.name
    )


def test_a_file_on_another_computer_does_not_take_over_a_shared_cache(tmp_path):
    blend, root = tmp_path / "home" / "shot.blend", tmp_path / "shared" / "Scene-1"
    for folder_ in (blend.parent, root):
        folder_.mkdir(parents=True)
    blend.write_text("blend")
    owner.claim(root, blend)
    elsewhere = tmp_path / "mail" / "shot.blend"
    elsewhere.parent.mkdir()
    blend.rename(elsewhere)
    assert owner.is_owner(root, elsewhere)
    sealed.write_sealed(root / files.OWNER, {"blend": str(blend), "host": "another"})
    assert not owner.is_owner(root, elsewhere)

# SPDX-License-Identifier: GPL-3.0-or-later
"""Stopping, killing, splitting and resuming bakes: the result has the bytes of an uninterrupted bake."""

import json
import os
import random
import re
import shutil
import signal
import subprocess
import time

import bpy
import child
import pytest
import snow_scene as s

KILLS = int(os.environ.get("SNOWBOUGH_TEST_KILLS", 3))


@pytest.fixture(scope="module")
def whole_shot(tmp_path_factory):
    """The moving scene with snow surfaces, saved after its whole bake, and the bytes of this bake."""
    bpy.ops.wm.read_homefile(use_empty=True)
    folder = tmp_path_factory.mktemp("whole")
    s.moving_scene(
        folder / "whole", noise_density=0.5, substeps=2, blur_radius=2.0, flutter=0.05, directions=48,
        surface_detail="DRAFT",
    )  # fmt: skip
    bpy.ops.snowbough.setup_displacement(mode="SHELL")
    # Before the bake: a saved file gives its cache a name.
    bpy.ops.wm.save_as_mainfile(filepath=str(folder / "shot.blend"))
    s.bake()
    bpy.ops.wm.save_mainfile()
    return folder / "shot.blend", s.files_of(folder / "whole")


@pytest.fixture
def undisturbed(whole_shot, tmp_path):
    """The bytes of whole_shot's bake. The open file is a copy of it, tmp/shot.blend; its cache is tmp/cache."""
    blend, files = whole_shot
    bpy.ops.wm.open_mainfile(filepath=str(blend))
    bpy.context.scene.snowbough.cache_directory = str(tmp_path / "cache")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    return files


def test_a_bake_that_stopped_at_any_frame_resumes_to_the_same_bytes(addon, undisturbed, tmp_path):
    for last in (1, 4, 7, 11):
        assert s.bake_part(addon, 1, last).error is None
        half = s.files_of(tmp_path / "cache")
        assert any(name.endswith(f"state_{last:04d}") for name in half)
        s.bake(resume=True)
        assert s.files_of(tmp_path / "cache") == undisturbed
        bpy.ops.snowbough.free_bake()


def test_esc_stops_between_frames_and_keeps_what_is_done(addon, undisturbed, tmp_path):
    stop = addon("bake.engine").stop
    running = s.bake_part(addon, on_frame=lambda result: stop() if result.frame == 5 else None)
    assert running.cancelled and running.error is None
    assert 5 <= running.job.results[-1].frame < 12
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_parts_of_the_receivers_make_the_same_bytes(addon, undisturbed, tmp_path):
    assert s.bake_part(addon, 1, 12, ["Cart"]).error is None
    assert s.bake_part(addon, 1, 6, ["Ground", "Flag"]).error is None
    assert s.bake_part(addon, 7, 12, ["Flag"]).error is None
    assert s.bake_part(addon, 1, 12, ["Ground"], resume=True).error is None
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_the_middle_of_a_shot_needs_a_checkpoint(addon, undisturbed, tmp_path):
    error = s.bake_part(addon, 6, 12).error
    assert isinstance(
        error, addon("cache.errors").NoCheckpoint
    ) and "Frame 6 needs the checkpoint of frame 5" in str(error)
    assert not (tmp_path / "cache").exists() or not s.files_of(tmp_path / "cache")


def test_resume_without_anything_baked_starts_at_the_first_frame(undisturbed, tmp_path):
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_resume_of_a_finished_bake_changes_nothing(undisturbed, tmp_path):
    s.bake()
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_a_moved_object_is_named_with_its_frame(addon, undisturbed):
    assert s.bake_part(addon, 1, 8).error is None
    cart = bpy.data.objects["Cart"]
    cart.location = (0, 0, 2)
    cart.keyframe_insert("location", frame=5)
    with pytest.raises(RuntimeError, match="Cart: transform changed at frame 1.5"):
        s.bake(resume=True)


def test_a_finished_bake_is_compared_to_its_last_frame(addon, undisturbed, tmp_path):
    s.bake()
    s.bake(resume=True)
    cart = bpy.data.objects["Cart"]
    cart.location = (0, 0, 2)
    cart.keyframe_insert("location", frame=11.9)
    addon("base.compat").curves_of(cart)[2].keyframe_points[0].interpolation = "CONSTANT"
    with pytest.raises(RuntimeError, match=r"v001 was baked from \(Cart: transform changed at frame"):
        s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


@pytest.mark.parametrize("last", [6, 12])
def test_every_receivers_recorded_scene_is_compared(addon, undisturbed, tmp_path, last):
    """One receiver was baked with the flag elsewhere; the receivers after it were baked from the current scene."""
    flag = bpy.data.objects["Flag"]
    flag.location.x = 0.5
    assert s.bake_part(addon, 1, last, ["Cart"]).error is None
    flag.location.x = 0.0
    assert s.bake_part(addon, 1, last, ["Flag", "Ground"]).error is None
    before = s.files_of(tmp_path / "cache")
    with pytest.raises(RuntimeError, match=r"not the one that Cart .*\(Flag: transform changed at frame 1\)"):
        s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == before


def test_a_resumed_receiver_is_compared_with_the_finished_ones_beside_it(addon, undisturbed, tmp_path):
    bpy.data.objects["Flag"].location.x = 0.5
    assert s.bake_part(addon, 1, 12, ["Ground"]).error is None
    bpy.data.objects["Flag"].location.x = 0.0
    assert s.bake_part(addon, 1, 6, ["Cart", "Flag"]).error is None
    with pytest.raises(
        RuntimeError, match=r"not the one that Ground .*\(Flag: transform changed at frame 1\)"
    ):
        s.bake(resume=True)


def test_a_finished_bake_with_other_settings_is_told(undisturbed, tmp_path):
    s.bake()
    bpy.context.scene.snowbough.end_depth = 0.2
    with pytest.raises(RuntimeError, match="other settings .*end depth: 0.1 m, now 0.2 m"):
        s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_a_changed_mesh_is_named(addon, undisturbed):
    assert s.bake_part(addon, 1, 8).error is None
    bpy.data.objects["Ground"].data.vertices[0].co.z = -0.5
    with pytest.raises(RuntimeError, match="Ground: shape changed at frame 1"):
        s.bake(resume=True)


def test_a_changed_setting_is_named(addon, undisturbed):
    assert s.bake_part(addon, 1, 8).error is None
    bpy.context.scene.snowbough.max_depth = 0.5
    with pytest.raises(RuntimeError, match="max depth: 1 m, now 0.5 m"):
        s.bake(resume=True)


def test_a_new_bake_keeps_the_finished_version(undisturbed, tmp_path):
    s.bake()
    bpy.context.scene.snowbough.end_depth = 0.3
    s.bake()
    files = s.files_of(tmp_path / "cache")
    assert {name: data for name, data in files.items() if "/v001/" in name} == undisturbed
    assert any("/v002/" in name for name in files)


# -- the command line ---------------------------------------------------------------------------------


def blender_command(addon, blend, *arguments):
    """A Blender process that bakes with the add-on under test."""
    package = os.environ["SNOWBOUGH_TEST_ADDON"]
    folder = os.path.dirname(addon("cli").__file__)
    names = ("frames", "cache", "json", "objects", "engine")
    given = {name: None for name in names}
    given.update(zip((a.lstrip("-") for a in arguments[::2]), arguments[1::2]))
    given.update({name: int(given[name]) for name in ("attempts", "wait") if name in given})
    resume = given.pop("resume", "no") == "yes"
    enable = (
        f"import sys; sys.path.insert(0, {os.path.dirname(folder)!r}); import snowbough; snowbough.register()"
        if package == "snowbough"
        else f"import addon_utils; addon_utils.check({package!r})[1] or addon_utils.enable({package!r})"
    )
    program = (
        f"{enable}\n"
        "import sys, importlib, types, bpy\n"
        f"bpy.ops.wm.open_mainfile(filepath={str(blend)!r})\n"
        f"cli = importlib.import_module({package!r} + '.bake.cli')\n"
        f"sys.exit(cli.run(types.SimpleNamespace(resume={resume}, **{given!r})))"
    )
    return child.command(program)


def run_blender(*arguments, **options):
    return subprocess.run(
        blender_command(*arguments),
        capture_output=True,
        text=True,
        timeout=120,
        **options,
    )


def start_baking(addon, tmp_path, report):
    """Starts a bake on the command line; returns it when its second frame is done."""
    running = subprocess.Popen(
        blender_command(addon, tmp_path / "shot.blend", "--json", str(report)),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    for line in running.stdout:
        if line.startswith("SNOWBOUGH frame=2"):
            break
    return running


def test_the_command_line_prints_a_parsable_line_a_frame(addon, undisturbed, tmp_path):
    report = tmp_path / "report.json"
    done = run_blender(
        addon, tmp_path / "shot.blend", "--cache", str(tmp_path / "cache"), "--json", str(report)
    )
    assert done.returncode == 0, done.stderr
    lines = [line for line in done.stdout.splitlines() if line.startswith("SNOWBOUGH frame=")]
    words = [dict(word.split("=") for word in line.split()[1:]) for line in lines]
    assert [int(word["frame"]) for word in words] == list(range(1, 13))
    assert float(words[-1]["depth"]) == pytest.approx(0.1)
    result = json.loads(report.read_text())
    assert (
        result["exit_code"] == 0
        and len(result["frames"]) == 12
        and sorted(result["receivers"]) == ["Cart", "Flag", "Ground"]
    )
    assert s.files_of(tmp_path / "cache") == undisturbed


@pytest.mark.parametrize(
    "arguments, code, message",
    [
        (("--frames", "6-12"), 3, "needs the checkpoint of frame 5"),
        (("--frames", "1-99"), 1, "not inside the shot"),
        (("--objects", "Cart,Sledge"), 1, "No enabled receiver is named Sledge"),
        (("--cache", "/dev/null/cache"), 5, "cannot be written"),
    ],
)
def test_the_exit_code_says_what_went_wrong(addon, undisturbed, tmp_path, arguments, code, message):
    report = tmp_path / "report.json"
    done = run_blender(addon, tmp_path / "shot.blend", "--json", str(report), *arguments)
    assert done.returncode == code and message in done.stderr
    result = json.loads(report.read_text())
    assert result["exit_code"] == code and message in result["error"]
    assert "Traceback" not in done.stderr


def test_a_changed_scene_ends_with_its_own_code(addon, undisturbed, tmp_path):
    s.bake()
    bpy.data.objects["Ground"].location.x = 0.25
    bpy.ops.wm.save_mainfile()
    done = run_blender(addon, tmp_path / "shot.blend", "--resume", "yes")
    assert done.returncode == 4 and "Ground: transform changed at frame 1)" in done.stderr
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_a_file_whose_drivers_are_disabled_is_refused(addon, undisturbed, tmp_path):
    curve = bpy.data.objects["Ground"].driver_add("location", 0)
    curve.driver.expression = "len(str(frame)) * 0.1"  # only Python can evaluate this
    bpy.ops.wm.save_mainfile()
    done = run_blender(addon, tmp_path / "shot.blend")
    assert done.returncode == 1 and "disabled scripts" in done.stderr and "-y" in done.stderr
    assert not list((tmp_path / "cache").rglob("*.exr"))


def test_overlapping_uvs_are_a_warning_on_the_command_line(addon, tmp_path):
    ground = s.square("Ground")
    twice = s.mesh_object(
        "Twice",
        [(0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1), (0, 0, 2), (1, 0, 2), (1, 1, 2)],
        [(0, 1, 2, 3), (4, 5, 6)],
        [(0, 0), (1, 0), (1, 1), (0, 1), (0, 0), (1, 0), (1, 1)],
    )
    s.receive(ground, twice)
    s.settings(tmp_path / "cache")
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "shot.blend"))
    done = run_blender(addon, tmp_path / "shot.blend")
    assert (
        done.returncode == 0
        and "warning=" in done.stderr
        and "'Twice'" in done.stderr
        and "'Ground'" not in done.stderr
    )


@pytest.mark.skipif(os.name == "nt", reason="Windows has no EGL")
def test_without_egl_the_message_and_the_code_say_so(addon, undisturbed, tmp_path):
    # A loader without any vendor's library: what a machine without EGL looks like.
    (tmp_path / "none").mkdir()
    environment = {**os.environ, "__EGL_VENDOR_LIBRARY_DIRS": str(tmp_path / "none")}
    done = run_blender(addon, tmp_path / "shot.blend", "--engine", "GL", env=environment)
    assert done.returncode == 6 and "OpenGL" in done.stderr
    assert not (tmp_path / "cache").exists()


def test_two_machines_share_a_shot(addon, undisturbed, tmp_path):
    parts = [
        subprocess.Popen(
            blender_command(addon, tmp_path / "shot.blend", "--objects", objects),
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
        )
        for objects in ("Cart,Flag", "Ground")
    ]
    for part in parts:
        assert part.wait(timeout=120) == 0, part.stderr.read()
        part.stderr.close()
    assert s.files_of(tmp_path / "cache") == undisturbed


def checkpoints_among(files):
    """The frames of the checkpoints in a listing of a cache: ``4 8``, or ``-``."""
    frames = {int(name[-4:]) for name in files if "/state_" in name and not name.endswith((".json", ".tmp"))}
    return " ".join(map(str, sorted(frames))) or "-"


def test_killed_at_random_moments_a_bake_resumes_to_the_same_bytes(addon, undisturbed, tmp_path):
    seed = int(os.environ.get("SNOWBOUGH_TEST_SEED", random.randrange(1 << 30)))
    print("seed", seed)
    print("| kill | frames reported | files left | checkpoints left | files after resume | stray | bytes |")
    moments = random.Random(seed)
    for number in range(KILLS):
        command = blender_command(addon, tmp_path / "shot.blend")
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        lines, wanted = 0, moments.randrange(0, 12)
        for line in process.stdout:
            lines += line.startswith("SNOWBOUGH frame=")
            if lines >= wanted:
                break
        time.sleep(moments.uniform(0, 0.05))
        process.kill()
        process.stdout.close()
        process.wait()
        killed = s.files_of(tmp_path / "cache") if (tmp_path / "cache").exists() else {}
        s.bake(resume=True)
        resumed = s.files_of(tmp_path / "cache")
        same, stray = resumed == undisturbed, sorted(set(resumed) - set(undisturbed))
        print(f"| {number + 1:2} | {lines:2} | {len(killed):2} | {checkpoints_among(killed):10} "
              f"| {len(resumed)} | {len(stray)} | {'same' if same else 'DIFFERENT'} |")  # fmt: skip
        assert same, f"kill {number} after {wanted} frames; stray: {stray}"
        bpy.ops.snowbough.free_bake()
        assert not list((tmp_path / "cache").rglob("*.exr"))


def test_the_lock_of_a_bake_killed_at_its_very_end_goes_with_the_next_one(addon, undisturbed, tmp_path):
    """Killed after one of two receivers was finished, or after both but before the unlock."""
    s.bake()
    (version,) = {path.parent.parent for path in (tmp_path / "cache").rglob("object.json")}
    dead = version / "lock-0123abcd"
    dead.write_text("process 1 on elsewhere\n")
    with addon("cache.lock").lock_receivers(version, ["another"]):
        dead.write_text("process 1 on elsewhere\n")
        s.bake(resume=True)
        assert len(list(version.glob("lock*"))) == 1 and not dead.exists()
    assert s.files_of(tmp_path / "cache") == undisturbed


def locked_half(addon, tmp_path):
    """Bakes the first four frames; returns a lock on the folder of one receiver."""
    assert s.bake_part(addon, 1, 4).error is None
    folder = next((tmp_path / "cache").rglob("object.json")).parent
    return addon("cache.lock").lock_receivers(folder.parent, [folder.name])


def start_waiting(addon, tmp_path, *arguments):
    """Starts a bake of a locked receiver; returns the process once it waits."""
    running = subprocess.Popen(
        blender_command(addon, tmp_path / "shot.blend", *arguments),
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    for line in running.stderr:
        if line.startswith("SNOWBOUGH waiting="):
            assert "is being baked by" in line
            return running
    raise AssertionError("it did not wait")


def test_a_command_with_attempts_waits_for_the_other_bake(addon, undisturbed, tmp_path):
    with locked_half(addon, tmp_path):
        running = start_waiting(addon, tmp_path, "--resume", "yes", "--attempts", "100", "--wait", "1")
    error = running.communicate(timeout=120)[1]
    assert running.returncode == 0, error
    assert s.files_of(tmp_path / "cache") == undisturbed


def test_a_command_whose_attempts_are_used_up_says_what_to_do(addon, undisturbed, tmp_path):
    with locked_half(addon, tmp_path):
        done = run_blender(
            addon, tmp_path / "shot.blend", "--resume", "yes", "--attempts", "2", "--wait", "1"
        )
    assert done.returncode == 5 and done.stderr.count("SNOWBOUGH waiting=1 ") == 1
    last = done.stderr.strip().splitlines()[-1]
    assert 'next="Do what the message says, then run the command again with --resume"' in last


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no such signals")
def test_ctrl_c_ends_the_waiting(addon, undisturbed, tmp_path):
    with locked_half(addon, tmp_path):
        running = start_waiting(addon, tmp_path, "--resume", "yes", "--attempts", "2", "--wait", "3600")
        running.send_signal(signal.SIGINT)
        running.communicate(timeout=120)
    assert running.returncode == 130


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no such signals")
@pytest.mark.parametrize("times", [1, 2, 5])
def test_ctrl_c_however_often_ends_with_130_and_can_be_resumed(addon, undisturbed, tmp_path, times):
    report = tmp_path / "report.json"
    running = start_baking(addon, tmp_path, report)
    for _ in range(times):
        running.send_signal(signal.SIGINT)
        time.sleep(0.002)
    error = running.communicate(timeout=120)[1]
    assert running.returncode == 130 and "Resume continues after them" in error and "Traceback" not in error
    assert json.loads(report.read_text())["exit_code"] == 130
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed


@pytest.mark.skipif(os.name != "posix", reason="Windows has shares there")
def test_on_the_command_line_two_slashes_are_the_systems(addon, undisturbed, tmp_path):
    done = run_blender(addon, tmp_path / "shot.blend", "--cache", f"/{tmp_path}/farm/snow")
    assert done.returncode == 0, done.stderr
    assert s.files_of(tmp_path / "farm" / "snow") == undisturbed
    assert f'SNOWBOUGH cache="{tmp_path}/farm/snow"\n' in done.stdout
    (log,) = (tmp_path / "farm").rglob("*.log")
    assert re.fullmatch(rf"\S+ cache {tmp_path}/farm/snow/Scene-\w+", log.read_text().splitlines()[0])


def as_printed(path):
    """A path in the command's lines, which escape backslashes."""
    return json.dumps(str(path))[1:-1]


@pytest.mark.parametrize("name", ["height_0004.exr", "surface.pc2", "object.json", "frames.tsv"])
def test_a_damaged_file_of_a_finished_bake_is_made_again(addon, undisturbed, tmp_path, name):
    s.bake()
    path = next((tmp_path / "cache").rglob(f"Flag-*/{name}"))
    path.write_bytes(path.read_bytes()[:-20])
    done = run_blender(addon, tmp_path / "shot.blend", "--resume", "yes")
    if name == "height_0004.exr":  # the first checkpoint lies behind it
        assert done.returncode == 5 and f"{as_printed(path)} is missing or damaged" in done.stderr
    else:
        assert done.returncode == 0 and f'repaired="{as_printed(path)} was' in done.stderr, done.stderr
        assert s.files_of(tmp_path / "cache") == undisturbed


@pytest.mark.parametrize("name", ["state_0004.json", "state_0004"])
def test_a_damaged_file_has_the_caches_code_and_says_what_to_do(addon, undisturbed, tmp_path, name):
    assert s.bake_part(addon, 1, 6).error is None
    path = next((tmp_path / "cache").rglob(f"Cart-*/{name}"))
    for later in path.parent.glob("state_0006*"):
        later.unlink()
    path.write_bytes(path.read_bytes()[:-20])
    done = run_blender(addon, tmp_path / "shot.blend", "--resume", "yes")
    assert done.returncode == 5 and as_printed(path) in done.stderr and "Traceback" not in done.stderr
    assert "is damaged" in done.stderr and "elete " in done.stderr


def test_a_cache_that_is_deleted_under_a_bake_does_not_say_to_make_room(addon, undisturbed, tmp_path):
    def delete(result):
        if result.frame == 5:
            shutil.rmtree(tmp_path / "cache", ignore_errors=True)  # a file may be renamed meanwhile

    running = s.bake_part(addon, on_frame=delete)
    assert addon("bake.cli").exit_code(running.error) in (5, 7)
    assert "free disk space" not in str(running.error) and "again" in str(running.error)


@pytest.mark.skipif(os.name == "nt", reason="Windows sends no such signals")
def test_a_bake_that_loses_its_lock_stops_and_leaves_the_other_bakes_files(addon, undisturbed, tmp_path):
    """The lock is deleted by hand, and a second bake clears the folder and goes ahead."""
    report = tmp_path / "report.json"
    first = start_baking(addon, tmp_path, report)
    locks = sorted((tmp_path / "cache").rglob("lock-*"))
    assert len(locks) == 1
    os.kill(first.pid, signal.SIGSTOP)
    for lock in locks:
        lock.unlink()
    s.bake()
    os.kill(first.pid, signal.SIGCONT)
    error = first.communicate(timeout=120)[1]
    assert first.returncode == 7 and "was removed or replaced during this bake" in error
    assert json.loads(report.read_text())["exit_code"] == 7
    assert s.files_of(tmp_path / "cache") == undisturbed


@pytest.fixture
def small_disk(tmp_path):
    """A disk of 400 KiB at tmp/small; grow() makes room."""
    folder = tmp_path / "small"
    folder.mkdir()
    if not shutil.which("mount"):
        pytest.skip("this system mounts no small disk")
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", str(folder)],
        stderr=subprocess.DEVNULL,
        check=False,
    )
    if mounted.returncode != 0:
        pytest.skip("mounting a small disk needs root")
    yield folder, lambda: subprocess.run(["mount", "-o", "remount,size=64m", str(folder)], check=True)
    subprocess.run(["umount", "-l", str(folder)], check=True)


def test_a_full_disk_stops_with_a_message_and_can_be_resumed(undisturbed, small_disk, tmp_path):
    folder, grow = small_disk
    bpy.context.scene.snowbough.cache_directory = str(folder)
    with pytest.raises(RuntimeError, match="(?i)no space left.*resume"):
        s.bake()
    assert not [name for name in s.files_of(folder) if ".tmp" in name]
    grow()
    s.bake(resume=True)
    assert s.files_of(folder) == undisturbed


def test_a_read_only_disk_is_refused_and_can_be_used_later(addon, undisturbed, small_disk, tmp_path):
    folder, grow = small_disk
    subprocess.run(["mount", "-o", "remount,ro", str(folder)], check=True)
    done = run_blender(addon, tmp_path / "shot.blend", "--cache", str(folder))
    assert done.returncode == 5 and "cannot be written" in done.stderr and "Traceback" not in done.stderr
    assert s.files_of(folder) == {}
    subprocess.run(["mount", "-o", "remount,rw", str(folder)], check=True)
    grow()
    assert run_blender(addon, tmp_path / "shot.blend", "--cache", str(folder)).returncode == 0
    assert s.files_of(folder) == undisturbed


def test_a_lost_folder_stops_with_a_message(addon, undisturbed, tmp_path):
    def lose(result):
        if result.frame == 5:
            (tmp_path / "cache").rename(tmp_path / "elsewhere")

    running = s.bake_part(addon, on_frame=lose)
    assert isinstance(running.error, (addon("cache.errors").CacheError, addon("bake.map_writer").WriteFailed))
    shutil.rmtree(tmp_path / "cache", ignore_errors=True)
    (tmp_path / "elsewhere").rename(tmp_path / "cache")
    s.bake(resume=True)
    assert s.files_of(tmp_path / "cache") == undisturbed

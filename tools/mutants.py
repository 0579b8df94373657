#!/usr/bin/env python3
"""Changes the code of the cache, of resuming, of moving snow, of fronts, of kept surfaces and of bending in small ways,
and checks that a test fails for each change.

    python3 tools/mutants.py [--only WORD] [--list]

Each mutant is applied to a copy of the tree, in a temporary folder, and removed again. Python's use the module in
build/python; for those of C++ the tests of their room, or a module, are built in the copy, file by file (the first
takes minutes). A mutant that survives means that a test is missing. The exit code is 0 only if all are killed.
"""

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
COPIED = ("CMakeLists.txt", "addon", "cmake", "native", "shaders", "tests", "pyproject.toml")
# Seconds that tests may take; with a mutant at least MIN_TIMEOUT, or this many times as long as without one.
TIMEOUT = 1200
MIN_TIMEOUT, SLOWER = 120, 5

ADDON = "tests/python/addon"
CACHE = tuple(f"{ADDON}/test_{name}.py" for name in ("cache", "free_bake", "sealed_files", "map_writer"))
REPAIRS = ("tests/faults/test_repairs.py",)
CALLS = ("tests/faults/test_file_calls.py", "-k", "flushed")
MEMORY = ("tests/faults/test_memory.py", "-k", "does_not_fit")


@dataclass(frozen=True)
class Linked:
    """Tests of a target that is built again with the mutated file."""

    target: str
    arguments: tuple = ()
    """Of the program, or of pytest if the target is the module."""


MODULE = "snowbough_native"
FILES = Linked("snowbough_image_tests", ("--gtest_filter=AtomicFile*",))
CHECKPOINTS = Linked("snowbough_map_tests", ("--gtest_filter=Checkpoint*",))


def module_tests(*names):
    """The engines share what moves snow: the processor's runs suffice."""
    return Linked(MODULE, (*(f"tests/python/native/test_snow_{name}.py" for name in names), "-k", "not GL"))


LANDING = module_tests("landing")
EDGES = module_tests("edges")
MASKS = module_tests("masks")
PRESSING = module_tests("pressing")
THAW = module_tests("melt")
SHEDDING = module_tests("shedding")
TURNS = Linked("snowbough_map_tests", ("--gtest_filter=RigidTurn*",))
RAYS = Linked("snowbough_map_tests", ("--gtest_filter=SceneRays*",))
COARSE = Linked("snowbough_map_tests", ("--gtest_filter=CoarseMap*",))
SURFACE = Linked("snowbough_surface_tests", ("--gtest_filter=Fronts.*:SnowSurface.*-*Blades*:*Twice*",))
SURFACE_PARTS = Linked("snowbough_surface_tests", ("--gtest_filter=FaceParts*:PointTree*",))
KEPT = Linked("snowbough_tree_uv_tests", ("--gtest_filter=Kept*",))
COVERAGE = Linked(
    "snowbough_tree_read_tests", ("--gtest_filter=*Coverage*:ReadTree.Says*:ReadTree.Reports*",)
)
BENDING = (f"{ADDON}/test_bending.py",)
LEDGER = (f"{ADDON}/test_ledger.py",)


@dataclass(frozen=True)
class Mutant:
    file: str
    before: str
    """Occurs once in the file."""
    after: str
    tests: tuple = CACHE
    """Arguments of pytest, or Linked."""


def cache(name, before, after, tests=CACHE):
    return Mutant(f"addon/snowbough/cache/{name}.py", before, after, tests)


def bake(name, before, after, tests=REPAIRS):
    return Mutant(f"addon/snowbough/bake/{name}.py", before, after, tests)


def image(name, before, after):
    return Mutant(f"native/image/{name}.cpp", before, after, FILES)


def state(before, after):
    return Mutant("native/snow/state/checkpoint.cpp", before, after, CHECKPOINTS)


def moving(name, before, after, tests):
    return Mutant(f"native/snow/movement/{name}.cpp", before, after, tests)


def surface(name, before, after, tests=SURFACE_PARTS):
    return Mutant(f"native/snow/surface/{name}.cpp", before, after, tests)


def kept(name, before, after):
    return Mutant(f"native/tree/kept/{name}.cpp", before, after, KEPT)


def coverage(before, after):
    return Mutant("native/tree/coverage/coverage.cpp", before, after, COVERAGE)


def bending(name, before, after):
    return Mutant(f"addon/snowbough/bending/{name}.py", before, after, BENDING)


MUTANTS = (
    # Files that are written as a whole.
    cache("files", "            os.fsync(stream.fileno())\n", "", CALLS),
    cache("files", "            temporary.unlink()", "            pass"),
    cache("files", "range(first, last + 1)", "range(first, last)"),
    cache("files", r'r"(.+?)(?:\.\d+\.\d+|\.[0-9a-f]{8})?\.tmp$"', r'r"(.+?)(?:\.[0-9a-f]{8})?\.tmp$"'),
    cache("files", "stat.S_ISREG(os.lstat(path).st_mode)", "stat.S_ISREG(os.stat(path).st_mode)"),
    cache("files", "if entry.is_dir(follow_symlinks=False)", "if entry.is_dir()"),
    cache("files", "name in ONCE or number is not None", "True or number is not None"),
    cache("files", "if not stat.S_ISREG(os.fstat(descriptor).st_mode):", "if False:"),
    cache("files", "hasher.update(block)", "hasher.update(block[:1 << 10])", REPAIRS),
    # Checksums.
    cache("sealed", "seal.group(1) != _checksum", "seal.group(0) == _checksum"),
    cache("sealed", "if is_known and not seal:", "if False:"),
    cache("sealed", "if os.fstat(stream.fileno()).st_size > MAX_BYTES:", "if False:"),
    cache("sealed", "if is_known and not fits(value, shape):", "if False:"),
    cache("integrity", "file_digest(Path(folder) / name) != digest", "False", REPAIRS),
    cache("integrity", "if not (Path(folder) / name).is_file() or digest and", "if digest and", REPAIRS),
    cache("integrity", 'damaged(folder, manifest.get("checksums", {}))', "None", REPAIRS),
    # Removal.
    cache("folder", "for name in (state_file(frame), f\"{state_file(frame)}.json\"):",
          "for name in (f\"{state_file(frame)}.json\", state_file(frame)):"),
    cache("folder", "if frame < before and", "if frame <= before and"),
    cache("folder", "(frame - frame_start + 1) % interval", "(frame - frame_start) % interval"),
    cache("folder", "int(match.group(1)) > frame", "int(match.group(1)) >= frame", REPAIRS),
    cache("folder", "int(match.group(1)) > frame", "int(match.group(1)) > frame + 1"),
    cache("folder", "is_listed(finished_name(name)) or", "True or"),
    cache("folder", "key=lambda name: (name in manifests, name in (FRAMES, SURFACE), name)", "key=None"),
    cache("folder", "            os.replace(folder / MANIFEST, folder / REMOVED_MANIFEST)", "            pass"),
    cache("folder", "return [path for path in own if is_regular(path)]", "return own"),
    cache("folder", "    if folder.is_symlink() or not folder.is_dir():", "    if not folder.is_dir():"),
    cache("folder", "if half or (match", "if (match", REPAIRS),
    cache("folder", ".json\").is_file()]", ".json\")]"),
    cache("folder", '"files": listed, "complete": False', '"files": listed, "complete": True', REPAIRS),
    cache("folder", "lines.ends[-1] != end or", ""),
    cache("folder", "for frame in reversed(checkpoints(folder)):", "for frame in checkpoints(folder)[:1]:", REPAIRS),
    # Versions and owners.
    cache("versions", 'if name in keys and manifest["complete"]:', "if False:"),
    cache("versions", 'manifest["settings"].get("shot") != shot_hash', "False"),
    cache("versions", "return number, [key for key in present if is_finished(folder / key)]", "return number, present"),
    cache("versions", 'manifest.get("cache") in identities', "True"),
    cache("owner", 'recorded["host"] in ("", own["host"]) and ', ""),
    # Locks.
    cache("lock", "fcntl.LOCK_EX | fcntl.LOCK_NB", "fcntl.LOCK_SH | fcntl.LOCK_NB"),
    cache("lock", "_is_at(self._path, self._descriptor) and stream", "stream"),
    cache("lock", "stream.read(len(self._head)) == self._head", "True"),
    cache("lock", "    if own:\n", "    if True:\n"),
    cache("lock", "keys & set(lines)", "set(lines)"),
    cache("lock", "_remove(path, descriptor)\n            continue", "os.close(descriptor)\n            continue"),
    # Lines.
    cache("journal", "_checksum(seal, raw[len(columns[0]) + 1 :]) != columns[0]", "False"),
    cache("journal", 'hashlib.blake2b(before + body', 'hashlib.blake2b(body'),
    cache("journal", 'if not is_header and entry["frame"] != lines.next_frame:', "if False:"),
    cache("journal", "            self._cut(descriptor)\n            os.fsync", "            os.fsync", REPAIRS),
    cache("manifest", "not lines.rest and ", ""),
    cache("integrity", "if not is_same", "if False"),
    cache("integrity", "return lost, FRAMES", "return None", REPAIRS),
    # Resuming.
    bake("resuming", "request.first - 1 <= frame < at", "request.first - 1 <= frame <= at"),
    bake("resuming", "return max(usable)", "return min(usable)"),
    bake("resuming", "if damage and any(", "if False and any("),
    bake("baked_receiver", "        self.write_manifest(shot, complete=False)\n        # Before", "        # Before"),
    bake("baked_receiver", "is_bake = (self.folder / MANIFEST).is_file()", "is_bake = True"),
    bake("baked_receiver", "        self.lock.check()\n        try:\n", "        try:\n"),
    bake("map_writer", "self._waiting_bytes + size <= MAX_WAITING_BYTES", "True", CACHE),
    bake("map_writer", "queue.Queue(max_waiting(maps))", "queue.Queue()", CACHE),
    bake("memory", "if not free or needed <= free:", "if True:", MEMORY),
    # C++: files that are written as a whole, and checkpoints.
    image("atomic_file", "  if (!flush_file(descriptor_)) fail(\"write\", path_, errno);\n", ""),
    image("atomic_file", "if (!renamed_) remove_file(temporary_);", ""),
    image("atomic_file", '      if (written < 0) fail("write", path_, errno);\n      // A full', "      // A full"),
    image("open_file_posix", "O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC", "O_WRONLY | O_CREAT | O_CLOEXEC"),
    state("body.size() > bytes || check_sum(body) != expected_sum",
          "body.size() > bytes || expected_sum == ~check_sum(body)"),
    state("if (body.size() < bytes) {", "if (false) {"),
    state("if (version < kVersion || version > kLastVersion) {", "if (false) {"),
    state("resolution == 0 || resolution > kLargestResolution", "resolution == 0"),
    state("if (!reader.at_end())", "if (false)"),
    state("  if (check) check(outline);\n", "  if (false) check(outline);\n"),
    state("return std::bit_cast<uint32_t>(height) == 0;", "return height == 0.0f;"),
    # Lines that are cut, and the balance.
    cache("journal", "self._cut(descriptor)  # what a failed attempt left", "pass"),
    cache("journal", "until is None or end < until.bytes", "True", REPAIRS),
    cache("journal", "lines.rest = size - end", "lines.rest = 0"),
    cache("journal", "or found.st_size < self.end.bytes", "or False"),
    cache("ledger", "entry.get(name, 0.0)", "0.0", LEDGER),
    cache("ledger", "if last[name] >= LEAST * last", "if last[name] > 0.0 * last", LEDGER),
    cache("ledger", 'math.fsum(entry["slid"] for entry in entries)', "0.0", LEDGER),
    # What lies beyond outlets.
    moving("repose/outlets", "link.rise = -way.z", "link.rise = 0.0f * -way.z", EDGES),
    moving("repose/outlets", "  link_walls(ground, limits, stand, block, blocks);\n", "", EDGES),
    moving("outlet_targets", "least = std::min(near, far)", "least = near", EDGES),
    moving("outlet_targets", "arch + part * (joined - arch)", "arch + 0.0f * part * joined", EDGES),
    moving("outlet_targets", "is_at_wall = is_side && is_closed", "is_at_wall = is_side && width < 0.0", EDGES),
    moving("outlet_targets", "width == 0.0 && target.searched < widest", "false && target.searched < widest", EDGES),
    # Landing.
    moving("landing", "  clock_ = state.clock;\n", "", LANDING),
    moving("splat", "is_back ? -now : now", "now", LANDING),
    moving("rays/map_point", "if (hit.object < 0 || holds_snow(hit)) return hit;", "return hit;", LANDING),
    moving("splat", "lost + put(centre, rest, map)", "lost", LANDING),
    moving("splat", "return !shared::is_wall(side", "return true || !shared::is_wall(side", LANDING),
    moving("splat", "return broadest;", "return place < 0 ? broadest : place;", LANDING),
    moving("landing", "std::min(falls, settings.longest_fall)", "0.0", LANDING),
    moving("landing", "landed.push_back(one);", "if (false) landed.push_back(one);", LANDING),
    moving("landing", "cell.units / kRays + (ray < cell.units % kRays ? 1 : 0);", "cell.units / kRays;", LANDING),
    moving("landing", "cell.outwards * (settings.throw_speed * speed);", "cell.outwards * (0.0 * speed);", LANDING),
    moving("landing", "on_floors_ += snow.units;", "left_ += snow.units;", LANDING),
    moving("landing", "map.slid -= kept;", "map.slid -= 0.0 * kept;", LANDING),
    # Masks.
    moving("masks", "(now < last[i] ? now / last[i] : 1.0f)", "1.0f", MASKS),
    moving("masks", "+ now * (thickness - old)", "+ (thickness - old)", MASKS),
    moving("masks", "map.masked += shrink(height, left, area[i]);", "shrink(height, left, area[i]);", MASKS),
    moving("masks", "if (object.mask == nullptr) last = {};", "", MASKS),
    moving("masks", "const float most = mask * max_depth;", "const float most = max_depth;", MASKS),
    moving("masks", "= last_[object][i];", "= 1.0f;", MASKS),
    moving("masks", "std::copysign(thickness, height)", "thickness", MASKS),
    # Pressing and pushing.
    moving("pressing", "(thickness + static_cast<double>(own.packed[i])) / ratio", "0.0 / ratio", PRESSING),
    moving("pressing", "map.cleared += lost;", "", PRESSING),
    moving("pressing", "own.packed[i] += static_cast<float>(", "own.packed[i] = static_cast<float>(", PRESSING),
    moving("pressing", "presses ? settings.pushed_aside : 1.0;", "1.0;", PRESSING),
    moving("pressing", "- kRefill * loose", "- 0.0f * loose", PRESSING),
    moving("pressing", "map.pressed += static_cast<double>(kept) * kPushUnit;", "", PRESSING),
    moving("pressing", "  load_plane(kStandsPlane, own.stands);\n", "", PRESSING),
    moving("pressing", "object.hidden) {\n      last_[i].clear();", "object.hidden) {", PRESSING),
    moving("press/push", "- kAhead * glm::dot(step, way_[from])", "", PRESSING),
    moving("press/push", "rest -= given;", "", PRESSING),
    moving("press/push", "(ahead_only && glm::dot(way, heap.way) < 0.0)", "(ahead_only && false)", PRESSING),
    moving("press/presser", "leaves ? 0.0 : std::max", "leaves && !leaves ? 0.0 : std::max", PRESSING),
    moving("press/presser", "  swept_.low -= margin;\n", "", PRESSING),
    moving("repose/rigid_turn", "most = std::max(most, glm::length(glm::dvec3(to[i]) - there));",
           "most = std::max(most, 0.0 * glm::length(glm::dvec3(to[i]) - there));", TURNS),
    moving("press/presser", "glm::dvec3(half_way[i]), to}", "to}", PRESSING),
    # Thaw, water and shedding.
    moving("melt/thaw", "run.depth * (1.0 - run.sun + run.sun *", "run.depth * (run.sun *", THAW),
    moving("melt/thaw", "    map.melted += volume;\n", "", THAW),
    moving("melt/thaw", "kBareMelts * run.unevenness", "0.0 * run.unevenness", THAW),
    moving("melt/thaw", "std::copysign(left, height[i])", "left", THAW),
    moving("melt/water", "- part * depth[i];", "- 0.0f * part * depth[i];", THAW),
    moving("melt/water", "    own.depth[b] += flow / own.area[b];\n", "", THAW),
    moving("melt/water", "(1.0f + decay * (height[i]", "(1.0f + 0.0f * decay * (height[i]", THAW),
    moving("melt/water", "static_cast<double>(melted[i]) * density);", "static_cast<double>(melted[i]));", THAW),
    moving("melt/water", "if (is_new) known->second = below(", "if (is_new) below(", THAW),
    moving("melt/linked_runs", "(links.forward[static_cast<size_t>(cell)] & link) != 0;",
           "(links.forward[static_cast<size_t>(cell)] & link) <= link;", THAW),
    moving("shedding", "-std::expm1(-dt / half_life * std::log(2.0))", "dt / half_life", SHEDDING),
    moving("shedding", "glm::floor(at * (1.0 / edge))", "glm::floor(at * (1e3 + 0.0 / edge))", SHEDDING),
    moving("shedding", "      map.slid += static_cast<double>(volume);\n", "", SHEDDING),
    # Rays.
    moving("rays/scene_rays", "  boxes_[node] = box_of(object);\n", "", RAYS),
    moving("rays/scene_rays", "while ((node /= 2) > 0) join(node);", "", RAYS),
    moving("rays/scene_rays", "hit.triangle >= 0 && i < object", "false", RAYS),
    moving("rays/scene_rays", "!may_meet(boxes_[node], from, direction, hit.distance)", "false", RAYS),
    # Coarser maps.
    moving("coarse_map", "std::numbers::sqrt2 * side * size < wanted", "side * size < 0.0 * wanted", COARSE),
    # Fronts of snow, and the parts and points among which they are found.
    surface("fronts", "front.bridged = opposite.nearness;", "front.bridged = 0.0f;", SURFACE),
    surface("fronts", "if (!std::isfinite(drop) && may_bridge && distance > kBeyond[0]) break;",
            "if (false && may_bridge) break;", SURFACE),
    surface("fronts", "front.lee = kLee * std::max(lee, 0.0f);", "front.lee = 0.0f * std::max(lee, 0.0f);", SURFACE),
    surface("fronts", "own = at.presence * covers;", "own = at.presence + 0.0f * covers;", SURFACE),
    surface("fronts", "holds += held[end] - held[begin];", "holds += held[end];", SURFACE),
    surface("fronts", "is_sheltered(tree, on_rim, depth);", "is_sheltered(tree, on_rim, depth) || true;", SURFACE),
    surface("face_parts", "if (has[pair.a] != 0 || has[pair.b] != 0) continue;", ""),
    surface("face_parts", "joined.join(blade.face, distinct.back().face);", ""),
    surface("face_parts", "if (b != a && turn <= kStraight)", "if (b != a)"),
    surface("point_tree", "if (away[k] <= found.back().distance)", "if (2.0f * away[k] <= found.back().distance)"),
    surface("point_tree", "node.end; ++i) {\n      const Found", "node.end - 1; ++i) {\n      const Found"),
    # Kept surfaces.
    kept("kept_surface", "found->second >= 0.0) continue;", "true) continue;"),
    kept("kept_surface", "if (polygons > kSmallPart) return;", "if (polygons < 0) return;"),
    kept("kept_surface", "if (wrong) kept.corner_normal = {};", ""),
    kept("kept_surface", "if (classified.role[p] == PartRole::kCrossSection) {", "if (false) {"),
    kept("kept_weights", "share -= own;", ""),
    kept("charts", " && polygons < kMaxPolygons", ""),
    kept("charts", "branch_of(other) == branch_of(static_cast<int32_t>(seed)) &&",
         "branch_of(other) == branch_of(other) &&"),
    kept("kept_uvs", "uv.x -= std::round(uv.x - first);", "uv.x -= 0.0 * std::round(uv.x - first);"),
    kept("upright", "away[up] = 0.0;", ""),
    # Coverage.
    coverage("covered *= part.supported();", ""),
    coverage("covered_[i] = away <= kReach * radius ? 1 : 0;", "covered_[i] = away < 0.0f * radius ? 0 : 1;"),
    coverage("if (covered < area) coverage", "if (false) coverage"),
    coverage("return near.cost <= kReachOfOthers", "return true || near.cost <= kReachOfOthers"),
    coverage("return a.second > b.second;", "return a.second < b.second;"),
    coverage("wood[skipped.part] = skipped.wood ? 1 : 0;", "wood[skipped.part] = 0;"),
    # Bending.
    bending("cantilevers", "(3.0 * a**3 * b**3)", "(3.0 * a**6)"),
    bending("cantilevers", "np.where(continues, half[self._before], 0.0)", "half[self._before]"),
    bending("cantilevers", "np.minimum(1.0, most / np.maximum(size, 1e-30))[:, None]", "1.0"),
    bending("cantilevers", "(moments * along).sum(axis=1)[:, None] * along", "0.0"),
    bending("cantilevers", "np.where(turns_back, SLOWER, FASTER)", "FASTER"),
    bending("cantilevers", "np.add.at(first, self.parents[rows], first[rows])", "pass"),
    bending("cantilevers", "_product(_transposed(parent_turns), turns)", "turns"),
    bending("load", "min(INTERCEPTED * depth * density, MAX_INTERCEPTED)", "INTERCEPTED * depth * density"),
    bending("load", "[1.0 - second - third, second, third]", "[second, third, 1.0 - second - third]"),
    bending("load", "np.abs(mesh.heights", "(mesh.heights"),
    bending("load", "after[0] = np.searchsorted", "np.searchsorted"),
    bending("load", "reached[limbs[bone]] += lengths[bone]", "pass"),
)  # fmt: skip


class Tree:
    """A copy of the tree with at most one mutant in it."""

    def __init__(self, folder):
        self.folder = folder
        self.objects = folder / "objects"
        self.allowed = TIMEOUT
        for name in COPIED:
            source = ROOT / name
            copy = shutil.copytree if source.is_dir() else shutil.copy
            copy(source, folder / name)
        (folder / "build").symlink_to(ROOT / "build")

    def run(self, tests):
        """(whether the tests pass, seconds)"""
        begun = time.monotonic()
        passes = self._built(tests) if isinstance(tests, Linked) else self._python(tests)
        return passes, time.monotonic() - begun

    def kills(self, mutant, seconds):
        """(whether the tests notice a mutant, seconds). seconds: how long they take without one."""
        self.allowed = max(MIN_TIMEOUT, SLOWER * seconds)
        path = self.folder / mutant.file
        text = path.read_text(encoding="utf-8")
        path.write_text(text.replace(mutant.before, mutant.after), encoding="utf-8")
        try:
            passes, seconds = self.run(mutant.tests)
        finally:
            path.write_text(text, encoding="utf-8")
        return not passes, seconds

    def _python(self, tests, modules="build/python"):
        environment = {
            **os.environ,
            "PYTHONPATH": modules,
            "PYTHONDONTWRITEBYTECODE": "1",
            "SNOWBOUGH_TEST_SEED": "1",
        }
        command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *tests]
        return self._ends_well(command, environment)

    def _built(self, tests):
        """Builds a target, every file by itself and without warnings as errors, and runs its tests."""
        if not (self.objects / "CMakeCache.txt").exists():
            settings = {
                "CMAKE_BUILD_TYPE": "Release",
                "CMAKE_CXX_FLAGS_RELEASE": "-O1 -w",
                "Python_EXECUTABLE": sys.executable,
                "SNOWBOUGH_PYTHON_DIR": self.objects / "python",
                "SNOWBOUGH_UNITY": "OFF",
            }
            command = ["cmake", "-S", self.folder, "-B", self.objects, "-G", "Ninja"]
            command += [f"-D{name}={value}" for name, value in settings.items()]
            subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        command = ["cmake", "--build", self.objects, "--target", tests.target]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        if tests.target == MODULE:
            return self._python(tests.arguments, str(self.objects / "python"))
        (program,) = self.objects.rglob(tests.target)
        command = [program, *tests.arguments]
        listed = subprocess.run([*command, "--gtest_list_tests"], capture_output=True, text=True).stdout
        if not any(line.startswith("  ") for line in listed.splitlines()):
            sys.exit(f"mutants: {tests.target} has no tests for {tests.arguments}")
        return self._ends_well(command, os.environ)

    def _ends_well(self, command, environment):
        try:
            done = subprocess.run(
                command, cwd=self.folder, env=environment, timeout=self.allowed,
                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            return False
        return done.returncode == 0


def is_stale(mutant):
    """Whether the code has changed, so that the mutant does not change exactly one place."""
    return (ROOT / mutant.file).read_text(encoding="utf-8").count(mutant.before) != 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--only", default="", help="only mutants of files with this word in their path")
    parser.add_argument("--list", action="store_true", help="print the mutants and stop")
    options = parser.parse_args()
    chosen = [mutant for mutant in MUTANTS if options.only in mutant.file]
    if options.list:
        print("\n".join(f"{m.file}: {m.before.strip()}  ->  {m.after.strip()}" for m in chosen))
        return 0
    stale = [mutant for mutant in chosen if is_stale(mutant)]
    chosen = [mutant for mutant in chosen if mutant not in stale]
    survived = 0
    with tempfile.TemporaryDirectory(prefix="snowbough-mutants-") as folder:
        tree = Tree(Path(folder))
        whole = {}
        for mutant in chosen:
            if mutant.tests not in whole:
                tree.allowed = TIMEOUT
                passes, whole[mutant.tests] = tree.run(mutant.tests)
                if not passes:
                    del whole[mutant.tests]
                    survived += 1
                    print(f"UNTESTED         {mutant.file}: {mutant.tests} fail without a mutant", flush=True)
                    continue
            killed, seconds = tree.kills(mutant, whole[mutant.tests])
            survived += not killed
            change = f"{mutant.before.strip()}  ->  {mutant.after.strip()}"
            print(
                f"{'killed  ' if killed else 'SURVIVED'} {seconds:4.1f} s  {mutant.file}: {change}",
                flush=True,
            )
    for mutant in stale:
        print(f"STALE            {mutant.file}: not one place with {mutant.before.strip()!r}")
    print(f"{len(chosen) - survived} of {len(chosen)} mutants killed")
    return 1 if survived or stale else 0


if __name__ == "__main__":
    sys.exit(main())

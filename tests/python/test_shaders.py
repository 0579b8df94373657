"""The reference compiler accepts every variant of every shader.

Drivers accept different extensions of the language: a shader that compiles on one machine may fail on another.
"""

import itertools
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import snowbough_testing

FOLDER = Path(__file__).resolve().parents[2] / "shaders"
# Folders of the passes that run the shaders.
PASSES = ["native/snow/*/gl/*", "native/render/*", "native/render/*/*"]
# The order in which a program's stages follow each other, and what glslangValidator calls them.
STAGES = ["vert", "tesc", "tese", "geom", "frag", "comp"]
# Macros with a value, and their values.
VALUES = {"LOCAL_SIZE": ("8", "64")}


def stage_of(file):
    return file.split(".")[1]


def programs():
    """Files of each program, by the pass that names them."""
    passes = {}
    for path in sorted(FOLDER.rglob("*.*.glsl")):
        passes.setdefault(path.name.split(".")[0], []).append(path.name)
    return {
        name: sorted(files, key=lambda file: STAGES.index(stage_of(file))) for name, files in passes.items()
    }


def choices(file):
    """For each switch in the text that a shader compiles: the defines that set it, one of which is taken."""
    text = snowbough_testing.shader_source(file)
    switches = set(re.findall(r"^\s*#\s*if(?:n?def)\s+(\w+)", text, re.MULTILINE))
    assert not re.search(r"^\s*#\s*(?:el)?if\b", text, re.MULTILINE), (
        "switches are asked for by #ifdef and #ifndef"
    )
    with_value = {name for name in VALUES if re.search(rf"\b{name}\b", text)}
    for name in sorted(switches - {"SNOWBOUGH_GLSL"} - with_value):
        yield name, [None, name]
    for name in sorted(with_value):
        yield name, [f"{name} {value}" for value in VALUES[name]]


def variants():
    """Each program in all combinations of its stages' switches: (its files, its defines)."""
    for files in programs().values():
        switches = dict(choice for file in files for choice in choices(file))
        for picked in itertools.product(*switches.values()):
            yield files, [define for define in picked if define]


def name_of(variant):
    files, defines = variant
    return " ".join([files[0].split(".")[0], *defines])


def complaints_of(sources, folder):
    """The reference compiler's errors of a program's stages: source by <pass>.<stage>."""
    compiler = shutil.which("glslangValidator")
    if compiler is None:
        pytest.skip("needs the package glslang-tools")
    for name, source in sources.items():
        (folder / name).write_text(source)
    ended = subprocess.run([compiler, "-l", *sources], cwd=folder, capture_output=True, text=True)
    lines = [line for line in ended.stdout.splitlines() if line not in sources]
    return lines or ([] if ended.returncode == 0 else [f"exit status {ended.returncode}"])


@pytest.mark.parametrize("variant", variants(), ids=name_of)
def test_a_variant_compiles_and_its_stages_fit_together(variant, tmp_path):
    files, defines = variant
    sources = {file.removesuffix(".glsl"): snowbough_testing.shader_source(file, defines) for file in files}
    assert complaints_of(sources, tmp_path) == []


def reads_of_write_only(source):
    """Where a shader reads its writeonly buffers, as NVIDIA's compiler sees it: also in `a[i] = b[i] = 0`, which reads
    b. Names and texts before them."""
    declared = (
        r"\bwriteonly\s+buffer\s+\w+\s*\{\s*\w+\s+(\w+)\s*\[[^}]*\}|KERNEL_BLOCK_WRITEONLY\(\w+, \w+, (\w+)\)"
    )
    text = re.sub(r"//.*|^\s*#.*", "", source, flags=re.MULTILINE)
    names = ["".join(groups) for groups in re.findall(declared, text)]
    body = re.sub(declared, "", text)
    found = []
    for name in names:
        for place in re.finditer(rf"\b{name}\s*\[", body):
            before = body[: place.start()].rstrip()
            if before[-1] not in ";{})":
                found.append((name, before[-20:]))
    return found


def test_no_shader_reads_a_writeonly_buffer():
    read = {
        file: reads_of_write_only(snowbough_testing.shader_source(file, defines))
        for files, defines in variants()
        for file in files
    }
    assert len(read) > 30
    assert {file: places for file, places in read.items() if places} == {}


def test_a_chained_assignment_to_a_writeonly_buffer_is_found():
    source = "layout(std430) writeonly buffer B { int b[]; };\nvoid main() { a[0] = b[0] = 1; }"
    assert [name for name, _ in reads_of_write_only(source)] == ["b"]
    assert reads_of_write_only(source.replace("a[0] = ", "if (true) ")) == []


def test_no_atomic_function_chooses_its_target_in_an_index():
    """NVIDIA's compiler (driver 580) then ends with 'unexpected expression in DUI_foreachId'."""
    choice = re.compile(r"\batomic\w+\(\s*\w+\[[^\]]*\?")
    assert choice.search("atomicAdd(requests[next > 0 ? i : to], 1);")
    found = [
        (file, match[0])
        for files, defines in variants()
        for file in files
        if (match := choice.search(snowbough_testing.shader_source(file, defines)))
    ]
    assert found == []


def test_no_stage_has_more_storage_blocks_than_drivers_are_asked_for():
    """OpenGL 4.5 guarantees 8 to the passes of snow; the renderer asks for more."""
    header = (FOLDER.parent / "native" / "render" / "renderer.h").read_text()
    most = int(re.search(r"kStorageBlocks = (\d+);", header)[1])
    used = [
        (len(set(re.findall(r"\bbuffer\s+(\w+)\s*\{", snowbough_testing.shader_source(file, defines)))), file)
        for files, defines in variants()
        for file in files
    ]
    assert max(used)[0] == most, max(used)
    snow = "".join(path.read_text() for path in (FOLDER.parent / "native" / "snow").rglob("*.cpp"))
    of_snow = [(count, file) for count, file in used if f'"{file}"' in snow]
    assert len(of_snow) > 12 and max(of_snow)[0] <= 8, max(of_snow)


def test_stages_that_do_not_fit_together_are_told(tmp_path):
    vertex = "#version 450 core\nflat out uint a;\nvoid main() { a = 1u; gl_Position = vec4(0.0); }\n"
    fragment = (
        "#version 450 core\nflat in vec2 a;\nlayout(location = 0) out vec2 b;\nvoid main() { b = a; }\n"
    )
    complaints = complaints_of({"it.vert": vertex, "it.frag": fragment}, tmp_path)
    assert any("Types must match" in line for line in complaints)


def test_every_glsl_file_is_a_stage_of_a_program_or_included_by_one():
    mains = {file for files in programs().values() for file in files}
    assert len(mains) > 10
    assert {stage_of(file) for file in mains} <= set(STAGES)
    included = set()
    for path in FOLDER.rglob("*.*"):
        included |= {Path(name).name for name in re.findall(r'#include "([^"]+)"', path.read_text())}
    assert {path.name for path in FOLDER.rglob("*.glsl")} - mains - included == set()


def test_every_switch_of_a_shader_is_set_by_a_pass():
    switches = {name for files in programs().values() for file in files for name, _ in choices(file)}
    passes = "".join(
        path.read_text() for glob in PASSES for path in FOLDER.parent.glob(glob) if path.is_file()
    )
    assert len(switches) > 3
    assert {name for name in switches if f'"{name}"' not in passes and f'"{name} "' not in passes} == set()


USES_THE_RULE = """
layout(local_size_x = 8) in;
layout(std430, binding = 0) buffer Shown { vec4 shown[]; };
void main() {
  const SnowStyle style = SnowStyle(1.0, 1.0, 1.0, 1.0);
  const SnowPoint point = SnowPoint(0.1, 0.2, 0.1, 0.1, 1.0, 2.0, 0.0);
  const SnowEdge edge = snow_edge(point, 0.1, 0.1, 1.0);
  const float height = thin_snow(edge, 0.1) + surface_relief(point, style, 0.1, 0.1) +
                       sagging(point, style, edge, 0.1, 0.1, 0.5);
  SnowFront front;
  front.distance = height;
  const SnowBehind behind = SnowBehind(0.1, 0.0, 0.0);
  const SnowJoin join = SnowJoin(0.0, 0.0);
  shown[0] = vec4(front_offset(front, style, behind, join, vec3(0.0, 0.0, 1.0), height, 0.0, 0.0), height);
}
"""


def test_the_rule_of_the_snow_surface_compiles_as_glsl(tmp_path):
    source = snowbough_testing.shader_source("snow_surface.h") + USES_THE_RULE
    assert complaints_of({"snow_surface.comp": source}, tmp_path) == []


def test_the_noise_of_the_snow_surface_compiles_as_glsl(tmp_path):
    source = snowbough_testing.shader_source("snow_noise.h") + (
        "layout(local_size_x = 8) in;\n"
        "layout(std430, binding = 0) buffer Values { float values[]; };\n"
        "void main() { values[0] = layered_noise(vec3(0.3), vec3(3.0, 1.4, 0.6), 0.5); }\n"
    )
    assert complaints_of({"snow_noise.comp": source}, tmp_path) == []

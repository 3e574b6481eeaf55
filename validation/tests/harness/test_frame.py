"""The frame as data: drivers run from the JSON of `validation/run plan` alone, docs/passes.md is made from it."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from support import called, load

from bokeh_validation import paths, shaders
from bokeh_validation.errors import UserError
from bokeh_validation.frame import apertures, methods
from bokeh_validation.frame import plan as frame
from bokeh_validation.shaders.passes import COPYING_ENTRIES, Pass, target_size

# The lens blurs the near and the far depths of `picture` by most of the height, so that every pass has work to do.
CAMERA = methods.Camera(aperture_diameter=0.4, focal_length=0.05, focus_distance=2.0, max_coc=0.8)
SIZE = (101, 77)
EVERY = [
    ("paper", "star", True),
    ("naive", "hexagon", True),
    ("exact", "octagon", True),
    ("exact", "octagon", False),
    ("layered", "hexagon", True),
    ("layered", "octagon", False),
    ("layered", "decagon", True),
]


def picture(size: tuple[int, int]) -> dict[str, np.ndarray]:
    """Colour and depth of blocks of 4 x 4 pixels: near, in focus, a little behind it, and far."""
    random = np.random.default_rng(5)
    wide, high = size
    color = np.ones((high, wide, 4), np.float16)
    color[..., :3] = random.exponential(1.0, (high, wide, 3))
    blocks = random.choice(np.float32([0.5, 1.0, 2.0, 2.2, 4.0, 50.0]), (-(-high // 4), -(-wide // 4)))
    return {"color": color, "depth": blocks.repeat(4, 0).repeat(4, 1)[:high, :wide].copy()}


def through_json(found: dict) -> dict:
    """What another program reads."""
    return json.loads(json.dumps(found, allow_nan=False))


def driven(driver, found: dict, color: np.ndarray, depth: np.ndarray, memory: bool = False) -> dict[str, np.ndarray]:
    """A frame on a driver, from its JSON and nothing else; with `memory`, targets share theirs. Texture -> pixels."""
    named = {t["name"]: f"memory {t['memory']}" if memory and t["written"] else t["name"] for t in found["textures"]}
    passes = []
    for step in found["passes"]:
        constants = dict(step["constants"])
        item = Pass(
            step["entry"],
            {source["slot"]: named[source["texture"]] for source in step["inputs"]},
            tuple(named[name] for name in step["targets"]),
            {**found["parameters"], **step["changes"]},
            constants.pop("BOKEH_NUM_SAMPLES"),
            constants,
            scale=step["scale"],
        )
        passes.append(item)
    textures = {"color": color, "depth": depth}
    for name, offsets in found["tables"].items():
        textures[name] = np.float32([[(x, y, 0.0, 0.0) for x, y in offsets]])
    wanted = [found["result"]] if memory else [name for step in found["passes"] for name in step["targets"]]
    output = driver.run(passes, textures, tuple(found["size"]), keep=[named[name] for name in wanted])
    return {name: output[named[name]] for name in wanted}


@pytest.mark.parametrize(("method", "aperture", "targets"), EVERY)
def test_a_driver_runs_from_the_json(method, aperture, targets):
    """Bit for bit what the harness itself draws, in every target, and each target of the size that the JSON says.

    Out of fewer targets too, which share their memory as `memory` says.
    """
    driver = load("osmesa")
    settings = methods.Settings(method, aperture, camera=CAMERA, targets=targets, rotation=10.0, squeeze=0.8)
    found = through_json(frame.frame(settings, SIZE))
    plan, textures = methods.plan(settings, SIZE), picture(SIZE)
    names = [name for item in plan.passes for name in item.outputs]
    wanted = driver.run(plan.passes, {**textures, **plan.tables}, SIZE, keep=names)
    output = driven(driver, found, **textures)
    assert list(output) == names
    for texture in found["textures"]:
        if texture["written"]:
            name = texture["name"]
            np.testing.assert_array_equal(output[name], wanted[name], err_msg=name)
            assert list(output[name].shape[1::-1]) == texture["size"]
    assert np.ptp(output["result"][..., :3].astype(float)) > 0.0
    shared = driven(driver, found, **textures, memory=True)["result"]
    np.testing.assert_array_equal(shared, output["result"])


@pytest.mark.parametrize("targets", [True, False])
@pytest.mark.parametrize("method", apertures.METHODS)
def test_every_frame_is_whole(method, targets):
    """What is read was written before or handed in, what is written is read; all is set free once, but the result.

    Textures share memory with their like, so that there is less of it.
    """
    allowed = methods.EXACT if method in ("exact", "layered") else apertures.NAMES
    for aperture in allowed:
        found = through_json(frame.frame(methods.Settings(method, aperture, targets=targets), (1921, 1081)))
        there = {"color", "depth", *found["tables"]}
        freed = []
        for number, step in enumerate(found["passes"], start=1):
            assert step["pass"] == number
            read = [source["texture"] for source in step["inputs"]]
            assert there.issuperset(read) and not there.intersection(step["targets"])
            assert step["size"] == list(target_size(step["scale"], (1921, 1081)))
            assert step["format"] == "RGBA16F" and step["define"] == shaders.glsl_pass(step["entry"])
            assert len(step["targets"]) == 1 or targets
            assert set(step["free"]) <= set(read)
            there = there.union(step["targets"]).difference(step["free"])
            freed += step["free"]
        assert there == {found["result"]} and len(freed) == len(set(freed)) == len(found["textures"]) - 1
        written = [texture for texture in found["textures"] if texture["written"]]
        kinds = {texture["memory"]: (*texture["size"], texture["format"], texture["bytes"]) for texture in written}
        for texture in written:
            assert kinds[texture["memory"]] == (*texture["size"], texture["format"], texture["bytes"])
        # RGBA16F: 8 bytes a texel
        assert all(size == 8 * wide * high for wide, high, _, size in kinds.values())
        assert found["bytes"] == sum(texture["bytes"] for texture in written)
        assert found["bytes_shared"] == sum(size for *_, size in kinds.values())
        assert found["bytes_shared"] < found["bytes"] or method == "naive"


# What docs/layers.md says of the targets that need two channels
TWO_CHANNELS = {"leftovers", "tile leftovers", "row leftovers", "shares", "sizes"}


def test_two_channels_are_enough():
    """The targets that docs/layers.md names may be RG16F: the same picture."""
    driver = load("osmesa")
    settings = methods.Settings("layered", "hexagon", camera=CAMERA, targets=False)
    passes, textures = methods.plan(settings, SIZE).passes, picture(SIZE)
    assert TWO_CHANNELS < {name for item in passes for name in item.outputs}
    main = "void main()\n{\n    whole();\n    BokehResult = vec4(BokehResult.rg, 0.0, 1.0);\n}\n"
    fewer = []
    for item in passes:
        if TWO_CHANNELS.issuperset(item.outputs):
            text = shaders.glsl(item.entry, "330", item.constants)
            item = replace(item, sources={"glsl": re.sub(r"\bvoid main\(\)", "void whole()", text) + main})
        fewer.append(item)
    wanted, output = (driver.run(each, textures, SIZE)["result"] for each in (passes, fewer))
    np.testing.assert_array_equal(output, wanted)


def counting(item: Pass, outputs: tuple[str, ...]) -> Pass:
    """A pass that writes how often it fetched in place of its result."""
    text = shaders.glsl(item.entry, "330", item.constants)
    head = re.compile(r"^(vec4 BokehFetch(?:Grid|Around|Nearest)\([^)]*\)\n\{\n)", re.MULTILINE)
    text, found = head.subn(r"\1    fetched += 1.0;\n", text)
    assert found == 3
    text, found = re.subn(r"\bvoid main\(\)", "void counted()", text)
    assert found >= 1
    version, rest = text.split("\n", 1)
    main = "void main()\n{\n    counted();\n    BokehResult = vec4(fetched);\n}\n"
    text = f"{version}\nfloat fetched = 0.0;\n{rest}\n{main}"
    return replace(item, output=outputs, sources={"glsl": text})


@pytest.mark.parametrize(("aperture", "preset", "targets"), [("hexagon", "medium", True), ("octagon", "low", False)])
def test_fetches_of_layered(aperture, preset, targets):
    """The largest number that any texel of a pass fetches, counted on a driver, is the one that is stated."""
    driver, size = load("osmesa"), (160, 120)
    settings = methods.Settings("layered", aperture, camera=CAMERA, preset=preset, targets=targets)
    found = frame.frame(settings, size)
    passes, names = [], []
    for number, item in enumerate(methods.plan(settings, size).passes):
        names.append(f"count {number}")
        others = tuple(f"count {number}, {k}" for k in range(1, len(item.outputs)))
        passes += [item, counting(item, (names[-1], *others))]
    output = driver.run(passes, picture(size), size, keep=names)
    for step, name in zip(found["passes"], names, strict=True):
        stated = step["fetches"]["color"] + step["fetches"]["depth"]
        assert output[name][..., 0].max() == stated, step["entry"]
    assert all(step["fetches"]["depth"] == (step["entry"] in COPYING_ENTRIES) for step in found["passes"])


def test_the_command(tmp_path):
    """`validation/run plan`: every pass in order with its textures, sizes and filters; the JSON is that of frame()."""
    target = tmp_path / "a frame.json"
    done = called("plan", "--method", "layered", "--size", "1921x1081", "--json", target)
    assert done.returncode == 0, done.stderr
    settings = methods.Settings("layered", "hexagon")
    found = frame.frame(settings, (1921, 1081))
    assert json.loads(target.read_text()) == through_json(found)
    assert done.stdout.splitlines() == list(frame.lines(found))
    heads = re.findall(r"^ *(\d+)  (\w+)  \((\w+)\)$", done.stdout, re.MULTILINE)
    plan = methods.plan(settings, (1921, 1081))
    entries = [(str(n), item.entry, shaders.glsl_pass(item.entry)) for n, item in enumerate(plan.passes, start=1)]
    assert heads == entries
    assert "writes tiles  (241 x 136 RGBA16F, 1/8)" in done.stdout
    assert "ColorSampE <- middle  (linear)" in done.stdout and "DepthSamp <- depth  (nearest)" in done.stdout


def test_json_to_standard_output(tmp_path, monkeypatch):
    """`--json -`: there is nothing but the JSON; the text for people goes to standard error, of this command alone."""
    monkeypatch.chdir(tmp_path)
    done = called("plan", "--method", "layered", "--json", "-")
    found = frame.frame(methods.Settings("layered"), (1920, 1080))
    assert done.returncode == 0 and json.loads(done.stdout) == through_json(found)
    assert done.stderr.splitlines() == list(frame.lines(found))
    assert called("plan", "--method", "layered").stdout == done.stderr
    assert list(tmp_path.iterdir()) == []


def test_passes_page_is_up_to_date():
    """Otherwise: validation/run plan --docs."""
    text = frame.PAGE.read_text(encoding="utf-8")
    assert frame.page(text) == text


@pytest.mark.parametrize("text", ["", frame.BEGIN, frame.END + frame.BEGIN, 2 * (frame.BEGIN + frame.END)])
def test_page_needs_its_markers(text):
    """A page without them is left alone."""
    with pytest.raises(UserError, match="markers"):
        frame.page(text)


def test_layers_page():
    """docs/layers.md: its presets are the code's, the passes that it names are those of a frame, in their order."""
    text = (paths.ROOT / "docs/layers.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `BOKEH_PRESET_(\w+)`[^|]*\| (\d+) \| (\d+) \| (\w+) \| (\d+) \|", text, re.MULTILINE)
    found = {}
    for name, rings, cells, enlarged, fetches in rows:
        found[name.lower()] = (int(rings), int(cells), {"bilinear": 0, "cubic": 1}[enlarged])
        stated = frame.frame(methods.Settings("layered", preset=name.lower()), frame.PAGE_SIZE)["fetches"]["color"]
        assert round(stated) == int(fetches), name
    assert found == methods.PRESETS
    named = list(dict.fromkeys(re.findall(r"^\d+\. \*\*(\w+)\*\*", text, re.MULTILINE)))
    steps = frame.frame(methods.Settings("layered"), SIZE)["passes"][1:]
    entries = dict.fromkeys(re.sub(r"Bokeh(?:Hexagon)?(?:Layer(?=[A-Z]))?", "", step["entry"]) for step in steps)
    assert named == list(entries)

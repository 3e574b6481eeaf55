"""The command `validation/run check`: after an edit of a shader, the little that it can have broken.

The functions whose code is not that of the last commit, all that call them, and the passes that do in the end. A pass
is drawn alone, on textures that the reference has made: nothing else is compiled.
"""

import re
import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np

from bokeh_validation import drivers, metrics, paths, shaders, terminal
from bokeh_validation.compilers import dxc, glslang, naga
from bokeh_validation.drivers.base import Driver, precision_of
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.frame import methods
from bokeh_validation.frame.methods import Settings
from bokeh_validation.reference import precision
from bokeh_validation.reference.device import Reference
from bokeh_validation.shaders import parity
from bokeh_validation.shaders.entries import ENTRIES

DRIVERS = {"glsl": "egl", "hlsl": "dxc", "wgsl": "wgpu"}
SIZE, VIEWPORT = (45, 29), (8, 8, 33, 17)
BAD_COLOR, BAD_DEPTH, BAD_SHARE = (np.nan, np.inf, -np.inf, -1.0, 6e-8), (np.nan, np.inf, -1.0, 0.0), 0.02
ALL = {"rotation": 17.0, "squeeze": 0.7, "bleeding_bias": 0.05, "bleeding_mult": 12.0}
ALL["camera"] = methods.Camera(0.5, 0.05, 4.0, sensor_height=0.02, max_coc=0.5)
ADAPTIVE = {"spacing": 1.5, "samples": 5, "jitter": 1.0, "frame": 61}
LENS = {"cats_eye": 0.7, "roundness": 0.5, **ALL}
# Everything away from its default, so that every entry of a method is drawn
FRAMES = (
    *(Settings("layered", name, jitter=0.5, frame=3, **ALL) for name in methods.EXACT),
    Settings("layered", "octagon", targets=False, jitter=1.0, **ALL),
    *(Settings("exact", name, **ADAPTIVE, **ALL) for name in methods.EXACT),
    Settings("exact", "decagon", targets=False, **ALL),
    Settings("exact", "hexagon", lateral=0.02, **ALL),
    Settings("paper", "hexagon", 8, **ALL),
    Settings("paper", "star", 4, blur_coc=False, **ALL),
    Settings("paper", "pentagon", **ADAPTIVE, **ALL),
    Settings("naive", "octagon", 6, **ALL),
    Settings("naive-grid", "square", 4, **ALL),
    Settings("paper", "square", coc=0.2, **ALL),
)
# Frames of programs with a constant that leaves code out
GUARDED = {
    "BOKEH_CHARACTER": (
        *(Settings("layered", "octagon", targets=several, **LENS) for several in (True, False)),
        *(Settings("exact", "octagon", axial=(0.05, -0.03), targets=several, **LENS) for several in (True, False)),
    ),
    "BOKEH_VIEWPORT": tuple(Settings(name, "hexagon", **ALL) for name in ("layered", "exact", "paper")),
}


def functions(text: str) -> tuple[dict[str, str], set[str]]:
    """Name -> code of every function, of entries with _PS or _VS; and the lines of code outside of them."""
    names = {shaders.glsl_pass(name): f"{name}_PS" for name in ENTRIES} | {"BOKEH_FULL_SCREEN": "BokehFullScreen_VS"}
    code, outside, end = {}, "", 0
    for match in shaders.FUNCTION.finditer(text):
        outside, end, name = outside + text[end : match.start()], match.end(), match["name"]
        if name == "main":
            name = names[re.findall(r"BOKEH_PASS == (\w+)", text[: match.start()])[-1]]
        # in HLSL two of one name stand in two branches of an #if
        code[name] = code.get(name, "") + " ".join(shaders.COMMENT.sub("", match["head"] + match["body"]).split())
    lines = shaders.COMMENT.sub("", outside + text[end:]).splitlines()
    return code, {line.strip() for line in lines if line.strip()}


def affected(before: str, after: str) -> tuple[set[str], set[str]]:
    """The functions whose code has changed, or that name what a changed line declares; they and all their callers."""
    (old, old_lines), (new, new_lines) = functions(before), functions(after)
    odd = {name for name in old.keys() | new.keys() if old.get(name) != new.get(name)}
    for line in old_lines ^ new_lines:
        declared = set(re.findall(r"\b(?:Bokeh|BOKEH_|bokeh)\w+", line))
        odd |= {name for name, code in new.items() if not declared or declared & set(re.findall(r"\w+", code))}
    reached, further = set(), odd
    while further:
        reached = reached | further
        further = {name for name, code in new.items() if further & set(re.findall(r"\w+(?=\()", code))} - reached
    return odd, reached


def _committed(key: str) -> str:
    """A file of the shaders as it is in the last commit, '' where it is new. Raises UserError outside of git."""
    git = ["git", "-C", str(paths.shaders())]
    if subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True).returncode:
        raise UserError(f"{paths.shaders()}: no git checkout. check looks at what has changed: clone the repository.")
    return subprocess.run([*git, "show", f"HEAD:./{key}"], capture_output=True, text=True).stdout


def _refused(language: str, entries: set[str]) -> Iterator[str]:
    """What one compiler of a language says of those that it does not take. Raises Unavailable."""
    vertex = naga.Stage(shaders.text("wgsl"), "BokehFullScreen_VS")
    for name in sorted(entries):
        if language == "glsl":
            result = glslang.parse(shaders.glsl(name), "frag")
        elif language == "hlsl":
            result = dxc.build(shaders.hlsl(6), "frag", f"{name}_PS")
        else:
            result = naga.build(vertex, replace(vertex, entry=f"{name}_PS", targets=ENTRIES[name].targets))
        if not result.ok:
            yield f"{language} {name}: {result.messages}"


def _wrong(settings: Settings, in_viewport: bool, used: Mapping[Driver, set[str]], here: set[str]) -> Iterator[str]:
    """The targets of the passes `here` that the reference does not allow, on random pixels, some of them hostile."""
    random, (width, height) = np.random.default_rng(1), SIZE
    color = random.lognormal(0.0, 1.0, (height, width, 4)).astype(np.float16)
    depth = np.kron(random.uniform(1.0, 30.0, (5, 8)), np.ones((6, 6)))[:height, :width].astype(np.float32)
    for pixels, bad in ((color, BAD_COLOR), (depth, BAD_DEPTH)):
        hostile = random.random(pixels.shape) < BAD_SHARE
        pixels[hostile] = random.choice(bad, hostile.sum())
    plan = methods.plan(settings, VIEWPORT[2:] if in_viewport else SIZE)
    plan = methods.in_viewport(plan, VIEWPORT, SIZE) if in_viewport else plan
    textures, names = {"color": color, "depth": depth, **plan.tables}, [n for item in plan.passes for n in item.outputs]
    made, wanted = {**textures, **Reference().run(plan.passes, textures, SIZE, keep=names)}, {}
    for driver, entries in used.items():
        device = (precision.SOFTWARE if driver.software else precision_of(driver.adapter)), driver.rounding
        if device not in wanted:
            wanted[device] = Reference().images(plan.passes, textures, SIZE, "half", *device, given=made)
        for item in plan.passes if here & entries else ():
            if item.entry in here & entries:
                inputs = {name: made[name] for name in item.inputs.values()}
                for name, pixels in driver.run([item], inputs, SIZE, keep=item.outputs).items():
                    if outside := metrics.compare(pixels, wanted[device][name], software=False).outside:
                        yield f"{driver.name}: {item.entry} writes {name!r} with {outside} wrong pixels"


def check() -> None:
    """What an edit of a shader can have broken: parity, rules, a compiler and a driver a language, within seconds."""
    changed, entries, guards, problems, skipped, used = set(), {}, {""}, [], [], {}
    for language in paths.LANGUAGES:
        keys = [files[language] for files in (parity.LIBRARY, parity.LAYERS, parity.PASSES)]
        before, after = "".join(map(_committed, keys)), shaders.text(language)
        if before != after:
            odd, reached = affected(before, after)
            code, everything = functions(after)[0], "BokehFullScreen_VS" in reached
            changed |= odd
            guards |= {guard for guard in GUARDED for name in reached if guard in code.get(name, "")}
            entries[language] = {name for name in ENTRIES if everything or f"{name}_PS" in reached}
    if not entries:
        terminal.tell("no shader differs from the last commit: nothing to check")
        return
    terminal.tell(f"changed: {', '.join(sorted(changed)) or 'comments only'}")
    problems += map(str, parity.check())
    for language, names in entries.items():
        try:
            refused = list(_refused(language, names))
            problems += refused
            if names and not refused:
                used[drivers.load(DRIVERS[language])] = names
        except Unavailable as error:
            skipped.append(f"{language} ({error})")
    left = set().union(*entries.values())
    for guard, frames in ({"": FRAMES} | GUARDED).items() if used else ():
        missing = set(left) if guard in guards else set()
        for settings in frames:
            drawn = {item.entry for item in methods.plan(settings, SIZE).passes} & missing
            missing -= drawn
            if drawn:
                problems += _wrong(settings, guard == "BOKEH_VIEWPORT", used, drawn)
        skipped += [f"{name}{' with ' * bool(guard)}{guard}" for name in sorted(missing)]
    names = ", ".join(driver.name for driver in used) or "no driver"
    terminal.tell(*problems[:24], f"{len(problems)} problems in parity, rules, {', '.join(entries)} and on {names}")
    terminal.tell(f"not run: {', '.join([*skipped, 'other drivers and compilers, probes, samples'])} (validation/test)")
    terminal.end(not problems)

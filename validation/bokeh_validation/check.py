"""The command `validation/run check`: after an edit of a shader, the little that it can have broken.

The programs whose code is not that of the last commit, each drawn as one pass of a small frame, on textures that the
reference has made: nothing else is compiled.
"""

import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

from bokeh_validation import drivers, paths, shaders, terminal
from bokeh_validation.compile_matrix import naga
from bokeh_validation.compilers import dxc, glslang
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.probes import coverage_frames, judges
from bokeh_validation.probes.judges import Frame
from bokeh_validation.shaders import calls, parity
from bokeh_validation.shaders.entries import ENTRIES

DRIVERS = {"glsl": "egl", "hlsl": "dxc", "wgsl": "wgpu"}
VERTEX = "BokehFullScreen_VS"
# Of a language: in the last commit, and now
Texts = tuple[str, str]


def _committed(key: str) -> str:
    """A file of the shaders as it is in the last commit, '' where it is new. Raises UserError outside of git."""
    # the checkout may be another user's
    git = ["git", "-c", "safe.directory=*", "-C", str(paths.shaders())]
    if subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True).returncode:
        raise UserError(f"{paths.shaders()}: no git checkout. check looks at what has changed: clone the repository.")
    return subprocess.run([*git, "show", f"HEAD:./{key}"], capture_output=True, text=True).stdout


def edited(texts: Texts, entry: str, constants: Mapping[str, int] | None = None) -> frozenset:
    """What is new in the program of an entry: its functions, and the lines that declare what they use."""
    before, after = ({}, {})
    for text, code in zip(texts, (before, after), strict=True):
        code |= calls.program(text, f"{entry}_PS", frozenset((constants or {}).items())) | calls.program(text, VERTEX)
        code["declared"] = calls.declared(text, code)
    return frozenset(after.items() - before.items())


def _refused(language: str, entries: set[str]) -> Iterator[str]:
    """What one compiler of a language says of those that it does not take. Raises Unavailable."""
    vertex = naga.Stage(shaders.text("wgsl"), VERTEX)
    for name in sorted(entries):
        if language == "glsl":
            result = glslang.parse(shaders.glsl(name), "frag")
        elif language == "hlsl":
            result = dxc.build(shaders.hlsl(6), "frag", f"{name}_PS")
        else:
            result = naga.build(vertex, replace(vertex, entry=f"{name}_PS", targets=ENTRIES[name].targets))
        if not result.ok:
            yield f"{language} {name}: {result.messages}"


def _wrong(used: Mapping[str, Driver], texts: Mapping[str, Texts], glsl: str) -> Iterator[str]:
    """The passes that are not what they were; of every edited code those of the first frame that has it.

    They are held to the GLSL of the last commit: an edit that is wrong in the same way in all languages shows, and what
    is edited is not what it is judged by. What differs there is held to the GLSL as it is as well: an edit that is
    meant to change pictures has to change them alike in all languages.
    """
    drawn = set()
    for label, frame in coverage_frames.all_frames().items():
        for language, driver in used.items() if not frame.main else ():
            codes = [edited(texts[language], item.entry, item.constants) for item in frame.passes]
            keys = [(language, item.entry, code) for item, code in zip(frame.passes, codes, strict=True)]
            new = {key for key in keys if key[2]} - drawn
            drawn |= new
            if new:
                yield from _differing(label, frame, driver, glsl, [key in new for key in keys])


def _differing(label: str, frame: Frame, driver: Driver, glsl: str, asked: Sequence[bool]) -> Iterator[str]:
    """What is wrong with those passes of a frame that are asked for."""
    device = driver.precision, driver.rounding
    try:
        before = judges.judges(label, frame, *device, glsl)
    except KeyError:
        # the last commit has not got what this frame draws
        before = [None] * len(frame.passes)
    objections = [judge.objection(driver) if judge and one else "" for judge, one in zip(before, asked, strict=True)]
    yield from (f"{driver.name}, by the last commit: {objection}" for objection in objections if objection)
    now = judges.judges(label, frame, *device) if any(objections) or None in before else []
    for judge, one, objection in zip(now, asked, objections, strict=False):
        if one and (objection or None in before) and (said := judge.objection(driver)):
            yield f"{driver.name}: {said}"


def check() -> None:
    """What an edit of a shader can have broken: parity, rules, a compiler and a driver a language, within seconds."""
    texts, entries, changed, problems, skipped, used = {}, {}, set(), [], [], {}
    keys = {language: [files[language] for files in parity.FILES.values()] for language in paths.LANGUAGES}
    committed = {language: "".join(map(_committed, files)) for language, files in keys.items()}
    for language, before in committed.items():
        after = shaders.text(language)
        if before != after:
            texts[language] = before, after
            changed |= {name for name, _ in calls.functions(after).items() ^ calls.functions(before).items()}
            entries[language] = {name for name in ENTRIES if edited(texts[language], name)}
    if not entries:
        terminal.tell("no shader differs from the last commit: nothing to check")
        return
    terminal.tell(f"changed: {', '.join(sorted(changed)) or 'no function'}")
    problems += map(str, parity.check())
    for language, names in entries.items():
        try:
            refused = list(_refused(language, names))
            problems += refused
            if names and not refused:
                used[language] = drivers.load(DRIVERS[language])
        except Unavailable as error:
            skipped.append(f"{language} ({error})")
    problems += _wrong(used, texts, committed["glsl"])
    names = ", ".join(driver.name for driver in used.values()) or "no driver"
    terminal.tell(*problems[:24], f"{len(problems)} problems in parity, rules, {', '.join(entries)} and on {names}")
    terminal.tell(f"not run: {', '.join([*skipped, 'other drivers and compilers, probes, samples'])} (validation/test)")
    terminal.end(not problems)

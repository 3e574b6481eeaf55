"""The command `validation/run check`: after an edit of a shader, the little that it can have broken.

The programs whose code is not that of the last commit, each drawn as one pass of a small frame, on textures that the
reference has made: nothing else is compiled.
"""

import subprocess
from collections.abc import Iterator, Mapping
from dataclasses import replace

from bokeh_validation import drivers, paths, shaders, terminal
from bokeh_validation.compile_matrix import naga
from bokeh_validation.compilers import dxc, glslang
from bokeh_validation.drivers.base import Driver
from bokeh_validation.errors import Unavailable, UserError
from bokeh_validation.probes import small_frames
from bokeh_validation.shaders import calls, parity
from bokeh_validation.shaders.entries import ENTRIES

DRIVERS = {"glsl": "egl", "hlsl": "dxc", "wgsl": "wgpu"}
VERTEX = "BokehFullScreen_VS"
# Of a language: in the last commit, and now
Texts = tuple[str, str]


def _committed(key: str) -> str:
    """A file of the shaders as it is in the last commit, '' where it is new. Raises UserError outside of git."""
    git = ["git", "-C", str(paths.shaders())]
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


def _wrong(used: Mapping[str, Driver], texts: Mapping[str, Texts]) -> Iterator[str]:
    """The passes that the reference does not allow; of every edited code those of the first frame that has it."""
    drawn = set()
    for label, frame in small_frames.all_frames().items():
        for language, driver in used.items() if not frame.main else ():
            codes = [edited(texts[language], item.entry, item.constants) for item in frame.passes]
            keys = [(language, item.entry, code) for item, code in zip(frame.passes, codes, strict=True)]
            new = {key for key in keys if key[2]} - drawn
            drawn |= new
            judges = small_frames.judges(label, frame, driver.precision, driver.rounding) if new else []
            for key, judge in zip(keys, judges, strict=False):
                if key in new and (objection := judge.objection(driver)):
                    yield f"{driver.name}: {objection}"


def check() -> None:
    """What an edit of a shader can have broken: parity, rules, a compiler and a driver a language, within seconds."""
    texts, entries, changed, problems, skipped, used = {}, {}, set(), [], [], {}
    for language in paths.LANGUAGES:
        keys = [files[language] for files in parity.FILES.values()]
        before, after = "".join(map(_committed, keys)), shaders.text(language)
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
    problems += _wrong(used, texts)
    names = ", ".join(driver.name for driver in used.values()) or "no driver"
    terminal.tell(*problems[:24], f"{len(problems)} problems in parity, rules, {', '.join(entries)} and on {names}")
    terminal.tell(f"not run: {', '.join([*skipped, 'other drivers and compilers, probes, samples'])} (validation/test)")
    terminal.end(not problems)

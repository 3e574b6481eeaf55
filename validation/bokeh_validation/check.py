"""Check an edit of a shader within seconds: the command `validation/run check`.

It looks only at programs whose code differs from the last commit. Each is drawn as one pass of a small frame, with
input textures computed by the reference; nothing else is compiled.
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
# The text of a language in the last commit, and now
Texts = tuple[str, str]


def _committed(key: str) -> str:
    """Return the text of a shader file in the last commit, or '' if the file is new.

    key  path of the file below the folder of the shaders, such as 'glsl/bokeh.glsl'
    Raises UserError outside a git checkout.
    """
    # git refuses a checkout that belongs to another user unless the checkout is marked as safe
    git = ["git", "-c", "safe.directory=*", "-C", str(paths.shaders())]
    if subprocess.run([*git, "rev-parse", "HEAD"], capture_output=True).returncode:
        raise UserError(f"{paths.shaders()}: no git checkout. check looks at what has changed: clone the repository.")
    return subprocess.run([*git, "show", f"HEAD:./{key}"], capture_output=True, text=True).stdout


def edited(texts: Texts, entry: str, constants: Mapping[str, int] | None = None) -> frozenset:
    """Return the functions and declarations of an entry's program that differ between the two texts.

    texts      the text of a language in the last commit, and now
    entry      name of the entry, without _PS
    constants  what the program is compiled with
    Returns (name, code) pairs, as they are now; 'declared' is the name for all lines that declare what the functions
    use.
    """
    old_code, new_code = ({}, {})
    for text, code in zip(texts, (old_code, new_code), strict=True):
        code |= calls.program(text, f"{entry}_PS", frozenset((constants or {}).items())) | calls.program(text, VERTEX)
        code["declared"] = calls.declared(text, code)
    return frozenset(new_code.items() - old_code.items())


def _refused(language: str, entries: set[str]) -> Iterator[str]:
    """Compile the entries with one compiler of the language and yield its messages for the entries that it rejects.

    Raises Unavailable if this machine lacks the compiler.
    """
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


def _wrong(by_language: Mapping[str, Driver], texts: Mapping[str, Texts], glsl: str) -> Iterator[str]:
    """Draw the edited passes and yield a line for each that is wrong.

    by_language  language -> driver that draws its programs
    texts        language -> its text in the last commit, and now
    glsl         the GLSL of the last commit, which the reference runs

    Each edited program is drawn in every frame that uses it, up to the first in which its result is not that of the
    GLSL of the last commit: so the same mistake in all three languages is noticed, also where few frames show it.
    A result that differs is also compared with the current GLSL: an edit that changes pixels on purpose must change
    them in the same way in every language.
    """
    differing = set()
    for label, frame in coverage_frames.all_frames().items():
        for language, driver in by_language.items() if not frame.main else ():
            codes = [edited(texts[language], item.entry, item.constants) for item in frame.passes]
            keys = [(language, item.entry, code) for item, code in zip(frame.passes, codes, strict=True)]
            undecided = {key for key in keys if key[2]} - differing
            if undecided:
                objections = _objections(label, frame, driver, glsl, [key in undecided for key in keys])
                differing |= {key for key, lines in zip(keys, objections, strict=True) if lines}
                yield from sum(objections, [])


def _objections(label: str, frame: Frame, driver: Driver, glsl: str, is_edited: Sequence[bool]) -> list[list[str]]:
    """Return what is wrong with the edited passes of a frame, one list of lines per pass.

    `is_edited` has one bool per pass.
    """
    device, lines = (driver.precision, driver.rounding), [[] for _ in frame.passes]
    try:
        old_judges = judges.judges(label, frame, *device, glsl)
    except KeyError:
        # the last commit lacks a function or parameter that this frame needs
        old_judges = [None] * len(frame.passes)
    for judge, edited_here, found in zip(old_judges, is_edited, lines, strict=True):
        if judge and edited_here and (objection := judge.objection(driver)):
            found.append(f"{driver.name}, by the last commit: {objection}")
    new_judges = judges.judges(label, frame, *device) if any(lines) or None in old_judges else []
    for old, new, edited_here, found in zip(old_judges, new_judges, is_edited, lines, strict=False):
        if edited_here and (found or old is None) and (objection := new.objection(driver)):
            found.append(f"{driver.name}: {objection}")
    return lines


def check() -> None:
    """Check what an edit of a shader can have broken: parity, rules, one compiler and one driver per language."""
    texts, entries, changed, problems, skipped, usable_drivers = {}, {}, set(), [], [], {}
    keys = {language: [files[language] for files in parity.FILES.values()] for language in paths.LANGUAGES}
    committed = {language: "".join(map(_committed, files)) for language, files in keys.items()}
    for language, old_text in committed.items():
        new_text = shaders.text(language)
        if old_text != new_text:
            texts[language] = old_text, new_text
            changed |= {name for name, _ in calls.functions(new_text).items() ^ calls.functions(old_text).items()}
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
                usable_drivers[language] = drivers.load(DRIVERS[language])
        except Unavailable as error:
            skipped.append(f"{language} ({error})")
    problems += _wrong(usable_drivers, texts, committed["glsl"])
    names = ", ".join(driver.name for driver in usable_drivers.values()) or "no driver"
    terminal.tell(*problems[:24], f"{len(problems)} problems in parity, rules, {', '.join(entries)} and on {names}")
    terminal.tell(f"not run: {', '.join([*skipped, 'other drivers and compilers, probes, samples'])} (validation/test)")
    terminal.end(not problems)

"""Write the repository's addresses into every package: `validation/run generate --repository ADDRESS`.

The checkout does not know where it is published, so manifests have no addresses until this command sets them. The
READMEs that stores show without the rest of the repository get absolute links.
"""

import json
import posixpath
import re

from bokeh_validation import __version__, paths
from bokeh_validation.errors import UserError

ADDRESS = re.compile(r"https://[\w.-]+(?:/[\w.~-]+)+?(?:\.git)?/?")
PYPROJECT = "integration/panda3d/pyproject.toml"
# Folder of a package -> the relative links of its README whose targets its archive contains; () if it has none of them
READMES = {
    "integration/panda3d": (),
    "integration/unity": (),
    "integration/wgpu": ("picture.png",),
    "integration/bevy": ("picture.png",),
}


def with_repository(address: str) -> dict[str, str]:
    """Return path below the checkout -> text of each manifest and README with these addresses, which replace earlier
    ones.

    address  of the repository's page, such as https://example.com/owner/name

    Raises UserError for anything else.
    """
    if not ADDRESS.fullmatch(address):
        raise UserError(f"--repository {address}: not an address. Give one like https://example.com/owner/name.")
    page = address.rstrip("/").removesuffix(".git")
    files = f"{page}/blob/v{__version__}"

    def git(folder: str) -> dict[str, str]:
        return {"type": "git", "url": f"git+{page}.git", "directory": folder}

    changed = {
        "integration/web/package.json": _json(
            "integration/web/package.json",
            "license",
            {"repository": git("integration/web"), "homepage": f"{page}#readme", "bugs": f"{page}/issues"},
        ),
        "integration/unity/package.json": _json(
            "integration/unity/package.json",
            "license",
            {
                "documentationUrl": f"{files}/integration/unity/README.md",
                "changelogUrl": f"{files}/CHANGELOG.md",
                "licensesUrl": f"{files}/LICENSE",
                "repository": git("integration/unity"),
            },
        ),
    }
    plugin = "integration/unreal/BokehDepthOfField/BokehDepthOfField.uplugin"
    guide = f"{files}/integration/unreal/README.md"
    changed[plugin] = _json(
        plugin, "CreatedBy", {"CreatedByURL": page, "DocsURL": guide, "SupportURL": f"{page}/issues"}
    )
    for crate in ("bevy", "wgpu"):
        name = f"integration/{crate}/Cargo.toml"
        changed[name] = _line(name, r'^license = "MIT"$', r'^repository = ".*"$', f'repository = "{page}"')
    urls = f'[project.urls]\nRepository = "{page}"\nIssues = "{page}/issues"\n'
    text = re.sub(r"\n\[project\.urls\]\n(?:.+\n)*", "", _text(PYPROJECT))
    changed[PYPROJECT] = f"{text.rstrip()}\n\n{urls}"
    changed["CITATION.cff"] = _line(
        "CITATION.cff", r"^license: MIT$", r"^repository-code: .*$", f"repository-code: {page}"
    )
    return changed | {f"{folder}/README.md": _readme(folder, page) for folder in READMES}


def _readme(folder: str, page: str) -> str:
    """Return the text of a README whose links to what its archive lacks are absolute, at the tag of this version.

    Images are linked by their raw address.
    """

    def absolute(match: re.Match) -> str:
        image, text, target = match.groups()
        target = re.sub(r"^https://.*?/(?:blob|raw)/v\d[^/]*/", posixpath.relpath(".", folder) + "/", target)
        if ":" in target or target.startswith("#") or target in READMES[folder]:
            return f"{image}[{text}]({target})"
        path = posixpath.normpath(posixpath.join(folder, target))
        return f"{image}[{text}]({page}/{'raw' if image else 'blob'}/v{__version__}/{path})"

    return re.sub(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)", absolute, _text(f"{folder}/README.md"))


def _text(name: str) -> str:
    return (paths.ROOT / name).read_text(encoding="utf-8")


def _json(name: str, after: str, values: dict[str, object]) -> str:
    """Return the text of a JSON manifest with these values after the key `after`; earlier values of their keys are
    removed.
    """
    text = _text(name)
    indent = re.search(r"^( +)\"", text, re.MULTILINE)[1]
    for key in values:
        text = re.sub(rf'^{indent}"{key}": .*,\n', "", text, flags=re.MULTILINE)
    lines = "".join(f"{indent}{json.dumps(key)}: {json.dumps(value)},\n" for key, value in values.items())
    return re.sub(rf'^({indent}"{after}": .*,\n)', lambda match: match[1] + lines, text, count=1, flags=re.MULTILINE)


def _line(name: str, after: str, old: str, line: str) -> str:
    """Return the text of a manifest with a line after another one; an earlier one that matches `old` is removed."""
    text = re.sub(rf"{old}\n", "", _text(name), flags=re.MULTILINE)
    return re.sub(after, lambda match: f"{match[0]}\n{line}", text, count=1, flags=re.MULTILINE)

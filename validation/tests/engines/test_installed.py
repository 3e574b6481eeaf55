"""An archive of validation/run release, installed into an empty project: it does what the sample does."""

import json
import re

import pytest
from support import needed

from bokeh_validation import engines, paths, release
from bokeh_validation.engines import pages

ENGINE = "threejs"


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """Folder with the sample's own files and its package from the archive, without the checkout's."""
    root = tmp_path_factory.mktemp(ENGINE)
    name, files = release.npm(ENGINE)
    release.pack(root / name, files)
    manifest = json.loads(files["package/package.json"].read_bytes())
    folder = root / "integration" / ENGINE
    folder.mkdir(parents=True)
    # what finds the package in the checkout
    lines = re.compile(rf'"(bokeh-{ENGINE}/|\./)[\w.]*": "[^"]*",\s*')
    installed = f'"imports": {{ "bokeh-{ENGINE}/": "./node_modules/bokeh-{ENGINE}/", '
    for path in (paths.ROOT / "integration" / ENGINE).iterdir():
        if path.suffix in (".js", ".html") and path.name not in manifest["files"]:
            page = lines.sub("", path.read_text(encoding="utf-8")).replace('"imports": { ', installed)
            (folder / path.name).write_text(page, encoding="utf-8")
    (folder / "package.json").write_text("{}")
    ((engine_package, version),) = manifest["devDependencies"].items()
    with needed("npm"):
        pages.call_npm(folder, "install", root / name, f"{engine_package}@{version}")
    return root


@pytest.mark.parametrize("kind", ["webgl", "webgpu"])
def test_npm_page(project, kind, tmp_path):
    """The sample's page on the installed package: every shot within the reference's interval."""
    with needed(ENGINE):
        pages.run(f"{ENGINE}-{kind}", tmp_path, project)
    shots = engines.read(tmp_path).shots
    assert shots
    for shot in shots:
        assert shot.comparison.outside == 0, f"{shot.name}: {shot.comparison}, {shot.outside}"

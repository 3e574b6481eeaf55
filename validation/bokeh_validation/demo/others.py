"""Depth of field by other libraries, for the page: three.js's and pmndrs', as the peers draw them."""

import base64
import gzip
import json
import re

from bokeh_validation.errors import Unavailable
from bokeh_validation.truth.peers import effects
from bokeh_validation.truth.peers.effects import EFFECTS

# Each after those that it imports
THREE = (
    "build/three.core.js",
    "build/three.module.js",
    *(f"examples/jsm/{name}.js" for name in ("postprocessing/Pass", "shaders/CopyShader", "shaders/BokehShader")),
    *(f"examples/jsm/postprocessing/{name}.js" for name in ("MaskPass", "ShaderPass", "RenderPass", "EffectComposer")),
    "examples/jsm/postprocessing/BokehPass.js",
)
FILES = (*(f"three/{name}" for name in THREE), "postprocessing/build/index.js")
OWN = ("feed.js", "three_webgl.js")
NAMED = {"three": "three.module.js", "postprocessing": "index.js"}
FROM = re.compile(r"""\bfrom\s*(['"])(?:(three|postprocessing)|[./\w-]*?([\w.]+\.js))\1""")
# What was best for market_7, times what the documentation asks for (docs/effects.md); other options
FACTORS = {
    "BokehPass": ({"aperture": 1.12, "maxblur": 0.7}, {}),
    "DepthOfFieldEffect": ({"focusRange": 0.5, "bokehScale": 0.35}, {"resolutionScale": 0.5}),
}


def listed() -> dict:
    """Name -> what the page is told of each; none where npm is missing."""
    try:
        modules = effects.installed()
    except Unavailable:
        return {}
    versions = effects.versions([modules], FACTORS)
    return {
        name: {
            "title": EFFECTS[name].title,
            "version": versions[EFFECTS[name].package],
            "factors": factors,
            "options": options,
        }
        for name, (factors, options) in FACTORS.items()
    }


def packed() -> str:
    """The libraries as the page takes them: base64 of gzip of JSON, [[name, text], ..], imports by "bokeh/NAME"."""
    files = [effects.installed() / name for name in FILES] + [effects.PAGE / name for name in OWN]
    texts = [[file.name, FROM.sub(_from, file.read_text(encoding="utf-8"))] for file in files]
    return base64.b64encode(gzip.compress(json.dumps(texts).encode(), mtime=0)).decode("ascii")


def _from(found: re.Match) -> str:
    return f'from "bokeh/{found[3] or NAMED[found[2]]}"'

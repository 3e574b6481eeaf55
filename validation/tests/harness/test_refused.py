"""Test bad options of every command: one line says what is wrong and what is allowed, exit code 2,
nothing is written.
"""

import shlex
import subprocess

import pytest
from support import called, refused

from bokeh_validation import paths

# command and options | words that the line must have
REFUSED = """
render --depth-channel depth | no depth channel 'depth'; B G R Z
render --focus-distance 0.05 | --focus-distance 0.05; focal length 0.05
render --f-stop 0 | --f-stop 0: not allowed; more than 0
render --bokeh-scale -1 | --bokeh-scale -1: not allowed; 0 or more
render --f-stop 2 --aperture-diameter 0.1 | --f-stop 2: no effect with --aperture-diameter
render --coc 0.5 | --coc 0.5; --max-coc
render --samples 1 | --samples 1; 2 to 1024
render --samples 200 --method naive | --samples 200; 8192
render --aperture circle | --aperture circle; hexagon
render --method fast | --method fast; paper
render --aperture star | --aperture star; layered; --method paper
render --squeeze 0 | --squeeze 0; more than 0
render --cats-eye 0.3 --method paper | --cats-eye 0.3: no effect on paper. Give --method exact or layered
render --samples 5 --method layered | --samples 5: no effect on layered; --preset
render --coc 0.1 --depth-channel Z | --depth-channel Z: no effect with --coc
render --rotation inf | --rotation inf
render --depth-channel '' | --depth-channel; empty
render --driver '' | --driver ; osmesa
render --driver d3d12 | --driver d3d12; osmesa
render --driver egl --adapter 'no such card' | no such card
render --png /no/such/folder/x.png | /no/such/folder
plan --method layered --aperture star | --aperture star; octagon
plan --size ١٩٢٠x1080 | --size; 1920x1080
plan --size 1920 | --size 1920; 1920x1080
plan --size 99999x9 | --size 99999x9; 2 to 16384
plan --jitter 1 --method paper | --jitter 1: no effect; --spacing
demo --output /no/such/folder/x.html | /no/such/folder
demo --data /no/such/folder | /no/such/folder
peers --effect Unreal | --effect Unreal; BokehPass
peers --scene x | --scene x; market_7
peers --motion walk | --motion walk: unknown. Give one of still, pan
peers --motion pan --scene market_7 | --motion pan; Leave out --scene
peers --search /no/such/p.json | /no/such/p.json; no folder
pictures --driver d3d12 | --driver d3d12; osmesa
pictures figure_99 | figure_99; figure_13
pictures --output /no/such/folder/x | /no/such/folder
pictures --output /dev/null | --output /dev/null; no such folder
probes --driver egl --adapter 'no such card' | no such card; llvmpipe
bench --size 800 | --size 800; 1920x1080
bench --rounds 0 | --rounds; 3
bench --driver nvidia | --driver nvidia; wgpu
bench --driver egl --adapter nothing | nothing; llvmpipe
bench --pack /no/such/folder/x | /no/such/folder; Make it first
bench --pack x --driver egl | --pack; --driver
bench --pack x --judge | --pack; --judge
bench --wheels | --wheels; --pack
bench --json /nowhere/b.json | /nowhere/b.json; no folder
aperture --sides 3 --vertices '0,0 1,0 1,1' | --sides; --vertices
aperture --sides 2 | --sides 2; 3 to 24
aperture --sides 17 | 17; at most 12
aperture --vertices '0,0 0.1,0 half' | --vertices; half; x,y
aperture --vertices '0,0 0.1,0 nan,0.2' | corners; up to 2
aperture --vertices '0.1,0.1 0.1,0.1 0.1,0.1' | 1 different corners; three
aperture --vertices '0,0 0.1,0 0.2,0' | thin; 0.01
aperture --vertices '0,0 0.4,0 0.1,0.1 0,0.4' | not convex
aperture --vertices '0,-0.5 0.294,0.405 -0.476,-0.155 0.476,-0.155 -0.294,0.405' | not convex
truth --method blur | --method blur: unknown. Give one of pinhole, paper, exact, gather, layered mobile, layered low
truth --method "layered best" | --method layered best: unknown; layered mobile, layered low, layered medium
truth --scene street | --scene street: unknown. Give one of market_7, street_11, canopy_12
truth --method layered --scene street | --scene street: unknown
truth --random 0 | --random 0: not allowed. Give 1 to 10000
truth --random 3 --motion pan | --random and --motion; Give one of them
truth --random 3 --seed -1 | --seed -1: not allowed; 0 or more
truth --seed 3 | --seed 3; with --random N
truth --motion walk | --motion walk: unknown. Give one of still, pan; all.
truth --motion pan --method "gather, jitter" | gather, jitter: unknown; layered medium, jitter
"""


@pytest.mark.parametrize("row", REFUSED.strip().splitlines())
def test_bad_option(row, tmp_path, monkeypatch):
    """Check the message, and that an existing output is left unchanged."""
    monkeypatch.chdir(tmp_path)
    options, _, words = row.partition(" | ")
    command, *options = shlex.split(options)
    output = {"render": [paths.SCENES / "street_11_pin.exr", "-o", "out"]}
    given = output.get(command, []) if "--output" not in options else []
    if command == "render":
        (tmp_path / "out").write_text("precious")
    refused(called(command, *given, *options), words.split("; "))
    assert [path.read_text() for path in tmp_path.iterdir()] == ["precious"] * (command == "render")


def test_bad_adapter_of_the_whole_run(tmp_path):
    """Check that without a command, too, a mistyped --adapter is refused instead of skipping all that needs it."""
    words = (paths.VALIDATION / "run", "--adapter", "no such card", "-o", tmp_path / "report.html")
    done = subprocess.run(words, capture_output=True, text=True)
    (line,) = done.stderr.splitlines()
    assert done.returncode == 2 and line.startswith("error: ") and "no such card" in line and "llvmpipe" in line
    assert not list(tmp_path.iterdir())

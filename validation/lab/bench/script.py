"""Time depth of field on this machine's GPU, each pass with the GPU's timestamps. Needs Python 3.11 and this folder:

    python3 -m pip install --no-deps -r requirements.txt    # with a folder wheels: --no-index --find-links wheels too
    python3 bench.py                                        # a minute; writes times.json, the file to send in

frames.json has what `validation/run plan` prints for each method. All frames are drawn in turn, in a different order
each round.
"""

import argparse
import ctypes.util
import json
import os
import platform
import random
import struct
import sys
import time
import zlib
from datetime import date
from pathlib import Path

HERE = Path(__file__).resolve().parent
FORMATS = {"RGBA16F": ("rgba16float", 8), "R32F": ("r32float", 4)}  # WebGPU's name, bytes per texel
PICTURES = {"color": "RGBA16F", "depth buffer": "R32F"}
BACKENDS, KINDS = ("Vulkan", "Metal", "D3D12"), ("DiscreteGPU", "IntegratedGPU", "Unknown", "CPU")
TIMER, MOST_STAMPS = "timestamp-query", 4096  # timestamps of a query set
SHORTEST, ROUNDS = 0.02, 3  # seconds: shorter frames are drawn repeatedly; the minimum of rounds
COLUMNS = ("pass", "median ms", "a tenth is below", "nine tenths are below")
AGREES = (0.8, 1.05)  # range of the fraction of the elapsed time that the timer must report

DISAGREES = "Not to be trusted: the timer shows {:.2f} of the time on the clock."


def refuse(text: str) -> None:
    """Print one line and exit with code 2."""
    print(f"error: {text}", file=sys.stderr)
    sys.exit(2)


class GPU:
    """Choose the adapter whose name contains `part`, preferably a GPU, and create a device on it."""

    def __init__(self, part: str = "", folder: Path = HERE):
        self.folder, loader = folder, folder / "wheels" / "libvulkan.so.1"
        if loader.exists() and not ctypes.util.find_library("vulkan"):
            ctypes.CDLL(str(loader))  # other code then finds it by its name
        os.environ.setdefault("XDG_RUNTIME_DIR", "/tmp")  # otherwise Mesa complains on standard error
        try:
            import wgpu
        except ImportError as error:
            refuse(f"{error}. Install requirements.txt, as the top of bench.py says.")
        found = [one for one in wgpu.gpu.enumerate_adapters_sync() if one.info["backend_type"] in BACKENDS]
        found = [one for one in found if TIMER in one.features and part.lower() in one.info["device"].lower()]
        if not found:
            refuse(f"no adapter {part or 'at all'} with timestamps in Vulkan, Metal or Direct3D 12.")
        adapter = min(found, key=lambda one: KINDS.index(one.info["adapter_type"]))
        self.wgpu, self.info = wgpu, dict(adapter.info)
        self.name = "{device}, {backend_type}, {description}: {adapter_type}".format(**self.info)
        self.device = adapter.request_device_sync(required_features=[TIMER])
        period = wgpu.backends.wgpu_native._api.libf.wgpuQueueGetTimestampPeriod
        self.tick = period(self.device.queue._internal) * 1e-6  # milliseconds; on AMD a tick has 10 ns

    def texture(self, size: list[int], kind: str, file: Path | None = None):
        """Create a texture of zeros, or with the content of a file."""
        use, (name, texel) = self.wgpu.TextureUsage, FORMATS[kind]
        use = use.RENDER_ATTACHMENT | use.COPY_SRC | use.COPY_DST | use.TEXTURE_BINDING
        made = self.device.create_texture(size=(*size, 1), format=name, usage=use)
        if file:
            layout = {"bytes_per_row": texel * size[0], "rows_per_image": size[1]}
            self.device.queue.write_texture({"texture": made}, zlib.decompress(file.read_bytes()), layout, made.size)
        return made


def wgsl(gpu: GPU, plan: dict, item: dict, module) -> tuple[dict, dict]:
    """Return the vertex and the fragment stage of a pass, from the unchanged shaders."""
    program = plan["programs"]["wgsl"]
    constants = (plan["preset"] or {}).get("stands_for", {}) | item["constants"]
    fragment = {"entry_point": program["entry"].format(**item)}
    fragment["constants"] = {name: float(value) for name, value in constants.items()}
    return {"module": module, "entry_point": program["vertex_entry"]}, {"module": module, **fragment}


def textures(gpu, plan: dict, pool: dict) -> dict:
    """Return name -> texture on `gpu` for a plan of frames.json; `pool` holds textures that plans share."""
    found = {}
    for texture in plan["textures"]:
        name, size, kind = texture["name"], texture["size"], texture["format"] or PICTURES[texture["name"]]
        file = gpu.folder / "{}-{}x{}.bin".format(name, *size) if texture["format"] is None else None
        key = file or (texture["memory"], *size, kind)
        found[name] = pool[key] = pool.get(key) or gpu.texture(size, kind, file)
    return found


class Frame:
    """Draw a plan of frames.json.

    stages  makes the stages of a pass from `program`, like wgsl()
    """

    def __init__(self, gpu: GPU, plan: dict, program, pool: dict, stages=wgsl):
        self.gpu, self.plan, self.textures = gpu, plan, textures(gpu, plan, pool)
        self.stages = lambda item: stages(gpu, plan, item, program)
        self.steps = [self._step(item, plan["parameters"] | item["changes"]) for item in plan["passes"]]

    def _step(self, item: dict, values: dict[str, float]) -> tuple:
        """Return (pipeline, bind group, targets)."""
        device, wgpu, plan = self.gpu.device, self.gpu.wgpu, self.plan
        block = struct.pack(f"{len(values)}f", *map(values.get, plan["block"]["order"]))
        block = block.ljust(4 * plan["block"]["floats"], b"\0")
        buffer = device.create_buffer_with_data(data=block, usage=wgpu.BufferUsage.UNIFORM)
        bound = [(plan["bindings"]["parameters"], {"buffer": {}}, {"buffer": buffer, "size": len(block)})]
        sampler = device.create_sampler(min_filter="linear", mag_filter="linear")
        bound.append((plan["bindings"]["sampler"], {"sampler": {}}, sampler))
        for read in item["inputs"]:
            kind = {"texture": {"sample_type": "float" if read["filter"] == "linear" else "unfilterable-float"}}
            bound.append((read["binding"], kind, self.textures[read["texture"]].create_view()))
        layout = [{"binding": at, "visibility": wgpu.ShaderStage.FRAGMENT, **kind} for at, kind, _ in bound]
        layout = device.create_bind_group_layout(entries=layout)
        vertex, fragment = self.stages(item)
        views = [self.textures[name].create_view() for name in item["targets"]]
        pipeline = device.create_render_pipeline(
            layout=device.create_pipeline_layout(bind_group_layouts=[layout]),
            vertex=vertex,
            fragment={**fragment, "targets": [{"format": view.texture.format} for view in views]},
        )
        bound = [{"binding": at, "resource": resource} for at, _, resource in bound]
        targets = [{"view": view, "load_op": "clear", "store_op": "store"} for view in views]
        return pipeline, device.create_bind_group(layout=layout, entries=bound), targets

    def drawn(self, repeats: int = 1) -> tuple[float, list[list[float]]]:
        """Draw `repeats` times without a pause; returns the elapsed milliseconds, and for each draw two timestamps per
        pass.
        """
        device, use, count = self.gpu.device, self.gpu.wgpu.BufferUsage, 2 * len(self.steps)
        encoder, total = device.create_command_encoder(), count * repeats
        answer = device.create_buffer(size=8 * total, usage=use.QUERY_RESOLVE | use.COPY_SRC)
        stamps = {"query_set": device.create_query_set(type="timestamp", count=total)}
        for number, (pipeline, bindings, targets) in enumerate(self.steps * repeats):
            stamps |= {"beginning_of_pass_write_index": 2 * number, "end_of_pass_write_index": 2 * number + 1}
            draw = encoder.begin_render_pass(color_attachments=targets, timestamp_writes=stamps)
            draw.set_pipeline(pipeline)
            draw.set_bind_group(0, bindings)
            draw.draw(self.plan["vertex"]["vertices"])
            draw.end()
        encoder.resolve_query_set(stamps["query_set"], 0, total, answer, 0)
        commands, begin = encoder.finish(), time.perf_counter()
        device.queue.submit([commands])
        ticks = struct.unpack(f"{total}Q", device.queue.read_buffer(answer))  # waits until the GPU has finished
        wall, times = (time.perf_counter() - begin) * 1e3, [(tick - ticks[0]) * self.gpu.tick for tick in ticks]
        return wall, [times[first : first + count] for first in range(0, total, count)]


def measured(frames: dict, seconds: float, rounds: int = ROUNDS) -> dict:
    """Time frames in at least `rounds` rounds and `seconds` seconds.

    Returns the fraction of the elapsed time that the timer reports, and COLUMNS of each frame and its passes.
    """
    repeats, shares, seen = {}, [], {key: [] for key in frames}
    for key, frame in frames.items():
        frame.drawn()  # compiles what is compiled on first use
        repeats[key] = min(MOST_STAMPS // (2 * len(frame.steps)), int(SHORTEST * 1e3 / frame.drawn()[0]) + 1)
    end = time.perf_counter() + seconds
    while len(shares) < rounds * len(frames) or time.perf_counter() < end:
        for key in random.sample(list(frames), len(frames)):
            wall, each = frames[key].drawn(repeats[key])
            shares.append((each[-1][-1] - each[0][0]) / wall)
            for one in each:
                passes = (after - before for before, after in zip(one[::2], one[1::2], strict=True))
                seen[key].append([one[-1] - one[0], *passes])
    rows = {}
    for key, frame in frames.items():
        names = ["whole frame", *(item["entry"] for item in frame.plan["passes"])]
        columns = zip(names, map(sorted, zip(*seen[key], strict=True)), strict=True)
        rows[key] = [[name, *(round(ms[len(ms) * part // 10], 5) for part in (5, 1, 9))] for name, ms in columns]
    return {"timer": sorted(shares)[len(shares) // 2], "frames": rows}


def show(size: str, found: dict) -> None:
    """Print a table for each method, with a row for each pass."""
    print(f"\n{size}, milliseconds, median")
    for method in dict.fromkeys(key.split()[0] for key in found["frames"]):
        columns = {key.partition(" ")[2]: rows for key, rows in found["frames"].items() if key.split()[0] == method}
        print(f"{method:26}" + "".join(f"{preset:>10}" for preset in columns))
        for row in zip(*columns.values(), strict=True):
            print(f"  {row[0][0]:24}" + "".join(f"{one[1]:10.3f}" for one in row))
    if not AGREES[0] <= found["timer"] <= AGREES[1]:
        print(DISAGREES.format(found["timer"]))


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.error = refuse
    parser.add_argument("--adapter", default="", help="part of a device's name")
    parser.add_argument("--seconds", type=float, default=20.0, help="that each size takes, 20")
    options = parser.parse_args()
    pack, gpu = json.loads((HERE / "frames.json").read_bytes()), GPU(options.adapter)
    text = "".join((HERE / name).read_text("ascii") for name in pack["files"])
    found = {"version": pack["version"], "shaders": f"{zlib.crc32(text.encode()):08x}", "adapter": gpu.info}
    found |= {"system": platform.platform(), "date": date.today().isoformat(), "columns": COLUMNS, "sizes": {}}
    print(gpu.name)
    module = gpu.device.create_shader_module(code=text)
    for name, plans in pack["sizes"].items():
        pool = {}
        frames = {key: Frame(gpu, plan, module, pool) for key, plan in plans.items()}
        found["sizes"][name] = measured(frames, options.seconds)
        show(name, found["sizes"][name])
        Path("times.json").write_text(json.dumps(found) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()

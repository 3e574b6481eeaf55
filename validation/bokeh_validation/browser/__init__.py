"""Headless Chromium with a page in it: that of the browser drivers and compilers (page/), an engine's sample, others.

A browser is started on first use, asked by one call at a time, and gone when the process ends. Playwright's event loop
would be in the way of others in the same thread. So it has a thread of its own, and a caller waits with a time limit.
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
# Debian's name, Ubuntu's (there a snap, which works as well), and Google's own packages
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
INSTALL = f"{needs.install('chromium')}, or set {VARIABLE} to a Chromium"
OLDEST = 140  # the first with Uint8Array.fromBase64

# The browser serves one page from memory: it has nothing to ask of any network. A software device may take long over
# one draw, and that is no reason to stop it: the limits below are ours.
FLAGS = (
    "--disable-background-networking --disable-component-update --disable-domain-reliability --disable-sync "
    "--disable-breakpad --disable-quic --no-first-run --no-pings --metrics-recording-only --disable-gpu-watchdog "
    "--disable-background-timer-throttling --enable-unsafe-webgpu "
    # the software device that comes with Chromium
    "--use-angle=swiftshader --enable-unsafe-swiftshader --use-webgpu-adapter=swiftshader"
).split() + ["--host-resolver-rules=MAP * ~NOTFOUND"]

START_LIMIT = 60.0  # seconds; it takes 1
RUN_LIMIT = 120.0  # 640 x 480 takes 1 on two cores
STOP_LIMIT = 40.0  # Playwright kills a browser that does not end within 30

TEMPORARY = {"prefix": "bokeh-chromium-", "ignore_cleanup_errors": True}
LONGEST_FOLDER = 40  # characters of the folder for temporary files
# Of what the page logged, an error repeats so many messages, and so many characters of each
MESSAGES, WORDS = 4, 800

PAGE = Path(__file__).parent / "page"
# [whether it returned, the value or the text of what it threw]: the page catches its own errors, so that they are not
# taken for Playwright's
CALL = """async (argument) => {
    try { return [true, await window.bokeh.%s(argument)]; }
    catch (error) { return [false, error.message ?? String(error)]; }
}"""
# WebGPU is for secure pages only. Nothing leaves the process: every request is answered from files.
ADDRESS = "https://bokeh.invalid/"


class BrowserError(RuntimeError):
    """The browser crashed, hung or could not be asked; the text says which. The next session() is a new one."""


class Refused(RuntimeError):
    """A function of the page threw an Error: its text."""


# Beginning of an address below ADDRESS -> the folder that has what is asked for, or the content itself
Places = Sequence[tuple[str, Path | bytes]]


class Session:
    """One browser with a page in it. Any thread may call it; as a context it is closed at the end.

    page     Playwright's, of its async interface
    version  of Chromium
    said     errors that the page wrote to the console since the last call
    dead     why call() cannot work any more; '' while it can
    """

    def __init__(
        self,
        address: str = "index.html",
        places: Places = (("", PAGE),),
        script: str = "",
        flags: Sequence[str] = (),
        limit: float = RUN_LIMIT,
    ):
        """Start it. Raises Unavailable where there is no Chromium, no Playwright, or it does not start.

        address  of the page, which must make window.bokeh; below ADDRESS, or a whole one
        places   tried in this order for each request
        script   runs before the page's own
        flags    more of the command line
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
        """Call window.bokeh.<function>(argument) and return what it returns (texts, numbers, lists, dicts).

        Raises BrowserError, and Refused also where something was only logged.
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
            # one mistake in the library is logged once for every pass
            said = [text[:WORDS] for text in dict.fromkeys(self.said)][:MESSAGES]
            self.said.clear()
        if said or not returned:
            raise Refused("\n".join(said if returned else [value, *said]))
        return value

    def work(self, step: Coroutine, limit: float = RUN_LIMIT) -> object:
        """What a step with Playwright's page returns. Raises TimeoutError after `limit` seconds."""
        return asyncio.run_coroutine_threadsafe(step, _loop()).result(limit)

    def close(self) -> None:
        """End the browser."""
        self.dead = self.dead or "Chromium was closed"
        with suppress(Exception):  # a browser that is dead already
            self.work(self._stack.aclose(), STOP_LIMIT)

    async def _open(self, path: str, flags: Sequence[str], address: str, places: Places, script: str) -> None:
        """Start the browser and load the page."""
        # Chromium makes a socket in there, and the path of a socket has at most 107 characters
        near = "/tmp" if os.path.isdir("/tmp") and len(tempfile.gettempdir()) > LONGEST_FOLDER else None
        folder = self._stack.enter_context(tempfile.TemporaryDirectory(dir=near, **TEMPORARY))
        try:
            from playwright.async_api import async_playwright
        except ImportError:
            raise Unavailable(f"Playwright, which drives Chromium, is not installed; {needs.install('web')}") from None

        # the browser's profile is where the driver has its temporary files; there is no parameter for that
        with patch.dict(os.environ, TMPDIR=folder):
            playwright = await async_playwright().start()
        self._stack.push_async_callback(playwright.stop)
        browser = await playwright.chromium.launch(
            executable_path=path,
            headless=True,
            # it refuses to start with a sandbox as root
            chromium_sandbox=not hasattr(os, "geteuid") or os.geteuid() != 0,
            args=[*FLAGS, *flags],
            # its crash reports go to the user's configuration folder otherwise, and its sockets to /tmp
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
    """Playwright's. Its thread is a daemon, or a browser that does not answer would keep Python from ending."""
    loop = asyncio.new_event_loop()
    threading.Thread(target=loop.run_forever, name="chromium", daemon=True).start()
    return loop


def executable() -> str:
    """Path of Chromium. Raises Unavailable."""
    named = os.environ.get(VARIABLE)
    for name in (named,) if named else NAMES:
        if path := shutil.which(name):
            return path
    missing = f"{VARIABLE} names no program: {named}" if named else f"Chromium is not on this machine; {INSTALL}"
    raise Unavailable(missing)


async def _answer(route, places: Places) -> None:
    """Answer a request of a page."""
    name = route.request.url.removeprefix(ADDRESS).partition("?")[0]
    for beginning, source in places:
        if isinstance(source, bytes):
            if name == beginning:
                return await route.fulfill(body=source, content_type=mimetypes.guess_type(name)[0])
        elif name.startswith(beginning) and (file := source / name.removeprefix(beginning)).is_file():
            return await route.fulfill(path=file)
    return await route.fulfill(status=204 if name == "favicon.ico" else 404)


def _cause(error: BaseException) -> str:
    """The telling line of a Playwright error, which holds all that Chromium printed."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    telling = ("FATAL", "error while loading", "cannot open")
    return next((line for line in lines if any(word in line for word in telling)), lines[0] if lines else repr(error))


_running: list[Session] = []
_guard = threading.Lock()


def session() -> Session:
    """The browser of this process, a new one where the last has died. Raises Unavailable."""
    with _guard:
        if not _running or _running[-1].dead:
            _running[:] = [Session()]
        return _running[-1]

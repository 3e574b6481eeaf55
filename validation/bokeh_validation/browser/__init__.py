"""Headless Chromium with a page in it: that of the browser drivers and compilers (page/), an engine's sample, others.

A browser is started on first use, asked by one call at a time, and gone when the process ends. Playwright's calls
without async belong to the thread that started it, and its event loop would be in the way of others in the same thread.
So the browser has a thread of its own, and a caller waits for it with a time limit.
"""

import atexit
import mimetypes
import os
import queue
import shutil
import signal
import tempfile
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from unittest.mock import patch

from bokeh_validation.errors import Unavailable

VARIABLE = "BOKEH_CHROMIUM"
# Debian's name, Ubuntu's (there a snap, which works as well), and Google's own packages
NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
INSTALL = (
    "apt-get install -y --no-install-recommends chromium (Ubuntu, where that is a snap: install google-chrome, "
    f"or set {VARIABLE} to a Chromium)"
)
OLDEST = 140  # the first with Uint8Array.fromBase64

# The browser serves one page from memory: it has nothing to ask of any network. A software device may take long over
# one draw, and that is no reason to stop it: the limits below are ours.
FLAGS = (
    "--disable-background-networking --disable-component-update --disable-domain-reliability --disable-sync "
    "--disable-breakpad --disable-quic --no-first-run --no-pings --metrics-recording-only --disable-gpu-watchdog "
    "--disable-background-timer-throttling --enable-unsafe-webgpu"
).split() + ["--host-resolver-rules=MAP * ~NOTFOUND"]
# the software device that comes with Chromium
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--use-webgpu-adapter=swiftshader")
# whatever GPU the machine has; Chromium's list of drivers that it does not trust is about web pages
HARDWARE = ("--ignore-gpu-blocklist", "--use-angle=vulkan", "--enable-features=Vulkan")

START_LIMIT = 60.0  # seconds; it takes 1
COMPILE_LIMIT = 30.0  # a shader takes 0.05
RUN_LIMIT = 120.0  # 640 x 480 takes 1 on two cores
STOP_LIMIT = 10.0

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

    version  of Chromium
    said     errors that the page wrote to the console: since it was opened if the session is strict, else in the last
             call
    dead     why call() cannot work any more; '' while it can
    """

    def __init__(
        self,
        address: str = "index.html",
        places: Places = (("", PAGE),),
        script: str = "",
        hardware: bool = False,
        flags: Sequence[str] = (),
        strict: bool = False,
        limit: float = RUN_LIMIT,
        **tab: object,
    ):
        """Start it. Raises Unavailable where there is no Chromium, no Playwright, or it does not start.

        address  of the page, which must make window.bokeh; below ADDRESS, or a whole one
        places   tried in this order for each request
        script   runs before the page's own
        flags    more of the command line
        strict   a call fails also where something was only logged
        limit    seconds that a call may take
        tab      options of Playwright's new_page()
        """
        path = _chromium()
        self.said: list[str] = []
        self._strict, self._limit = strict, limit
        self.version = ""
        self._process = 0
        self._crashes: list[str] = []
        self.dead = ""
        self._stack = ExitStack()
        self._jobs: queue.SimpleQueue = queue.SimpleQueue()
        self._lock = threading.Lock()
        # a daemon, or a browser that does not answer would keep Python from ending
        self._thread = threading.Thread(target=self._work, name="chromium", daemon=True)
        self._thread.start()

        def start() -> None:
            browser = self._launched(path, [*FLAGS, *(HARDWARE if hardware else SOFTWARE), *flags])
            self._page = self._opened(browser.new_page(**tab), address, places, script)

        try:
            self._ask(start).result(START_LIMIT)
        except TimeoutError:
            self._kill()
            raise Unavailable(f"{path} hung: it did not start within {START_LIMIT:g} s") from None
        except Unavailable:
            self.close()
            raise
        except Exception as error:
            self.close()
            raise Unavailable(f"{path} did not start: {_cause(error)}") from error

    def __enter__(self) -> "Session":
        return self

    def __exit__(self, *_) -> None:
        self.close()

    def call(self, function: str, argument: object = None, limit: float | None = None) -> object:
        """Call window.bokeh.<function>(argument) and return what it returns (texts, numbers, lists, dicts).

        limit   seconds until the browser is taken for hung and killed
        Raises Refused and BrowserError, with what the page logged.
        """
        limit = limit or self._limit
        with self._lock:
            if not self._strict:
                self.said.clear()
            if self.dead:
                raise BrowserError(self.dead)
            try:
                returned, value = self._ask(lambda: self._page.evaluate(CALL % function, argument)).result(limit)
            except TimeoutError:
                self.dead = f"Chromium hung: stopped after {limit:g} s"
                self._kill()
            except Exception as error:
                self.dead = self._crashes[0] if self._crashes else f"Chromium crashed: {_cause(error)}"
            if self.dead:
                self.close()
                raise BrowserError(self._with_messages(self.dead))
        if not returned:
            raise Refused(self._with_messages(value))
        if self._strict and self.said:
            raise Refused(self._with_messages())
        return value

    def work(self, step: Callable) -> object:
        """What step(Playwright's page) returns."""
        return self._ask(lambda: step(self._page)).result(self._limit)

    def _with_messages(self, *texts: str) -> str:
        """Texts, and the first messages of the page: one mistake in the library is logged once for every pass."""
        return "\n".join([*texts, *(text[:WORDS] for text in [*dict.fromkeys(self.said)][:MESSAGES])])

    def close(self) -> None:
        """End the browser: asked first, killed where it does not listen."""
        self.dead = self.dead or "Chromium was closed"
        self._jobs.put(None)
        self._thread.join(STOP_LIMIT)
        if self._thread.is_alive():
            self._kill()
            self._thread.join(STOP_LIMIT)

    def _kill(self) -> None:
        """End the browser and all its processes without asking."""
        with suppress(ProcessLookupError):
            if self._process:
                os.killpg(self._process, signal.SIGKILL)  # Playwright starts it in a group of its own

    def _work(self) -> None:
        """The browser's thread: do jobs until there is a None, then end the browser."""
        while (job := self._jobs.get()) is not None:
            action, answer = job
            try:
                answer.set_result(action())
            except BaseException as error:  # it belongs to whoever waits, not to this thread
                answer.set_exception(error)
        with suppress(Exception):  # a browser that is dead already
            self._stack.close()

    def _ask(self, action: Callable[[], object]) -> Future:
        """Have the browser's thread do something."""
        answer: Future = Future()
        self._jobs.put((action, answer))
        return answer

    def _launched(self, path: str, flags: list[str]):
        """Playwright's browser."""
        # Chromium makes a socket in there, and the path of a socket has at most 107 characters
        near = "/tmp" if os.path.isdir("/tmp") and len(tempfile.gettempdir()) > LONGEST_FOLDER else None
        folder = self._stack.enter_context(tempfile.TemporaryDirectory(dir=near, **TEMPORARY))
        browser = self._stack.enter_context(_playwright(folder)).chromium.launch(
            executable_path=path,
            headless=True,
            # it refuses to start with a sandbox as root
            chromium_sandbox=not hasattr(os, "geteuid") or os.geteuid() != 0,
            args=flags,
            # its crash reports go to the user's configuration folder otherwise, and its sockets to /tmp
            env={**os.environ, "TMPDIR": folder, "XDG_CONFIG_HOME": folder, "XDG_CACHE_HOME": folder},
            timeout=START_LIMIT * 1000,
        )
        self._stack.callback(browser.close)
        client = browser.new_browser_cdp_session()
        processes = client.send("SystemInfo.getProcessInfo")["processInfo"]
        client.detach()
        self._process = next((int(process["id"]) for process in processes if process["type"] == "browser"), 0)
        self.version = browser.version
        if int(self.version.split(".")[0]) < OLDEST:
            raise Unavailable(f"{path} is Chromium {self.version}; it has to be {OLDEST} or later")
        return browser

    def _opened(self, page, address: str, places: Places, script: str):
        """Playwright's page, loaded."""
        page.set_default_timeout(START_LIMIT * 1000)
        page.on("console", lambda message: self.said.append(message.text) if message.type == "error" else None)
        page.on("pageerror", lambda error: self.said.append(error.message))
        page.on("crash", lambda _: self._crashes.append("Chromium crashed: the page's process ended"))
        if ":" not in address:
            address = ADDRESS + address
            page.route("**/*", lambda route: _answer(route, places))
        page.add_init_script(script)
        page.goto(address)
        page.wait_for_function("window.bokeh !== undefined")
        return page


def _chromium() -> str:
    """Path of Chromium. Raises Unavailable."""
    named = os.environ.get(VARIABLE)
    for name in (named,) if named else NAMES:
        if path := shutil.which(name):
            return path
    missing = f"{VARIABLE} names no program: {named}" if named else f"Chromium is not on this machine; {INSTALL}"
    raise Unavailable(missing)


@contextmanager
def _playwright(folder: str) -> Iterator:
    """Playwright with its temporary files, the browser's profile among them, in a folder of ours.

    It leaves them behind when the browser is killed. There is no parameter for the place.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise Unavailable(f"{error.name} is not installed; validation/run sets it up") from error
    with patch.dict(os.environ, TMPDIR=folder):
        playwright = sync_playwright().start()
    yield playwright
    playwright.stop()


def _answer(route, places: Places) -> None:
    """Answer a request of a page."""
    name = route.request.url.removeprefix(ADDRESS).partition("?")[0]
    kind = "text/javascript" if name.endswith(".js") else mimetypes.guess_type(name)[0] or "text/plain"
    for beginning, source in places:
        content = None
        if isinstance(source, bytes):
            content = source if name == beginning else None
        elif name.startswith(beginning) and ".." not in name:
            file = source / name.removeprefix(beginning)
            content = file.read_bytes() if file.is_file() else None
        if content is not None:
            route.fulfill(body=content, content_type=kind)
            return
    route.fulfill(status=204 if name == "favicon.ico" else 404)


def _cause(error: BaseException) -> str:
    """The telling line of a Playwright error, which holds all that Chromium printed."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    telling = ("FATAL", "error while loading", "cannot open")
    return next((line for line in lines if any(word in line for word in telling)), lines[0] if lines else repr(error))


_sessions: dict[bool, Session | Unavailable] = {}
_guard = threading.Lock()


def session(hardware: bool = False) -> Session:
    """The browser of this process, a new one where the last has died. Raises Unavailable, the same each time."""
    with _guard:
        running = _sessions.get(hardware)
        if running is None or (isinstance(running, Session) and running.dead):
            try:
                running = Session(hardware=hardware)
                atexit.register(running.close)
            except Unavailable as error:
                running = error
            _sessions[hardware] = running
    if isinstance(running, Unavailable):
        raise running
    return running

"""One running Chromium: started on first use, asked by one call at a time, gone when the process ends.

Playwright's calls without async belong to the thread that started it, and its event loop would be in the way of others
in the same thread. So the browser has a thread of its own, and a caller waits for it with a time limit.
"""

import atexit
import mimetypes
import os
import queue
import shutil
import signal
import tempfile
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import Future, TimeoutError
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from bokeh_validation.browser import chromium
from bokeh_validation.errors import Unavailable

START_LIMIT = 60.0  # seconds; it takes 1
COMPILE_LIMIT = 30.0  # a shader takes 0.05
RUN_LIMIT = 120.0  # 640 x 480 takes 1 on two cores
STOP_LIMIT = 10.0

LONGEST_FOLDER = 40  # characters of the folder for temporary files

PAGE = Path(__file__).parent / "page"
# WebGPU is for secure pages only. Nothing leaves the process: every request is answered from PAGE.
ADDRESS = "https://bokeh.invalid/"


class BrowserError(RuntimeError):
    """The browser crashed, hung or could not be asked; the text says which. The next session() is a new one."""


class Refused(RuntimeError):
    """A function of the page threw an Error: its text."""


class Session:
    """One browser with the page in it. Any thread may call it.

    version  of Chromium
    """

    def __init__(self, hardware: bool = False, open_page: Callable | None = None, flags: Sequence[str] = ()):
        """Start it. Raises Unavailable where there is no Chromium, no Playwright, or it does not start.

        open_page   of Playwright's browser: opens a page that has window.bokeh, and returns it. Default: that of page/
        flags       more of the command line
        """
        path = chromium.find()
        self.version = ""
        self._process = 0
        self._dead = ""
        self._jobs: queue.SimpleQueue = queue.SimpleQueue()
        self._lock = threading.Lock()
        started: Future = Future()
        work = partial(self._work, path, [*chromium.flags(hardware), *flags], open_page or _open_page, started)
        # a daemon, or a browser that does not answer would keep Python from ending
        self._thread = threading.Thread(target=work, name="chromium", daemon=True)
        self._thread.start()
        try:
            started.result(START_LIMIT)
        except Unavailable:
            raise
        except TimeoutError:
            self._kill()
            raise Unavailable(f"{path} hung: it did not start within {START_LIMIT:g} s") from None
        except Exception as error:
            raise Unavailable(f"{path} did not start: {_cause(error)}") from error

    @property
    def alive(self) -> bool:
        """Whether call() can be expected to work."""
        return not self._dead and self._thread.is_alive()

    def call(self, function: str, argument: object = None, limit: float = RUN_LIMIT) -> object:
        """Call window.bokeh.<function>(argument) and return what it returns (texts, numbers, lists, dicts).

        limit   seconds until the browser is taken for hung and killed
        Raises Refused and BrowserError.
        """
        with self._lock:
            if not self.alive:
                raise BrowserError(self._dead or "Chromium has ended")
            answer: Future = Future()
            self._jobs.put((function, argument, answer))
            try:
                kind, value = answer.result(limit)
            except TimeoutError:
                self._dead = f"Chromium hung: stopped after {limit:g} s"
                self._kill()
                self.close()
                raise BrowserError(self._dead) from None
        if kind == "returned":
            return value
        if kind == "threw":
            raise Refused(value)
        self._dead = value
        self.close()
        raise BrowserError(value)

    def close(self) -> None:
        """End the browser: asked first, killed where it does not listen."""
        self._dead = self._dead or "Chromium was closed"
        self._jobs.put(None)
        self._thread.join(STOP_LIMIT)
        if self._thread.is_alive():
            self._kill()
            self._thread.join(STOP_LIMIT)

    def _kill(self) -> None:
        """End the browser and all its processes without asking."""
        if not self._process:
            return
        try:
            if os.getpgid(self._process) == self._process:  # Playwright starts it in a group of its own
                os.killpg(self._process, signal.SIGKILL)
            else:
                os.kill(self._process, signal.SIGKILL)
        except ProcessLookupError:
            pass

    def _work(self, path: str, flags: list[str], open_page: Callable, started: Future) -> None:
        """The browser's thread: start it, answer jobs until there is a None, end it."""
        # Chromium makes a socket in there, and the path of a socket has at most 107 characters
        near = "/tmp" if os.path.isdir("/tmp") and len(tempfile.gettempdir()) > LONGEST_FOLDER else None
        folder = tempfile.mkdtemp(prefix="bokeh-chromium-", dir=near)
        try:
            with _playwright(folder) as playwright:
                browser = playwright.chromium.launch(
                    executable_path=path,
                    headless=True,
                    chromium_sandbox=chromium.sandboxed(),
                    args=flags,
                    # its crash reports go to the user's configuration folder otherwise, and its sockets to /tmp
                    env={**os.environ, "TMPDIR": folder, "XDG_CONFIG_HOME": folder, "XDG_CACHE_HOME": folder},
                    timeout=START_LIMIT * 1000,
                )
                try:
                    self._process = _process_of(browser)
                    self.version = browser.version
                    if int(self.version.split(".")[0]) < chromium.OLDEST:
                        raise Unavailable(f"{path} is Chromium {self.version}; it has to be {chromium.OLDEST} or later")
                    page = open_page(browser)
                    started.set_result(None)
                    self._answer(page)
                finally:
                    browser.close()
        except BaseException as error:  # it belongs to whoever waits, not to this thread
            if not started.done():
                started.set_exception(error)
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _answer(self, page) -> None:
        crashes: list[str] = []
        page.on("crash", lambda _: crashes.append("Chromium crashed: the page's process ended"))
        while (job := self._jobs.get()) is not None:
            function, argument, answer = job
            answer.set_result(_evaluate(page, function, argument, crashes))


@contextmanager
def _playwright(folder: str):
    """Playwright with its temporary files, the browser's profile among them, in a folder of ours.

    It leaves them behind when the browser is killed. There is no parameter for the place.
    """
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise Unavailable(f"{error.name} is not installed; validation/run sets it up") from error
    before = os.environ.get("TMPDIR")
    os.environ["TMPDIR"] = folder
    try:
        playwright = sync_playwright().start()
    finally:
        if before is None:
            del os.environ["TMPDIR"]
        else:
            os.environ["TMPDIR"] = before
    try:
        yield playwright
    finally:
        playwright.stop()


def _evaluate(page, function: str, argument: object, crashes: list[str]) -> tuple[str, object]:
    """('returned', value), ('threw', text) or ('died', text)."""
    # the page catches its own errors, so that they are not taken for Playwright's
    script = f"""async (argument) => {{
        try {{ return ["returned", await window.bokeh.{function}(argument)]; }}
        catch (error) {{ return ["threw", error.message ?? String(error)]; }}
    }}"""
    try:
        kind, value = page.evaluate(script, argument)
        return kind, value
    except Exception as error:
        return "died", crashes[0] if crashes else f"Chromium crashed: {_cause(error)}"


def _open_page(browser):
    """The page of page/, loaded."""
    page = browser.new_page()
    page.set_default_timeout(START_LIMIT * 1000)
    page.route("**/*", _serve)
    page.goto(ADDRESS)
    page.wait_for_function("window.bokeh !== undefined")
    return page


def _serve(route) -> None:
    name = route.request.url.removeprefix(ADDRESS) or "index.html"
    file = PAGE / name
    if file.parent != PAGE or not file.is_file():
        route.fulfill(status=404)
        return
    kind = "text/javascript" if file.suffix == ".js" else mimetypes.guess_type(name)[0]
    route.fulfill(body=file.read_bytes(), content_type=kind)


def _process_of(browser) -> int:
    """Id of the browser's main process, 0 if it does not say."""
    client = browser.new_browser_cdp_session()
    told = client.send("SystemInfo.getProcessInfo")["processInfo"]
    client.detach()
    return next((int(process["id"]) for process in told if process["type"] == "browser"), 0)


def _cause(error: BaseException) -> str:
    """The telling line of a Playwright error, which holds all that Chromium printed."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    telling = ("FATAL", "error while loading", "cannot open")
    return next((line for line in lines if any(word in line for word in telling)), lines[0] if lines else repr(error))


_sessions: dict[bool, Session] = {}
_failed: dict[bool, Unavailable] = {}
_start = threading.Lock()


def session(hardware: bool = False) -> Session:
    """The browser of this process, a new one where the last has died. Raises Unavailable, the same each time."""
    with _start:
        running = _sessions.get(hardware)
        if running is None or not running.alive:
            if hardware in _failed:
                raise _failed[hardware]
            try:
                _sessions[hardware] = Session(hardware)
            except Unavailable as error:
                _failed[hardware] = error
                raise
        return _sessions[hardware]


@atexit.register
def _close_all() -> None:
    for running in _sessions.values():
        running.close()

"""Headless Chromium: WebGL 2 and WebGPU in a page of ours, for the browser drivers and compilers.

chromium.py   where the browser is and how it is started
session.py    one running browser and the page in it
page/         the page: JavaScript modules, a function for each kind of job
"""

from bokeh_validation.browser.chromium import INSTALL
from bokeh_validation.browser.session import COMPILE_LIMIT, BrowserError, Refused, Session, session

__all__ = ["COMPILE_LIMIT", "INSTALL", "BrowserError", "Refused", "Session", "session"]

// Opens a page in headless Chromium. All requests are answered here, from files, so no server listens on a port.

import { readFileSync, statSync } from 'node:fs';
import { dirname, extname } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { errorsOf, launched } from './chromium.js';

// The folder integration/, and the folder node_modules with the packages that package.json names
export const INTEGRATION = fileURLToPath(new URL('../..', import.meta.url));
export const MODULES = `${dirname(dirname(fileURLToPath(import.meta.resolve('playwright-core/package.json'))))}/`;

// Only pages with https have WebGPU
const ADDRESS = 'https://bokeh.invalid/';
const TYPES = { '.css': 'text/css', '.html': 'text/html', '.js': 'text/javascript', '.png': 'image/png' };
const START_LIMIT = 60_000; // milliseconds until the page has started, which usually takes 2000
const CALL_LIMIT = 240_000; // milliseconds for a call; the longest takes 30000

// Starts a browser for several pages, one after another. The caller must close it.
export const started = (flags = []) => launched(chromium, flags);

// Opens page.html, which must set window.bokeh to an object of functions.
//   places   [[beginning of an address, folder or Buffer], ...]; the first that has the requested file answers
//   browser  the browser to open the page in; by default a new one
// Returns { page, call(name, argument), close() }. `page` is Playwright's. `call` calls a function of window.bokeh, and
// also throws the errors that the page has written to the console since the last call.
export async function opened(places, flags = [], browser = null) {
  const own = browser ?? (await started(flags));
  const page = await own.newPage();
  const errors = errorsOf(page);
  const throwErrors = () => {
    if (errors.length) throw new Error([...new Set(errors.splice(0))].join('\n'));
  };
  const close = () => (browser ? page : own).close();
  try {
    await page.route('**/*', (route) => answer(route, places));
    await page.goto(`${ADDRESS}page.html`);
    await page.waitForFunction(() => window.bokeh, null, { timeout: START_LIMIT });
  } catch (error) {
    await close();
    throw new Error([error.message, ...errors].join('\n'), { cause: error });
  }
  const call = async (name, argument) => {
    const evaluated = page.evaluate(([name, argument]) => window.bokeh[name](argument), [name, argument]);
    const value = await within(CALL_LIMIT, evaluated, name);
    throwErrors();
    return value;
  };
  return { page, call, close };
}

function answer(route, places) {
  const name = decodeURI(new URL(route.request().url()).pathname.slice(1));
  const contentType = TYPES[extname(name)];
  for (const [beginning, source] of places) {
    if (Buffer.isBuffer(source) ? name !== beginning : !name.startsWith(beginning)) continue;
    if (Buffer.isBuffer(source)) return route.fulfill({ body: source, contentType });
    const path = `${source}/${name.slice(beginning.length)}`;
    if (statSync(path, { throwIfNoEntry: false })?.isFile()) return route.fulfill({ body: readFileSync(path), contentType });
  }
  return route.fulfill({ status: name === 'favicon.ico' ? 204 : 404 });
}

// Resolves as the promise does, or throws an Error after `limit` milliseconds.
function within(limit, promise, what) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`${what}: not done after ${limit / 1000} s`)), limit);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

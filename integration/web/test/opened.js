// A page in headless Chromium, served from files: nothing listens on a port, every request is answered from here.

import { readFileSync, statSync } from 'node:fs';
import { dirname, extname } from 'node:path';
import { fileURLToPath } from 'node:url';
import { chromium } from 'playwright-core';
import { errorsOf, launched } from './chromium.js';

// integration/, and the folder node_modules that has what package.json names
export const INTEGRATION = fileURLToPath(new URL('../..', import.meta.url));
export const MODULES = `${dirname(dirname(fileURLToPath(import.meta.resolve('playwright-core/package.json'))))}/`;

// WebGPU is for secure pages only
const ADDRESS = 'https://bokeh.invalid/';
const TYPES = { '.css': 'text/css', '.html': 'text/html', '.js': 'text/javascript', '.png': 'image/png' };
const START_LIMIT = 60_000; // milliseconds; it takes 2000
const CALL_LIMIT = 240_000; // of a call; the longest takes 30000

// Start a browser for several pages, one after another; the caller closes it.
export const started = (flags = []) => launched(chromium, flags);

// Open page.html. `places` is [[beginning of an address, folder or Buffer], ...], tried in this order. The page makes
// window.bokeh, an object of functions. Without a `browser` it is opened in a new one. Returns
// { page, call(name, argument), close() }: `page` is Playwright's, and a call throws also what the page only wrote to
// the console since the last one.
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

// What a promise gives, or an error after so many milliseconds
function within(limit, promise, what) {
  let timer;
  const late = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error(`${what}: not done after ${limit / 1000} s`)), limit);
  });
  return Promise.race([promise, late]).finally(() => clearTimeout(timer));
}

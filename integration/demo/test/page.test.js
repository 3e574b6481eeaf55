// Tests the built page in headless Chromium, opened from disk and from a host, with its controls.
//
// The environment variable BOKEH_PAGE names a folder that validation/lab/tests/test_demo.py writes. It contains:
//   page.html  the page as one file
//   site/      the page for a host
//   given/     files to open, and cases.json, which says what to draw from them
//   drawn/     the folder for the images, which Python compares with the reference

import assert from "node:assert/strict";
import { readFileSync, statSync, writeFileSync } from "node:fs";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { chromium } from "playwright-core";
import { errorsOf, launched } from "../../web/test/chromium.js";
import { median, steady } from "../src/steady.js";
import * as hand from "./hand.js";

const FOLDER = process.env.BOKEH_PAGE;
const given = (name) => readFileSync(`${FOLDER}/given/${name}`);
const SIZE = [960, 540]; // size of the scene market_7
const FOCUS = 2.42; // focus distance of that scene in metres

let browser;
let page;
let errors;
const requests = [];

before(async () => {
  assert.ok(FOLDER, "BOKEH_PAGE is not set: run validation/test validation/lab/tests/test_demo.py");
  browser = await launched(chromium);
  page = await browser.newPage({ hasTouch: true });
  errors = errorsOf(page);
  page.on("request", (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(`${FOLDER}/page.html`).href);
  await page.evaluate(() => bokeh.ready);
});

after(() => browser?.close());

const set = (values, exactly = {}) => page.evaluate(hand.set, [values, exactly]);
const opened = (...files) => page.evaluate(hand.open, files.map(([name, data]) => [name, data.toString("base64")]));
const choose = (index) => page.evaluate((index) => bokeh.choose(index), index);

// Writes images of a side to drawn/, as "LABEL NAME.f32".
async function leave(label, side, names) {
  for (const [name, image] of await page.evaluate(hand.pictures, [side, names])) {
    assert.equal(image.format, "rgba32float");
    writeFileSync(`${FOLDER}/drawn/${label} ${name}.f32`, Buffer.from(image.data, "base64"));
  }
}

function between(value, least, most, what) {
  assert.ok(least <= value && value <= most, `${what} is ${value}, not between ${least} and ${most}`);
}

test("pictures for the judge", async (t) => {
  for (const { label, files, controls, exactly, keep } of JSON.parse(given("cases.json"))) {
    await t.test(label, async () => {
      assert.equal(await opened(...files.map((name) => [name, given(name)])), "");
      await set(controls, exactly);
      for (const [side, names] of Object.entries(keep)) await leave(label, side, names);
    });
  }
});

test("it begins with the lens of every integration, and a scene with a name", async () => {
  const { stop, scale } = await page.evaluate(() => bokeh.state);
  assert.deepEqual([stop, scale], [2.8, 10]);
  assert.equal(await page.locator("#scene option").first().textContent(), "Night market");
  assert.equal(await page.locator("h1").textContent(), "Polygonal bokeh");
});

test("a scene that is chosen from the list takes the lens that it was ray traced with", async () => {
  await page.locator("#scene").selectOption({ label: "Winter evening" });
  await page.waitForFunction(() => bokeh.state.scene === 1 && Math.abs(bokeh.state.stop - 11.4) < 0.1);
  await choose(0);
  assert.equal(await page.evaluate(() => bokeh.state.stop), 2.8);
});

test("the install line is copied by its button", async () => {
  await page.context().grantPermissions(["clipboard-read", "clipboard-write"]).catch(() => {});
  const line = await page.locator("#install code").textContent();
  assert.match(line, /^npm install .*three$/);
  await page.evaluate(() => (navigator.clipboard.writeText = async (text) => (window.copied = text)));
  await page.locator("#copy").click();
  assert.equal(await page.evaluate(() => window.copied), line);
});

test("milliseconds are told when five in a row are within 15 %", () => {
  assert.ok(!steady([1, 1, 1, 1]));
  assert.ok(!steady([9, 10, 10, 10, 12]));
  assert.ok(steady([500, 9, 10, 10.2, 10.1, 10]));
  assert.equal(median([500, 9, 10, 10.2, 10.1, 10]), 10);
});

test("a scene of the page, and the canvas", async () => {
  await choose(0);
  await page.evaluate(() => bokeh.traced());
  await set({ left: "truth", right: "layered", preset: "medium" });
  await leave("market_7", "right", ["result"]);
  await leave("market_7", "left", ["truth", "color"]);
  writeFileSync(`${FOLDER}/drawn/market_7 canvas.u8`, Buffer.from(await page.evaluate(hand.canvas), "base64"));
  await page.screenshot({ path: `${FOLDER}/drawn/page.png` });
});

for (const name of ["BokehPass", "DepthOfFieldEffect"]) {
  test(`another library's effect: ${name}`, async () => {
    await choose(0);
    await page.evaluate(() => bokeh.traced());
    const said = await set({ left: "input", right: name });
    assert.equal(said.facts, "round bokeh");
    assert.equal(said.said, "");
    await leave("market_7", "right", [name]);
  });
}

test("controls: sliders, lists, divider, a click that focuses, the readout, keys", async () => {
  await choose(0);
  let said = await set({ left: "input", right: "exact", preset: "low", stop: 0, scale: 1, rotation: 30 });
  assert.deepEqual([said.stop, said.scale, said.rotation], [1, 1, 30]);
  assert.match(said.facts, /^\d passes$/);
  const box = await page.locator("#canvas").boundingBox();
  const depth = new Float32Array(Uint8Array.from(given("market_7 depth.f32")).buffer);
  // returns the position of the middle of a texel on the screen
  const at = (x, y) => [box.x + ((x + 0.5) * box.width) / SIZE[0], box.y + ((y + 0.5) * box.height) / SIZE[1]];
  // returns the smallest and the largest depth around a texel: a click hits a whole pixel of the screen, which may lie
  // in a neighbouring texel
  const near = (x, y) => {
    const rows = [y - 1, y, y + 1].flatMap((row) => [...depth.subarray(row * SIZE[0] + x - 1, row * SIZE[0] + x + 2)]);
    return [Math.min(...rows), Math.max(...rows)];
  };

  await page.mouse.move(...at(480, 100));
  await page.mouse.down();
  await page.mouse.move(...at(720, 130), { steps: 3 });
  await page.mouse.up();
  said = await set({});
  between(said.split, 0.74, 0.76, "the split, by mouse,");
  assert.equal(said.focus, FOCUS);
  const fingers = await page.context().newCDPSession(page);
  for (const [type, x] of [["touchStart", 720], ["touchMove", 600], ["touchMove", 240], ["touchEnd", null]]) {
    const [left, top] = at(x ?? 0, 130);
    const touchPoints = x === null ? [] : [{ x: left, y: top }];
    await fingers.send("Input.dispatchTouchEvent", { type, touchPoints });
  }
  said = await set({});
  between(said.split, 0.24, 0.26, "the split, by finger,");
  assert.equal(said.focus, FOCUS);

  await page.mouse.move(...at(600, 400));
  await page.mouse.down();
  await page.mouse.move(...at(700, 470), { steps: 3 });
  await page.mouse.up();
  assert.equal((await set({})).focus, FOCUS, "a drag has moved the focus");
  await set({}, { focus: 60 });
  await page.evaluate(hand.focuses);
  await page.mouse.click(...at(700, 470));
  const { focus, split } = await set({});
  between(focus, ...near(700, 470), "the focus");
  assert.ok(near(700, 470)[1] < FOCUS);
  const passed = await page.evaluate(hand.focuses);
  assert.ok(new Set(passed.filter((one) => one !== 60 && one !== focus)).size > 1, "the focus jumped");
  assert.deepEqual(passed, passed.toSorted((a, b) => b - a));

  await page.mouse.move(...at(300, 60));
  const { under } = await set({});
  const [metres, pixels] = /^\d+, \d+: (\S+) m, CoC (\S+) pixels far$/.exec(under).slice(1).map(Number);
  const [least, most] = near(300, 60);
  between(metres, 0.99 * least, 1.01 * most, "the depth under the pointer");
  // for a lens of 50 mm at f/1 and a sensor of 24 mm; the page limits the CoC to 0.15 of the image height
  const coc = Math.min((0.05 * 0.05 * (metres - focus)) / (metres * (focus - 0.05)) / 0.024, 0.15) * SIZE[1];
  between(pixels, 0.98 * coc, 1.02 * coc, "the circle of confusion");

  const keys = async (focused, ...names) => {
    await page.locator(focused).focus();
    for (const name of names) await page.keyboard.press(name);
    return set({});
  };
  // a slider handles its arrows itself, so they do not move the split
  const changed = await keys("#stop", "ArrowRight", "x", "]", "b");
  between(changed.stop, 2 ** 0.3 - 1e-6, 2 ** 0.3 + 1e-6, "the f-stop");
  assert.equal(changed.split, split);
  assert.deepEqual([changed.left, changed.right, changed.blades], ["exact", "input", 8]);
  const traced = await keys("#divider", "t");
  assert.deepEqual([traced.stop.toFixed(1), traced.scale, traced.focus], ["7.0", 10, FOCUS]);
  const last = await keys("#divider", "ArrowLeft", "Shift+Digit3", "0");
  between(last.split, split - 0.02 - 1e-6, split - 0.02 + 1e-6, "the split, by a key,");
  assert.deepEqual([last.right, last.focus, last.rotation, last.blades], ["exact", FOCUS, 0, 6]);
});

test("a file that cannot be read is refused in one line", async (t) => {
  const bad = Buffer.from("no picture");
  const refusals = [
    ["depth is 40 x 24, but the image is 160 x 90 pixels", [["a.exr", given("color.exr")], ["a_depth.png", given("a depth.png")]]],
    ["no.exr: it has no depth", [["no.exr", given("color.exr")]]],
    ["piz.exr: its channels have different types. Save it with ZIP compression", [["piz.exr", given("two types.exr")]]],
    ["bad.exr: not an EXR file", [["bad.exr", bad]]],
    ["cut.exr: ", [["cut.exr", given("piz.EXR").subarray(0, 900)]]],
    ["bad.png: ", [["bad.png", bad]]],
  ];
  for (const [words, files] of refusals) {
    await t.test(words, async () => {
      const said = await opened(...files);
      assert.ok(said.includes(words) && !said.includes("\n"), said);
    });
  }
});

test("the page asks for nothing outside itself, and writes no error", () => {
  const address = pathToFileURL(`${FOLDER}/page.html`).href;
  assert.deepEqual(requests.filter((url) => url !== address && !/^(data|blob):/.test(url)), []);
  assert.deepEqual(errors, []);
});

// Opens the page for a host, in a folder of that host, on a screen of this size. Returns { page, bytes: name of each
// file that was loaded -> its size }.
async function hosted(width, height) {
  const other = await browser.newPage({ viewport: { width, height } });
  const bytes = {};
  await other.route("**/*", (route) => {
    const name = decodeURI(new URL(route.request().url()).pathname.replace(/^\/a\/folder\//, "")) || "index.html";
    const path = `${FOLDER}/site/${name}`;
    if (!statSync(path, { throwIfNoEntry: false })?.isFile()) return route.fulfill({ status: 404 });
    bytes[name] = statSync(path).size;
    return route.fulfill({ path });
  });
  await other.goto("https://bokeh.invalid/a/folder/");
  await other.evaluate(() => bokeh.ready);
  return { page: other, bytes };
}

test("on a host the first picture takes at most 3 MB; a truth and other effects are loaded when they are asked for", async () => {
  const { page: other, bytes } = await hosted(1280, 800);
  const sum = () => Object.values(bytes).reduce((a, b) => a + b);
  assert.ok(sum() <= 3e6, `${sum()} bytes: ${JSON.stringify(bytes)}`);
  const before = Object.keys(bytes).length;
  await other.evaluate(() => bokeh.change({ left: "truth" }));
  await other.evaluate(() => bokeh.change({ left: "BokehPass" }));
  assert.equal(Object.keys(bytes).length, before + 2);
  await other.screenshot({ path: `${FOLDER}/drawn/host.png` });
  await other.close();
});

test("on a phone the picture is as wide as the screen, and nothing overlaps or sticks out", async () => {
  const { page: other } = await hosted(390, 844);
  const box = (id) => other.locator(id).boundingBox();
  const [picture, left, right, panel] = await Promise.all(["#picture", "#left", "#right", "#panel"].map(box));
  assert.deepEqual([picture.x, picture.width], [0, 390]);
  assert.ok(left.y >= picture.y + picture.height && right.y === left.y);
  assert.ok(left.x + left.width <= right.x && right.x + right.width <= 390);
  assert.ok(panel.y >= left.y + left.height);
  assert.equal(await other.evaluate(() => document.documentElement.scrollWidth), 390);
  await other.screenshot({ path: `${FOLDER}/drawn/phone.png`, fullPage: true });
  await other.close();
});

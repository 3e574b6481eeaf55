// Tests the files that npm packs, other ways to install the package, and its types.

import assert from 'node:assert/strict';
import { cpSync, readFileSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { WEB, bundled, copyTo, folder, madeIn, npm, run } from './project.js';

let root;

before(() => {
  root = folder();
});

after(() => root?.remove());

test('npm packs scripts and types, and neither tests nor templates', async () => {
  const [packed] = JSON.parse(await npm(WEB, 'pack', '--dry-run', '--json'));
  const always = ['LICENSE', 'README.md', 'package.json'];
  const wanted = readdirSync(WEB).filter((name) => always.includes(name) || /\.(d\.ts|js)$/.test(name));
  assert.deepEqual(packed.files.map(({ path }) => path).sort(), wanted.sort());
});

test('each entry of the exports map has types beside it, and no file of the package is left out', async () => {
  const { exports } = JSON.parse(readFileSync(join(WEB, 'package.json'), 'utf8'));
  const files = new Set(readdirSync(WEB));
  const entries = Object.entries(exports).filter(([name]) => name !== './package.json');
  for (const [name, { types, default: script }] of entries) {
    assert.deepEqual([types, script], [`${name}.d.ts`, `${name}.js`]);
    assert.ok(files.has(types.slice(2)) && files.has(script.slice(2)), name);
  }
  const imported = [...files].filter((name) => /\.js$/.test(name)).map((name) => readFileSync(join(WEB, name), 'utf8')).join();
  const unused = [...files].filter((name) => /\.js$/.test(name) && !exports[`./${name.slice(0, -3)}`] && !imported.includes(`'./${name}'`));
  assert.deepEqual(unused, []);
});

test('the README holds outside of the repository: links stay in the package, what it imports is there', async () => {
  const text = readFileSync(join(WEB, 'README.md'), 'utf8');
  const links = [...text.matchAll(/\]\(([^)#]*)(#[^)]*)?\)/g)].map(([, target]) => target).filter((target) => target && !/^https:/.test(target));
  const files = readdirSync(WEB).filter((name) => /\.(d\.ts|js)$|^(LICENSE|package\.json)$/.test(name));
  assert.deepEqual(links.filter((target) => !files.includes(target)), []);
  const rows = [...text.matchAll(/import \{ (\w+) \} from 'polygonal-bokeh\/([\w-]+)'/g)].map(([, name, entry]) => [entry, name]);
  for (const [, named, classes] of text.matchAll(/^\|`polygonal-bokeh\/(.*?)\|(.*?)\|/gm)) {
    const entries = `polygonal-bokeh/${named}`.match(/(?<=polygonal-bokeh\/)[\w-]+/g);
    const [...names] = classes.match(/(?<=[`<])Polygon\w+/g);
    for (const entry of entries) for (const name of names) rows.push([entry, name]);
  }
  assert.ok(rows.length >= 9, `${rows}`);
  for (const [entry, name] of rows) assert.match(readFileSync(join(WEB, `${entry}.js`), 'utf8'), new RegExp(`export (class|function) ${name}\\b`));
});

test('the folder copied into a project, and linked there by npm, finds the project\'s three.js', async () => {
  const copied = join(root.path, 'copied');
  copyTo(WEB, join(copied, 'web'));
  writeFileSync(join(copied, 'package.json'), '{}');
  await npm(copied, 'install', './web');
  writeFileSync(join(copied, 'entry.js'), "export * from 'polygonal-bokeh/three';");
  await bundled(copied, 'esbuild', 'entry.js', 'out');
});

test('tsc --strict has nothing against the types and their user; what no option may be is an error', async () => {
  const project = await madeIn(root.path);
  cpSync(join(WEB, 'test/types.ts'), join(project, 'types.ts'));
  const tsc = '../node_modules/.bin/tsc --strict --noEmit --target esnext --module esnext --moduleResolution bundler';
  // the types of the engines themselves have errors, so only look at ours; `right` shows that tsc ran to the end
  const said = await run(project, 'sh', '-c', `${tsc} types.ts; ${tsc} --skipLibCheck types.ts && echo right`);
  const lines = said.trim().split('\n');
  assert.deepEqual(lines.filter((line) => /polygonal-bokeh|^types\.ts/.test(line)), []);
  assert.equal(lines.at(-1), 'right');
});

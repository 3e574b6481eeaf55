// What npm packs, the package installed otherwise, and its types.

import assert from 'node:assert/strict';
import { cpSync, readdirSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import * as languages from '../shaders.js';
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
  // the engines' own types have errors; the last word shows that it came to an end
  const said = await run(project, 'sh', '-c', `${tsc} types.ts; ${tsc} --skipLibCheck types.ts && echo right`);
  const lines = said.trim().split('\n');
  assert.deepEqual(lines.filter((line) => /polygonal-bokeh|^types\.ts/.test(line)), []);
  assert.equal(lines.at(-1), 'right');
});

test('the shaders of one language have at most 60 kB', () => {
  for (const files of Object.values(languages)) assert.ok(Object.values(files).join('').length <= 60_000);
});

// A user's project with the package installed in it, and programs run there.

import { execFile } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { INTEGRATION, MODULES } from './opened.js';

export const WEB = fileURLToPath(new URL('..', import.meta.url));
export const SAMPLES = ['threejs', 'babylonjs', 'playcanvas'];
const LIMIT = 300_000; // milliseconds that a program may take; the longest takes 30000
const QUIET = ['--ignore-scripts', '--no-audit', '--no-fund', '--no-update-notifier', '--loglevel=error'];

// Programs of Node.js that make OUT/main.js of ENTRY
const BUNDLERS = {
  esbuild: `import { build } from 'esbuild';
await build({ entryPoints: ['ENTRY'], bundle: true, minify: true, format: 'esm', outfile: 'OUT/main.js',
  jsx: 'automatic', define: { 'process.env.NODE_ENV': '"production"' } });`,
  vite: `import { build } from 'vite';
const lib = { entry: 'ENTRY', formats: ['es'], fileName: () => 'main.js' };
await build({ logLevel: 'warn', build: { outDir: 'OUT', minify: true, lib } });`,
  webpack: `import webpack from 'webpack';
const output = { path: process.cwd() + '/OUT', filename: 'main.js', module: true };
const [mode, performance, experiments] = ['production', { hints: false }, { outputModule: true }];
webpack({ mode, entry: './ENTRY', output, performance, experiments }, (error, stats) => {
  if (error || stats.hasErrors() || stats.hasWarnings()) throw error ?? new Error(stats.toString());
});`,
};

// A temporary folder, above which Node.js finds the packages that the tests need
export function folder() {
  const made = mkdtempSync(join(tmpdir(), 'polygonal-bokeh-'));
  symlinkSync(MODULES, join(made, 'node_modules'));
  return { path: made, remove: () => rmSync(made, { recursive: true }) };
}

// A project in such a folder: the package installed by the commands of the README, and the samples beside it.
export async function madeIn(root) {
  const project = join(root, 'project');
  mkdirSync(project);
  writeFileSync(join(project, 'package.json'), '{"type": "module"}');
  const commands = readFileSync(join(WEB, 'README.md'), 'utf8').split('```')[1].trim().split('\n').slice(1);
  // the last must not make a link of the copy
  for (const line of [...commands, 'npm install']) {
    await npm(project, ...line.split(' ').slice(1).map((word) => (word.includes('PATH') ? WEB : word)));
  }
  for (const name of SAMPLES) copyTo(join(INTEGRATION, name), join(project, name), /\.json$/);
  return project;
}

// Copy a folder, but for packages that were installed in it and files whose name fits
export function copyTo(from, to, without = /^$/) {
  const wanted = (path) => path !== join(from, 'node_modules') && !without.test(basename(path));
  cpSync(from, to, { recursive: true, filter: wanted });
}

// What a program says, both streams. It is told nothing of the npm and of the test that run it.
export async function run(cwd, program, ...words) {
  const told = /^(NODE_TEST_CONTEXT|INIT_CWD|npm_(package|lifecycle|config_local_prefix).*)$/;
  const env = Object.fromEntries(Object.entries(process.env).filter(([name]) => !told.test(name)));
  const options = { cwd, env, timeout: LIMIT, maxBuffer: 2 ** 26 };
  const { stdout, stderr } = await promisify(execFile)(program, words, options).catch((error) => {
    throw new Error(`${program} ${words[0]}: ${error.killed ? 'not done in time' : error.code}\n${error.stdout}${error.stderr}`);
  });
  return stdout + stderr;
}

export const npm = (cwd, ...words) => run(cwd, 'npm', ...words, ...QUIET);

// Have a bundler make OUT/main.js; returns what it said
export function bundled(cwd, bundler, entry, out) {
  const program = BUNDLERS[bundler].replace('ENTRY', entry).replace('OUT', out);
  return run(cwd, process.execPath, '--input-type=module', '-e', program);
}

// Creates a user's project in which the package is installed, and runs programs there.

import { execFile } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { basename, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { promisify } from 'node:util';
import { INTEGRATION, MODULES } from './opened.js';

export const WEB = fileURLToPath(new URL('..', import.meta.url));
export const SAMPLES = ['threejs', 'babylonjs', 'playcanvas'];
const LIMIT = 300_000; // milliseconds that a program may take; the slowest takes 30000
const QUIET = ['--ignore-scripts', '--no-audit', '--no-fund', '--no-update-notifier', '--loglevel=error'];

// Programs for Node.js that bundle ENTRY into OUT/main.js
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

// Creates a temporary folder with a link to the packages that the tests need. Node.js finds them from all folders
// inside.
export function folder() {
  const made = mkdtempSync(join(tmpdir(), 'polygonal-bokeh-'));
  symlinkSync(MODULES, join(made, 'node_modules'));
  return { path: made, remove: () => rmSync(made, { recursive: true }) };
}

// Creates a project in such a folder, installs the package by the commands of the README, and copies the samples into
// it. Returns its path.
export async function madeIn(root) {
  const project = join(root, 'project');
  mkdirSync(project);
  writeFileSync(join(project, 'package.json'), '{"type": "module"}');
  const commands = readFileSync(join(WEB, 'README.md'), 'utf8').split('```')[1].trim().split('\n').slice(1);
  // the last command checks that a later install does not replace the copy with a link
  for (const line of [...commands, 'npm install']) {
    await npm(project, ...line.split(' ').slice(1).map((word) => (word.includes('PATH') ? WEB : word)));
  }
  for (const name of SAMPLES) copyTo(join(INTEGRATION, name), join(project, name), /\.json$/);
  return project;
}

// Copies a folder, except the packages that were installed in it, and files whose name matches `without`.
export function copyTo(from, to, without = /^$/) {
  const wanted = (path) => path !== join(from, 'node_modules') && !without.test(basename(path));
  cpSync(from, to, { recursive: true, filter: wanted });
}

// Runs a program, and returns what it writes to both streams. Its environment has no variables of the npm and the test
// runner that run this. Throws an Error if the program fails, or does not end in time.
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

// Lets a bundler write OUT/main.js. Returns what the bundler wrote to the console.
export function bundled(cwd, bundler, entry, out) {
  const program = BUNDLERS[bundler].replace('ENTRY', entry).replace('OUT', out);
  return run(cwd, process.execPath, '--input-type=module', '-e', program);
}

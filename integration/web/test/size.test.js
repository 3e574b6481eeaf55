// Tests how much shader text a browser has to load.

import assert from 'node:assert/strict';
import { test } from 'node:test';
import * as languages from '../shaders.js';

test('the shaders of one language have at most 60 kB', () => {
  for (const files of Object.values(languages)) assert.ok(Object.values(files).join('').length <= 60_000);
});

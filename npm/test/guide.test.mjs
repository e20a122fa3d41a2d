// The blocks of JavaScript in the guide.

import assert from 'node:assert';
import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';
import { findChromium } from 'volref/page';

// Where CI is set, no cause is looked for unless a test asks: the tests are those of any machine.
delete process.env.CI;

const HERE = path.dirname(fileURLToPath(import.meta.url));
const CHAPTER = process.env.VOLREF_CHAPTER ?? path.join(HERE, '../../src/guide/in_your_tests.md');
const [theirs, renderer, ...others] = [...fs.readFileSync(CHAPTER, 'utf8').matchAll(/```javascript\n(.*?)```/gs)].map(
  ([, block]) => block,
);
// Within the project, whose packages it imports.
const folder = fs.mkdtempSync(path.join(HERE, 'guide-'));
after(() => fs.rmSync(folder, { recursive: true, force: true }));

test('a project tests its canvas', { skip: findChromium() ? false : 'there is no Chromium' }, () => {
  assert.strictEqual(others.length, 0);
  fs.writeFileSync(path.join(folder, 'my.test.mjs'), theirs);
  fs.writeFileSync(path.join(folder, 'my-renderer.js'), renderer);
  // Without what the runner of this test tells those that it starts.
  const { NODE_TEST_CONTEXT, ...env } = process.env;
  const ran = spawnSync(process.execPath, ['--test', 'my.test.mjs'], { cwd: folder, env, encoding: 'utf8' });
  assert.strictEqual(ran.status, 1, ran.stdout + ran.stderr);
  for (const name of ['opaque', 'thin']) {
    assert.match(ran.stdout, new RegExp(`sampled/${name}: fail\\n *nothing was drawn`));
  }
});

test('the README of the package shows the same test', () => {
  const readme = fs.readFileSync(
    path.join(path.dirname(createRequire(import.meta.url).resolve('volref/package.json')), 'README.md'),
    'utf8',
  );
  assert.ok(readme.includes(theirs));
});

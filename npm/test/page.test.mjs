// Pages in a real Chromium, and what becomes of it.

import assert from 'node:assert';
import { spawn, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { setTimeout as pause } from 'node:timers/promises';
import { check, exportBundle } from 'volref';
import { Bundle, Refusal, readNpy } from 'volref/bundle';
import { findChromium, startPage } from 'volref/page';

const SCRIPT = path.join(path.dirname(createRequire(import.meta.url).resolve('volref/package.json')), 'volref-page.js');
// Temporary files of its own, by which its processes are known.
const folder = fs.realpathSync(fs.mkdtempSync(path.join(os.tmpdir(), 'volref-pages-')));
process.env.TMPDIR = folder;
after(() => fs.rmSync(folder, { recursive: true, force: true }));
const within = (name) => path.join(folder, name);
const options = { skip: findChromium() ? false : 'there is no Chromium', timeout: 60_000 };

// What is to go wrong is said by the step.
fs.writeFileSync(within('parts.js'), 'export const colour = (k) => `rgb(${10 * k} 20 30)`;');
fs.writeFileSync(
  within('page.js'),
  `
import { refuse } from 'volref/bundle';
import { colour } from './parts.js';

export async function render(element, bundle, step) {
  if (step === 2) refuse('two');
  if (step === 3) throw new RangeError('three is too much');
  if (step === 4) for (;;);
  if (step === 5) await new Promise(() => {});
  if (step === 6) console.error('six', 6);
  if (step === 7) return new Uint8Array(5);
  if (step === 8) return new Float32Array(3 * bundle.width * bundle.height).fill(1.5);
  if (step === 9) return [element.clientWidth, element.clientHeight, devicePixelRatio];
  if (step === 10) throw undefined;
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [step === 11 ? 1 : bundle.width, bundle.height];
  const context = canvas.getContext('2d');
  context.fillStyle = colour(1);
  context.fillRect(0, 0, canvas.width, 5);
  // Later than the task that drew it.
  await new Promise(requestAnimationFrame);
  return canvas;
}
`,
);

/** State, parent and group of a process. */
function statOf(pid) {
  const [state, parent, group] = fs.readFileSync(`/proc/${pid}/stat`, 'utf8').replace(/.*\) /s, '').split(' ');
  return { state, parent: Number(parent), group: Number(group) };
}

/** Processes that inherited the temporary folder of this test, and those of their groups: some overwrite what they inherited. */
function processes() {
  if (process.platform !== 'linux') return [];
  const found = fs
    .readdirSync('/proc')
    .map(Number)
    .filter((pid) => pid > 0 && pid !== process.pid)
    .flatMap((pid) => {
      try {
        const isMarked = fs.readFileSync(`/proc/${pid}/environ`, 'utf8').includes(`TMPDIR=${folder}`);
        return [{ pid, isMarked, ...statOf(pid) }];
      } catch {
        return [];
      }
    });
  for (const { isMarked, group } of found) if (isMarked) groups.add(group);
  groups.delete(statOf('self').group);
  return found
    .filter(({ isMarked, group, state }) => state !== 'Z' && (isMarked || groups.has(group)))
    .map(({ pid }) => pid);
}

const groups = new Set();
const profiles = () => fs.readdirSync(folder).filter((name) => /^volref-page-|chromium/i.test(name));

async function nothingIsLeft({ but = [] } = {}) {
  for (let waited = 0; processes().length > 0 && waited < 5000; waited += 50) await pause(50);
  const left = processes().map((pid) => fs.readFileSync(`/proc/${pid}/cmdline`, 'utf8').replaceAll('\0', ' '));
  assert.deepStrictEqual([left, profiles().filter((name) => !but.includes(name))], [[], []]);
}

const thin = () => exportBundle('sampled/thin');

test('a canvas is read, and its faults are said', options, async (t) => {
  const page = await startPage(within('page.js'), { timeout: 30 });
  t.after(() => page.close());
  const bundle = thin();
  const { data, width, height, alpha, messages } = await page.render(bundle, 1);
  assert.strictEqual(alpha, 'straight');
  assert.deepStrictEqual([width, height, data.length, messages], [64, 64, 4 * 64 * 64, []]);
  assert.deepStrictEqual([...data.subarray(0, 4)], [10, 20, 30, 255]);
  assert.deepStrictEqual([...data.subarray(-4)], [0, 0, 0, 0]);
  await assert.rejects(page.render(bundle, 2), (error) => error instanceof Refusal && error.message === 'two');
  await assert.rejects(
    page.render(bundle, 3),
    /^Error: RangeError: three is too much\n.*at render \(page\.js:\d+:\d+\)/s,
  );
  assert.deepStrictEqual((await page.render(bundle, 6)).messages, ['six 6']);
  await assert.rejects(page.render(bundle, 7), /5 values, which are not 64 × 64 pixels/);
  const radiance = await page.render(bundle, 8);
  assert.ok(radiance.data instanceof Float32Array && radiance.data.every((value) => value === 1.5));
  await assert.rejects(page.render(bundle, 9), /returns a canvas/);
  await assert.rejects(page.render(bundle, 10), /undefined/);
  await assert.rejects(page.render(bundle, 11), /1 × 64 pixels, and not 64 × 64/);
  // Side by side, one after the other.
  const both = await Promise.allSettled([page.render(bundle, 3), page.render(bundle)]);
  assert.deepStrictEqual(
    both.map(({ status }) => status),
    ['rejected', 'fulfilled'],
  );
  assert.strictEqual(profiles().length, 1);
  await page.close();
  await nothingIsLeft();
});

test('a page of WebGL is judged', options, async (t) => {
  fs.writeFileSync(
    within('webgl.js'),
    `
    export function render(element, bundle) {
      const canvas = document.createElement('canvas');
      [canvas.width, canvas.height] = [bundle.width, bundle.height];
      const gl = canvas.getContext('webgl2', { antialias: false });
      const { floats } = bundle.table(2);
      gl.enable(gl.SCISSOR_TEST);
      const quarter = (x, y, colour) => {
        gl.scissor(x * bundle.width / 2, y * bundle.height / 2, bundle.width / 2, bundle.height / 2);
        gl.clearColor(...colour);
        gl.clear(gl.COLOR_BUFFER_BIT);
      };
      quarter(0, 1, [1, 0, 0, 1]);
      quarter(1, 0, [0, 0, 1, 0.5]);
      return canvas;
    }`,
  );
  const page = await startPage(within('webgl.js'));
  t.after(() => page.close());
  const image = await page.render(thin());
  assert.strictEqual(image.alpha, 'premultiplied');
  const at = (x, y) => [...image.data.subarray(4 * (64 * y + x), 4 * (64 * y + x) + 4)];
  assert.deepStrictEqual(
    [at(1, 1), at(62, 1), at(62, 62)],
    [
      [255, 0, 0, 255],
      [0, 0, 0, 0],
      [0, 0, 255, 128],
    ],
  );
  assert.strictEqual(check('sampled/thin', image, { bits: '8-linear', explain: 0 }).verdict, 'fail');
});

test('values of any kind of array arrive in the page', options, async (t) => {
  fs.writeFileSync(
    within('values.js'),
    'export const render = (element, { values, width, height }) => new Float32Array(3 * width * height).fill(values.at(-1));',
  );
  const page = await startPage(within('values.js'));
  t.after(() => page.close());
  const { description, files } = thin();
  const [name] = Object.keys(files);
  const values = new Float32Array(files[name].length / 4 + 1).fill(7).subarray(1);
  for (const part of [values, values.slice().buffer, Buffer.from(values.buffer, 4)]) {
    assert.strictEqual((await page.render(new Bundle(description, { [name]: part }))).data[0], 7);
  }
  await assert.rejects(
    page.render(new Bundle(description, { [name]: values.subarray(1) })),
    /21951 values, and not 21952/,
  );
  await assert.rejects(page.render(new Bundle(description, {})), /lacks its file/);
});

test('an endless page is ended, and the next one is rendered', options, async (t) => {
  const page = await startPage(within('page.js'), { timeout: 6 });
  t.after(() => page.close());
  await assert.rejects(page.render(thin(), 4), /did not return an image within 6 s/);
  assert.strictEqual((await page.render(thin(), 1)).width, 64);
  await page.close();
  await nothingIsLeft();
});

test(
  'a page that crashes is an error, as is a browser that ends',
  { ...options, skip: options.skip || process.platform !== 'linux' },
  async (t) => {
    const page = await startPage(within('page.js'), { timeout: 30 });
    t.after(() => page.close());
    await page.render(thin(), 1);
    const killed = async (isIt) => {
      const image = assert.rejects(page.render(thin(), 5), /the page crashed|Chromium ended by SIGKILL/);
      await pause(1000);
      for (const pid of processes()) {
        if (isIt(fs.readFileSync(`/proc/${pid}/cmdline`, 'utf8'))) process.kill(pid, 'SIGKILL');
      }
      await image;
    };
    await killed((words) => words.includes('--type=renderer'));
    assert.strictEqual((await page.render(thin(), 1)).width, 64);
    await killed((words) => words.includes('--remote-debugging-pipe') && !words.includes('--type='));
    assert.strictEqual((await page.render(thin(), 1)).width, 64);
    await page.close();
    await nothingIsLeft();
  },
);

test('a module that cannot be loaded says why', options, async (t) => {
  await assert.rejects(startPage(within('none.js')), /there is no such file/);
  await assert.rejects(startPage(within('page.js'), { timeout: -1 }), /timeout is -1/);
  fs.writeFileSync(within('faulty ü.js'), '');
  const page = await startPage(within('faulty ü.js'));
  t.after(() => page.close());
  for (const [text, words] of [
    ['import * as three from "three";', /"three".*bundle the module first/s],
    ['import "./none.js";', /none\.js/],
    ['const x = ;', /SyntaxError: Unexpected token ';'/],
    ['export const draw = 1;', /exports no function render/],
    ['import { x } from "../page.js/../../../../etc/passwd";', /Failed to fetch|does not provide/],
  ]) {
    fs.writeFileSync(within('faulty ü.js'), text);
    await assert.rejects(page.render(thin()), words);
  }
  await page.close();
  await nothingIsLeft();
});

test('a browser that does not start says why', options, async () => {
  const known = process.env.CHROMIUM;
  for (const [program, words] of [
    [within('none'), /cannot run .*none/],
    ['/bin/false', /Chromium ended with exit code 1/],
  ]) {
    process.env.CHROMIUM = program;
    const page = await startPage(within('page.js'));
    await assert.rejects(page.render(thin()), words);
    await page.close();
  }
  if (known === undefined) delete process.env.CHROMIUM;
  else process.env.CHROMIUM = known;
  await nothingIsLeft();
});

test('others learn nothing from the server of a page', options, async (t) => {
  const outside = ['files-of-module/..%2f..%2f..%2f..%2fetc%2fpasswd', 'volref/page.js', 'files/9', '%ff'];
  fs.writeFileSync(
    within('address.js'),
    `
    export async function render(element, bundle) {
      const answers = await Promise.all(${JSON.stringify(outside)}.map((name) => fetch(location.href + name)));
      const found = await Promise.all(answers.map(async (answer) => (answer.ok && (await answer.text()) !== '' ? 1 : 0)));
      return new Float32Array(3 * bundle.width * bundle.height).fill(location.port).fill(Math.max(...found), 1, 2);
    }`,
  );
  const page = await startPage(within('address.js'));
  t.after(() => page.close());
  const [port, found] = (await page.render(thin())).data;
  assert.strictEqual(found, 0);
  for (const address of ['/', '//', '/%', '/bundle.json', '/undefined/bundle.json', '/files/0']) {
    const status = await new Promise((resolve) =>
      http.get({ port, path: address }, (answer) => resolve(answer.resume().statusCode)),
    );
    assert.strictEqual(status, 404, address);
  }
  assert.strictEqual((await page.render(thin())).data[0], port);
});

test('volref-page renders once', options, async () => {
  thinFiles();
  const once = (...words) =>
    spawnSync(process.execPath, [SCRIPT, within('page.js'), within('thin.json'), ...words], { encoding: 'utf8' });
  assert.strictEqual(once(within('image.npy'), '--step', '6').stderr, 'console: six 6\n');
  const { values, shape } = readNpy(fs.readFileSync(within('image.npy')));
  assert.deepStrictEqual(shape, [64, 64, 4]);
  assert.ok(Math.abs(values[1] - 20 / 255) < 1e-7);
  const refused = once(within('none.npy'), '--step', '2');
  assert.deepStrictEqual([refused.status, refused.stderr], [1, 'refused: two\n']);
  assert.ok(!fs.existsSync(within('none.npy')));
  assert.match(once(within('image.exr')).stderr, /\.npy or \.png/);
  for (const words of [
    [],
    ['x.npy', '--step', 'two'],
    ['x.npy', '--stpe', '2'],
    ['x.npy', '--timeout', '0'],
    ['a.npy', 'b.npy'],
  ]) {
    const { status, stderr } = once(...words);
    assert.deepStrictEqual([status, /volref-page MODULE --serve/.test(stderr)], [2, true], words);
  }
  await nothingIsLeft();
});

function thinFiles() {
  exportBundle('sampled/thin', { folder });
}

/** volref-page as a renderer that stays, and a function that asks it. */
function staying(...words) {
  const child = spawn(process.execPath, [SCRIPT, within('page.js'), '--serve', ...words], {
    stdio: ['pipe', 'pipe', 'pipe'],
  });
  const answers = [];
  let waiting;
  let rest = '';
  child.stdout.setEncoding('utf8').on('data', (text) => {
    const lines = (rest + text).split('\n');
    rest = lines.pop();
    answers.push(...lines);
    waiting?.();
  });
  const answer = async () => {
    while (answers.length === 0) await new Promise((resolve) => (waiting = resolve));
    return JSON.parse(answers.shift());
  };
  const ask = (line) => {
    child.stdin.write(`${typeof line === 'string' ? line : JSON.stringify(line)}\n`);
    return answer();
  };
  const ended = new Promise((resolve) => child.on('exit', (code, signal) => resolve(signal ?? code)));
  return { child, ask, ended };
}

test('volref-page stays, and hostile lines are errors', options, async () => {
  thinFiles();
  const { child, ask, ended } = staying();
  const request = {
    volref: 1,
    case: 'sampled/thin',
    'export:bundle': within('thin.json'),
    output: within('image.npy'),
  };
  assert.deepStrictEqual(await ask({ ...request, step: 1 }), { image: within('image.npy') });
  assert.deepStrictEqual(await ask({ ...request, step: 2 }), { cannot: 'two' });
  assert.match((await ask({ ...request, step: 3 })).error, /three is too much/);
  for (const [line, words] of [
    ['{', /JSON/],
    ['', /JSON/],
    ['null', /protocol undefined/],
    [{ ...request, volref: 2 }, /protocol 2, and not 1/],
    [{ volref: 1, output: 'x.npy' }, /name \{export:bundle\} in the command/],
    [{ ...request, 'export:bundle': within('none.json') }, /none\.json/],
    [{ ...request, output: undefined }, /no output/],
    [{ ...request, output: within('none/image.npy') }, /none\/image\.npy/],
    [{ ...request, step: 'alert(1)' }, /step is "alert\(1\)"/],
  ]) {
    assert.match((await ask(line)).error ?? '', words, line);
  }
  assert.deepStrictEqual(await ask(request), { image: within('image.npy') });
  child.stdin.end();
  assert.strictEqual(await ended, 0);
  await nothingIsLeft();
});

test('nothing is left when volref-page is ended', options, async () => {
  thinFiles();
  const request = { volref: 1, 'export:bundle': within('thin.json'), output: within('image.npy'), step: 1 };
  for (const signal of ['SIGTERM', 'SIGKILL']) {
    const { child, ask, ended } = staying();
    await ask(request);
    const left = profiles();
    child.kill(signal);
    assert.strictEqual(await ended, signal);
    // Nobody could remove the profile: a browser that is started ten minutes later does.
    await nothingIsLeft({ but: signal === 'SIGKILL' ? left : [] });
    const ago = new Date(Date.now() - 700_000);
    for (const name of profiles()) fs.utimesSync(within(name), ago, ago);
  }
  // Another's folder, as old, stays.
  const mine = 'volref-page-mine';
  fs.mkdirSync(within(mine));
  fs.writeFileSync(within(`${mine}/notes.txt`), 'mine');
  const ago = new Date(Date.now() - 700_000);
  fs.utimesSync(within(mine), ago, ago);
  const page = await startPage(within('page.js'));
  await page.render(thin(), 1);
  await page.close();
  await nothingIsLeft({ but: [mine] });
  assert.deepStrictEqual(fs.readdirSync(within(mine)), ['notes.txt']);
});

// Verdicts, and files as the program reads them.

import assert from 'node:assert';
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import os from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { VolrefError, cases, check, exportBundle, program, writeImage } from 'volref';
import { npy, png, readNpy } from 'volref/bundle';

// Where CI is set, no cause is looked for unless a test asks: the tests are those of any machine.
delete process.env.CI;

const PACKAGE = path.dirname(createRequire(import.meta.url).resolve('volref/package.json'));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'volref-test-'));
process.on('exit', () => fs.rmSync(folder, { recursive: true, force: true }));
const volref = (...words) => execFileSync(program(), words, { encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe'] });
const within = (name) => path.join(folder, name);

function rendered(name, ...words) {
  const file = within('rendered.npy');
  volref('render', name, '-o', file, ...words);
  const { values, shape } = readNpy(fs.readFileSync(file));
  return { width: shape[1], height: shape[0], data: values };
}

/** The codes of the colours of radiance. */
function codesOf({ width, height, data }) {
  const colours = data.length === 4 * width * height ? data.filter((_, index) => index % 4 < 3) : data;
  return { width, height, data: Uint8Array.from(colours, (value) => Math.round(255 * Math.min(1, value))) };
}

test('an array survives the way through the program', () => {
  const image = rendered('sampled/thin');
  fs.writeFileSync(
    within('again.npy'),
    npy(image.data, [image.height, image.width, image.data.length / image.width / image.height]),
  );
  volref('compare', '--gate', 'exact', within('rendered.npy'), within('again.npy'));
  const doubles = Float64Array.of(1, -0.5, Number.MAX_VALUE, NaN);
  assert.deepStrictEqual(readNpy(npy(doubles, [2, 2])), { values: doubles, shape: [2, 2] });
  assert.deepStrictEqual(readNpy(npy(Float32Array.of(7), [1])).shape, [1]);
});

test('a PNG is read by the program as it was written', () => {
  const image = codesOf(rendered('sampled/thin'));
  // More than one stored part of zlib.
  const size = { width: 200, height: 180 };
  const codes = Uint8Array.from({ length: 4 * 200 * 180 }, (_, index) => (index % 4 === 3 ? 255 : (index * 37) % 256));
  for (const { width, height, data } of [image, { ...size, data: codes }]) {
    fs.writeFileSync(within('image.png'), png(data, width, height));
    const rgb = data.length === 4 * width * height ? data.filter((_, index) => index % 4 < 3) : data;
    fs.writeFileSync(within('rgb.png'), png(rgb, width, height));
    volref('compare', within('image.png'), within('rgb.png'));
  }
  assert.throws(() => png(codes, 100, 100), /not 100 × 100 pixels/);
});

test('damaged arrays are rejected', () => {
  const whole = npy(Float32Array.of(1, 2), [2]);
  const text = (bytes, from, to) =>
    Uint8Array.from(Buffer.from(Buffer.from(bytes).toString('latin1').replace(from, to), 'latin1'));
  for (const [bytes, words] of [
    [new Uint8Array(), /not an NPY file/],
    [whole.subarray(0, 11), /not an NPY file/],
    [whole.subarray(0, 60), /bytes of values/],
    [whole.subarray(0, -1), /with 7 bytes of values/],
    [text(whole, '<f4', '>f4'), /type >f4/],
    [text(whole, "'<f4'", "'|O' "), /type \|O/],
    [text(whole, 'False', 'True '), /order of Fortran/],
    [text(whole, '(2,)', '(9e9999,)'), /bytes of values/],
  ]) {
    assert.throws(() => readNpy(bytes), words);
  }
  assert.throws(() => npy(Float32Array.of(1), [2]), /not those of the shape/);
  assert.throws(() => npy([1], [1]), /Float32Array/);
});

test('cases are listed', () => {
  assert.ok(cases().length > 200);
  const [found] = cases('figures/figure-1');
  assert.strictEqual(found.kind, 'deterministic');
  assert.throws(() => cases('figure-99'), VolrefError);
  for (const wrong of ['', '--json', 7]) assert.throws(() => cases(wrong), /no case matches/);
});

test('an image is judged', () => {
  const image = rendered('figures/figure-1');
  const right = check('figures/figure-1', image);
  assert.ok(right.passed, String(right));
  const black = check(
    'figures/figure-1',
    { ...image, data: new Float32Array(image.data.length) },
    { report: within('report') },
  );
  assert.strictEqual(black.verdict, 'fail');
  assert.match(String(black), /nothing was drawn: .*\nreport: /s);
  assert.ok(fs.existsSync(black.report) && !black.reason.includes(os.tmpdir()));
});

test('conventions are accepted where that is asked for', () => {
  const [{ sceneFile }] = cases('sampled/thin');
  const fixtures = path.resolve(path.dirname(sceneFile), '../..');
  const scene = fs.readFileSync(sceneFile, 'utf8').replaceAll('../../', `${fixtures}/`);
  const file = within('other.toml');
  fs.writeFileSync(file, `${scene}\n[classified.conventions]\nopacity = "linear"\n`);
  const image = rendered(file);
  const found = check('sampled/thin', image);
  assert.deepStrictEqual([found.verdict, found.passed], ['convention', false], String(found));
  const accepted = check('sampled/thin', image, { acceptConventions: true });
  assert.deepStrictEqual([accepted.verdict, accepted.passed], ['convention', true], String(accepted));
});

test('codes are those of the exposure, or with 8-linear of radiance', () => {
  // Its exposure is 3 stops.
  const image = codesOf(rendered('limit/thin-haze'));
  const data = Uint8Array.from({ length: (image.data.length / 3) * 4 }, (_, k) =>
    k % 4 < 3 ? image.data[3 * (k >> 2) + (k % 4)] : 255,
  );
  const images = { 1: { ...image, data }, 0.5: image, 0.25: image };
  assert.ok(check('limit/thin-haze', images, { bits: '8-linear', explain: 0 }).passed);
  assert.ok(!check('limit/thin-haze', images, { explain: 0 }).passed);
});

test('a transparent image keeps its opacity, and is put before the background', () => {
  const { width, height, data: right } = rendered('scenes/opacity-over-grey');
  const { background } = exportBundle('scenes/opacity-over-grey');
  // Straight, as getImageData has it, in floats: what is clear has no colour.
  const straight = right.map((value, k) => {
    const opacity = right[k - (k % 4) + 3];
    if (k % 4 === 3) return value;
    return opacity > 0 ? (value - (1 - opacity) * background[k % 4]) / opacity : 0;
  });
  const judge = (data, options) => check('scenes/opacity-over-grey', { width, height, data, ...options }, { explain: 0 });
  assert.ok(judge(straight, { alpha: 'straight' }).passed, String(judge(straight, { alpha: 'straight' })));
  assert.strictEqual(judge(straight).verdict, 'fail');
  const squared = straight.map((value, k) => (k % 4 === 3 ? value * value : value));
  assert.match(String(judge(squared, { alpha: 'straight' })), /opacity/);
  const codes = { width: 1, height: 2, data: Uint8Array.of(255, 0, 0, 128, 0, 0, 0, 255) };
  writeImage(within('codes.npy'), codes);
  assert.deepStrictEqual(readNpy(fs.readFileSync(within('codes.npy'))).shape, [2, 1, 4]);
  assert.throws(() => writeImage(within('codes.png'), codes), /is transparent.*bits: '8-linear'/);
});

test('errors speak of options, not of flags', () => {
  const image = { width: 64, height: 64, data: new Float32Array(3 * 64 * 64) };
  const message = (options) => {
    try {
      return String(check('sampled/thin', image, { explain: 0, ...options }));
    } catch (error) {
      return error.message;
    }
  };
  for (const [options, words] of [
    [{ bits: 7 }, /^bits is '7': /],
    [{ explain: 'long' }, /^explain is 'long': /],
    [{ alpha: 'straight' }, /and alpha: 'straight' is declared: .*, or leave alpha out/],
    [{ profile: 'nobody' }, /nobody/],
    [{ suite: within('nowhere') }, /nowhere/],
    [{ accept: true }, /^check has no option accept: give profile, bits, alpha, acceptConventions/],
  ]) {
    assert.match(message(options), words);
    assert.doesNotMatch(message(options), /--\w|`volref /);
  }
  assert.throws(
    () => cases('figure-99'),
    ({ message }) => /no case matches/.test(message) && !/--\w|`volref/.test(message),
  );
});

test('what is no image is rejected before the program is called', () => {
  const judge = (image, options) => () => check('sampled/thin', image, options);
  const [width, height] = [64, 64];
  for (const image of [undefined, null, 7, 'image.png', [], {}]) assert.throws(judge(image), TypeError);
  assert.throws(judge({ width, height, data: [1, 2] }), /its data a Float32Array/);
  assert.throws(judge({ width, height, data: new Float32Array(5) }), /5 values are not 64 × 64 pixels/);
  assert.throws(judge({ 1: {}, 0.3: {} }), /without a gap/);
  assert.throws(() => check(7, {}), TypeError);
  assert.throws(() => check('figures/*', {}), /names 5 cases: give one/);
  assert.throws(judge({ width, height, data: new Uint8Array(3 * width * height) }, { profile: 'nobody' }), VolrefError);
  assert.throws(
    () => writeImage(within('image.exr'), { width, height, data: new Uint8Array(3 * width * height) }),
    /\.npy or \.png/,
  );
});

test('nothing is left of an image that could not be written', () => {
  const image = { width: 1, height: 1, data: Uint8Array.of(1, 2, 3) };
  // The file that was asked for is named, not the one beside it.
  assert.throws(() => writeImage(within('none/image.npy'), image), /cannot write .*image\.npy: ENOENT$/);
  fs.mkdirSync(within('taken/image.npy'), { recursive: true });
  assert.throws(() => writeImage(within('taken/image.npy'), image));
  assert.deepStrictEqual(fs.readdirSync(within('taken')), ['image.npy']);
});

test('a bundle is kept where that is asked', () => {
  exportBundle('sampled/thin', { folder: within('kept') });
  assert.deepStrictEqual(fs.readdirSync(within('kept')).sort(), ['thin.grid-1.raw', 'thin.json']);
});

test('another suite is judged by', () => {
  const suite = within('suite');
  volref('suite', '--extract', suite);
  const scene = path.join(suite, 'fixtures/scenes/sampled/thin.toml');
  assert.strictEqual(cases('sampled/thin', { suite })[0].sceneFile, scene);
  fs.writeFileSync(scene, fs.readFileSync(scene, 'utf8').replace(/width = \d+/, 'width = 32'));
  assert.strictEqual(exportBundle('sampled/thin', { suite }).width, 32);
  assert.strictEqual(exportBundle('sampled/thin').width, 64);
  const black = { width: 64, height: 64, data: new Float32Array(3 * 64 * 64) };
  assert.match(check('sampled/thin', black, { suite, explain: 0 }).verdict, /error|missing/);
});

test('a program that is missing, or another one, is named', () => {
  const known = process.env.VOLREF_PROGRAM;
  const with_ = (file) => {
    process.env.VOLREF_PROGRAM = file;
    try {
      cases();
    } catch (error) {
      return error.message;
    } finally {
      if (known === undefined) delete process.env.VOLREF_PROGRAM;
      else process.env.VOLREF_PROGRAM = known;
    }
  };
  assert.match(with_(within('nothing')), /VOLREF_PROGRAM names .*nothing, where there is no file/);
  assert.match(with_(process.execPath), /is not volref/);
});

test('the script volref is the program', () => {
  const ran = spawnSync(process.execPath, [path.join(PACKAGE, 'volref.js'), 'list', 'figures'], { encoding: 'utf8' });
  assert.strictEqual(ran.status, 0);
  assert.match(ran.stdout, /figures\/figure-1/);
  assert.strictEqual(spawnSync(process.execPath, [path.join(PACKAGE, 'volref.js'), 'list', 'figure-99']).status, 5);
});

test('the package has the version of the program, and depends on nothing that somebody else could publish', () => {
  const description = JSON.parse(fs.readFileSync(path.join(PACKAGE, 'package.json'), 'utf8'));
  assert.strictEqual(volref('--version').trim(), `volref ${description.version}`);
  assert.deepStrictEqual([description.name, description.private], ['volref', true]);
  const depends = Object.keys(description).filter((key) => /dependencies/i.test(key));
  assert.deepStrictEqual(depends, []);
});

// A reference renderer for volumes, and golden images that other volume renderers are tested against.

import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { Bundle } from './bundle.js';
import { npy, png } from './files.js';
import { VolrefError, call, inTermsOfJavaScript } from './program.js';

export { VolrefError, program } from './program.js';

const MOST_HALVINGS = 10;
const OPTIONS = ['profile', 'bits', 'alpha', 'acceptConventions', 'explain', 'report', 'suite'];
const FILE_KEYS = ['file', 'vertices', 'triangles'];

/** The cases that the filters name: families, cases, or patterns such as `figures/*`, with `!` before them excluded; all without one. */
export function cases(...filters) {
  const suite = typeof filters.at(-1) === 'object' ? filters.pop().suite : undefined;
  const wrong = filters.find((filter) => typeof filter !== 'string' || !filter || filter.startsWith('-'));
  if (wrong !== undefined) throw new VolrefError(`no case matches ${JSON.stringify(wrong)} (cases() lists all cases)`);
  return call(['list', ...filters, ...suiteWords(suite)]).cases.map((found) => ({
    name: found.name,
    family: found.family,
    kind: found.class,
    gate: found.gate,
    source: found.source,
    shows: found.shows,
    computes: found.computes,
    exposure: found.exposure,
    sceneFile: path.resolve(found.scene),
  }));
}

/** The verdict on an image of a case: see `Result` in index.d.ts. */
export class Result {
  #acceptsConventions;

  constructor(acceptsConventions = false) {
    this.#acceptsConventions = acceptsConventions;
  }

  get passed() {
    return this.verdict === 'pass' || (this.#acceptsConventions && this.verdict === 'convention');
  }

  toString() {
    const likely = this.looksLike.map(({ name, advice }) => `looks like ${name}: ${advice}`);
    const page = this.report ? [`report: ${this.report}`] : [];
    return [`${this.name}: ${this.verdict}`, this.reason, ...likely, ...this.difference, ...page].join('\n');
  }
}

/**
 * Judges an image of a case: an `Image`; an array of them, renderings with seeds of their own; or for a case of the
 * family `limit` an object by the factor on the step, `{ 1: a, 0.5: b, 0.25: c }`.
 */
export function check(name, image, options = {}) {
  const unknown = Object.keys(options).find((option) => !OPTIONS.includes(option));
  if (unknown !== undefined) throw new TypeError(`check has no option ${unknown}: give ${OPTIONS.join(', ')}`);
  const { profile, bits, acceptConventions = false, explain, report, suite } = options;
  const alpha = options.alpha ?? declaredAlpha(image);
  const { name: found } = one(name, suite);
  return inTemporaryFolder((folder) => {
    // A PNG would hold the codes at the exposure of the case.
    const isRadiance = bits === '8-linear' || profile !== undefined;
    for (const [file, each] of named(found, image)) write(path.join(folder, file), each, isRadiance);
    const value = call([
      'validate',
      found,
      `--outputs=${folder}`,
      ...(explain === undefined ? [] : [`--explain=${explain}`]),
      ...(profile === undefined ? [] : [`--as=${profile}`]),
      ...(bits === undefined ? [] : [`--bits=${bits}`]),
      ...(alpha === undefined ? [] : [`--alpha=${alpha}`]),
      ...(acceptConventions ? ['--accept-conventions'] : []),
      ...(report === undefined ? [] : [`--report=${report}`]),
      ...suiteWords(suite),
    ]);
    const [judged] = value.cases;
    const words = inTermsOfJavaScript;
    const advice = new Map((value.looks_like ?? []).map((mistake) => [mistake.mistake, words(mistake.advice)]));
    return Object.assign(new Result(acceptConventions), {
      name: judged.name,
      verdict: judged.verdict,
      // Nobody finds a folder for temporary files again.
      reason: words(judged.reason.replaceAll(folder + path.sep, '')),
      gate: judged.gate,
      looksLike: judged.looks_like.map((mistake) => ({ name: mistake, advice: advice.get(mistake) ?? '' })),
      conventions: judged.conventions ?? [],
      difference: (judged.difference ?? []).map(words),
      metrics: judged.metrics,
      searchEnded: judged.search_ended,
      report: report === undefined ? undefined : path.resolve(report, 'index.html'),
    });
  });
}

/** The bundle of a case; its files are kept in `folder`, if one is given. */
export function exportBundle(name, { folder, suite } = {}) {
  const scene = suite === undefined ? text(name) : one(name, suite).sceneFile;
  const exported = (into) => {
    const { main } = call(['export', scene, '--to=bundle', `--output=${into}`]);
    return readBundle(path.join(into, main));
  };
  return folder === undefined ? inTemporaryFolder(exported) : exported(folder);
}

/** The bundle of a file that `volref export --to bundle` wrote. */
export function readBundle(file) {
  const description = JSON.parse(fs.readFileSync(file, 'utf8'));
  const read = (name) => [name, fs.readFileSync(path.join(path.dirname(file), path.basename(name)))];
  return new Bundle(description, Object.fromEntries([...new Set(filesIn(description))].map(read)));
}

/** Names of the files beside a bundle. */
function filesIn(value) {
  if (value === null || typeof value !== 'object') return [];
  return Object.entries(value).flatMap(([key, part]) =>
    FILE_KEYS.includes(key) && typeof part === 'string' ? [part] : filesIn(part),
  );
}

/** Writes an image as NPY, where codes of 8 bits are divided by 255, or as PNG without opacity, whole or not at all. */
export function writeImage(file, { width, height, data }) {
  const extension = path.extname(file).toLowerCase();
  if (!['.npy', '.png'].includes(extension)) {
    throw new VolrefError(`${file}: images are written as .npy or .png (validate --format npy)`);
  }
  const isFloat = data instanceof Float32Array;
  if (extension === '.png' && isFloat) throw new VolrefError(`${file}: a PNG holds codes of 8 bits, and not floats`);
  const channels = data.length / (width * height);
  const values = isFloat ? data : Float32Array.from(data, (code) => code / 255);
  const isPng = extension === '.png';
  if (isPng && isTransparent(data, channels)) throw new TypeError(TRANSPARENT);
  const bytes = isPng ? png(colours(data, channels), width, height) : npy(values, [height, width, channels]);
  const beside = `${file}.${process.pid}.part`;
  try {
    fs.writeFileSync(beside, bytes);
    fs.renameSync(beside, file);
  } catch (error) {
    fs.rmSync(beside, { force: true });
    throw new VolrefError(`cannot write ${file}: ${error.code}`);
  }
}

const TRANSPARENT =
  "the image is transparent, and sRGB codes cannot be put before a background: draw the scene's background on the " +
  "canvas (a WebGL context takes { alpha: false }), or draw radiance and give bits: '8-linear'";

/** Some opacity is not 1, and it is not 0 everywhere, as where nobody wrote it. */
function isTransparent(data, channels) {
  if (channels !== 4) return false;
  let [isClear, isOpaque] = [true, true];
  for (let at = 3; at < data.length; at += 4) [isClear, isOpaque] = [isClear && data[at] === 0, isOpaque && data[at] === 255];
  return !isClear && !isOpaque;
}

/** Whether colours are multiplied by opacity, as a transparent canvas says it. */
function declaredAlpha(image) {
  const { data, width, height, alpha } = (Array.isArray(image) ? image[0] : image) ?? {};
  return alpha !== undefined && isTransparent(data, data.length / (width * height)) ? alpha : undefined;
}

/** Codes without opacity. */
function colours(data, channels) {
  return channels === 3 ? data : data.filter((_, index) => index % 4 < 3);
}

function text(name) {
  if (typeof name !== 'string') throw new TypeError(`the name of a case is text, family/name, and not ${typeof name}`);
  return name;
}

function one(name, suite) {
  const found = cases(text(name), { suite });
  if (found.length !== 1) throw new VolrefError(`${name} names ${found.length} cases: give one, as family/name`);
  return found[0];
}

/** The images of a case by the names of their files. */
function named(name, image) {
  if (Array.isArray(image)) {
    if (image.length === 0) throw new TypeError('the list of images is empty');
    return image.map((each, index) => [`${name}.${index}`, each]);
  }
  if (image && typeof image === 'object' && !('data' in image)) {
    const factors = Object.keys(image)
      .map(Number)
      .sort((a, b) => b - a);
    if (factors.length === 0 || factors.length > MOST_HALVINGS || factors.some((factor, k) => factor !== 0.5 ** k)) {
      throw new TypeError(`factors on the step are 1, 0.5, 0.25 and so on without a gap, not ${Object.keys(image)}`);
    }
    return factors.map((factor) => [factor === 1 ? name : `${name}@${factor}`, image[factor]]);
  }
  return [[name, image]];
}

/** Writes floats, or codes of 8 bits, in the format that stands for them. */
function write(file, image, isRadiance) {
  const { width, height, data } = image ?? {};
  const isFloat = data instanceof Float32Array;
  const isCodes = data instanceof Uint8Array || data instanceof Uint8ClampedArray;
  const channels = data?.length / (width * height);
  if (!isFloat && !isCodes) {
    throw new TypeError(
      'an image is { width, height, data }, its data a Float32Array, Uint8Array or Uint8ClampedArray',
    );
  }
  if (![3, 4].includes(channels)) {
    throw new TypeError(`${data.length} values are not ${width} × ${height} pixels of 3 or 4 channels`);
  }
  fs.mkdirSync(path.dirname(file), { recursive: true });
  writeImage(`${file}.${isFloat || isRadiance ? 'npy' : 'png'}`, image);
}

function suiteWords(suite) {
  return suite === undefined ? [] : [`--suite=${suite}`];
}

function inTemporaryFolder(work) {
  const folder = fs.mkdtempSync(path.join(fs.realpathSync(os.tmpdir()), 'volref-'));
  try {
    return work(folder);
  } finally {
    fs.rmSync(folder, { recursive: true, force: true });
  }
}

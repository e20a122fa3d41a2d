// The program that the package calls.

import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';

const VARIABLE = 'VOLREF_PROGRAM';
const MOST_PRINTED = 1 << 30;
const FILE = process.platform === 'win32' ? 'volref.exe' : 'volref';

/** The program could not do what it was asked to: says why, and what to do. */
export class VolrefError extends Error {
  name = 'VolrefError';
}

const isFile = (file) => fs.statSync(file, { throwIfNoEntry: false })?.isFile() ?? false;

/** The package that brings the program for this platform. */
export const platformPackage = () => `@volref/${process.platform}-${process.arch}`;

/** Path of the program: that of $VOLREF_PROGRAM, else the one of the platform's package, else the one on the path. */
export function program() {
  const given = process.env[VARIABLE];
  if (given) {
    if (!isFile(given)) throw new VolrefError(`${VARIABLE} names ${given}, where there is no file`);
    return given;
  }
  try {
    const description = createRequire(import.meta.url).resolve(`${platformPackage()}/package.json`);
    return path.join(path.dirname(description), 'bin', FILE);
  } catch (error) {
    if (error.code !== 'MODULE_NOT_FOUND') throw error;
  }
  const folders = (process.env.PATH ?? '').split(path.delimiter).filter(Boolean);
  const found = folders.map((folder) => path.join(folder, FILE)).find(isOtherProgram);
  if (found) return found;
  throw new VolrefError(
    `there is no program volref: the optional package ${platformPackage()} was not installed, or there is none for this ` +
      `platform. Install again with optional packages (npm install --include=optional); or build the program with Rust ` +
      `(cargo install --path . in a clone of volref); or name a program: ${VARIABLE}=PATH`,
  );
}

/** A program on the path, but for the script of this package, which npm puts there. */
function isOtherProgram(file) {
  return isFile(file) && path.extname(fs.realpathSync(file)) !== '.js';
}

/** What the program prints as JSON. */
export function call(words) {
  const file = program();
  const ran = run(file, [...words, '--json']);
  const value = parsed(ran.stdout);
  if (!value?.schema) {
    if (!run(file, ['--version']).stdout?.startsWith('volref ')) {
      throw new VolrefError(`${file} is not volref: it does not answer to --version as volref does`);
    }
    const end = ran.signal ? `was ended by ${ran.signal}` : `ended with exit code ${ran.status}`;
    throw new VolrefError(`${file} ${words[0]} ${end}:\n${(ran.stderr || ran.stdout).trim()}`);
  }
  if (value.schema !== 'volref/error/1') return value;
  const message = value.error.replace(/^error: /, '').replace(/\s*For more information, try '--help'\.\s*$/, '');
  throw new VolrefError(value.help ? `${message} (${value.help})` : message);
}

function run(file, words) {
  const options = { encoding: 'utf8', maxBuffer: MOST_PRINTED, stdio: ['ignore', 'pipe', 'pipe'], windowsHide: true };
  const ran = spawnSync(file, words, options);
  if (ran.error) throw new VolrefError(`cannot run ${file}: ${ran.error.message}`);
  return ran;
}

function parsed(text) {
  try {
    return JSON.parse(text);
  } catch {
    return undefined;
  }
}

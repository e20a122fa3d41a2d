// The program that the package calls.

import { spawnSync } from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const VARIABLE = 'VOLREF_PROGRAM';
const MOST_PRINTED = 1 << 30;
const FILE = process.platform === 'win32' ? 'volref.exe' : 'volref';

/** The program could not do what it was asked to: says why, and what to do. */
export class VolrefError extends Error {
  name = 'VolrefError';
}

const isFile = (file) => fs.statSync(file, { throwIfNoEntry: false })?.isFile() ?? false;

/** Path of the program: that of $VOLREF_PROGRAM, else the one that the package brings, else the one on the path. */
export function program() {
  const given = process.env[VARIABLE];
  if (given) {
    if (!isFile(given)) throw new VolrefError(`${VARIABLE} names ${given}, where there is no file`);
    return given;
  }
  const brought = path.join(path.dirname(fileURLToPath(import.meta.url)), 'bin', FILE);
  if (isFile(brought)) return brought;
  const folders = (process.env.PATH ?? '').split(path.delimiter).filter(Boolean);
  const found = folders.map((folder) => path.join(folder, FILE)).find(isOtherProgram);
  if (found) return found;
  throw new VolrefError(
    `there is no program volref: this package brings none. Install one that npm/pack.mjs made in a clone of volref, or that ` +
      `a release has for ${process.platform}-${process.arch}; or build the program with Rust (cargo install --path . in the ` +
      `clone); or name a program: ${VARIABLE}=PATH`,
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
  throw new VolrefError(inTermsOfJavaScript(value.help ? `${message} (${value.help})` : message));
}

/** Flags of the program by the options of this package. */
const OPTIONS = {
  as: 'profile',
  alpha: 'alpha',
  bits: 'bits',
  explain: 'explain',
  report: 'report',
  suite: 'suite',
  'accept-conventions': 'acceptConventions',
};

/** A text of the program, with this package's functions and options in place of commands and flags. */
export function inTermsOfJavaScript(text) {
  const flag = new RegExp(`--(${Object.keys(OPTIONS).join('|')})(?![\\w-])(?:[ =]([\\w.-]*\\w))?`, 'g');
  return text
    .replace(/invalid value '(.*?)' for '--([\w-]+) <\S+>': /g, (_, value, name) => `${OPTIONS[name] ?? name} is '${value}': `)
    .replace("run volref in the suite's folder, or give the folder with --suite DIR", 'give the folder of a suite as suite')
    .replace(/`volref list[^`]*` shows/g, 'cases() lists')
    .replace(/`volref list[^`]*`/g, 'cases()')
    .replace(flag, (_, name, value) => said(OPTIONS[name], value));
}

/** An option with its value, unless that is a word for any; what follows a flag without a value is none. */
function said(option, value) {
  if (option === 'acceptConventions') return `${option}: true${value ? ` ${value}` : ''}`;
  if (value === undefined || /^[A-Z]+$/.test(value)) return option;
  const isValue = /^(\d[\w.-]*|premultiplied|straight)$/.test(value);
  return isValue ? `${option}: ${/^[\d.]+$/.test(value) ? value : `'${value}'`}` : `${option} ${value}`;
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

#!/usr/bin/env node
// Renders bundles with a module of a web page: once, or as a renderer that stays.

import readline from 'node:readline';
import { parseArgs } from 'node:util';
import { Refusal } from './bundle.js';
import { readBundle, writeImage } from './index.js';
import { startPage } from './page.js';

const USAGE = `volref-page MODULE BUNDLE OUTPUT [--step H]
volref-page MODULE --serve

Renders bundles in Chromium by the function render(element, bundle, step) that MODULE exports; OUTPUT is .npy or .png.

  volref validate sampled --format npy --serve 'volref-page MODULE --serve {export:bundle} {step}'

  --step H       distance between samples, world units
  --serve        read requests and answer them, by the protocol of volref validate --serve
  --timeout S    limit for an image, seconds [default: 60]
  --help         print this`;

async function main() {
  const { values, positionals } = parsed();
  if (values.help) return console.log(USAGE);
  const [module, bundle, output, ...others] = positionals;
  const isWhole = values.serve ? module && !bundle : output && others.length === 0;
  if (!isWhole) return usage('give MODULE BUNDLE OUTPUT, or MODULE --serve');
  const timeout = number('timeout', values.timeout ?? '60');
  const step = values.step === undefined ? undefined : number('step', values.step);
  const page = await startPage(module, { timeout });
  try {
    if (values.serve) await serve(page);
    else await draw(page, bundle, output, step);
  } finally {
    await page.close();
  }
}

function parsed() {
  const options = { step: 'string', timeout: 'string', serve: 'boolean', help: 'boolean' };
  const typed = Object.fromEntries(Object.entries(options).map(([name, type]) => [name, { type }]));
  try {
    return parseArgs({ options: typed, allowPositionals: true });
  } catch (error) {
    return usage(error.message);
  }
}

function number(name, text) {
  const value = Number(text);
  return value > 0 && Number.isFinite(value) ? value : usage(`--${name} is ${text}: give a positive number`);
}

function usage(fault) {
  console.error(`${fault}\n\n${USAGE}`);
  process.exit(2);
}

async function draw(page, bundle, output, step) {
  const { messages, ...image } = await page.render(readBundle(bundle), step);
  for (const message of messages) console.error(`console: ${message}`);
  writeImage(output, image);
}

/** Answers each request with a line; ends with standard input. */
async function serve(page) {
  for await (const line of readline.createInterface({ input: process.stdin })) {
    process.stdout.write(`${JSON.stringify(await answer(page, line))}\n`);
  }
}

async function answer(page, line) {
  try {
    const request = JSON.parse(line);
    if (request?.volref !== 1) throw new Error(`a request of the protocol ${request?.volref}, and not 1`);
    const { 'export:bundle': bundle, output, step } = request;
    if (!bundle) throw new Error('the request has no bundle: name {export:bundle} in the command');
    if (!output) throw new Error('the request has no output');
    await draw(page, bundle, output, step);
    return { image: output };
  } catch (error) {
    return error instanceof Refusal ? { cannot: error.message } : { error: error.message };
  }
}

// Nobody reads the answers.
process.stdout.on('error', () => process.exit(1));
main().catch((error) => {
  console.error(error instanceof Refusal ? `refused: ${error.message}` : error.message);
  process.exit(1);
});

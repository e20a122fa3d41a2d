#!/usr/bin/env node
// Makes the npm package `volref`, with the program for a platform: a file that npm installs. No registry has it.
//
//     npm/pack.mjs FOLDER                                  this platform, target/release/volref
//     npm/pack.mjs FOLDER linux-x64=PATH darwin-arm64=PATH

import { execFileSync } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { fileURLToPath } from 'node:url';

const HERE = path.dirname(fileURLToPath(import.meta.url));
const ROOT = path.dirname(HERE);
const main = JSON.parse(fs.readFileSync(path.join(HERE, 'package.json'), 'utf8'));
const PLATFORMS = ['darwin-arm64', 'linux-x64', 'win32-x64'];
const program = (system) => (system === 'win32' ? 'volref.exe' : 'volref');

/** Packs the package with the program of a platform. */
function pack(platform, binary, staged, into) {
  const [system, processor] = platform.split('-');
  const description = {
    ...main,
    os: [system],
    cpu: [processor],
    ...(system === 'linux' ? { libc: ['glibc'] } : {}),
    // Packages in archives of their own cannot hold a program that is run.
    preferUnplugged: true,
  };
  const folder = path.join(staged, platform);
  fs.mkdirSync(path.join(folder, 'bin'), { recursive: true });
  const isPart = (name) => /\.(js|d\.ts)$/.test(name) || name === 'README.md';
  for (const name of fs.readdirSync(HERE).filter(isPart))
    fs.copyFileSync(path.join(HERE, name), path.join(folder, name));
  for (const license of ['LICENSE-APACHE', 'LICENSE-MIT'])
    fs.copyFileSync(path.join(ROOT, license), path.join(folder, license));
  fs.copyFileSync(binary, path.join(folder, 'bin', program(system)));
  fs.chmodSync(path.join(folder, 'bin', program(system)), 0o755);
  fs.writeFileSync(path.join(folder, 'package.json'), `${JSON.stringify(description, undefined, 2)}\n`);
  const windows = process.platform === 'win32';
  // Through the shell, which would split it.
  const words = ['pack', '--silent', `--pack-destination=${windows ? `"${folder}"` : folder}`];
  const packed = execFileSync(windows ? 'npm.cmd' : 'npm', words, { cwd: folder, encoding: 'utf8', shell: windows });
  const name = `${main.name}-${main.version}-${platform}.tgz`;
  fs.copyFileSync(path.join(folder, packed.trim()), path.join(into, name));
  console.log(name);
}

function fault(words) {
  console.error(`${words}\n\npack.mjs FOLDER [PLATFORM=BINARY...], platforms: ${PLATFORMS.join(', ')}`);
  process.exit(2);
}

const [target, ...given] = process.argv.slice(2);
if (!target) fault('give a folder for the packages');
const own = `${process.platform}-${process.arch}`;
const words = given.length > 0 ? given : [`${own}=${path.join(ROOT, 'target', 'release', program(process.platform))}`];
const binaries = words.map((word) => word.split(/=(.*)/s));
for (const [platform, binary] of binaries) {
  if (!PLATFORMS.includes(platform)) fault(`${platform} is none of the platforms`);
  if (!binary || !fs.existsSync(binary)) fault(`${platform}: there is no program ${binary}`);
}
const into = path.resolve(target);
fs.mkdirSync(into, { recursive: true });
const staged = fs.mkdtempSync(path.join(os.tmpdir(), 'volref-pack-'));
try {
  for (const [platform, binary] of binaries) pack(platform, binary, staged, into);
} finally {
  fs.rmSync(staged, { recursive: true, force: true });
}

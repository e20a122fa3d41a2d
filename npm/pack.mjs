#!/usr/bin/env node
// Makes the npm packages: `volref`, and for each binary one that brings the program for its platform.
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
const platforms = Object.keys(main.optionalDependencies).map((name) => name.slice('@volref/'.length));
const program = (system) => (system === 'win32' ? 'volref.exe' : 'volref');

/** The package of a platform, in a folder of its own. */
function platformPackage(platform, binary, folder) {
  const [system, processor] = platform.split('-');
  const description = {
    name: `@volref/${platform}`,
    version: main.version,
    description: `The program volref for ${platform}`,
    license: main.license,
    os: [system],
    cpu: [processor],
    ...(system === 'linux' ? { libc: ['glibc'] } : {}),
    // Packages in archives of their own cannot hold a program that is run.
    preferUnplugged: true,
  };
  fs.mkdirSync(path.join(folder, 'bin'), { recursive: true });
  fs.copyFileSync(binary, path.join(folder, 'bin', program(system)));
  fs.chmodSync(path.join(folder, 'bin', program(system)), 0o755);
  fs.writeFileSync(path.join(folder, 'package.json'), `${JSON.stringify(description, undefined, 2)}\n`);
}

function packed(folder, into) {
  for (const license of ['LICENSE-APACHE', 'LICENSE-MIT'])
    fs.copyFileSync(path.join(ROOT, license), path.join(folder, license));
  const windows = process.platform === 'win32';
  // Through the shell, which would split it.
  const words = ['pack', '--silent', `--pack-destination=${windows ? `"${into}"` : into}`];
  console.log(
    execFileSync(windows ? 'npm.cmd' : 'npm', words, { cwd: folder, encoding: 'utf8', shell: windows }).trim(),
  );
}

function fault(words) {
  console.error(`${words}\n\npack.mjs FOLDER [PLATFORM=BINARY...], platforms: ${platforms.join(', ')}`);
  process.exit(2);
}

const [target, ...given] = process.argv.slice(2);
if (!target) fault('give a folder for the packages');
const own = `${process.platform}-${process.arch}`;
const words = given.length > 0 ? given : [`${own}=${path.join(ROOT, 'target', 'release', program(process.platform))}`];
const binaries = words.map((word) => word.split(/=(.*)/s));
for (const [platform, binary] of binaries) {
  if (!platforms.includes(platform)) fault(`${platform} is none of the platforms`);
  if (!binary || !fs.existsSync(binary)) fault(`${platform}: there is no program ${binary}`);
}
const into = path.resolve(target);
fs.mkdirSync(into, { recursive: true });
const staged = fs.mkdtempSync(path.join(os.tmpdir(), 'volref-pack-'));
try {
  for (const [platform, binary] of binaries) {
    platformPackage(platform, binary, path.join(staged, platform));
    packed(path.join(staged, platform), into);
  }
  const folder = path.join(staged, 'volref');
  fs.mkdirSync(folder);
  const isPart = (name) => /\.(js|d\.ts)$/.test(name) || ['README.md', 'package.json'].includes(name);
  for (const name of fs.readdirSync(HERE).filter(isPart))
    fs.copyFileSync(path.join(HERE, name), path.join(folder, name));
  packed(folder, into);
} finally {
  fs.rmSync(staged, { recursive: true, force: true });
}

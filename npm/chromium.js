// Chromium by its DevTools protocol, over the pipes that it reads as 3 and writes as 4.

import { spawn } from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

const CHROMIUM = ['chromium', 'chromium-browser', 'google-chrome', 'google-chrome-stable', 'chrome'];
const NAMES = [...CHROMIUM, 'microsoft-edge', 'msedge'];
const ENDING = process.platform === 'win32' ? '.exe' : '';
const PLACES = {
  darwin: [
    '/Applications/Google Chrome.app/Contents/MacOS/Google Chrome',
    '/Applications/Chromium.app/Contents/MacOS/Chromium',
  ],
  win32: [
    'C:\\Program Files\\Google\\Chrome\\Application\\chrome.exe',
    'C:\\Program Files (x86)\\Microsoft\\Edge\\Application\\msedge.exe',
  ],
};
const FLAGS = [
  '--headless=new',
  '--remote-debugging-pipe',
  '--no-first-run',
  '--no-default-browser-check',
  '--disable-background-networking',
  '--disable-breakpad',
  '--disable-component-update',
  '--disable-default-apps',
  '--disable-dev-shm-usage',
  '--disable-extensions',
  '--disable-sync',
  '--force-color-profile=srgb',
  '--force-device-scale-factor=1',
  '--hide-scrollbars',
  '--mute-audio',
  '--password-store=basic',
  '--use-mock-keychain',
];
// Mesa draws without a screen: SwiftShader, Chromium's own, moves the corners of triangles by up to 1/32 of a pixel.
const GRAPHICS = ['--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist', '--enable-unsafe-swiftshader'];
const PREFIX = 'volref-page-';
// Tells our profiles from any other folder with such a name.
const MARK = 'made-by-volref-page';
const SIGNALS = ['SIGINT', 'SIGTERM', 'SIGHUP'];
const MOST_SAID = 4096;
// A browser that starts has its lock long before.
const LONGEST_START = 600_000;

/** Path of Chromium: that of $CHROMIUM, else one on the path, or where systems install it; or none. */
export function findChromium() {
  if (process.env.CHROMIUM) return process.env.CHROMIUM;
  const folders = (process.env.PATH ?? '').split(path.delimiter).filter(Boolean);
  const named = NAMES.flatMap((name) => folders.map((folder) => path.join(folder, name + ENDING)));
  return [...named, ...(PLACES[process.platform] ?? [])].find((file) => fs.existsSync(file));
}

/** A browser without a window, which ends with this process. */
export class Chromium {
  #child;
  #profile;
  #waiting = new Map();
  #listeners = new Map();
  #last = 0;
  #said = '';
  #fault;
  #onSignal = (signal) => {
    this.end();
    // Without another listener the signal would end this process.
    if (process.listenerCount(signal) === 0) process.kill(process.pid, signal);
  };
  #onExit = () => this.end();

  constructor() {
    const program = findChromium();
    if (!program) throw new Error('there is no Chromium: install one, or name it as CHROMIUM=PATH');
    removeLeftProfiles();
    this.#profile = fs.mkdtempSync(path.join(os.tmpdir(), PREFIX));
    fs.writeFileSync(path.join(this.#profile, MARK), '');
    const isLinux = process.platform === 'linux';
    const flags = [...FLAGS, ...(isLinux ? GRAPHICS : []), ...(process.getuid?.() === 0 ? ['--no-sandbox'] : [])];
    this.#child = spawn(program, [...flags, `--user-data-dir=${this.#profile}`, 'about:blank'], {
      // Its own group, so that all that it starts is ended.
      detached: process.platform !== 'win32',
      env: isLinux ? { EGL_PLATFORM: 'surfaceless', ...process.env, TMPDIR: this.#profile } : process.env,
      stdio: ['ignore', 'ignore', 'pipe', 'pipe', 'pipe'],
      windowsHide: true,
    });
    this.#child.on('error', (error) => this.#fail(`cannot run ${program}: ${error.message}`));
    this.#child.on('exit', (code, signal) => {
      const said = this.#said.trim().split('\n').slice(-5).join('\n');
      this.#fail(`Chromium ended ${signal ? `by ${signal}` : `with exit code ${code}`}${said ? `:\n${said}` : ''}`);
    });
    this.#child.stderr.setEncoding('utf8').on('data', (text) => (this.#said = (this.#said + text).slice(-MOST_SAID)));
    this.#child.stdio[3].on('error', () => {});
    this.#child.stdio[4].on('error', () => {});
    this.#read(this.#child.stdio[4]);
    // The process may end while the browser waits.
    for (const stream of [this.#child, this.#child.stderr, this.#child.stdio[3], this.#child.stdio[4]]) stream.unref();
    for (const signal of SIGNALS) process.once(signal, this.#onSignal);
    process.once('exit', this.#onExit);
  }

  /** The browser was ended, or ended by itself. */
  get hasEnded() {
    return this.#fault !== undefined;
  }

  /** Calls a method of the protocol; the answer, or its error. */
  send(method, params = {}, sessionId = undefined) {
    if (this.#fault) return Promise.reject(this.#fault);
    const id = ++this.#last;
    return new Promise((resolve, reject) => {
      this.#waiting.set(id, { resolve, reject, method });
      this.#child.stdio[3].write(`${JSON.stringify({ id, method, params, sessionId })}\0`);
    });
  }

  /** Calls `heard(method, params)` for the events of a session; returns what ends that. */
  listen(sessionId, heard) {
    this.#listeners.set(sessionId, heard);
    return () => this.#listeners.delete(sessionId);
  }

  /** Ends the browser with all that it started, and removes its profile. */
  end() {
    this.#fail('Chromium was ended');
    for (const signal of SIGNALS) process.off(signal, this.#onSignal);
    process.off('exit', this.#onExit);
    try {
      if (process.platform === 'win32') this.#child.kill();
      else process.kill(-this.#child.pid, 'SIGKILL');
    } catch {
      // It has ended.
    }
    // Processes that are being ended may still write there.
    try {
      fs.rmSync(this.#profile, { recursive: true, force: true, maxRetries: 10, retryDelay: 50 });
    } catch {
      // A later browser removes it.
    }
  }

  #read(stream) {
    let parts = [];
    stream.on('data', (bytes) => {
      let first = 0;
      for (let end = bytes.indexOf(0); end >= 0; end = bytes.indexOf(0, first)) {
        const message = Buffer.concat([...parts, bytes.subarray(first, end)]).toString();
        [parts, first] = [[], end + 1];
        this.#hear(JSON.parse(message));
      }
      parts.push(bytes.subarray(first));
    });
  }

  #hear({ id, method, params, result, error, sessionId }) {
    if (id === undefined) return this.#listeners.get(sessionId)?.(method, params);
    const waiting = this.#waiting.get(id);
    this.#waiting.delete(id);
    if (error) waiting?.reject(new Error(`${waiting.method}: ${error.message}`));
    else waiting?.resolve(result);
  }

  #fail(words) {
    this.#fault ??= new Error(words);
    for (const { reject } of this.#waiting.values()) reject(this.#fault);
    this.#waiting.clear();
    for (const heard of this.#listeners.values()) heard('ended', { words });
  }
}

/** Removes profiles of browsers whose starter was killed before it could. */
function removeLeftProfiles() {
  for (const name of fs.readdirSync(os.tmpdir()).filter((name) => name.startsWith(PREFIX))) {
    const folder = path.join(os.tmpdir(), name);
    try {
      if (isLeft(folder)) fs.rmSync(folder, { recursive: true, force: true });
    } catch {
      // It is being removed, or another user's.
    }
  }
}

/** It is a profile of ours whose browser has ended: its lock is gone, or names a process of this machine that is. */
function isLeft(folder) {
  // Not followed, where a link leads to a profile elsewhere.
  if (!fs.lstatSync(folder).isDirectory() || !fs.existsSync(path.join(folder, MARK))) return false;
  // On Windows the lock is another file, which is there while the browser runs.
  if (fs.existsSync(path.join(folder, 'lockfile'))) return false;
  const lock = path.join(folder, 'SingletonLock');
  if (!fs.lstatSync(lock, { throwIfNoEntry: false })) return fs.lstatSync(folder).mtimeMs < Date.now() - LONGEST_START;
  const [, host, pid] = /^(.*)-(\d+)$/.exec(fs.readlinkSync(lock)) ?? [];
  try {
    return host === os.hostname() && !process.kill(Number(pid), 0);
  } catch (error) {
    return error.code === 'ESRCH';
  }
}

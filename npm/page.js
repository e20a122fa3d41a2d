// Renderers of web pages, in Chromium without a screen.

import { randomBytes } from 'node:crypto';
import { once } from 'node:events';
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { Refusal } from './bundle.js';
import { Chromium } from './chromium.js';

export { findChromium } from './chromium.js';

const HERE = path.dirname(fileURLToPath(import.meta.url));
const TYPES = {
  '.css': 'text/css',
  '.html': 'text/html; charset=utf-8',
  '.js': 'text/javascript; charset=utf-8',
  '.json': 'application/json',
  '.mjs': 'text/javascript; charset=utf-8',
  '.svg': 'image/svg+xml',
  '.wasm': 'application/wasm',
};
const BYTES = 'application/octet-stream';
const MISSING = [404, 'text/plain', 'no such file'];
/** Files of this package that pages load. */
const OWN = ['bundle.js', 'files.js', 'in_page.js'];
const LEAST_WINDOW = 64;
const MOST_QUOTED = 3;
const MOST_MESSAGES = 20;
const MOST_LETTERS = 500;

/**
 * A page that renders bundles by a module, which exports `render(element, bundle, step)`: it draws into the element,
 * which has the size of the image, and returns a canvas, an `ImageData`, RGBA codes or radiance as floats.
 * `timeout`: limit for an image in seconds, the start of the browser included.
 */
export async function startPage(module, { timeout = 60 } = {}) {
  const file = path.resolve(module);
  if (!fs.statSync(file, { throwIfNoEntry: false })?.isFile()) throw new Error(`${module}: there is no such file`);
  if (!(timeout > 0 && timeout < 1e6)) throw new TypeError(`timeout is ${timeout}: give a number of seconds`);
  const server = new Server(file);
  await server.listen();
  return new Page(server, timeout);
}

export class Page {
  #server;
  #timeout;
  #browser;
  #last = Promise.resolve();

  constructor(server, timeout) {
    this.#server = server;
    this.#timeout = timeout;
  }

  /** The image of a bundle; by default the step is that of the scene. Images are rendered one after the other. */
  render(bundle, step) {
    if (step !== undefined && !(Number.isFinite(step) && step > 0)) {
      return Promise.reject(new TypeError(`step is ${JSON.stringify(step)}: give a positive number`));
    }
    const image = this.#last.then(() => this.#render(bundle, step));
    this.#last = image.catch(() => {});
    return image;
  }

  /** Ends the browser with all that it started. */
  async close() {
    this.#browser?.end();
    this.#server.close();
  }

  async #render(bundle, step) {
    this.#server.bundle = bundle;
    if (this.#browser?.hasEnded) this.#browser = undefined;
    this.#browser ??= new Chromium();
    const browser = this.#browser;
    const messages = [];
    let timer;
    const late = new Promise((_, reject) => {
      timer = setTimeout(() => {
        browser.end();
        reject(new Error(`the page did not return an image within ${this.#timeout} s; its browser was ended`));
      }, 1000 * this.#timeout);
    });
    try {
      const { width, height } = bundle;
      const image = await Promise.race([late, this.#inTab(browser, bundle, step, messages)]);
      return { width, height, ...image, messages };
    } catch (error) {
      if (browser.hasEnded) browser.end();
      if (error instanceof Refusal) throw error;
      const others = messages.filter((message) => !error.message.includes(message)).slice(0, MOST_QUOTED);
      throw new Error([error.message, ...others.map((message) => `console: ${message}`)].join('\n'));
    } finally {
      clearTimeout(timer);
    }
  }

  async #inTab(browser, { width, height }, step, messages) {
    const { targetId } = await browser.send('Target.createTarget', { url: 'about:blank' });
    const { sessionId } = await browser.send('Target.attachToTarget', { targetId, flatten: true });
    const send = (method, params) => browser.send(method, params, sessionId);
    let stop;
    try {
      const crashed = new Promise((_, reject) => {
        stop = browser.listen(sessionId, (method, params) => {
          if (method === 'Inspector.targetCrashed') reject(new Error('the page crashed'));
          if (method === 'ended') reject(new Error(params.words));
          this.#note(method, params, messages);
        });
      });
      return await Promise.race([crashed, this.#image(send, width, height, step)]);
    } finally {
      stop?.();
      await browser.send('Target.closeTarget', { targetId }).catch(() => {});
    }
  }

  async #image(send, width, height, step) {
    await Promise.all(['Inspector', 'Log', 'Page', 'Runtime'].map((domain) => send(`${domain}.enable`)));
    const [w, h] = [width, height].map((size) => Math.max(size, LEAST_WINDOW));
    await send('Emulation.setDeviceMetricsOverride', { width: w, height: h, deviceScaleFactor: 1, mobile: false });
    const { errorText } = await send('Page.navigate', { url: this.#server.url });
    if (errorText) throw new Error(`the page was not loaded: ${errorText}`);
    const { result, exceptionDetails } = await send('Runtime.evaluate', {
      expression: `import('./volref/in_page.js').then(({ run }) => run(${step ?? ''}))`,
      awaitPromise: true,
      returnByValue: true,
    });
    if (exceptionDetails) throw new Error(this.#words(exceptionDetails));
    if (result.value.cannot !== undefined) throw new Refusal(result.value.cannot);
    const bytes = Uint8Array.from(Buffer.from(result.value.base64, 'base64'));
    const data = result.value.type === 'float' ? new Float32Array(bytes.buffer) : bytes;
    return result.value.alpha === undefined ? { data } : { data, alpha: result.value.alpha };
  }

  /** Notes what the page said on its console, and exceptions that nobody caught. */
  #note(method, params, messages) {
    if (messages.length >= MOST_MESSAGES) return;
    if (method === 'Runtime.consoleAPICalled' && ['error', 'assert'].includes(params.type)) {
      messages.push(this.#short(params.args.map((arg) => arg.description ?? String(arg.value)).join(' ')));
    }
    if (method === 'Runtime.exceptionThrown') messages.push(this.#words(params.exceptionDetails));
    if (method === 'Log.entryAdded' && params.entry.level === 'error') {
      messages.push(this.#short([params.entry.text, params.entry.url].filter(Boolean).join(' ')));
    }
  }

  #words({ exception, text }) {
    const words = this.#short(exception?.description ?? (exception ? `${text} ${exception.value}` : text));
    const isBare = /Failed to resolve module specifier/.test(words);
    return isBare ? `${words} (bundle the module first: esbuild MODULE --bundle --format=esm)` : words;
  }

  /** Text with the names of files in place of addresses. */
  #short(text) {
    const named = String(text).replaceAll(this.#server.modules, '').replaceAll(this.#server.url, '');
    return named.length > MOST_LETTERS ? `${named.slice(0, MOST_LETTERS)}…` : named;
  }
}

/** A server of this machine's alone, for pages that know its address: the module's folder, and the bundle. */
class Server {
  #file;
  #root;
  #token = randomBytes(16).toString('hex');
  #server = http.createServer((request, response) => {
    const [status, type, body] = this.#answer(request.url);
    response.writeHead(status, { 'Content-Type': type, 'Cache-Control': 'no-store', Connection: 'close' }).end(body);
  });
  bundle;

  constructor(file) {
    this.#file = file;
    this.#root = rootOf(path.dirname(file));
  }

  async listen() {
    this.#server.listen(0, '127.0.0.1');
    await once(this.#server, 'listening');
    this.#server.unref();
  }

  get url() {
    return `http://127.0.0.1:${this.#server.address().port}/${this.#token}/`;
  }

  /** Address of the files beside the module. */
  get modules() {
    return `${this.url}files-of-module/`;
  }

  close() {
    this.#server.close();
  }

  #answer(address) {
    try {
      return this.#found(new URL(address, 'http://127.0.0.1').pathname);
    } catch {
      return MISSING;
    }
  }

  #found(pathname) {
    const [token, kind, ...rest] = decodeURIComponent(pathname).slice(1).split('/');
    if (token !== this.#token) return MISSING;
    const name = rest.join('/');
    const { description, files, width, height } = this.bundle;
    const names = Object.keys(files);
    if (kind === '') return [200, TYPES['.html'], html(width, height)];
    if (kind === 'bundle.json') return [200, TYPES['.json'], JSON.stringify({ description, files: names })];
    if (kind === 'files') return [200, BYTES, bytesOf(files[names[Number(name)]])];
    if (kind === 'volref' && OWN.includes(name)) return contents(path.join(HERE, name));
    if (kind === 'module') {
      const within = path.relative(this.#root, this.#file).split(path.sep).map(encodeURIComponent).join('/');
      return [200, TYPES['.js'], `export * from './files-of-module/${within}';`];
    }
    const file = path.join(this.#root, name);
    const isWithin = !path.relative(this.#root, file).startsWith('..');
    return kind === 'files-of-module' && isWithin ? contents(file) : MISSING;
  }
}

const bytesOf = (part) =>
  ArrayBuffer.isView(part) ? new Uint8Array(part.buffer, part.byteOffset, part.byteLength) : new Uint8Array(part);
const contents = (file) => [200, TYPES[path.extname(file)] ?? BYTES, fs.readFileSync(file)];

/** The nearest folder with a package.json from `folder` up, or `folder`: modules import from within it. */
function rootOf(folder) {
  for (let at = folder; at !== path.dirname(at); at = path.dirname(at)) {
    if (fs.existsSync(path.join(at, 'package.json'))) return at;
  }
  return folder;
}

const html = (width, height) => `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<script type="importmap">{ "imports": { "volref/bundle": "./volref/bundle.js" } }</script>
<body style="margin: 0"><div style="width: ${width}px; height: ${height}px"></div>`;

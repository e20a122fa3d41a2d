#!/usr/bin/env node
// Renders a bundle of a classified volume with a renderer of web pages, in Chromium without a screen.
//
//     render.js RENDERER DIR/SCENE.json OUTPUT.npy [STEP]      RENDERER: vtkjs, niivue or tutorial
//
// Needs Node, `npm install` in this folder, and Chromium: that of $CHROMIUM, or `chromium` on the path. Values are
// those of the canvas, codes of 8 bits divided by 255. Each renderer is a module beside this file, which draws a panel
// into an element and returns the codes.
//
// Chromium draws through llvmpipe, as far as it is installed: SwiftShader, its own, moves the corners of triangles,
// and rays with them, by up to 1/32 of a pixel.

import fs from 'node:fs';
import path from 'node:path';
import { execFileSync } from 'node:child_process';
import { fileURLToPath } from 'node:url';
import { build } from 'esbuild';
import puppeteer from 'puppeteer-core';

const here = path.dirname(fileURLToPath(import.meta.url));

function chromium() {
  return process.env.CHROMIUM ?? execFileSync('which', ['chromium'], { encoding: 'utf8' }).trim();
}

/** The page's script: the module of a renderer, with all that it imports. */
async function script(renderer) {
  const result = await build({
    entryPoints: [path.join(here, `${renderer}.js`)],
    bundle: true,
    format: 'iife',
    globalName: 'renderer',
    loader: { '.glsl': 'text' },
    logLevel: 'error',
    write: false,
  });
  return result.outputFiles[0].text;
}

/** NPY, version 1.0, of 32-bit floats. */
function npy(values, shape) {
  const text = `{'descr': '<f4', 'fortran_order': False, 'shape': (${shape.join(', ')}), }`;
  const length = Math.ceil((text.length + 11) / 64) * 64 - 10;
  const head = Buffer.from([0x93, 0x4e, 0x55, 0x4d, 0x50, 0x59, 1, 0, length & 255, length >> 8]);
  const header = Buffer.from(`${text.padEnd(length - 1)}\n`);
  return Buffer.concat([head, header, Buffer.from(Float32Array.from(values).buffer)]);
}

async function main([renderer, bundlePath, output, step]) {
  const bundle = JSON.parse(fs.readFileSync(bundlePath, 'utf8'));
  const [panel, ...others] = bundle.panels;
  if (others.length > 0 || panel.shows !== 'volume') throw new Error('refused: more than one panel, or a plot');
  if (panel.mode) throw new Error('refused: a projection or isosurfaces');
  if (panel.phong) throw new Error('refused: shading');
  const grid = fs.readFileSync(path.join(path.dirname(bundlePath), panel.grid.file));
  const browser = await puppeteer.launch({
    executablePath: chromium(),
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=gl-egl', '--ignore-gpu-blocklist'],
    env: { EGL_PLATFORM: 'surfaceless', ...process.env },
  });
  try {
    const page = await browser.newPage();
    page.on('console', (message) => {
      if (message.type() === 'error') console.error(message.text());
    });
    const { width, height } = panel;
    await page.setViewport({ width: Math.max(width, 64), height: Math.max(height, 64) });
    await page.setContent(`<body style="margin: 0"><div style="width: ${width}px; height: ${height}px">`);
    await page.addScriptTag({ content: await script(renderer) });
    const codes = await page.evaluate(
      async (panel, base64, step) => {
        // Numbers of its own, so that each call makes the same image.
        let state = 1;
        Math.random = () => (state = (state * 1664525 + 1013904223) % 2 ** 32) / 2 ** 32;
        const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
        const values = new Float32Array(bytes.buffer);
        return Array.from(await globalThis.renderer.render(document.querySelector('div'), panel, values, step));
      },
      panel,
      grid.toString('base64'),
      step ? Number(step) : panel.sampling.step,
    );
    const colours = codes.filter((_, index) => index % 4 < 3);
    fs.writeFileSync(output, npy(colours.map((code) => code / 255), [height, width, 3]));
  } finally {
    await browser.close();
  }
}

main(process.argv.slice(2)).catch((error) => {
  console.error(error.message.split('\n')[0]);
  process.exit(1);
});

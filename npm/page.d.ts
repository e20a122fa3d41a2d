import { Bundle } from './bundle.js';
import { Alpha } from './index.js';

/** The image that a page rendered. */
export interface PageImage {
  width: number;
  height: number;
  /** RGBA codes, or radiance of 3 or 4 channels, top row first. */
  data: Uint8Array | Float32Array;
  /** Of a canvas or an `ImageData`: how its colours go with its opacity. */
  alpha?: Alpha;
  /** Errors that the page said on its console. */
  messages: string[];
}

/** A page that renders bundles. */
export interface Page {
  /** The image of a bundle; by default the step is that of the scene. Throws a `Refusal` that the module threw. */
  render(bundle: Bundle, step?: number): Promise<PageImage>;
  /** Ends the browser with all that it started. */
  close(): Promise<void>;
}

/**
 * A page that renders by a module, which exports `render(element, bundle, step)`: it returns a canvas, an `ImageData`,
 * RGBA codes or floats. `timeout`: seconds for an image, the start of the browser included; 60 by default.
 */
export function startPage(module: string, options?: { timeout?: number }): Promise<Page>;
/** Path of Chromium: that of $CHROMIUM, else one on the path, or where systems install it. */
export function findChromium(): string | undefined;

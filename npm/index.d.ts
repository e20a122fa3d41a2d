import { Bundle } from './bundle.js';

/**
 * An image, rows from the top, 3 or 4 channels: floats are linear radiance in front of the background of the scene,
 * codes of 8 bits sRGB at the exposure of the case. Opacity is compared, unless it is 1 or 0 everywhere.
 */
export interface Image {
  width: number;
  height: number;
  data: Float32Array | Uint8Array | Uint8ClampedArray;
  /** Colours beside opacity leave out the background: `straight`, as `getImageData` has them, or `premultiplied`. */
  alpha?: Alpha;
}

export type Alpha = 'straight' | 'premultiplied';

/** A case of the suite. */
export interface Case {
  /** `family/name`. */
  name: string;
  family: string;
  kind: 'deterministic' | 'stochastic' | 'limit';
  /** Rule by which images of linear radiance are compared. */
  gate: string;
  /** Document and figure that it reproduces. */
  source: string;
  /** Features of a correct image. */
  shows: string;
  /** The exact computation, in words. */
  computes: string;
  /** Exposure of 8-bit images, in stops. */
  exposure: number;
  /** Scene file (TOML). */
  sceneFile: string;
}

export interface SuiteOptions {
  /** Folder of a suite, in place of $VOLREF_SUITE and of the one within the program. */
  suite?: string;
}

export interface CheckOptions extends SuiteOptions {
  /** Conventions by which to judge: a name such as `vtkjs`, or a file. Codes are those of radiance, without exposure. */
  profile?: string;
  /** Bits of a channel: differences up to half a code agree. With `8-linear` codes are those of radiance, without exposure. */
  bits?: 8 | '8-linear' | '8-srgb';
  /** Colours beside opacity leave out the background of the scene: that of the image by default. */
  alpha?: Alpha;
  /** Pass images that are right under other conventions, which a search finds: `explain` is above 0. */
  acceptConventions?: boolean;
  /** Seconds for finding the mistake behind an image that fails; 0 for no search, the default where CI is set, else 10. */
  explain?: number;
  /** Folder for a page with both images. */
  report?: string;
}

/** The verdict on an image of a case. */
export class Result {
  name: string;
  verdict: 'pass' | 'fail' | 'convention' | 'inconclusive' | 'missing' | 'error';
  /** The verdict is `pass`, or `convention` with `acceptConventions`. */
  readonly passed: boolean;
  /** The rule, and the difference, in words. */
  reason: string;
  gate: string;
  /** Known mistakes that explain an image that fails, most likely first. */
  looksLike: { name: string; advice: string }[];
  /** Choices under which the image is right. */
  conventions: string[];
  /** Measurements of a difference that nothing known explains, in sentences. */
  difference: string[];
  metrics: Record<string, number>;
  /** Of an image that differs: false if the search for the cause was left out or ended by its limit. */
  searchEnded?: boolean;
  /** The page of the report, if one was asked for. */
  report?: string;
  toString(): string;
}

/** The program could not do what it was asked to. */
export class VolrefError extends Error {}

/** Path of the program: that of $VOLREF_PROGRAM, else the one that the package brings, else the one on the path. */
export function program(): string;
/** The cases that the filters name: families, cases, or patterns such as `figures/*`, with `!` before them excluded; all without one. */
export function cases(...filters: (string | SuiteOptions)[]): Case[];
/**
 * Judges an image of a case; a list of them, renderings with seeds of their own; or for a case of the family `limit`
 * images by the factor on the step, `{ 1: a, 0.5: b, 0.25: c }`.
 */
export function check(name: string, image: Image | Image[] | Record<number, Image>, options?: CheckOptions): Result;
/** The bundle of a case; its files are kept in `folder`, if one is given. */
export function exportBundle(name: string, options?: SuiteOptions & { folder?: string }): Bundle;
/** The bundle of a file that `volref export --to bundle` wrote. */
export function readBundle(file: string): Bundle;
/** Writes an image as .npy, where codes are divided by 255, or as .png, which holds no opacity. */
export function writeImage(file: string, image: Image): void;

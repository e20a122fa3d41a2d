/** A matrix: 16 numbers, column by column. */
export type Matrix = number[];
export type Vector = [number, number, number];

/** A projection, or isosurfaces. */
export type Mode = 'maximum' | 'minimum' | 'mean' | 'sum' | 'attenuated-maximum' | 'isosurface';
/** What a picture takes beside one volume along the axes, seen from one point, interpolated and composited. */
export type Feature =
  | Mode
  | 'several'
  | 'parallel'
  | 'placed'
  | 'sheared'
  | 'nearest'
  | 'formula'
  | 'shading'
  | 'shadow'
  | 'clips'
  | 'surfaces'
  | 'modulation';

/** A point of a transfer function: linear colour, and opacity over the reference length. */
export interface Point {
  value: number;
  colour: Vector;
  opacity: number;
}

/** Red, green, blue and opacity of evenly spaced values, from `least` to `most`. */
export interface Table {
  floats: Float32Array;
  bytes: Uint8Array;
  least: number;
  most: number;
}

/** The length over which a table states opacities: the reference length, a step, or a voxel. */
export interface TableOptions {
  per?: 'length' | 'step' | 'voxel';
  /** World units; that of the scene by default. */
  step?: number;
}

/** A volume of a bundle. */
export class Volume {
  /** What the JSON says of it. */
  readonly part: Record<string, any>;
  /** Numbers of nodes along x, y and z. */
  readonly nodes: Vector;
  /** The values, x fastest. */
  readonly values: Float32Array | Float64Array;
  /** Distance between samples, world units. */
  readonly step: number;
  /** The value of a point is that of the nearest node. */
  readonly isNearest: boolean;
  /** Length of the shortest edge of a cell in the world. */
  readonly voxel: number;
  /** From numbers of nodes (i, j, k) to the world. */
  readonly affine: Matrix;
  /** From the unit cube, which the box of the volume is in texture coordinates, to the world. */
  readonly boxToWorld: Matrix;
  /** From the coordinates of the grid to the world: the unit matrix where the volume is not placed. */
  readonly matrix: Matrix;
  /** Corners of the box in the world. */
  readonly corners: Vector[];
  /** Points of the transfer function, of a formula `count` of them; of a projection the colours that it shows. */
  points(count?: number): Point[];
  /** A table of `count` entries, 256 by default. */
  table(count?: number, options?: TableOptions): Table;
}

/** What `volref export --to bundle` wrote: a scene as numbers. */
export class Bundle {
  constructor(description: Record<string, any>, files: Record<string, ArrayBuffer | ArrayBufferView>);
  /** The JSON. */
  readonly description: Record<string, any>;
  /** The bytes of the files that it names. */
  readonly files: Record<string, ArrayBuffer | ArrayBufferView>;
  readonly name: string;
  /** Size of the image. */
  readonly width: number;
  readonly height: number;
  /** What the JSON says of the panel; a bundle of several, or of a plot, is refused. */
  readonly panel: Record<string, any>;
  readonly volumes: Volume[];
  /** The volume; several are refused. Its values, nodes, affine, points and table are those of the bundle, too. */
  readonly volume: Volume;
  readonly values: Float32Array | Float64Array;
  readonly nodes: Vector;
  readonly affine: Matrix;
  /** Distance between samples, world units; a sixteenth of the one to begin with where nothing is sampled. */
  readonly step: number;
  readonly background: Vector;
  /** `composited`, or a projection or isosurfaces. */
  readonly mode: 'composited' | Mode;
  /** Features that the picture takes, each with the words for it. */
  readonly asks: Partial<Record<Feature, string>>;
  /** Refuses the scene if the picture takes features beside these. */
  allow(...features: Feature[]): void;
  points(count?: number): Point[];
  table(count?: number, options?: TableOptions): Table;
  readonly isParallel: boolean;
  readonly eye: Vector;
  /** Directions of length 1. */
  readonly forward: Vector;
  readonly right: Vector;
  readonly up: Vector;
  /** Vertical field of view in degrees, of rays from one point. */
  readonly fieldOfView: number;
  /** Height of the image in world units, of parallel rays. */
  readonly parallelHeight: number | undefined;
  /** Corners of the boxes of all volumes, in the world. */
  readonly corners: Vector[];
  /** Distance from the eye to the farthest corner. */
  readonly farthest: number;
  /** Depths of planes: half that of the nearest corner, unless the eye stands within, and twice that of the farthest. */
  readonly near: number;
  readonly far: number;
  /** From the camera, which looks along -z with y up, to the world. */
  readonly cameraToWorld: Matrix;
  /** From the world to the camera. */
  readonly view: Matrix;
  /** From the camera to clip space, OpenGL's. */
  readonly projection: Matrix;
}

/** Something in the scene for which the renderer has no words. */
export class Refusal extends Error {}
/** Says that the renderer has no words for the scene. */
export function refuse(reason: string): never;

export function length(vector: number[]): number;
/** Product of two matrices: `b` first. */
export function multiply(a: Matrix, b: Matrix): Matrix;
/** The place of a point; with `w = 0`, of a direction. */
export function transform(matrix: Matrix, point: number[], w?: number): Vector;
/** Inverse of a matrix that is no projection. */
export function invert(matrix: Matrix): Matrix;
/** Determinant of the first three rows and columns. */
export function determinant(matrix: Matrix): number;
/** The first three columns, and their first three rows. */
export function columns(matrix: Matrix): Vector[];

/** The codes of a WebGL context's frame buffer, RGBA, top row first. */
export function pixels(gl: any, width?: number, height?: number): Uint8Array;
/** An NPY file of an array, the last axis of `shape` fastest. */
export function npy(values: Float32Array | Float64Array, shape: number[]): Uint8Array;
export function readNpy(bytes: ArrayBuffer | ArrayBufferView): { values: Float32Array | Float64Array; shape: number[] };
/** A PNG file of 8-bit codes, RGB or RGBA, top row first. */
export function png(codes: Uint8Array | Uint8ClampedArray, width: number, height: number): Uint8Array;

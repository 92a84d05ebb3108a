/** What the page hands to its script: the JSON of `<script id="playback">`, and the same when decoded. */

export type Vec3 = [number, number, number];

/** A shape at its stated place. `path`, if there, is its shift from that place at each frame (metres). */
export type Obstacle = { path?: Vec3[] } & (
  | { shape: "plane"; normal: Vec3; offset: number } // normal . x = offset
  | { shape: "ball"; center: Vec3; radius: number }
  | { shape: "box"; center: Vec3; half: Vec3; axes: [Vec3, Vec3, Vec3] }
  | { shape: "capsule"; ends: [Vec3, Vec3]; radius: number }
  | { shape: "mesh"; vertices: Vec3[]; triangles: Vec3[] }
);

export interface EngineFacts {
  id: string;
  name: string;
  /** `#rrggbb`. */
  colour: string;
  /** An SVG dash array, or "". */
  dash: string;
  /** One of the project's own integrators. */
  own: boolean;
  truth: boolean;
  /** How many frames it has; nothing is drawn of it after them. */
  last: number;
  /** Seconds, or null. */
  diverged: number | null;
  fault: number | null;
}

export interface Playback {
  version: number;
  particles: { count: number; fixed: number[]; radius: number | number[] };
  springs: { count: number; ends: string; rest: string };
  rods: { count: number; ends: string };
  obstacles: Obstacle[];
  /** Seconds of the frames, growing. */
  t: number[];
  engines: (EngineFacts & { origin: Vec3; unit: number; positions: string })[];
}

/** Positions are origin + unit q, with q by frame, then coordinate, then particle. */
export interface Engine extends EngineFacts {
  origin: Vec3;
  unit: number;
  q: Int32Array;
}

export interface Motion {
  count: number;
  fixed: number[];
  radius: number | number[];
  /** i0, j0, i1, j1, ... */
  springs: Int32Array;
  rest: Float32Array;
  rods: Int32Array;
  obstacles: Obstacle[];
  t: number[];
  engines: Engine[];
}

/** Where a picture is drawn, in pixels of the raster: the right and lower edges lie outside. */
export interface Panel {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

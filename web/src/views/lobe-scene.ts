/** The lobe in space: what is drawn with WebGL. Loaded when the first plots are there. z is the normal. */
import {
  BufferAttribute,
  BufferGeometry,
  CircleGeometry,
  Color,
  ColorManagement,
  ConeGeometry,
  CylinderGeometry,
  DoubleSide,
  Group,
  Line,
  LineBasicMaterial,
  LineDashedMaterial,
  LineLoop,
  LinearSRGBColorSpace,
  LineSegments,
  type Material,
  Mesh,
  MeshBasicMaterial,
  type Object3D,
  PerspectiveCamera,
  Raycaster,
  Scene,
  SphereGeometry,
  Vector2,
  Vector3,
  WebGLRenderer,
} from "three";
import type { Angles } from "../engine/protocol";
import { channelOf } from "../plot/colours";
import { mirrored, toAngles, toVector } from "../plot/directions";
import type { Axis } from "../plot/scale";
import { srgb8 } from "../plot/tone";
import type { Channel } from "../state";
import { Film } from "./lobe-film";
import { lobeMaterial, setContours, setOpacity } from "./lobe-material";

// Colours are those of the style sheet, from the attribute to the pixel: nothing here is light that adds up.
ColorManagement.enabled = false;

/** How far out the light and the viewer are, where the rim of the axis is at 1. */
export const REACH = 1.22;

/** A frame of a usual screen with some slack, milliseconds. */
const FRAME = 20;
/** The longest pause between frames, milliseconds. */
const LONGEST = 500;

export interface Part {
  /** sRGB, as a style sheet has it. */
  colour: string;
  directions: Float32Array;
  values: Float32Array;
  triangles: Float32Array;
  spikes: Float32Array;
}

export interface Colours {
  line: string;
  strong: string;
  ink: string;
  light: string;
}

/** Where something is on the view, in pixels, and whether it is before the centre. */
export interface Place {
  x: number;
  y: number;
  near: boolean;
}

export class LobeScene {
  private readonly renderer: WebGLRenderer;
  private readonly scene = new Scene();
  private readonly camera = new PerspectiveCamera(28, 1, 0.1, 50);
  private readonly lobes = new Group();
  private readonly stage = new Group();
  private readonly light = new Group();
  private readonly viewer = new Group();
  private readonly ray = new Raycaster();
  private readonly inks = new Inks();
  private readonly skin = lobeMaterial();
  private readonly film: Film;
  private width = 1;
  private height = 1;
  private waiting = false;
  /** A frame is being drawn, and whether another one is wanted after it. */
  private drawing = false;
  private again = false;
  private prepared = false;
  private gone = false;
  private shown = true;
  /** When the last frame was begun, and how long it took beyond a usual one: without a graphics card it may be a tenth of a second. */
  private last = 0;
  private cost = 0;
  /** Of the camera about the normal, and above the surface, radians. */
  azimuth = -1.08;
  elevation = 0.42;
  zoom = 1;

  /** `drawn` is called after each frame. Throws where WebGL 2 can't be had. */
  constructor(
    readonly canvas: HTMLCanvasElement,
    private readonly drawn: () => void,
  ) {
    this.renderer = new WebGLRenderer({ canvas, antialias: false, alpha: true, powerPreference: "low-power" });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.film = new Film(this.renderer);
    this.scene.add(this.stage, this.lobes, this.light, this.viewer);
    this.camera.up.set(0, 0, 1);
    canvas.addEventListener("webglcontextrestored", () => this.invalidate());
  }

  dispose(): void {
    this.gone = true;
    for (const group of [this.stage, this.lobes, this.light, this.viewer]) empty(group);
    this.inks.dispose();
    this.skin.dispose();
    this.film.dispose();
    this.renderer.dispose();
  }

  resize(width: number, height: number): void {
    this.width = width;
    this.height = height;
    // More would cost time and show nothing.
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.film.resize(this.canvas.width, this.canvas.height);
    this.camera.aspect = width / height;
    this.invalidate();
  }

  /** The surface with the rings of the axis. */
  setStage(axis: Axis, colours: Colours): void {
    empty(this.stage);
    this.stage.add(new Mesh(new CircleGeometry(1, 96), this.inks.veil(colours.line)));
    const line = this.inks.line(colours.line);
    for (const { position, label } of axis.ticks) if (label !== "" && position > 0 && position < 1) this.stage.add(ring(position, line));
    this.stage.add(ring(1, this.inks.line(colours.strong)));
    const spokes: number[] = [];
    for (let phi = 0; phi < 360; phi += 30) {
      const [c, s] = [Math.cos((phi * Math.PI) / 180), Math.sin((phi * Math.PI) / 180)];
      spokes.push(0, 0, 0, c, s, 0);
    }
    this.stage.add(new LineSegments(points(spokes), line));
    this.stage.add(new Line(points([0, 0, 0, 0, 0, REACH]), this.inks.line(colours.strong)));
    this.stage.add(head([0, 0, REACH], [0, 0, 1], this.inks.solid(colours.strong), 0.7));
    this.invalidate();
  }

  setLobes(parts: Part[], axis: Axis, channel: Channel): void {
    empty(this.lobes);
    setContours(this.skin, axis);
    setOpacity(this.skin, parts.length > 1 ? 0.62 : 1);
    for (const part of parts) {
      const mesh = new Mesh(surface(part, axis, channel), this.skin);
      mesh.geometry.computeBoundingSphere();
      // The larger ones after those that may be inside of them.
      mesh.renderOrder = mesh.geometry.boundingSphere?.radius ?? 0;
      this.lobes.add(mesh);
      for (let k = 0; k + 5 < part.spikes.length; k += 6) {
        const d = [...part.spikes.subarray(k, k + 3)] as [number, number, number];
        const ink = this.inks.solid(part.colour);
        this.lobes.add(shaft(d, 0, 0.94, ink, 0.012), head([d[0], d[1], d[2]], d, ink, 1));
      }
    }
    this.invalidate();
  }

  /** The light's arrow, the plane of incidence, and where a mirror sends the light. */
  setLight(wi: Angles, colours: Colours): void {
    empty(this.light);
    const d = [...toVector(wi)] as [number, number, number];
    const ink = this.inks.solid(colours.light);
    this.light.add(shaft(d, 0.86, REACH, ink, 0.011));
    this.light.add(head([0.78 * d[0], 0.78 * d[1], 0.78 * d[2]], [-d[0], -d[1], -d[2]], ink, 1.1));
    const dim = this.inks.dashed(colours.light);
    this.light.add(dashed([0, 0, 0, 0.78 * d[0], 0.78 * d[1], 0.78 * d[2]], dim));
    const m = toVector(mirrored(wi));
    this.light.add(dashed([0, 0, 0, REACH * m[0], REACH * m[1], REACH * m[2]], dim));
    const arc: number[] = [];
    for (let t = -90; t <= 90; t += 3) {
      const v = toVector({ theta: Math.abs(t), phi: t < 0 ? wi.phi : wi.phi + 180 });
      arc.push(REACH * v[0], REACH * v[1], REACH * v[2]);
    }
    this.light.add(new Line(points(arc), this.inks.line(colours.line)));
    const knob = new Mesh(new SphereGeometry(0.045, 24, 16), ink);
    knob.position.set(REACH * d[0], REACH * d[1], REACH * d[2]);
    this.light.add(knob);
    this.invalidate();
  }

  setViewer(wo: Angles | null, colours: Colours): void {
    empty(this.viewer);
    if (wo !== null) {
      const d = toVector(wo);
      const at: [number, number, number] = [REACH * d[0], REACH * d[1], REACH * d[2]];
      this.viewer.add(new Line(points([0, 0, 0, ...at]), this.inks.line(colours.ink)));
      const knob = new Mesh(new SphereGeometry(0.032, 24, 16), this.inks.solid(colours.ink));
      knob.position.set(...at);
      this.viewer.add(knob);
    }
    this.invalidate();
  }

  turn(azimuth: number, elevation: number): void {
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.max(this.elevation + elevation, -1.5), 1.5);
    this.invalidate();
  }

  scale(factor: number): void {
    this.zoom = Math.min(Math.max(this.zoom * factor, 0.5), 12);
    this.invalidate();
  }

  /** Whether anybody sees it; frames that nobody sees aren't drawn. */
  setShown(shown: boolean): void {
    this.shown = shown;
    if (shown) this.invalidate();
  }

  /** Draws in the next frame; where drawing is slow, not so often that everything else comes to a halt. */
  invalidate(): void {
    if (this.waiting || !this.shown) return;
    if (this.drawing) {
      this.again = true;
      return;
    }
    this.waiting = true;
    const wait = this.last + Math.min(4 * this.cost, LONGEST) - performance.now();
    if (wait > 0) setTimeout(() => requestAnimationFrame(() => this.draw()), wait);
    else requestAnimationFrame(() => this.draw());
  }

  private draw(): void {
    this.waiting = false;
    if (this.gone) return;
    if (!this.prepared) {
      this.prepare();
      return;
    }
    const start = performance.now();
    this.last = start;
    this.expose();
    this.drawing = true;
    this.film.whenDone(() => {
      this.drawing = false;
      if (this.gone) return;
      this.film.show();
      this.drawn();
      this.cost = 0.5 * this.cost + 0.5 * Math.max(0, performance.now() - start - FRAME);
      if (this.again) {
        this.again = false;
        this.invalidate();
      }
    });
  }

  private prepare(): void {
    this.drawing = true;
    void this.film.prepare(this.scene, this.camera).finally(() => {
      this.prepared = true;
      this.drawing = false;
      if (!this.gone) this.invalidate();
    });
  }

  /** Where a point is on the view; after `render`. */
  project(x: number, y: number, z: number): Place {
    const p = new Vector3(x, y, z);
    const near = p.distanceTo(this.camera.position) < this.camera.position.length();
    p.project(this.camera);
    return { x: ((p.x + 1) / 2) * this.width, y: ((1 - p.y) / 2) * this.height, near };
  }

  /** The direction under a place of the view, on the sphere that the handles move on: of two, the nearer to `before`. */
  direction(x: number, y: number, before: Angles): Angles {
    this.ray.setFromCamera(new Vector2((2 * x) / this.width - 1, 1 - (2 * y) / this.height), this.camera);
    const { origin, direction } = this.ray.ray;
    const along = -origin.dot(direction);
    const nearest = origin.clone().addScaledVector(direction, along);
    const half = REACH * REACH - nearest.lengthSq();
    if (half <= 0) return toAngles(nearest.toArray(), before.phi);
    const old = new Vector3(...toVector(before));
    const [a, b] = [-1, 1].map((side) => nearest.clone().addScaledVector(direction, side * Math.sqrt(half)));
    return toAngles((a!.dot(old) > b!.dot(old) ? a! : b!).toArray(), before.phi);
  }

  /** Draws now, for pictures that are saved. */
  render(): void {
    this.expose();
    this.film.show();
  }

  private expose(): void {
    const narrow = Math.min(1, this.camera.aspect * 0.92);
    const distance = 1.36 / Math.sin((this.camera.fov * Math.PI) / 360) / narrow / this.zoom;
    const c = Math.cos(this.elevation);
    this.camera.position.set(distance * c * Math.cos(this.azimuth), distance * c * Math.sin(this.azimuth), distance * Math.sin(this.elevation) + 0.42);
    this.camera.lookAt(0, 0, 0.42);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    this.film.expose(this.scene, this.camera);
  }
}

type Triple = [number, number, number];

function points(numbers: number[]): BufferGeometry {
  return new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(numbers), 3));
}

function ring(radius: number, material: Material): Object3D {
  const numbers: number[] = [];
  for (let k = 0; k < 128; k += 1) numbers.push(radius * Math.cos((k * Math.PI) / 64), radius * Math.sin((k * Math.PI) / 64), 0);
  return new LineLoop(points(numbers), material);
}

function dashed(numbers: number[], material: Material): Object3D {
  const line = new Line(points(numbers), material);
  line.computeLineDistances();
  return line;
}

/** The head of an arrow that ends at `tip`. */
function head(tip: Triple, towards: Triple, ink: Material, size: number): Object3D {
  const length = 0.085 * size;
  const cone = new Mesh(new ConeGeometry(0.028 * size, length, 20), ink);
  const d = new Vector3(...towards).normalize();
  // A cone points along +y.
  cone.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), d);
  cone.position.set(...tip).addScaledVector(d, -length / 2);
  return cone;
}

/** A rod between two distances along a direction: lines are one pixel wide on most machines. */
function shaft(d: Triple, from: number, to: number, ink: Material, radius: number): Object3D {
  const rod = new Mesh(new CylinderGeometry(radius, radius, to - from, 12), ink);
  rod.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...d));
  rod.position.set(...d).multiplyScalar((from + to) / 2);
  return rod;
}

function surface({ colour, directions, values, triangles }: Part, axis: Axis, channel: Channel): BufferGeometry {
  const count = directions.length / 3;
  const positions = new Float32Array(3 * count);
  const colours = new Float32Array(3 * count);
  const own = new Color(colour);
  for (let k = 0; k < count; k += 1) {
    const value = channelOf(channel, values, 3 * k);
    const radius = Number.isFinite(value) ? axis.position(value) : 0;
    for (let c = 0; c < 3; c += 1) positions[3 * k + c] = radius * directions[3 * k + c]!;
    if (channel === "rgb") {
      const most = Math.max(values[3 * k]!, values[3 * k + 1]!, values[3 * k + 2]!, 1e-30);
      for (let c = 0; c < 3; c += 1) colours[3 * k + c] = srgb8(values[3 * k + c]! / most) / 255;
    } else colours.set([own.r, own.g, own.b], 3 * k);
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(positions, 3));
  geometry.setAttribute("color", new BufferAttribute(colours, 3));
  geometry.setIndex(new BufferAttribute(Uint32Array.from(triangles), 1));
  geometry.computeVertexNormals();
  return geometry;
}

/** Takes everything out of a group and gives back its memory. */
function empty(group: Group): void {
  for (const child of [...group.children]) {
    group.remove(child);
    (child as Mesh).geometry.dispose();
  }
}

/** A material for each look and colour, kept: with the last material of a kind its program goes, and to compile one takes longer than a frame. */
class Inks {
  private readonly kept = new Map<string, Material>();

  line = (colour: string): Material => this.get(`line ${colour}`, () => new LineBasicMaterial({ color: colour }));
  solid = (colour: string): Material => this.get(`solid ${colour}`, () => new MeshBasicMaterial({ color: colour }));
  dashed = (colour: string): Material => this.get(`dashed ${colour}`, () => new LineDashedMaterial({ color: colour, dashSize: 0.035, gapSize: 0.03 }));
  veil = (colour: string): Material =>
    this.get(`veil ${colour}`, () => new MeshBasicMaterial({ color: colour, transparent: true, opacity: 0.25, side: DoubleSide, depthWrite: false }));

  dispose(): void {
    for (const material of this.kept.values()) material.dispose();
  }

  private get(key: string, make: () => Material): Material {
    let material = this.kept.get(key);
    if (material === undefined) this.kept.set(key, (material = make()));
    return material;
  }
}

/** How a lobe is lit: softly from the upper left of the viewer, with lines where its radius is a value of the axis. */
import { DoubleSide, ShaderMaterial } from "three";
import type { Axis } from "../plot/scale";

/** Lines that are drawn at most. */
const MOST = 12;

const VERTEX = /* glsl */ `
  varying vec3 vNormal;
  varying vec3 vAt;
  varying vec3 vOwn;
  attribute vec3 color;
  void main() {
    vNormal = normalMatrix * normal;
    vAt = position;
    vOwn = color;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }
`;

const FRAGMENT = /* glsl */ `
  uniform float contours[${MOST}];
  uniform float opacity;
  varying vec3 vNormal;
  varying vec3 vAt;
  varying vec3 vOwn;
  void main() {
    vec3 n = normalize(vNormal);
    if (!gl_FrontFacing) n = -n;
    float key = 0.5 + 0.5 * dot(n, normalize(vec3(-0.45, 0.65, 0.6)));
    float shade = 0.5 + 0.58 * key * key;
    float r = length(vAt);
    float width = max(fwidth(r), 1e-6);
    float line = 0.0;
    for (int k = 0; k < ${MOST}; k++) line = max(line, 1.0 - smoothstep(0.4, 1.3, abs(r - contours[k]) / width));
    vec3 lit = min(vOwn * shade + 0.10 * pow(key, 12.0), vec3(1.0));
    gl_FragColor = vec4(mix(lit, lit * 0.62, line), mix(opacity, 1.0, 0.5 * line));
  }
`;

export function lobeMaterial(): ShaderMaterial {
  return new ShaderMaterial({
    vertexShader: VERTEX,
    fragmentShader: FRAGMENT,
    uniforms: { contours: { value: new Array<number>(MOST).fill(-1) }, opacity: { value: 1 } },
    transparent: true,
    side: DoubleSide,
  });
}

/** Lobes that others are inside of can be seen through. */
export function setOpacity(material: ShaderMaterial, opacity: number): void {
  material.uniforms["opacity"]!.value = opacity;
}

/** The values of an axis that a lobe has lines at; −1 stands for none. */
export function setContours(material: ShaderMaterial, axis: Axis): void {
  const places = axis.ticks.filter((t) => t.label !== "" && t.position > 0).map((t) => t.position);
  material.uniforms["contours"]!.value = Array.from({ length: MOST }, (_, k) => places[k] ?? -1);
}

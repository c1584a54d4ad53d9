/** The rows of the theory: name, formula, what it says, and its figure. The names and the formulas' numbers are those of the book's chapters. */
import type { ComponentType } from "preact";
import { Energy, ReflectionEquation } from "./figures/energy";
import { DifferentialSolidAngle, SolidAngle, SphericalCoordinates } from "./figures/geometry";
import { Diffuse, Fresnel, Mirror, Specular, TorranceSparrow } from "./figures/models";
import { EnvironmentMap, Measured, NonPhotorealistic } from "./figures/pictures";
import { Irradiance, Light, Radiance, RadiantExitance } from "./figures/radiometry";
import { Isotropy, Linearity, Reciprocity, ReflectionFunction } from "./figures/reflection";

export interface Row {
  /** As in the book: T1 to T21. */
  key: string;
  name: string;
  /** The chapter in the book's folder `theory`. */
  chapter: string;
  formulas: { text: string; number?: string }[];
  text: string;
  Live: ComponentType;
}

export const ROWS: readonly Row[] = [
  {
    key: "T1",
    name: "Light",
    chapter: "light",
    formulas: [{ text: "Φ_v = K_m ∫ Φ(λ) V(λ) dλ,  K_m = 683 \\text{ lm/W}" }],
    text: "Light is visible electromagnetic radiation, about 400 to 700 nm, treated as independent rays of energy: no polarization, no photon counting, no interference. The eye's response V(λ) turns radiant quantities into photometric ones, and the standard observer's three into colour.",
    Live: Light,
  },
  {
    key: "T2",
    name: "Solid angle",
    chapter: "solid-angle",
    formulas: [{ text: "Ω = \\frac{A}{r^2}" }],
    text: "A solid angle is the area A that a set of directions cuts out of a sphere of radius r, over r². Its unit is the steradian; the whole sphere has 4π sr, the hemisphere 2π.",
    Live: SolidAngle,
  },
  {
    key: "T3",
    name: "Spherical coordinates",
    chapter: "spherical-coordinates",
    formulas: [
      { text: "x = r sinθ cosφ,  y = r sinθ sinφ,  z = r cosθ", number: "1" },
      { text: "φ = atan2(y, x),  θ = atan2(\\sqrt{x^2 + y^2}, z)", number: "2" },
      { text: "r = \\sqrt{x^2 + y^2 + z^2}", number: "3" },
    ],
    text: "A direction is an angle θ from the surface's normal and an angle φ around it. atan2 takes the signs of both of its arguments into account, so each direction gets its own angles, in all four quadrants.",
    Live: SphericalCoordinates,
  },
  {
    key: "T4",
    name: "Differential solid angle",
    chapter: "differential-solid-angle",
    formulas: [
      { text: "dA = r^2 sinθ dθ dφ", number: "5" },
      { text: "dA = −r^2 dφ d(cosθ)", number: "6" },
    ],
    text: "So dω = sinθ dθ dφ: a step in θ and φ covers the less of the sphere, the nearer it is to the pole. Over the sphere of radius r the integral is 4πr².",
    Live: DifferentialSolidAngle,
  },
  {
    key: "T5",
    name: "Radiance",
    chapter: "radiance",
    formulas: [{ text: "dΦ = L cosθ dω dA,  [L] = \\text{W m⁻² sr⁻¹}" }],
    text: "Radiance is power per projected area and solid angle. Along a ray in vacuum it is constant, which is why a renderer computes it: a lamp looks as bright from afar as from near, only smaller.",
    Live: Radiance,
  },
  {
    key: "T6",
    name: "Irradiance",
    chapter: "irradiance",
    formulas: [{ text: "E = ∫_{H^2} L(x, ω) cosθ dω,  [E] = \\text{W m⁻²}", number: "7" }],
    text: "Irradiance is the power that arrives per area, from the hemisphere above it. The cosine is there because slanting light spreads over more of the surface. Under uniform unit radiance it is π.",
    Live: Irradiance,
  },
  {
    key: "T7",
    name: "Radiant exitance",
    chapter: "radiant-exitance",
    formulas: [{ text: "M = ∫_{H^2} L(x, ω) cosθ dω" }],
    text: "Radiant exitance is the power that leaves a surface per area: the same integral as irradiance, over the directions that leave. A diffuse surface of reflectance ρ has M = ρE; a lamp of uniform radiance L has M = πL.",
    Live: RadiantExitance,
  },
  {
    key: "T8",
    name: "The reflection function",
    chapter: "brdf",
    formulas: [{ text: "f(ω_i → ω_r) = \\frac{dL_r(ω_r)}{L_i(ω_i) cosθ_i dω_i},  [f] = \\text{sr⁻¹}", number: "8" }],
    text: "The bidirectional reflectance distribution function (BRDF) is reflected radiance per irradiance. It is a density, not a share: in a sharp highlight it may be far above 1.",
    Live: ReflectionFunction,
  },
  {
    key: "T9",
    name: "Linearity",
    chapter: "linearity",
    formulas: [{ text: "f = ∑_k f_k" }],
    text: "Over lights: the reflection of a sum of lights is the sum of the reflections. Over components: a reflection function may be a sum of reflection functions. The first lets lights be mixed after a rendering, the second lets materials be made of layers.",
    Live: Linearity,
  },
  {
    key: "T10",
    name: "Reciprocity",
    chapter: "reciprocity",
    formulas: [{ text: "f(ω_i → ω_r) = f(ω_r → ω_i)" }],
    text: "Light and viewer may change places. What follows from the physics of a passive surface is not given for a formula that somebody has written: a cartoon shader, which asks where the viewer is and where the light is in different ways, lacks it.",
    Live: Reciprocity,
  },
  {
    key: "T11",
    name: "Isotropy and anisotropy",
    chapter: "isotropy",
    formulas: [{ text: "f = f(θ_i, θ_r, φ_i − φ_r)" }],
    text: "An isotropic surface looks the same when it turns about its normal: f depends on φi − φr only, and with reciprocity on |φi − φr|. Brushed metal does not.",
    Live: Isotropy,
  },
  {
    key: "T12",
    name: "Energy conservation",
    chapter: "energy-conservation",
    formulas: [
      { text: "M ≤ E", number: "9" },
      { text: "∫_{H^2} f(ω_i → ω_r) cosθ_r dω_r ≤ 1 \\text{ for every } ω_i", number: "10, 11" },
    ],
    text: "A passive surface reflects no more than arrives, for every incident field. In a white furnace, uniform light from everywhere, a surface of albedo 1 becomes invisible; one that shines brighter than the furnace makes light of nothing.",
    Live: Energy,
  },
  {
    key: "T13",
    name: "The reflection equation",
    chapter: "reflection-equation",
    formulas: [
      { text: "L_r(ω_r) = ∑_i L_i f(ω_i → ω_r) cosθ_i", number: "12" },
      { text: "L_r(ω_r) = ∫_{H^2} L_i(ω_i) f(ω_i → ω_r) cosθ_i dω_i", number: "13" },
    ],
    text: "What is seen of a surface is the light from everywhere, each direction weighted by the reflection function and the cosine. Over point lights it is a sum, over continuous lights an integral; a renderer solves it at every point that it sees.",
    Live: ReflectionEquation,
  },
  {
    key: "T14",
    name: "Mirror",
    chapter: "mirror",
    formulas: [{ text: "f = ρ \\frac{δ(cosθ_i − cosθ_r)}{cosθ_r} δ((φ_i − φ_r + π) mod 2π)", number: "14" }],
    text: "A perfect mirror reflects all light into one direction. ρ, in [0, 1], may be a Fresnel reflectance: that of a metal has a colour.",
    Live: Mirror,
  },
  {
    key: "T15",
    name: "Diffuse reflection",
    chapter: "diffuse",
    formulas: [{ text: "f = \\frac{ρ_d}{π},  0 ≤ ρ_d ≤ 1", number: "15" }],
    text: "A Lambertian surface reflects the same radiance into every direction. The π makes ρd the share of the light that leaves again.",
    Live: Diffuse,
  },
  {
    key: "T16",
    name: "Specular reflection",
    chapter: "specular",
    formulas: [{ text: "f ∝ cos^p α", number: "16" }],
    text: "The Phong model is diffuse reflection plus a lobe around the mirror direction; α is the angle between the mirrored incident and the reflected direction. As published it gains or loses energy with its exponent; normalised by (p + 2)/2π it conserves it.",
    Live: Specular,
  },
  {
    key: "T17",
    name: "Fresnel's equations",
    chapter: "fresnel",
    formulas: [{ text: "F(θ) = F_0 + (1 − F_0)(1 − cosθ)^5", number: "17" }],
    text: "Fresnel's equations give the reflectance of a smooth boundary from the index of refraction; Schlick's formula approximates them. Every surface becomes a mirror at grazing light.",
    Live: Fresnel,
  },
  {
    key: "T18",
    name: "Torrance–Sparrow",
    chapter: "torrance-sparrow",
    formulas: [{ text: "f = \\frac{F(θ′) G(ω_i, ω_r) D(θ_h)}{4 cosθ_i cosθ_r}", number: "18" }],
    text: "A rough surface is made of tiny mirrors, the facets. D says how their normals are distributed, G how they shadow and mask each other, F what each of them reflects.",
    Live: TorranceSparrow,
  },
  {
    key: "T19",
    name: "Measured reflection",
    chapter: "empirical",
    formulas: [{ text: "f = f(θ_h, θ_d, φ_d)" }],
    text: "A reflection function may be a table of measured values over the angles of both directions: four numbers, three where the material is isotropic. Half and difference angles put the highlight on one edge of the table, where a fine grid pays.",
    Live: Measured,
  },
  {
    key: "T20",
    name: "Non-photorealistic reflection",
    chapter: "non-photorealistic",
    formulas: [{ text: "f = \\frac{ρ}{π} \\frac{q(cosθ_i)}{cosθ_i} + \\frac{k_s}{π} [θ_h ≤ \\text{edge}],  q(x) = \\frac{⌊x n + 1/2⌋}{n}" }],
    text: "A reflection function need not be physical: a cartoon shader shows n flat bands of light, a hard highlight and a bright rim; technical illustration shows tones from cool to warm, so that nothing drowns in black.",
    Live: NonPhotorealistic,
  },
  {
    key: "T21",
    name: "Environment maps",
    chapter: "environment-map",
    formulas: [{ text: "L_i(x, ω) = L(ω)" }],
    text: "An environment map is light from infinitely far away: one radiance per direction, the same at every point. It may be captured by photographing a mirrored ball, and is looked up in the mirror direction (Blinn & Newell 1976).",
    Live: EnvironmentMap,
  },
];

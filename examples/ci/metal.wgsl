// A rough metal: the GGX distribution, Smith's masking, Schlick's Fresnel reflectance.
//
// A renderer includes this file; Gonio runs the same text without a GPU. Directions leave the surface: wi to the light, wo to the
// viewer, in a frame whose normal is +z.

override roughness: f32 = 0.4; // 0.1..1 perceptual roughness

const PI: f32 = 3.14159265;
const F0 = vec3f(1.0, 0.78, 0.34);

struct Sample {
    wi: vec3f,
    weight: vec3f, // f cosθi / pdf
    pdf: f32,      // 0: nothing was drawn
}

/// alpha², the square of the slope scale alpha = roughness².
fn alpha2() -> f32 {
    return roughness * roughness * roughness * roughness;
}

fn above(wi: vec3f, wo: vec3f) -> bool {
    return wi.z > 0.0 && wo.z > 0.0;
}

fn distribution(h: vec3f) -> f32 {
    let t = h.x * h.x + h.y * h.y + h.z * h.z * alpha2();
    return alpha2() / (PI * t * t);
}

/// Smith's masking and shadowing of both directions over 4 cosθi cosθo.
fn visibility(wi: vec3f, wo: vec3f) -> f32 {
    let a2 = alpha2();
    let a = wo.z * sqrt(a2 + (1.0 - a2) * wi.z * wi.z);
    let b = wi.z * sqrt(a2 + (1.0 - a2) * wo.z * wo.z);
    return 0.5 / (a + b);
}

/// f in sr⁻¹, without the cosine.
fn eval(wi: vec3f, wo: vec3f) -> vec3f {
    if !above(wi, wo) {
        return vec3f(0.0);
    }
    // |wi + wo| / 2 is the cosine between the half vector and either direction, and never negative.
    let cosine = 0.5 * length(wi + wo);
    let schlick = pow(max(1.0 - cosine, 0.0), 5.0);
    let fresnel = F0 + (vec3f(1.0) - F0) * schlick;
    return fresnel * (distribution(normalize(wi + wo)) * visibility(wi, wo));
}

/// The density per solid angle with which `sample` draws wi.
fn pdf(wi: vec3f, wo: vec3f) -> f32 {
    if !above(wi, wo) {
        return 0.0;
    }
    let h = normalize(wi + wo);
    return distribution(h) * h.z / (2.0 * length(wi + wo));
}

fn sample(wo: vec3f, u: vec3f) -> Sample {
    var s = Sample(vec3f(0.0, 0.0, 1.0), vec3f(0.0), 0.0);
    if wo.z <= 0.0 {
        return s;
    }
    let a2 = alpha2();
    let tan2 = a2 * u.x / (1.0 - u.x);
    let z = 1.0 / sqrt(1.0 + tan2);
    let r = sqrt(tan2) * z;
    let phi = 2.0 * PI * u.y;
    let h = vec3f(r * cos(phi), r * sin(phi), z);
    let wi = 2.0 * dot(wo, h) * h - wo;
    let p = pdf(wi, wo);
    if p > 0.0 {
        s = Sample(wi, eval(wi, wo) * (wi.z / p), p);
    }
    return s;
}

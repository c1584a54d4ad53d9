// A rough metal: microfacets with the GGX distribution, Smith's height-correlated masking and Schlick's Fresnel term, with the
// sampling of visible normals (Walter et al. 2007; Heitz 2014 and 2018; Schlick 1994).

override roughness: f32 = 0.3; // 0.05..1 perceptual roughness: alpha is its square
override f0_red: f32 = 0.95; // 0..1 reflection at normal incidence, red
override f0_green: f32 = 0.64; // 0..1 the same, green
override f0_blue: f32 = 0.54; // 0..1 the same, blue

const PI = 3.14159265359;

struct Sample {
    wi: vec3f,
    weight: vec3f,
    pdf: f32,
}

fn square(x: f32) -> f32 {
    return x * x;
}

// D(h), in 1/sr.
fn distribution(h: vec3f) -> f32 {
    let a2 = square(square(roughness));
    return a2 / (PI * square(1.0 + (a2 - 1.0) * square(h.z)));
}

// What Smith's masking has of a direction: 1 + 2Λ(w) is this over w.z.
fn root(w: vec3f) -> f32 {
    let a2 = square(square(roughness));
    return sqrt(a2 + (1.0 - a2) * square(w.z));
}

// Opposite grazing directions have no half vector: whatever stands here must be finite.
fn half_vector(wi: vec3f, wo: vec3f) -> vec3f {
    let sum = wi + wo;
    return sum / max(length(sum), 1e-15);
}

fn fresnel(cos_theta: f32) -> vec3f {
    let f0 = vec3f(f0_red, f0_green, f0_blue);
    return f0 + (1.0 - f0) * pow(clamp(1.0 - cos_theta, 0.0, 1.0), 5.0);
}

fn above(wi: vec3f, wo: vec3f) -> bool {
    return wi.z > 0.0 && wo.z > 0.0;
}

// f(wi→wo) in 1/sr, without the cosine.
fn eval(wi: vec3f, wo: vec3f) -> vec3f {
    if !above(wi, wo) {
        return vec3f(0.0);
    }
    let h = half_vector(wi, wo);
    // Masking over 4 cosθi cosθr, without a quotient that grazing directions make infinite.
    let visibility = 0.5 / (wo.z * root(wi) + wi.z * root(wo));
    // The cosine between h and either direction, by a formula that is the same for both.
    let cos_d = 0.5 * length(wi + wo);
    return fresnel(cos_d) * (distribution(h) * visibility);
}

// The density of drawing wi, in 1/sr: that of the visible normals over 4 cosθ'.
fn pdf(wi: vec3f, wo: vec3f) -> f32 {
    if !above(wi, wo) {
        return 0.0;
    }
    return distribution(half_vector(wi, wo)) / (2.0 * (wo.z + root(wo)));
}

fn sample(wo: vec3f, u: vec3f) -> Sample {
    let nothing = Sample(vec3f(0.0, 0.0, 1.0), vec3f(0.0), 0.0);
    if wo.z <= 0.0 {
        return nothing;
    }
    // The hemisphere seen from wo, stretched to a rough surface of alpha 1.
    let alpha = square(roughness);
    let v = normalize(vec3f(alpha * wo.xy, wo.z));
    let length2 = dot(v.xy, v.xy);
    var t1 = vec3f(1.0, 0.0, 0.0);
    if length2 > 0.0 {
        t1 = vec3f(-v.y, v.x, 0.0) / sqrt(length2);
    }
    let t2 = cross(v, t1);
    let r = sqrt(u.x);
    let phi = 2.0 * PI * u.y;
    let p1 = r * cos(phi);
    let s = 0.5 * (1.0 + v.z);
    let p2 = (1.0 - s) * sqrt(max(1.0 - p1 * p1, 0.0)) + s * r * sin(phi);
    let stretched = p1 * t1 + p2 * t2 + sqrt(max(1.0 - p1 * p1 - p2 * p2, 0.0)) * v;
    let h = normalize(vec3f(alpha * stretched.xy, max(stretched.z, 1e-7)));
    let wi = reflect(-wo, h);
    if wi.z <= 0.0 {
        return nothing;
    }
    // f cosθ / pdf, where the distribution cancels.
    let masking = wi.z * (wo.z + root(wo)) / (wo.z * root(wi) + wi.z * root(wo));
    return Sample(wi, fresnel(dot(wi, h)) * masking, pdf(wi, wo));
}

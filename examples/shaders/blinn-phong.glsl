// Blinn's reflection (1977): a diffuse part and a lobe of the half vector, whose factor keeps the albedo at normal incidence
// below the sum of the two colours.

uniform vec3 diffuse;          // = 0.4/0.25/0.15 0..1 diffuse reflectance
uniform vec3 specular;         // = 0.2 0..1 share of the lobe
uniform float exponent = 30.0; // 1..1000 how narrow the lobe is

const float PI = 3.14159265359;

vec3 eval(vec3 wi, vec3 wo) {
    if (wi.z <= 0.0 || wo.z <= 0.0) return vec3(0);
    vec3 h = normalize(wi + wo);
    // (n + 2)(n + 4) / (8π (2^(−n/2) + n)): the lobe's albedo at normal incidence is 1.
    float scale = (exponent + 2.0) * (exponent + 4.0) / (8.0 * PI * (exp2(-0.5 * exponent) + exponent));
    return diffuse / PI + specular * scale * pow(max(h.z, 1e-6), exponent);
}

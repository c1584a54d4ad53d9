use gonio_num::Vec3;
use gonio_shader::*;
use std::path::Path;

fn load(name: &str, text: &str) -> Result<Shader, ShaderError> {
    Shader::new(Path::new(name), None, text, &Settings::default())
}

#[test]
fn basics() {
    let s = load("a.wgsl", "
struct S { wi: vec3f, weight: vec3f, pdf: f32 }
override roughness: f32 = 0.3; // 0.01..1 perceptual roughness
override n: i32 = 3; // 1..9 count
fn pow5(x: f32) -> f32 { let y = x*x; return y*y*x; }
fn early(x: f32) -> f32 { if x < 0.5 { return 1.0; } var s = 0.0; for (var i = 0; i < n; i++) { if i == 1 { continue; } s += f32(i); if s > 3.0 {break;} } return s; }
fn eval(wi: vec3f, wo: vec3f) -> vec3f {
  let a = array<f32, 4>(1.0, 2.0, 3.0, 4.0);
  var v = wi; v.x = pow5(wo.z); 
  return vec3f(early(wi.z), v.x * roughness, a[i32(wo.z * 3.0)]);
}
fn sample(wo: vec3f, u: vec3f) -> S { return S(wo, u, 1.0); }
").unwrap();
    println!("{:?}", s.parameters());
    println!("ops {}", s.program().operations());
    let wi = Vec3::new(0.6, 0.0, 0.8);
    for (wi, wo) in [(wi, wi), (wi, Vec3::new(0.0, 0.0, 1.0)), (Vec3::new(0.8, 0.0, 0.4), wi)] {
        println!("{:?}", s.eval(&[0.3, 3.0], wi, wo));
        println!("{:?}", s.eval::<f32>(&[0.3, 3.0], Vec3::new(wi.x as f32, wi.y as f32, wi.z as f32), Vec3::new(wo.x as f32, wo.y as f32, wo.z as f32)));
    }
    println!("{:?}", s.sample(&[0.3, 3.0], wi, [0.1, 0.2, 0.3]));
}

#[test]
fn glsl() {
    let s = load("a.glsl", "
uniform float rough = 0.25; // 0..1 how rough
layout(constant_id = 3) const float other = 0.5; // 0..1 other
vec3 helper(inout vec3 x, out float y) { x *= 2.0; y = x.x; return x; }
vec3 eval(vec3 wi, vec3 wo) { vec3 a = wi; float y; helper(a, y); a[1] = mix(1, 3, wi.z); return a * y * rough + vec3(other); }
vec3 my_sample(vec3 wo, vec3 u, out vec3 wi, out float pdf) { wi = u; pdf = 2.0; return wo; }
").unwrap();
    println!("{:?}", s.parameters());
    let wi = Vec3::new(0.6, 0.0, 0.8);
    println!("{:?}", s.eval(&s.defaults(), wi, wi));
    let s = load("a.brdf", "analytic\n::begin parameters\nfloat r 0 1 .5\ncolor c 1 .5 .25\nbool b 1\n::end parameters\n::begin shader\nconst float PI = 3.14;\nvec3 BRDF( vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y )\n{ float a = dot(L, N); if (a < 0) return vec3(0); return b ? c * r : vec3(a, dot(L,X), dot(L,Y)); }\n::end shader\n").unwrap();
    println!("{:?}", s.parameters());
    println!("{:?}", s.eval(&s.defaults(), wi, wi));
    println!("{:?}", s.eval(&[0.5, 1.0, 0.5, 0.25, 0.0], wi, wi));
}

#[test]
fn errors() {
    for (name, text) in [
        ("a.wgsl", "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n  let x = ;\n return wi; }"),
        ("a.wgsl", "fn evil(wi: vec3f, wo: vec3f) -> vec3f { return wi; }"),
        ("a.wgsl", "fn eval(wi: vec3f) -> vec3f { return wi; }"),
        ("a.wgsl", "fn f(x: f32) -> f32 { return f(x); }\nfn eval(wi: vec3f, wo: vec3f) -> vec3f { return wi * f(wo.x); }"),
        ("a.glsl", "float f(float x) { return f(x); }\nvec3 eval(vec3 wi, vec3 wo) { return wi * f(wo.x); }"),
        ("a.glsl", "float f(float x);\nfloat g(float x) { return f(x); }\nfloat f(float x) { return g(x); }\nvec3 eval(vec3 wi, vec3 wo) { return wi * f(wo.x); }"),
        ("a.glsl", "vec3 eval(vec3 wi, vec3 wo) { return wi + ; }"),
        ("a.glsl", "vec3 eval(vec3 wi, vec3 wo) { return wi * 2 + unknown; }"),
        ("a.glsl", "vec3 eval(vec3 wi, vec3 wo) { return dFdx(wi); }"),
        ("a.glsl", "vec3 eval(vec3 wi, vec3 wo) { float a[100000000]; a[1] = 1.0; return wi * a[2]; }"),
        ("a.wgsl", "@group(0) @binding(0) var t: texture_2d<f32>;\n@group(0) @binding(1) var s: sampler;\nfn eval(wi: vec3f, wo: vec3f) -> vec3f { return textureSampleLevel(t, s, wi.xy, 0.0).xyz; }"),
        ("a.wgsl", "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return wi.x; }"),
        ("a.wgsl", "fn eval(wi: vec3f, wo: vec3f) -> vec3f { return wi + true; }"),
        ("a.wgsl", "var<workgroup> x: atomic<u32>;\nfn eval(wi: vec3f, wo: vec3f) -> vec3f { return wi * f32(atomicAdd(&x, 1u)); }"),
        ("a.wgsl", ""),
        ("a.brdf", "analytic\n::begin parameters\nfloat r 0 1\n::end parameters\n"),
        ("a.brdf", "analytic\n::begin shader\nvec3 BRDF( vec3 L, vec3 V, vec3 N, vec3 X, vec3 Y )\n{ return x; }\n::end shader"),
    ] {
        let e = load(name, text).unwrap_err();
        println!("{e}\n{}\nhelp: {:?}\n", e.snippet().unwrap_or_default(), e.help);
    }
    let s = load("a.wgsl", "fn eval(wi: vec3f, wo: vec3f) -> vec3f {\n var x = wi;\n while x.x < 2.0 { x.y += 1.0; }\n return x; }").unwrap();
    let t = std::time::Instant::now();
    println!("{:?} {:?} {:?}", s.eval::<f64>(&[], Vec3::new(0.0,0.0,1.0), Vec3::new(0.0,0.0,1.0)), s.failure(), t.elapsed());
}
const GGX: &str = "
override roughness: f32 = 0.3;
fn eval(wi: vec3f, wo: vec3f) -> vec3f {
  if wi.z <= 0.0 || wo.z <= 0.0 { return vec3f(0.0); }
  let a = roughness * roughness; let a2 = a * a;
  let h = normalize(wi + wo);
  let t = 1.0 + (a2 - 1.0) * h.z * h.z;
  let d = a2 / (3.14159265 * t * t);
  let li = sqrt(a2 + (1.0 - a2) * wi.z * wi.z); let lo = sqrt(a2 + (1.0 - a2) * wo.z * wo.z);
  let g = 0.5 / (wo.z * li + wi.z * lo);
  let f = vec3f(0.9, 0.7, 0.3) + (vec3f(1.0) - vec3f(0.9, 0.7, 0.3)) * pow(1.0 - dot(wi, h), 5.0);
  return f * (d * g);
}";
fn native(r: f32, wi: Vec3<f32>, wo: Vec3<f32>) -> [f32; 3] {
  use gonio_num::Real;
  if wi.z <= 0.0 || wo.z <= 0.0 { return [0.0; 3]; }
  let a = r * r; let a2 = a * a;
  let h = Vec3::new(wi.x+wo.x,wi.y+wo.y,wi.z+wo.z); let l = (h.x*h.x+h.y*h.y+h.z*h.z).sqrt(); let h = Vec3::new(h.x/l,h.y/l,h.z/l);
  let t = 1.0 + (a2 - 1.0) * h.z * h.z;
  let d = a2 / (3.14159265 * t * t);
  let li = (a2 + (1.0 - a2) * wi.z * wi.z).sqrt(); let lo = (a2 + (1.0 - a2) * wo.z * wo.z).sqrt();
  let g = 0.5 / (wo.z * li + wi.z * lo);
  let c = 1.0 - (wi.x*h.x+wi.y*h.y+wi.z*h.z); let s = Real::exp(5.0*Real::ln(c));
  [0.9f32,0.7,0.3].map(|f| (f + (1.0-f)*s)*(d*g))
}
#[test]
#[ignore]
fn speed() {
    use gonio_num::lanes::Lanes;
    let s = load("a.wgsl", GGX).unwrap();
    println!("ops {}", s.program().operations());
    let n = 200_000;
    let t = std::time::Instant::now();
    let mut sum = 0.0;
    for i in 0..n { let x = i as f32 / n as f32 * 0.9; sum += native(std::hint::black_box(0.3), Vec3::new(x, 0.0, (1.0-x*x).sqrt()), Vec3::new(0.6, 0.0, 0.8))[0]; }
    println!("native f32 {:.1} ns {sum}", t.elapsed().as_secs_f64() * 1e9 / n as f64);
    let t = std::time::Instant::now();
    let mut sum = 0.0;
    for i in 0..n { let x = i as f32 / n as f32 * 0.9; sum += s.eval(&[0.3f32], Vec3::new(x, 0.0, (1.0-x*x).sqrt()), Vec3::new(0.6, 0.0, 0.8))[0]; }
    println!("f32 {:.1} ns {sum}", t.elapsed().as_secs_f64() * 1e9 / n as f64);
    fn lanes<const L: usize>(s: &Shader, n: usize) {
        let t = std::time::Instant::now();
        let mut sum = 0.0;
        for g in 0..n / L {
            let mut x = Lanes([0.0; L]); let mut z = x;
            for l in 0..L { x.0[l] = (g * L + l) as f32 / n as f32 * 0.9; z.0[l] = (1.0 - x.0[l] * x.0[l]).sqrt(); }
            let c = |v| Lanes::splat(v);
            sum += s.eval(&[c(0.3)], Vec3::new(x, c(0.0), z), Vec3::new(c(0.6), c(0.0), c(0.8)))[0].0.iter().sum::<f32>();
        }
        println!("lanes {L} {:.1} ns {sum}", t.elapsed().as_secs_f64() * 1e9 / n as f64);
    }
    lanes::<8>(&s, n); lanes::<16>(&s, n); lanes::<64>(&s, n); lanes::<128>(&s, n); lanes::<256>(&s, n); lanes::<512>(&s, n);
    let inputs: Vec<f64> = (0..n).flat_map(|i| { let x = i as f64 / n as f64 * 0.9; [x, 0.0, (1.0-x*x).sqrt(), 0.6, 0.0, 0.8] }).collect();
    let mut out = vec![0.0; n * 3];
    let t = std::time::Instant::now();
    s.program().run_many(&[0.3], &inputs, &mut out).unwrap();
    println!("many f64 {:.1} ns", t.elapsed().as_secs_f64() * 1e9 / n as f64);
    let inputs: Vec<f32> = inputs.iter().map(|&x| x as f32).collect();
    let mut out = vec![0.0; n * 3];
    let t = std::time::Instant::now();
    s.program().run_many(&[0.3f32], &inputs, &mut out).unwrap();
    println!("many f32 {:.1} ns", t.elapsed().as_secs_f64() * 1e9 / n as f64);
}

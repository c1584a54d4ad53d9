//! HLSL, MSL and OSL through a C++ compiler.

use super::*;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

const LANGUAGES: [(Language, &str, [&str; 2]); 3] = [
    (Language::Hlsl, "hlsl", ["float3", "float3"]),
    (Language::Msl, "metal", ["float3", "float3"]),
    (Language::Osl, "osl", ["vector", "color"]),
];

/// GCC: a literal without a suffix is single precision there, as it is in those languages.
const FLAGS: [&str; 4] = ["-std=c++14", "-O0", "-w", "-fsingle-precision-constant"];

fn compiler() -> Option<String> {
    let name = std::env::var("CXX").unwrap_or_else(|_| "c++".into());
    let mut probe = Command::new(&name);
    probe.args(FLAGS).args(["-E", "-x", "c++", "-"]);
    let output = probe.stdin(std::process::Stdio::null()).output();
    output.is_ok_and(|o| o.status.success()).then_some(name)
}

/// The text of one model in its namespace, and a function that runs it.
fn unit(
    text: &str,
    name: &str,
    (language, space, [vector, _]): (Language, &str, [&str; 2]),
) -> String {
    let text = text
        .replace("#include <metal_stdlib>", "")
        .replace("using namespace metal;", "");
    let c = |k: usize| match language {
        Language::Osl => format!("[{k}]"),
        _ => [".x", ".y", ".z"][k].to_owned(),
    };
    let [x, y, z] = [0, 1, 2].map(c);
    format!(
        "namespace {space} {{\n{text}\n}}\n\
         void {space}_{name}(const float *a, float *b) {{\n\
         using namespace {space};\n\
         {vector} wi({vector}(a[0], a[1], a[2])), wo({vector}(a[3], a[4], a[5])), xi({vector}(a[6], a[7], a[8]));\n\
         auto f = {name}_eval(wi, wo);\n\
         {name}_sample_result s = {name}_sample(wo, xi);\n\
         float all[] = {{f{x}, f{y}, f{z}, {name}_pdf(wi, wo), s.wi{x}, s.wi{y}, s.wi{z},\n\
             s.weight{x}, s.weight{y}, s.weight{z}, s.pdf, s.delta}};\n\
         for (int k = 0; k < {OUTPUTS}; k++) b[k] = all[k];\n}}\n"
    )
}

/// What the compiled code gives for the inputs: for each unit the outputs of all pairs.
fn run(
    compiler: &str,
    folder: &Path,
    units: &[(String, String)],
    inputs: &[[f32; INPUTS]],
) -> Vec<Vec<f32>> {
    let mut source = include_str!("shim.hpp").to_owned();
    source += "#include <cstdio>\n#define constant static const\n";
    for (_, text) in units {
        source += text;
    }
    source += "typedef void (*Unit)(const float *, float *);\nstatic Unit units[] = {\n";
    for (name, _) in units {
        let _ = writeln!(source, "    {name},");
    }
    let _ = write!(
        source,
        "}};\nint main() {{\n    static float a[{}];\n    if (fread(a, 4, {0}, stdin) != {0}) return 1;\n    for (Unit unit : units)\n\
         for (int i = 0; i < {COUNT}; i++) {{\n float b[{OUTPUTS}];\n unit(a + {INPUTS} * i, b);\n fwrite(b, 4, {OUTPUTS}, stdout);\n }}\n}}\n",
        INPUTS * COUNT
    );
    let (file, program) = (folder.join("units.cpp"), folder.join("units"));
    std::fs::write(&file, source).unwrap();
    let built = Command::new(compiler)
        .args(FLAGS)
        .arg(&file)
        .arg("-o")
        .arg(&program)
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&built.stderr);
    assert!(
        built.status.success(),
        "{}",
        said.lines().take(20).collect::<Vec<_>>().join("\n")
    );
    let data = folder.join("inputs");
    let bytes: Vec<u8> = inputs
        .iter()
        .flatten()
        .flat_map(|x| x.to_ne_bytes())
        .collect();
    std::fs::write(&data, bytes).unwrap();
    let ran = Command::new(&program)
        .stdin(std::fs::File::open(&data).unwrap())
        .output()
        .unwrap();
    assert!(ran.status.success());
    let numbers: Vec<f32> = ran
        .stdout
        .chunks_exact(4)
        .map(|b| f32::from_ne_bytes(b.try_into().unwrap()))
        .collect();
    assert_eq!(numbers.len(), units.len() * COUNT * OUTPUTS);
    numbers
        .chunks(COUNT * OUTPUTS)
        .map(<[f32]>::to_vec)
        .collect()
}

/// What a compiler is given: of each model the first that is shown, and variants of microfacets that look tables up in one, two and three
/// dimensions, and go through every Fresnel term. That is every operation that is ever recorded; the rest is run by the evaluator.
fn chosen() -> Vec<ModelSpec> {
    let mut all: Vec<ModelSpec> = Vec::new();
    for spec in showcase() {
        let variants = ["fresnel", "distribution=gaussian", "distribution=student-t"];
        let text = spec.to_string();
        let more = spec.name == "torrance-sparrow" && variants.iter().any(|v| text.contains(v));
        if more || all.iter().all(|other| other.name != spec.name) {
            all.push(spec);
        }
    }
    all
}

#[test]
fn compiled_code_is_the_model() {
    let Some(compiler) = compiler() else {
        eprintln!("skipped: no C++ compiler here that takes {FLAGS:?}, as GCC does");
        return;
    };
    let inputs = inputs("compiled export");
    let specs = chosen();
    let mut units = Vec::new();
    for (k, spec) in specs.iter().enumerate() {
        let export = Export::new(spec).unwrap();
        for language in LANGUAGES {
            let name = format!("m{k}");
            let text = unit(&text(&export, language.0, &name), &name, language);
            units.push((format!("{}_{name}", language.1), text));
        }
    }
    // A wrong one: 1/π is off by 3e-5.
    let diffuse = ModelSpec::parse("lambertian").unwrap();
    let altered = text(&Export::new(&diffuse).unwrap(), Language::Osl, "altered");
    let altered = altered.replace("0.31830987", "0.31832");
    units.push((
        "osl_altered".into(),
        unit(&altered, "altered", LANGUAGES[2]),
    ));

    let folder = tempfile::tempdir().unwrap();
    let results = run(&compiler, folder.path(), &units, &inputs);
    let (last, results) = results.split_last().unwrap();
    let mut wrong = Vec::new();
    for (k, got) in results.iter().enumerate() {
        let found = difference(&specs[k / LANGUAGES.len()], &inputs, got);
        wrong.extend(found.map(|d| format!("{}: {d}", LANGUAGES[k % LANGUAGES.len()].1)));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let noticed = difference(&diffuse, &inputs, last);
    assert!(noticed.is_some(), "an altered export went unnoticed");
}

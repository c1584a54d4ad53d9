//! `gonio brdf export`.

use crate::support::Place;

const LANGUAGES: [(&str, &str); 5] = [
    ("wgsl", "fn ggx_eval(wi: vec3f, wo: vec3f) -> vec3f {"),
    ("glsl", "vec3 ggx_eval(vec3 wi, vec3 wo) {"),
    ("hlsl", "float3 ggx_eval(float3 wi, float3 wo) {"),
    ("msl", "inline float3 ggx_eval(float3 wi, float3 wo) {"),
    ("osl", "color ggx_eval(vector wi, vector wo) {"),
];

#[test]
fn every_language_is_written() {
    let place = Place::new();
    for (language, head) in LANGUAGES {
        let spec = "ggx:roughness=0.25,interreflection=none";
        let text = place
            .good(&["brdf", "export", spec, "--lang", language])
            .out;
        let command = format!("//   gonio brdf export {spec} --lang {language}\n");
        assert!(text.contains(&command), "{text}");
        assert!(text.contains(head), "{text}");
        assert!(text.contains("ggx_roughness"), "{text}");
        assert!(text.contains("interreflection=none"), "{text}");
        for function in ["ggx_pdf(", "ggx_sample("] {
            assert!(text.contains(function), "{text}");
        }
        // A part of it.
        let arguments = [
            "brdf", "export", spec, "--lang", language, "--with", "pdf,pdf",
        ];
        let part = place.good(&arguments).out;
        assert!(
            part.contains("ggx_pdf(") && part.contains("--with pdf\n"),
            "{part}"
        );
        assert!(
            !part.contains("ggx_eval(") && !part.contains("ggx_sample("),
            "{part}"
        );
    }
}

#[test]
fn the_file_tells_the_language() {
    let place = Place::new();
    for (file, word) in [
        ("a.wgsl", "fn glass_"),
        ("a.frag", "vec3 glass_"),
        ("a.HLSL", "float3 glass_"),
        ("a.metal", "#include <metal_stdlib>"),
        ("a.osl", "color glass_"),
    ] {
        let arguments = [
            "brdf",
            "export",
            "smooth-dielectric",
            "--name",
            "glass",
            "-o",
            file,
        ];
        let said = place.good(&arguments).out;
        assert!(
            said.starts_with(&format!("{file}: glass_eval, glass_pdf, glass_sample in ")),
            "{said}"
        );
        let text = String::from_utf8(place.read(file)).unwrap();
        assert!(text.contains(word), "{text}");
        assert!(
            text.ends_with("}\n") && text.contains("--name glass\n"),
            "{text}"
        );
    }
    assert_eq!(place.files().len(), 5);
}

#[test]
fn a_description_with_parentheses_is_quoted() {
    let place = Place::new();
    let spec = "sum(lambertian:0.4, ggx:f0=0.1,interreflection=none)";
    let text = place.good(&["brdf", "export", spec, "--lang", "glsl"]).out;
    assert!(
        text.contains(&format!("export '{spec}' --lang glsl")),
        "{text}"
    );
    for name in ["sum_lambertian_reflectance", "sum_torrance_sparrow_f0"] {
        assert!(text.contains(name), "{text}");
    }
}

#[test]
fn what_makes_no_sense_is_named() {
    let place = Place::new();
    let export = |rest: &[&str], code: i32, words: &[&str]| {
        place.bad(&[&["brdf", "export"], rest].concat(), code, words);
    };
    export(&["ggx", "--lang", "glls"], 2, &["did you mean 'glsl'?"]);
    export(&["ggx", "--lang", "cuda"], 2, &["it is one of wgsl, glsl"]);
    export(
        &["ggx", "--lang", "glsl", "--with", "evel"],
        2,
        &["did you mean 'eval'?"],
    );
    export(
        &["ggx", "--lang", "glsl", "--with", ""],
        2,
        &["eval, pdf, sample"],
    );
    export(
        &["lambertan", "--lang", "glsl"],
        2,
        &["did you mean `lambertian`?"],
    );
    export(&["ggx"], 2, &["which language?", "--lang with one of wgsl"]);
    export(&["ggx", "-o", "a.gls"], 2, &["did you mean '.glsl'?"]);
    export(
        &["ggx", "-o", "a.txt"],
        2,
        &[".txt is no shading language's"],
    );
    export(&["ggx", "-o", "a"], 2, &["no extension"]);
    export(
        &["ggx", "-o", "no/a.glsl"],
        3,
        &["the folder no does not exist"],
    );
    export(
        &["ggx", "-o", ".", "--lang", "osl"],
        3,
        &["this is a folder"],
    );
    for (language, word) in [
        ("wgsl", "fn"),
        ("glsl", "float"),
        ("hlsl", "float3"),
        ("msl", "kernel"),
        ("osl", "color"),
    ] {
        let rest = ["ggx", "--lang", language, "--name", word];
        export(&rest, 2, &["it is a word of the language"]);
    }
    for (name, why) in [
        ("2x", "begin with a letter"),
        ("a b", "other characters"),
        ("a__b", "two `_`"),
        ("", "begin with a letter"),
    ] {
        export(&["ggx", "--lang", "glsl", "--name", name], 2, &[why]);
    }
    let walk = "ggx:interreflection=random-walk";
    for spec in [walk, &format!("scaled(0.5, {walk})")] {
        export(
            &[spec, "--lang", "osl"],
            2,
            &["traced, not computed", "kulla-conty"],
        );
    }
    export(
        &["table:file=a.binary", "--lang", "osl"],
        2,
        &["searched in memory", "texture"],
    );
}

/// The book shows what the command prints.
#[test]
fn the_book_shows_the_output() {
    let place = Place::new();
    let page = include_str!("../../../../book/src/export.md");
    let arguments = [
        "brdf",
        "export",
        "burley:roughness=0.4",
        "--lang",
        "glsl",
        "--with",
        "eval",
    ];
    assert!(page.contains(&format!("gonio {}\n", arguments.join(" "))));
    let text = place.good(&arguments).out;
    let shown: Vec<&str> = page.split("```glsl\n").skip(1).collect();
    assert_eq!(shown.len(), 2);
    for block in shown {
        let block = block.split("```").next().unwrap();
        assert!(text.contains(block), "{block}\n{text}");
    }
}

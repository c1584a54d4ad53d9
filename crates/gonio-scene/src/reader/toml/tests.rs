use crate::{Light, LoadOptions, Projection, Scene, SceneError};
use gonio_image::Image;
use gonio_num::Vec3;

/// Loads a scene file with this text, beside a texture `red.png`.
fn load(text: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().unwrap();
    Image::filled(4, 2, [1.0, 0.0, 0.0])
        .write(&folder.path().join("red.png"))
        .unwrap();
    let path = folder.path().join("scene.toml");
    std::fs::write(&path, text).unwrap();
    Scene::load(&path, &LoadOptions::default())
}

/// The error of a scene file and its help, with the place shown.
fn refused(text: &str) -> (String, String) {
    let error = load(text).unwrap_err();
    let message = error.to_string();
    assert!(matches!(error, SceneError::Description { .. }), "{message}");
    assert!(
        message.contains("scene.toml:") && message.contains(" | ") && message.contains('^'),
        "{message}"
    );
    (message, error.help().unwrap_or_default())
}

const BALL: &str = "[[shape]]\nkind = \"sphere\"\n";

#[test]
fn a_whole_scene() {
    let scene = load(
        r##"
name = "still life"
[film]
size = [640, 360]
[camera]
eye = [0, 1, 5]
target = [0, 1, 0]
fov_deg = 30
lens_radius = 0.1
[environment]
uniform = [0.1, 0.2, 0.3]
scale = 2
[[material]]
name = "paint"
model = "lambertian"
params = { reflectance = [0.2, 0.4, 0.8] }
textures = { reflectance = { file = "red.png", wrap = "clamp", uv_scale = [2, 2], filter = "nearest" } }
normal = { file = "red.png", scale = 0.5 }
[[material]]
name = "gold"
model = "torrance-sparrow:roughness=0.3"
opacity = { value = 0.5 }
[[material]]
name = "lamp"
emission = { radiance = "#ffffff", strength = 5 }
double_sided = true
[[shape]]
kind = "sphere"
material = "gold"
scale = 0.5
rotate_deg = [0, 90, 0]
translate = [1, 2, 3]
[[shape]]
kind = "disk"
material = "paint"
matrix = [1, 0, 0, 0,  0, 1, 0, 7,  0, 0, 1, 0]
instances = [{ translate = [0, 0, 1] }, { translate = [0, 0, 2], scale = 2 }]
[[shape]]
kind = "rectangle"
material = "lamp"
translate = [0, 4, 0]
look_at = [0, 0, 0]
[[light]]
kind = "point"
position = [0, 3, 0]
intensity = [1, 2, 3]
[[light]]
kind = "directional"
direction = [0, -2, 0]
irradiance = 3
[[light]]
kind = "spot"
position = [0, 3, 0]
target = [0, 0, 0]
intensity = 9
outer_deg = 20
"##,
    )
    .unwrap();
    assert_eq!(
        (scene.name.as_str(), scene.film_size),
        ("still life", Some([640, 360]))
    );
    assert_eq!(scene.material_names(), ["paint", "gold", "lamp"]);
    let lens = scene.cameras[0].projection;
    assert!(
        matches!(lens, Projection::ThinLens { focus_distance, .. } if focus_distance == 5.0),
        "{lens:?}"
    );
    let at = |i: usize, p: Vec3<f32>| scene.geometry.instances()[i].to_world.transform_point(p);
    // A quarter turn about y takes +x to −z.
    assert!((at(0, Vec3::new(1.0, 0.0, 0.0)) - Vec3::new(1.0, 2.0, 2.5)).length() < 1e-6);
    assert_eq!(at(1, Vec3::zero()), Vec3::new(0.0, 7.0, 1.0));
    assert_eq!(at(2, Vec3::new(1.0, 0.0, 0.0)), Vec3::new(2.0, 7.0, 2.0));
    assert!(
        (at(3, Vec3::new(0.0, 0.0, 1.0)) - Vec3::new(0.0, 3.0, 0.0)).length() < 1e-6,
        "its normal points down"
    );
    let kinds: Vec<_> = scene.lights.iter().collect();
    assert!(matches!(
        kinds[..],
        [
            Light::Point { .. },
            Light::Directional { .. },
            Light::Spot { .. },
            Light::Area { .. },
            Light::Environment(_)
        ]
    ));
    assert!(
        matches!(kinds[1], Light::Directional { direction, .. } if *direction == Vec3::new(0.0, -1.0, 0.0))
    );
    assert_eq!(
        scene
            .lights
            .environment()
            .unwrap()
            .radiance(Vec3::new(1.0, 0.0, 0.0)),
        [0.2, 0.4, 0.6]
    );
    assert_eq!(scene.materials[2].emission.radiance, [5.0; 3]);
    assert!(
        scene.has_transparency() && scene.materials[0].normal_map.as_ref().unwrap().scale == 0.5
    );
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn unknown_words_are_shown_and_guessed() {
    let (message, help) = refused("[camera]\neye = [0, 0, 1]\ntraget = [0, 0, 0]\n");
    assert!(
        message.contains(
            ":3:1: unknown key `traget` in [camera]\n  |\n3 | traget = [0, 0, 0]\n  | ^^^^^^"
        ),
        "{message}"
    );
    assert_eq!(help, "did you mean `target`?");
    let (message, help) = refused("[enviroment]\nuniform = 1\n");
    assert!(
        message.contains("`enviroment`") && help == "did you mean `environment`?",
        "{message}"
    );
    let (message, help) = refused("[[material]]\nname = \"a\"\nmodel = \"lambertain\"\n");
    assert!(
        message.contains(":3:9: ") && help == "did you mean `lambertian`?",
        "{message} {help}"
    );
    let (message, help) = refused("[[material]]\nname = \"a\"\nparams = { reflectence = 1 }\n");
    assert!(
        message.contains(":3:12: ") && help == "did you mean `reflectance`?",
        "{message} {help}"
    );
    let (message, help) =
        refused("[[material]]\nname = \"a\"\ntextures = { reflectence = \"red.png\" }\n");
    assert!(
        message.contains(":3:14: ") && help == "did you mean `reflectance`?",
        "{message} {help}"
    );
    let (message, help) = refused(
        "[[material]]\nname = \"bronze\"\n[[shape]]\nkind = \"sphere\"\nmaterial = \"bronce\"\n",
    );
    assert!(
        message.contains("no material `bronce`") && help == "did you mean `bronze`?",
        "{message} {help}"
    );
    let (message, help) = refused("[[shape]]\nkind = \"shpere\"\n");
    assert!(
        message.contains("`shpere`") && help == "did you mean `sphere`?",
        "{message} {help}"
    );
    let (_, help) = refused("[[light]]\nkind = \"spot\"\npositoin = [0, 0, 0]\n");
    assert_eq!(help, "did you mean `position`?");
}

#[test]
fn wrong_values_are_shown() {
    for (text, says) in [
        (
            "[camera]\neye = \"here\"\ntarget = [0, 0, 0]\n",
            "the text \"here\", expected 3 numbers",
        ),
        (
            "[camera]\neye = [0, nan, 1]\ntarget = [0, 0, 0]\n",
            "is NaN",
        ),
        (
            "[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 0]\n",
            "the same point",
        ),
        ("[camera]\neye = [0, 0, 0]\n", "has no `target`"),
        (
            "[environment]\nuniform = 1\ngroup = \"a.b\"\n",
            "`group` is \"a.b\", expected a name of letters, digits, - and _",
        ),
        (
            "[environment]\nuniform = 1\ngroup = 3\n",
            "a text in quotes",
        ),
        (
            "[[material]]\nname = \"a\"\ngroup = \"key\"\n",
            "`group` is for lights, and this material has no `emission`",
        ),
        (
            "[camera]\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nfov_deg = 180\n",
            "from 0.01 to 179",
        ),
        (
            "[camera]\nkind = \"orthographic\"\neye = [0, 0, 0]\ntarget = [0, 0, 1]\nfov_deg = 30\n",
            "no meaning here",
        ),
        ("[film]\nsize = [0, 10]\n", "whole numbers"),
        ("[film]\nsize = [10.5, 10]\n", "whole numbers"),
        ("[film]\nsize = [100000, 10]\n", "65536"),
        ("name = 3\n", "expected a text"),
        ("shape = 3\n", "expected a table"),
        ("[[shape]]\nkind = \"sphere\"\nscale = 0\n", "flattens"),
        (
            "[[shape]]\nkind = \"sphere\"\nmatrix = [1, 2]\n",
            "expected 12 numbers",
        ),
        (
            "[[shape]]\nkind = \"sphere\"\nmatrix = [1,0,0,0, 0,1,0,0, 0,0,1,0, 5,0,0,1]\n",
            "last row",
        ),
        (
            "[[shape]]\nkind = \"sphere\"\nfile = \"a.ply\"\n",
            "no meaning here",
        ),
        ("[[shape]]\nkind = \"mesh\"\n", "has no `file`"),
        (
            "[[shape]]\nkind = \"gltf\"\nfile = \"gone.glb\"\n",
            "gone.glb",
        ),
        ("[environment]\nfile = \"gone.hdr\"\n", "gone.hdr"),
        (
            "[environment]\nrotate_deg = 4\n",
            "needs `file`, `uniform` or `sky`",
        ),
        (
            "[environment]\nsky = \"elevation=20,turbidity=30\"\n",
            "turbidity = 30, expected a number from 1 to 10",
        ),
        (
            "[environment]\nuniform = 1\nsky = \"elevation=20\"\n",
            "both `uniform` and `sky`",
        ),
        (
            "[environment]\nuniform = 1\nproxy = \"box:0,0,0\"\n",
            "box:X0,Y0,Z0,X1,Y1,Z1",
        ),
        ("[environment]\nuniform = -1\n", "none below 0"),
        ("[environment]\nuniform = 1\nfile = \"red.png\"\n", "both"),
        (
            "[[material]]\nname = \"a\"\nparams = { reflectance = 2 }\n",
            "from 0 to 1",
        ),
        (
            "[[material]]\nname = \"a\"\nparams = { reflectance = [0.1, true, 0] }\n",
            "NaN",
        ),
        (
            "[[material]]\nname = \"a\"\nnormal = \"gone.png\"\n",
            "gone.png",
        ),
        ("[[material]]\nname = \"a\"\nopacity = 1.5\n", "from 0 to 1"),
        (
            "[[material]]\nname = \"a\"\n[[material]]\nname = \"a\"\n",
            "a second material called `a`",
        ),
        (
            "[[light]]\nkind = \"point\"\nposition = [0, 0, 0]\n",
            "has no `intensity`",
        ),
        (
            "[[light]]\nkind = \"directional\"\ndirection = [0, 0, 0]\nirradiance = 1\n",
            "no direction",
        ),
        (
            "[[light]]\nkind = \"spot\"\nposition = [0, 0, 0]\ntarget = [0, 1, 0]\nintensity = 1\ninner_deg = 40\n",
            "cone",
        ),
        ("a = = 3\n", "this is not TOML"),
        ("[camera]\neye = [0, 0, 1\n", "this is not TOML"),
    ] {
        let (message, _) = refused(text);
        assert!(message.contains(says), "{says}: {message}");
    }
}

/// Lights by their own group, surfaces by the material's unless the shape has one; what is in none is in `default`.
#[test]
fn groups_of_lights_are_read() {
    let scene = load(
        r#"
[environment]
uniform = 1
group = "sky"
[[material]]
name = "lamp"
emission = 5
group = "practical"
[[shape]]
kind = "sphere"
material = "lamp"
[[shape]]
kind = "sphere"
material = "lamp"
group = "window"
instances = [{ translate = [2, 0, 0] }, { translate = [4, 0, 0] }]
[[shape]]
kind = "sphere"
material = "lamp"
translate = [6, 0, 0]
[[light]]
kind = "point"
position = [0, 3, 0]
intensity = 1
[[light]]
kind = "directional"
direction = [0, -1, 0]
irradiance = 1
group = "key"
"#,
    )
    .unwrap();
    let lights = &scene.lights;
    assert_eq!(
        lights.groups(),
        ["default", "key", "practical", "window", "sky"]
    );
    let of: Vec<u32> = (0..7).map_while(|light| lights.group(light)).collect();
    assert_eq!(of, [0, 1, 2, 3, 3, 2, 4]);
    assert_eq!(
        (lights.group(7), lights.environment_index()),
        (None, Some(6))
    );
    // Another environment takes the place of the one before.
    let mut scene = scene;
    let other = gonio_env::Environment::uniform([2.0; 3]);
    scene.set_environment(Some(other));
    assert_eq!(scene.lights.group(6), Some(4));
    assert_eq!(scene.lights.groups()[4], "sky");
    scene.set_environment(None);
    assert_eq!(scene.lights.groups().len(), 4);
    let dark = load(&format!("{BALL}group = \"key\"\n")).unwrap();
    let says = |w: &String| w.contains("the group of lights `key` doesn't shine");
    assert!(dark.warnings.iter().any(says), "{:?}", dark.warnings);
}

#[test]
fn files_that_are_no_scene_are_refused() {
    assert!(matches!(load("").unwrap_err(), SceneError::Empty { .. }));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bad.toml");
    std::fs::write(&path, b"name = \"\xff\"").unwrap();
    let error = Scene::load(&path, &LoadOptions::default())
        .unwrap_err()
        .to_string();
    assert!(
        error.contains("byte 8") && error.contains("UTF-8"),
        "{error}"
    );
    let small = LoadOptions {
        max_bytes: 4,
        ..LoadOptions::default()
    };
    let error = Scene::load(&path, &small).unwrap_err();
    assert!(matches!(error, SceneError::Limit { .. }), "{error}");
    let error = Scene::load(folder.path().join("gone.toml"), &small).unwrap_err();
    assert!(matches!(error, SceneError::Io { .. }), "{error}");
}

/// Shapes without a material share one grey default.
#[test]
fn the_default_material_is_made_once() {
    let scene = load(&format!("{BALL}{BALL}")).unwrap();
    assert_eq!(scene.material_names(), ["default"]);
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
}

/// A glTF object inside a TOML scene: placed, its material replaced, its cameras and lights left out.
#[test]
fn a_gltf_object_is_included() {
    let folder = tempfile::tempdir().unwrap();
    let corners: [f32; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let bin: Vec<u8> = corners.iter().flat_map(|x| x.to_le_bytes()).collect();
    std::fs::write(folder.path().join("t.bin"), bin).unwrap();
    let document = r#"{"asset":{"version":"2.0"},"scenes":[{"name":"inner","nodes":[0]}],"nodes":[{"mesh":0,"camera":0}],
        "cameras":[{"type":"perspective","perspective":{"yfov":0.6,"znear":0.1}}],
        "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"byteLength":36,"uri":"t.bin"}],
        "bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]}"#;
    std::fs::write(folder.path().join("t.gltf"), document).unwrap();
    let path = folder.path().join("outer.toml");
    let text = "[[material]]\nname = \"red\"\n[[shape]]\nkind = \"gltf\"\nfile = \"t.gltf\"\nmaterial = \"red\"\ntranslate = [0, 0, 4]\n\
                [[shape]]\nkind = \"gltf\"\nfile = \"t.gltf\"\ninstances = [{ scale = 2 }, { translate = [5, 0, 0] }]\n";
    std::fs::write(&path, text).unwrap();
    let scene = Scene::load(&path, &LoadOptions::default()).unwrap();
    assert_eq!((scene.name.as_str(), scene.cameras.len()), ("outer", 0));
    let placed = &scene.geometry.instances()[0];
    assert_eq!(
        (placed.material, placed.to_world.origin),
        (0, Vec3::new(0.0, 0.0, 4.0))
    );
    let copies = &scene.geometry.instances()[1..];
    assert_eq!(copies.len(), 2);
    assert!(
        copies
            .iter()
            .all(|i| i.shape == 1 && scene.materials[i.material as usize].spec().name == "gltf")
    );
    assert_eq!(copies[0].to_world.x, Vec3::new(2.0, 0.0, 0.0));
    assert_eq!(copies[1].to_world.origin, Vec3::new(5.0, 0.0, 0.0));
}

/// A shader is found beside the scene; its own parameters may stand before its file, and textures drive them.
#[test]
fn shaders_are_materials() {
    let folder = tempfile::tempdir().unwrap();
    Image::filled(4, 2, [1.0, 0.0, 0.0])
        .write(&folder.path().join("red.png"))
        .unwrap();
    let shader = "override amount: f32 = 0.5; // 0..1 albedo
        fn eval(wi: vec3f, wo: vec3f) -> vec3f { return vec3f(amount / 3.14159265); }";
    std::fs::write(folder.path().join("matt.wgsl"), shader).unwrap();
    let path = folder.path().join("scene.toml");
    let material = |text: &str| {
        let shape = "[[shape]]\nkind = \"sphere\"\nmaterial = \"m\"\n";
        std::fs::write(
            &path,
            format!("[[material]]\nname = \"m\"\n{text}\n{shape}"),
        )
        .unwrap();
        Scene::load(&path, &LoadOptions::default())
    };
    material("model = \"matt.wgsl:amount=0.25\"").unwrap();
    material("model = \"shader\"\nparams = { amount = 0.25, file = \"matt.wgsl\" }").unwrap();
    material("model = \"matt.wgsl\"\ntextures = { amount = \"red.png\" }").unwrap();
    let error = material("model = \"matt.wgsl\"\nparams = { amonut = 0.25 }").unwrap_err();
    assert!(
        error
            .to_string()
            .contains("`shader` has no parameter `amonut`"),
        "{error}"
    );
}

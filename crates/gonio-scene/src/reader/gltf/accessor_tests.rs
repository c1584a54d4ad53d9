use super::*;

/// A document of one accessor over 16 bytes 0, 1, 2, …
fn with_accessor<T>(accessor: &str, then: impl FnOnce(&Arrays) -> T) -> T {
    let text = format!(
        r#"{{"asset":{{"version":"2.0"}},"buffers":[{{"byteLength":16}}],
        "bufferViews":[{{"buffer":0,"byteLength":16}},{{"buffer":0,"byteOffset":4,"byteLength":12,"byteStride":6}},
        {{"buffer":0,"byteOffset":12,"byteLength":8}},{{"buffer":3,"byteLength":8}}],
        "accessors":[{accessor}]}}"#
    );
    let root = json::Root::from_str(&text).unwrap();
    let buffers = vec![(0..16).collect::<Vec<u8>>()];
    then(&Arrays {
        path: Path::new("a.gltf"),
        root: &root,
        buffers: &buffers,
    })
}

#[test]
fn components_are_read_and_scaled() {
    let bytes = r#"{"bufferView":0,"componentType":5121,"count":2,"type":"VEC3","byteOffset":1}"#;
    let rows = with_accessor(bytes, |a| a.rows::<4>(0, &[Type::Vec3], 9.0)).unwrap();
    assert_eq!(rows, [[1.0, 2.0, 3.0, 9.0], [4.0, 5.0, 6.0, 9.0]]);
    let unit = r#"{"bufferView":0,"componentType":5121,"count":1,"type":"VEC2","normalized":true}"#;
    let rows = with_accessor(unit, |a| a.rows::<2>(0, &[Type::Vec2], 0.0)).unwrap();
    assert_eq!(rows, [[0.0, 1.0 / 255.0]]);
    let strided = r#"{"bufferView":1,"componentType":5123,"count":2,"type":"SCALAR"}"#;
    let indices = with_accessor(strided, |a| a.indices(0)).unwrap();
    assert_eq!(indices, [0x0504, 0x0B0A]);
}

#[test]
fn sparse_elements_replace() {
    let sparse = r#"{"componentType":5121,"count":4,"type":"SCALAR","sparse":{"count":2,
        "indices":{"bufferView":0,"byteOffset":1,"componentType":5121},"values":{"bufferView":0,"byteOffset":7}}}"#;
    assert_eq!(
        with_accessor(sparse, |a| a.indices(0)).unwrap(),
        [0, 7, 8, 0]
    );
    let outside = sparse.replace(r#""byteOffset":1"#, r#""byteOffset":3"#);
    let error = with_accessor(&outside, |a| a.indices(0))
        .unwrap_err()
        .to_string();
    assert!(error.contains("index 4"), "{error}");
}

#[test]
fn nothing_is_read_outside_a_view() {
    for (accessor, says) in [
        (
            r#"{"bufferView":0,"componentType":5126,"count":5,"type":"SCALAR"}"#,
            "16 bytes of bufferView 0",
        ),
        (
            r#"{"bufferView":0,"componentType":5126,"count":18446744073709551615,"type":"SCALAR"}"#,
            "elements inside",
        ),
        (
            r#"{"bufferView":0,"componentType":5121,"count":1,"type":"SCALAR","byteOffset":18446744073709551615}"#,
            "elements inside",
        ),
        (
            r#"{"bufferView":2,"componentType":5121,"count":1,"type":"SCALAR"}"#,
            "16 bytes of buffer 0",
        ),
        (
            r#"{"bufferView":3,"componentType":5121,"count":1,"type":"SCALAR"}"#,
            "buffer 3",
        ),
        (
            r#"{"bufferView":8,"componentType":5121,"count":1,"type":"SCALAR"}"#,
            "bufferView 8",
        ),
        (
            r#"{"bufferView":1,"componentType":5126,"count":1,"type":"VEC2"}"#,
            "stride 6",
        ),
        (
            r#"{"bufferView":0,"componentType":1,"count":1,"type":"SCALAR"}"#,
            "componentType",
        ),
        (
            r#"{"bufferView":0,"componentType":5121,"count":1,"type":"VEC9"}"#,
            "type",
        ),
        (
            r#"{"bufferView":0,"componentType":5121,"count":1,"type":"MAT2"}"#,
            "Mat2",
        ),
        (
            r#"{"componentType":5121,"count":1000000000000,"type":"SCALAR"}"#,
            "limit",
        ),
    ] {
        let types = [Type::Scalar, Type::Vec2];
        let error = with_accessor(accessor, |a| a.rows::<2>(0, &types, 0.0))
            .unwrap_err()
            .to_string();
        assert!(
            error.contains(says) && error.starts_with("a.gltf: "),
            "{error}"
        );
    }
    let error = with_accessor("", |a| a.indices(3)).unwrap_err().to_string();
    assert!(
        error.contains("accessor 3") && error.contains("below 0"),
        "{error}"
    );
    let float = r#"{"bufferView":0,"componentType":5126,"count":1,"type":"SCALAR"}"#;
    assert!(
        with_accessor(float, |a| a.indices(0))
            .unwrap_err()
            .to_string()
            .contains("unsigned")
    );
}

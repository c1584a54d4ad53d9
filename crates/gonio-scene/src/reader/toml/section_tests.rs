use super::*;

fn with<T>(text: &str, then: impl FnOnce(Section) -> T) -> T {
    let source = Source {
        path: "s.toml".into(),
        text: text.into(),
    };
    let table = DeTable::parse(&source.text).unwrap();
    then(Section::of_table(
        &source,
        "[top]",
        table.span(),
        table.get_ref(),
    ))
}

#[test]
fn values_of_every_kind() {
    with(
        "a = 0x10\nb = -1_0.5\nc = [1, 2.0, 3e1]\nd = \"#ff0080\"\ne = true\nf = 0.5",
        |s| {
            assert_eq!(s.number("a").unwrap(), Some(16.0));
            assert_eq!(s.number("b").unwrap(), Some(-10.5));
            assert_eq!(s.numbers::<3>("c").unwrap(), Some([1.0, 2.0, 30.0]));
            assert_eq!(s.colour("c").unwrap(), Some([1.0, 2.0, 30.0]));
            let [r, g, b] = s.colour("d").unwrap().unwrap();
            // sRGB 128 is linear 0.2158605.
            assert!(r == 1.0 && g == 0.0 && (b - 0.215_860_5).abs() < 1e-6);
            assert_eq!(s.flag("e").unwrap(), Some(true));
            assert_eq!(s.colour("f").unwrap(), Some([0.5; 3]));
            assert_eq!(s.number("none").unwrap(), None);
        },
    );
}

#[test]
fn wrong_values_are_shown_in_their_line() {
    for (text, says) in [
        ("a = nan", "s.toml:1:5: `a` in [top] is NaN"),
        ("a = inf", "is inf"),
        ("a = 1e39", "finite"),
        ("a = \"x\"", "the text \"x\", expected a number"),
        ("a = [1]", "a list, expected a number"),
    ] {
        let error = with(text, |s| s.number("a").unwrap_err().to_string());
        assert!(
            error.contains(says) && error.contains("\n1 | a = "),
            "{error}"
        );
    }
    let error = with("a = [1, 2]", |s| s.vector("a").unwrap_err().to_string());
    assert!(error.contains("has 2 items, expected 3 numbers"), "{error}");
    let error = with("a = [1, nan, 2]", |s| {
        s.vector("a").unwrap_err().to_string()
    });
    assert!(error.contains("1:9") && error.ends_with("^^^"), "{error}");
    let error = with("a = [1, -1, 2]", |s| s.colour("a").unwrap_err().to_string());
    assert!(error.contains("none below 0"), "{error}");
    let error = with("a = 3", |s| {
        s.number_in("a", 0.0, 1.0, "a share")
            .unwrap_err()
            .to_string()
    });
    assert!(error.contains("is 3, expected a share"), "{error}");
}

#[test]
fn unknown_words_are_guessed() {
    let error = with("colour = 1\nroughnes = 2", |s| {
        s.allow(&["colour", "roughness"]).unwrap_err()
    });
    assert!(
        error
            .to_string()
            .starts_with("s.toml:2:1: unknown key `roughnes` in [top]"),
        "{error}"
    );
    assert_eq!(error.help().unwrap(), "did you mean `roughness`?");
    let error = with("kind = \"speher\"", |s| {
        s.choice("kind", &[("sphere", 1), ("disk", 2)]).unwrap_err()
    });
    assert_eq!(error.help().unwrap(), "did you mean `sphere`?");
}

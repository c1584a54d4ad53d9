//! The languages that recorded functions are printed in, and what they differ in.

/// A shading language.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Language {
    /// WebGPU Shading Language.
    Wgsl,
    /// OpenGL Shading Language, 3.30 and ES 3.00 or later; Godot's language takes it too.
    Glsl,
    /// DirectX High-Level Shader Language, as Unity and Unreal use it.
    Hlsl,
    /// Metal Shading Language.
    Msl,
    /// Open Shading Language.
    Osl,
}

impl Language {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Wgsl, Self::Glsl, Self::Hlsl, Self::Msl, Self::Osl];

    /// Its name in lower case, such as `wgsl`.
    pub fn name(self) -> &'static str {
        ["wgsl", "glsl", "hlsl", "msl", "osl"][self as usize]
    }

    /// The extensions of its files without the dot, the usual one first.
    pub fn extensions(self) -> &'static [&'static str] {
        match self {
            Self::Wgsl => &["wgsl"],
            Self::Glsl => &["glsl", "frag", "vert", "comp", "gdshaderinc"],
            Self::Hlsl => &["hlsl", "hlsli", "cginc", "fx", "ush"],
            Self::Msl => &["metal", "msl"],
            Self::Osl => &["osl"],
        }
    }

    /// The language of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|l| l.name() == name)
    }

    /// The language whose files have this extension, in lower case and without the dot.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|l| l.extensions().contains(&extension))
    }

    /// Why `name` can't begin the names of this language's functions, if it can't: an empty name, other characters than ASCII letters,
    /// digits and `_`, a digit or `_` in front, two `_` in a row or one at the end (which GLSL keeps for itself), and words of
    /// the language.
    pub fn refuses(self, name: &str) -> Option<&'static str> {
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        if !name.starts_with(|c: char| c.is_ascii_alphabetic()) {
            Some("it doesn't begin with a letter")
        } else if !name.chars().all(plain) {
            Some("it has other characters than letters, digits and `_`")
        } else if name.contains("__") || name.ends_with('_') {
            Some("it has two `_` in a row, or ends with one")
        } else if super::names::is_word(self, name) {
            Some("it is a word of the language")
        } else if name.starts_with("gl_") || name.starts_with("gonio_") {
            Some("what begins so is reserved")
        } else {
            None
        }
    }

    pub(super) fn dialect(self) -> &'static Dialect {
        match self {
            Self::Wgsl => &WGSL,
            Self::Glsl => &GLSL,
            Self::Hlsl => &HLSL,
            Self::Msl => &MSL,
            Self::Osl => &OSL,
        }
    }
}

/// What a value of a recorded function is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) enum Type {
    Number,
    Truth,
    /// Three numbers, a direction.
    Vector,
    /// Three numbers, one a colour component.
    Colour,
}

/// How module-level constants are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Constants {
    /// `const NAME: TYPE = VALUE;`
    Const,
    /// The keyword, then `TYPE NAME = VALUE;`
    Keyword(&'static str),
    /// `#define NAME VALUE`, and arrays inside the function that reads them.
    Macro,
}

/// What the printer needs to know of a language.
#[derive(Debug)]
pub(super) struct Dialect {
    pub language: Language,
    number: &'static str,
    truth: &'static str,
    vector: &'static str,
    colour: &'static str,
    pub integer: &'static str,
    /// Stands behind a number's literal.
    pub suffix: &'static str,
    /// Of an integer from a number, and back: what stands in front of the parenthesis.
    pub to_integer: &'static str,
    pub to_number: &'static str,
    pub atan2: &'static str,
    pub constants: Constants,
    /// In front of a function.
    pub function: &'static str,
    /// What reaches the three components.
    pub components: [&'static str; 3],
    /// Whether a vector's constructor takes one number for all components.
    pub splats: bool,
    /// The bits of a NaN or an infinity as a number, with the bits between the two texts.
    pub from_bits: Option<[&'static str; 2]>,
    /// Whether an array is written as a call of its type.
    pub array_calls: bool,
    /// Truth values as literals.
    pub literals: [&'static str; 2],
}

impl Dialect {
    pub fn type_name(&self, kind: Type) -> &'static str {
        match kind {
            Type::Number => self.number,
            Type::Truth => self.truth,
            Type::Vector => self.vector,
            Type::Colour => self.colour,
        }
    }

    /// The type of an array of numbers.
    pub fn array(&self, count: usize) -> String {
        match self.is_wgsl() {
            true => format!("array<{}, {count}>", self.number),
            false => format!("{}[{count}]", self.number),
        }
    }

    /// Whether types stand behind names.
    pub fn is_wgsl(&self) -> bool {
        self.language == Language::Wgsl
    }

    /// `NAME: TYPE` or `TYPE NAME`.
    pub fn typed(&self, kind: &str, name: &str) -> String {
        if self.is_wgsl() {
            format!("{name}: {kind}")
        } else {
            format!("{kind} {name}")
        }
    }

    /// The declaration of a value that stays.
    pub fn value(&self, kind: &str, name: &str, text: &str) -> String {
        if self.is_wgsl() {
            format!("let {name} = {text};")
        } else {
            format!("{kind} {name} = {text};")
        }
    }

    /// The declaration of a variable, with a value if there is a text.
    pub fn variable(&self, kind: &str, name: &str, text: Option<&str>) -> String {
        let var = if self.is_wgsl() { "var " } else { "" };
        let value = text.map(|t| format!(" = {t}")).unwrap_or_default();
        format!("{var}{}{value};", self.typed(kind, name))
    }

    /// The head of a function, up to the brace.
    pub fn head(&self, name: &str, parameters: &[String], returns: &str) -> String {
        let parameters = parameters.join(", ");
        if self.is_wgsl() {
            format!("fn {name}({parameters}) -> {returns} {{\n")
        } else {
            format!("{}{returns} {name}({parameters}) {{\n", self.function)
        }
    }

    /// Whether constants are macros.
    pub fn has_macros(&self) -> bool {
        self.constants == Constants::Macro
    }

    /// A number from the bits of one that isn't finite. WGSL has another way, and OSL has none: there it is the largest number.
    pub fn not_finite(&self, bits: &str) -> String {
        match self.from_bits {
            Some([open, close]) => format!("{open}{bits}{close}"),
            None => "3.4028235e38".into(),
        }
    }

    /// A finite number, the shortest text that reads back as the same.
    pub fn number(&self, x: f32) -> String {
        format!("{x:?}{}", self.suffix)
    }

    /// A vector from the texts of its components.
    pub fn vector(&self, kind: Type, components: [&str; 3]) -> String {
        let [x, y, z] = components;
        let name = self.type_name(kind);
        if self.splats && x == y && y == z {
            format!("{name}({x})")
        } else {
            format!("{name}({x}, {y}, {z})")
        }
    }
}

const XYZ: [&str; 3] = [".x", ".y", ".z"];

static WGSL: Dialect = Dialect {
    language: Language::Wgsl,
    number: "f32",
    truth: "bool",
    vector: "vec3f",
    colour: "vec3f",
    integer: "i32",
    suffix: "",
    to_integer: "i32",
    to_number: "f32",
    atan2: "atan2",
    constants: Constants::Const,
    function: "",
    components: XYZ,
    splats: true,
    // WGSL refuses constants that aren't finite, so the bits come from a variable.
    from_bits: Some(["bitcast<f32>(", ")"]),
    array_calls: true,
    literals: ["false", "true"],
};

static GLSL: Dialect = Dialect {
    language: Language::Glsl,
    number: "float",
    truth: "bool",
    vector: "vec3",
    colour: "vec3",
    integer: "int",
    suffix: "",
    to_integer: "int",
    to_number: "float",
    atan2: "atan",
    constants: Constants::Keyword("const"),
    function: "",
    components: XYZ,
    splats: true,
    from_bits: Some(["uintBitsToFloat(", "u)"]),
    array_calls: true,
    literals: ["false", "true"],
};

static HLSL: Dialect = Dialect {
    language: Language::Hlsl,
    number: "float",
    truth: "bool",
    vector: "float3",
    colour: "float3",
    integer: "int",
    suffix: "",
    to_integer: "int",
    to_number: "float",
    atan2: "atan2",
    constants: Constants::Keyword("static const"),
    function: "",
    components: XYZ,
    splats: false,
    from_bits: Some(["asfloat(", "u)"]),
    array_calls: false,
    literals: ["false", "true"],
};

static MSL: Dialect = Dialect {
    language: Language::Msl,
    number: "float",
    truth: "bool",
    vector: "float3",
    colour: "float3",
    integer: "int",
    suffix: "f",
    to_integer: "int",
    to_number: "float",
    atan2: "atan2",
    constants: Constants::Keyword("constant"),
    function: "inline ",
    components: XYZ,
    splats: true,
    from_bits: Some(["as_type<float>(", "u)"]),
    array_calls: false,
    literals: ["false", "true"],
};

/// Components by index, as older versions have no names for them.
static OSL: Dialect = Dialect {
    language: Language::Osl,
    number: "float",
    truth: "int",
    vector: "vector",
    colour: "color",
    integer: "int",
    suffix: "",
    to_integer: "(int)",
    to_number: "(float)",
    atan2: "atan2",
    constants: Constants::Macro,
    function: "",
    components: ["[0]", "[1]", "[2]"],
    splats: true,
    from_bits: None,
    array_calls: false,
    literals: ["0", "1"],
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_extensions_find_their_language() {
        for language in Language::ALL {
            assert_eq!(Language::from_name(language.name()), Some(language));
            for extension in language.extensions() {
                assert_eq!(Language::from_extension(extension), Some(language));
            }
        }
        assert_eq!(Language::from_name("cg"), None);
        assert_eq!(Language::from_extension("txt"), None);
    }

    #[test]
    fn names_that_a_language_refuses() {
        for language in Language::ALL {
            for good in ["ggx", "my_model2", "x"] {
                assert_eq!(language.refuses(good), None, "{good}");
            }
            for bad in [
                "", "2x", "_x", "é", "a b", "a-b", "a__b", "a_", "gl_x", "for", "gonio_x",
            ] {
                assert!(language.refuses(bad).is_some(), "{bad}");
            }
        }
        assert!(Language::Glsl.refuses("float").is_some());
        assert!(Language::Wgsl.refuses("float").is_none());
        assert!(Language::Osl.refuses("color").is_some());
        assert!(Language::Hlsl.refuses("float3").is_some());
    }
}

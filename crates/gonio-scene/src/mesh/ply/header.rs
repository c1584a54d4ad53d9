//! The header: encoding, elements and their properties.

use super::Fault;

/// How the body is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// A number's type.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of a colour channel at full intensity; 1 for floating point.
    pub(super) fn full(self) -> f64 {
        match self {
            Self::I8 => 127.0,
            Self::U8 => 255.0,
            Self::I16 => 32_767.0,
            Self::U16 => 65_535.0,
            Self::I32 => 2_147_483_647.0,
            Self::U32 => 4_294_967_295.0,
            Self::F32 | Self::F64 => 1.0,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }
}

/// One number, or a list of them with their count before it.
#[derive(Debug, Clone)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of a list's count; `None` for one number.
    pub(super) list: Option<Scalar>,
    pub(super) scalar: Scalar,
}

#[derive(Debug, Clone)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

impl Element {
    /// The fewest bytes that one such element can take in the body.
    pub(super) fn least_bytes(&self, encoding: Encoding) -> u64 {
        self.properties
            .iter()
            .map(|p| match encoding {
                // A digit and a separator.
                Encoding::Ascii => 2,
                _ => p.list.unwrap_or(p.scalar).bytes() as u64,
            })
            .sum()
    }
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

/// The longest header that is read; comments count.
const LONGEST: usize = 1 << 20;

/// The header, and the offset of the body.
pub(super) fn parse(bytes: &[u8]) -> Result<(Header, usize), Fault> {
    let mut at = 0;
    let mut number = 0;
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        number += 1;
        let place = || format!("line {number}");
        let rest = &bytes[at..bytes.len().min(LONGEST)];
        let Some(end) = rest.iter().position(|&b| b == b'\n') else {
            return Err(if number == 1 && !rest.starts_with(b"ply") {
                not_ply(bytes)
            } else {
                Fault::new(
                    place(),
                    "the end of the header's bytes",
                    "end_header within the first MiB",
                )
            });
        };
        at += end + 1;
        let text = String::from_utf8_lossy(&rest[..end]);
        let words: Vec<&str> = text.split_whitespace().collect();
        let odd = |expected: &str| {
            let shown: String = text.trim().chars().take(60).collect();
            Err(Fault::new(place(), format!("{shown:?}"), expected))
        };
        match words.as_slice() {
            _ if number == 1 => {
                if words != ["ply"] {
                    return Err(not_ply(bytes));
                }
            }
            ["format", name, "1.0"] => {
                encoding = Some(match *name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return odd("format ascii, binary_little_endian or binary_big_endian 1.0"),
                });
            }
            ["comment" | "obj_info", ..] | [] => {}
            ["element", name, count] => {
                let Ok(count) = count.parse() else {
                    return odd("element NAME COUNT");
                };
                elements.push(Element {
                    name: (*name).to_owned(),
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", kind @ .., name] => {
                let Some(element) = elements.last_mut() else {
                    return odd("an element before its properties");
                };
                let (list, scalar) = match kind {
                    [one] => (None, Scalar::named(one)),
                    ["list", count, one] => match Scalar::named(count) {
                        Some(count) if !count.is_float() => (Some(count), Scalar::named(one)),
                        _ => return odd("a list whose count is a whole number"),
                    },
                    _ => return odd("property TYPE NAME or property list TYPE TYPE NAME"),
                };
                let Some(scalar) = scalar else {
                    return odd("a type: char, uchar, short, ushort, int, uint, float or double");
                };
                element.properties.push(Property {
                    name: (*name).to_owned(),
                    list,
                    scalar,
                });
            }
            ["end_header"] => break,
            _ => return odd("format, element, property, comment or end_header"),
        }
    }
    match encoding {
        Some(encoding) => Ok((Header { encoding, elements }, at)),
        None => Err(Fault::new(
            format!("line {number}"),
            "the end of the header without a format",
            "format ascii, binary_little_endian or binary_big_endian 1.0",
        )),
    }
}

fn not_ply(bytes: &[u8]) -> Fault {
    let start = String::from_utf8_lossy(&bytes[..bytes.len().min(8)]).into_owned();
    Fault::new("line 1", format!("{start:?}"), "the word ply")
}

//! The `tensor_file` container: named arrays in one file.
//!
//! | bytes | what |
//! |---|---|
//! | 12 | `tensor_file`, 0 |
//! | 2 | version: 1, 0 |
//! | 4 | number of fields |
//! | for each field | 2: length of the name; the name, UTF-8; 2: number of dimensions; 1: type ([`Dtype`]); 8: where its data begin, counted from the file's first byte; 8 for each dimension, the slowest first |
//!
//! All numbers are little-endian. Data may lie anywhere after the header, at any alignment; this writer aligns them to 8 bytes.
//!
//! Source: Dupuy & Jakob 2018, "An Adaptive Parameterization for Efficient Material Acquisition and Rendering", and the
//! loader published with it.

use super::file::{self, Fault};
use super::output;
use crate::BrdfError;
use std::io::Write as _;
use std::path::Path;

/// What a file begins with.
pub const MAGIC: &[u8; 12] = b"tensor_file\0";
const VERSION: [u8; 2] = [1, 0];
/// More fields, dimensions or letters than any file has that was written in earnest.
const MOST_FIELDS: u32 = 1024;
const MOST_DIMENSIONS: u16 = 16;
const LONGEST_NAME: u16 = 256;
/// Data that this writer writes begin at multiples of this.
const ALIGNMENT: u64 = 8;

/// The type of a field's numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Dtype {
    /// Unsigned, 8 bits.
    U8 = 1,
    /// Signed, 8 bits.
    I8 = 2,
    /// Unsigned, 16 bits.
    U16 = 3,
    /// Signed, 16 bits.
    I16 = 4,
    /// Unsigned, 32 bits.
    U32 = 5,
    /// Signed, 32 bits.
    I32 = 6,
    /// Unsigned, 64 bits.
    U64 = 7,
    /// Signed, 64 bits.
    I64 = 8,
    /// IEEE 754, 16 bits.
    F16 = 9,
    /// IEEE 754, 32 bits.
    F32 = 10,
    /// IEEE 754, 64 bits.
    F64 = 11,
}

impl Dtype {
    /// All of them, by their number in a file.
    pub const ALL: [Self; 11] = [
        Self::U8,
        Self::I8,
        Self::U16,
        Self::I16,
        Self::U32,
        Self::I32,
        Self::U64,
        Self::I64,
        Self::F16,
        Self::F32,
        Self::F64,
    ];

    /// Bytes a number.
    pub fn size(self) -> u64 {
        match self {
            Self::U8 | Self::I8 => 1,
            Self::U16 | Self::I16 | Self::F16 => 2,
            Self::U32 | Self::I32 | Self::F32 => 4,
            Self::U64 | Self::I64 | Self::F64 => 8,
        }
    }

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::U8 => "uint8",
            Self::I8 => "int8",
            Self::U16 => "uint16",
            Self::I16 => "int16",
            Self::U32 => "uint32",
            Self::I32 => "int32",
            Self::U64 => "uint64",
            Self::I64 => "int64",
            Self::F16 => "float16",
            Self::F32 => "float32",
            Self::F64 => "float64",
        }
    }
}

/// One array of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Field {
    /// Its name, unique in the file.
    pub name: String,
    /// Type of its numbers.
    pub dtype: Dtype,
    /// Its dimensions, the slowest first; none for a single number.
    pub shape: Vec<usize>,
    /// Where its data lie in the file.
    pub range: std::ops::Range<usize>,
}

impl Field {
    /// How many numbers it has.
    pub fn count(&self) -> usize {
        self.shape.iter().product()
    }
}

/// A file's header, over the bytes of the file: a memory map or a vector.
///
/// Every field is known to lie within the bytes, after the header, with a size that its dimensions and type give.
#[derive(Debug, Clone)]
pub struct TensorFile<'a> {
    bytes: &'a [u8],
    fields: Vec<Field>,
}

impl<'a> TensorFile<'a> {
    /// Reads the header; `path` names the file in errors. Nothing is allocated but the header itself, which is limited to 1024 fields
    /// of 16 dimensions.
    ///
    /// # Errors
    /// If the magic or the version is another; if a name is not UTF-8, empty, too long or there twice; if a type is unknown;
    /// if a field has too many dimensions, or does not lie between the header and the end of the file.
    pub fn parse(bytes: &'a [u8], path: &Path) -> Result<Self, BrdfError> {
        Self::read(bytes).map_err(|fault| fault.at(path))
    }

    fn read(bytes: &'a [u8]) -> Result<Self, Fault> {
        let mut header = Header { bytes, at: 0 };
        let magic = header.take(MAGIC.len(), "magic")?;
        if magic != MAGIC {
            return Err(Fault::new(
                "magic, byte 0",
                file::quoted(magic),
                "`tensor_file` and a zero byte",
            ));
        }
        let version = header.take(2, "version")?;
        if version != VERSION {
            return Err(Fault::new(
                "version, byte 12",
                format!("{}.{}", version[0], version[1]),
                format!("{}.{}", VERSION[0], VERSION[1]),
            ));
        }
        let count = u32::from_le_bytes(header.array("number of fields")?);
        if count > MOST_FIELDS {
            return Err(Fault::new(
                "number of fields, byte 14",
                count,
                format!("at most {MOST_FIELDS}"),
            ));
        }
        let mut fields: Vec<Field> = Vec::new();
        for k in 0..count {
            let field = header.field(k)?;
            if fields.iter().any(|f| f.name == field.name) {
                return Err(Fault::new(
                    format!("field {k} of the header"),
                    format!("a second field `{}`", field.name),
                    "names that differ",
                ));
            }
            fields.push(field);
        }
        for field in &fields {
            if field.range.start < header.at && !field.range.is_empty() {
                return Err(Fault::new(
                    format!("offset of field `{}`", field.name),
                    format!("byte {}, within the header", field.range.start),
                    format!("{} or more", header.at),
                ));
            }
        }
        Ok(Self { bytes, fields })
    }

    /// The fields, in the file's order.
    pub fn fields(&self) -> &[Field] {
        &self.fields
    }

    /// The field `name`, if it is there.
    pub fn find(&self, name: &str) -> Option<&Field> {
        self.fields.iter().find(|f| f.name == name)
    }

    /// The bytes of a field.
    pub fn bytes_of(&self, field: &Field) -> &'a [u8] {
        &self.bytes[field.range.clone()]
    }

    /// The numbers of a field of type [`Dtype::F32`]; `None` if it has another.
    pub fn f32s(&self, field: &Field) -> Option<Vec<f32>> {
        (field.dtype == Dtype::F32).then(|| {
            let (numbers, _) = self.bytes_of(field).as_chunks();
            numbers.iter().map(|b| f32::from_le_bytes(*b)).collect()
        })
    }

    /// The numbers of a field of type [`Dtype::F32`] or [`Dtype::F64`]; `None` if it has another.
    pub fn f64s(&self, field: &Field) -> Option<Vec<f64>> {
        if field.dtype == Dtype::F64 {
            let (numbers, _) = self.bytes_of(field).as_chunks();
            return Some(numbers.iter().map(|b| f64::from_le_bytes(*b)).collect());
        }
        let single = self.f32s(field)?;
        Some(single.into_iter().map(f64::from).collect())
    }

    /// The text of a field of type [`Dtype::U8`]; bytes that are not UTF-8 become �. `None` if it has another type.
    pub fn text(&self, field: &Field) -> Option<String> {
        (field.dtype == Dtype::U8)
            .then(|| String::from_utf8_lossy(self.bytes_of(field)).into_owned())
    }
}

/// What of the header has been read.
struct Header<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Header<'a> {
    fn take(&mut self, count: usize, what: &str) -> Result<&'a [u8], Fault> {
        let rest = &self.bytes[self.at..];
        let Some(taken) = rest.get(..count) else {
            return Err(Fault::new(
                format!("{what}, byte {}", self.at),
                format!("the end of the file, {} bytes long", self.bytes.len()),
                format!("{count} bytes"),
            ));
        };
        self.at += count;
        Ok(taken)
    }

    fn array<const K: usize>(&mut self, what: &str) -> Result<[u8; K], Fault> {
        let mut out = [0; K];
        out.copy_from_slice(self.take(K, what)?);
        Ok(out)
    }

    fn field(&mut self, k: u32) -> Result<Field, Fault> {
        let what = format!("field {k} of the header");
        let begin = self.at;
        let length = u16::from_le_bytes(self.array(&what)?);
        if length == 0 || length > LONGEST_NAME {
            return Err(Fault::new(
                format!("{what}, byte {begin}"),
                format!("a name of {length} bytes"),
                format!("1 to {LONGEST_NAME}"),
            ));
        }
        let name = self.take(usize::from(length), &what)?;
        let Ok(name) = std::str::from_utf8(name) else {
            return Err(Fault::new(
                format!("{what}, byte {}", begin + 2),
                file::quoted(name),
                "a name in UTF-8",
            ));
        };
        let what = format!("field `{}`", name.escape_debug());
        let begin = self.at;
        let dimensions = u16::from_le_bytes(self.array(&what)?);
        if dimensions > MOST_DIMENSIONS {
            return Err(Fault::new(
                format!("{what}, byte {begin}"),
                format!("{dimensions} dimensions"),
                format!("at most {MOST_DIMENSIONS}"),
            ));
        }
        let [code] = self.array(&what)?;
        let Some(dtype) = Dtype::ALL.into_iter().find(|d| *d as u8 == code) else {
            return Err(Fault::new(
                format!("{what}, byte {}", begin + 2),
                format!("type {code}"),
                "1 (uint8) to 11 (float64)",
            ));
        };
        let offset = u64::from_le_bytes(self.array(&what)?);
        let mut size = Some(dtype.size());
        let mut shape = Vec::new();
        for _ in 0..dimensions {
            let n = u64::from_le_bytes(self.array(&what)?);
            size = size.and_then(|s| s.checked_mul(n));
            // Too large for the address space is too large for the file, which the size says below.
            shape.push(usize::try_from(n).unwrap_or(usize::MAX));
        }
        let length = self.bytes.len();
        let end = size.and_then(|s| s.checked_add(offset));
        let Some(end) = end.filter(|end| *end <= length as u64) else {
            let found = match size {
                Some(size) => format!("{size} bytes from byte {offset}"),
                None => "more than 2⁶⁴ bytes".into(),
            };
            return Err(Fault::new(
                what,
                format!("dimensions {}: {found}", dimensions_of(&shape)),
                format!("what the file's {length} bytes hold"),
            ));
        };
        Ok(Field {
            name: name.into(),
            dtype,
            shape,
            // Both are at most the file's length.
            range: offset as usize..end as usize,
        })
    }
}

/// `2×128`, as messages have it.
pub(super) fn dimensions_of(shape: &[usize]) -> String {
    if shape.is_empty() {
        return "none".into();
    }
    let words: Vec<_> = shape.iter().map(usize::to_string).collect();
    words.join("×")
}

/// A file to be written: fields are added, then it is written whole.
#[derive(Debug, Clone, Default)]
pub struct TensorWriter {
    fields: Vec<(String, Dtype, Vec<usize>, Vec<u8>)>,
}

impl TensorWriter {
    /// A file without fields.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a field of bytes: a text, or a flag.
    ///
    /// # Panics
    /// As [`TensorWriter::f32s`].
    pub fn bytes(&mut self, name: &str, shape: &[usize], values: &[u8]) {
        self.add(name, Dtype::U8, shape, values.to_vec());
    }

    /// Adds a field of single-precision numbers.
    ///
    /// # Panics
    /// If `values` are not as many as `shape` says, if the name is empty, longer than 256 bytes or there already, or if there are more than
    /// 16 dimensions or 1024 fields.
    pub fn f32s(&mut self, name: &str, shape: &[usize], values: &[f32]) {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(name, Dtype::F32, shape, bytes);
    }

    /// Adds a field of double-precision numbers.
    ///
    /// # Panics
    /// As [`TensorWriter::f32s`].
    pub fn f64s(&mut self, name: &str, shape: &[usize], values: &[f64]) {
        let bytes = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(name, Dtype::F64, shape, bytes);
    }

    fn add(&mut self, name: &str, dtype: Dtype, shape: &[usize], bytes: Vec<u8>) {
        let expected = shape.iter().product::<usize>() as u64 * dtype.size();
        assert_eq!(bytes.len() as u64, expected, "{name}: {shape:?}");
        assert!(
            (1..=usize::from(LONGEST_NAME)).contains(&name.len())
                && shape.len() <= usize::from(MOST_DIMENSIONS)
                && self.fields.len() < MOST_FIELDS as usize
                && self.fields.iter().all(|f| f.0 != name),
            "{name}: cannot be a field here"
        );
        self.fields
            .push((name.into(), dtype, shape.to_vec(), bytes));
    }

    /// The file's bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut header = MAGIC.to_vec();
        header.extend(VERSION);
        header.extend((self.fields.len() as u32).to_le_bytes());
        let length = |name: &str, shape: &[usize]| 2 + name.len() + 2 + 1 + 8 + 8 * shape.len();
        let all: usize = self.fields.iter().map(|f| length(&f.0, &f.2)).sum();
        let mut end = (header.len() + all) as u64;
        let mut offsets = Vec::new();
        for (name, dtype, shape, bytes) in &self.fields {
            let offset = end.next_multiple_of(ALIGNMENT);
            end = offset + bytes.len() as u64;
            offsets.push(offset);
            header.extend((name.len() as u16).to_le_bytes());
            header.extend(name.as_bytes());
            header.extend((shape.len() as u16).to_le_bytes());
            header.push(*dtype as u8);
            header.extend(offset.to_le_bytes());
            for n in shape {
                header.extend((*n as u64).to_le_bytes());
            }
        }
        let mut out = header;
        for ((_, _, _, bytes), offset) in self.fields.iter().zip(offsets) {
            out.resize(offset as usize, 0);
            out.extend(bytes);
        }
        out
    }

    /// Writes the file, to a temporary name in the same folder first, then renamed.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), BrdfError> {
        output::write(path, |out| out.write_all(&self.to_bytes()))
    }
}

#[cfg(test)]
mod tests;

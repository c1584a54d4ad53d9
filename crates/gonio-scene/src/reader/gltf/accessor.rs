//! Typed arrays out of glTF buffers, every index and length checked before it is used.

use crate::SceneError;
use gltf::json::{
    self, Index,
    accessor::{ComponentType, Type},
    validation::Checked,
};
use std::path::Path;

/// Elements that an accessor without bytes of its own (sparse over zeros) may ask for.
const MAX_ELEMENTS: u64 = 1 << 28;

/// A document with the bytes of its buffers.
pub(super) struct Arrays<'a> {
    pub path: &'a Path,
    pub root: &'a json::Root,
    pub buffers: &'a [Vec<u8>],
}

/// Where an accessor's elements lie: element i starts at `i · stride`.
struct Strided<'a> {
    bytes: &'a [u8],
    stride: usize,
}

/// How a stored component becomes a number.
#[derive(Clone, Copy)]
struct Component {
    kind: ComponentType,
    normalized: bool,
}

impl Component {
    /// The component at the start of `bytes`, which holds at least its size.
    fn to_f32(self, bytes: &[u8]) -> f32 {
        let scaled = |value: f32, full: f32| {
            if self.normalized {
                (value / full).max(-1.0)
            } else {
                value
            }
        };
        match self.kind {
            ComponentType::I8 => scaled(f32::from(bytes[0] as i8), 127.0),
            ComponentType::U8 => scaled(f32::from(bytes[0]), 255.0),
            ComponentType::I16 => {
                scaled(f32::from(i16::from_le_bytes([bytes[0], bytes[1]])), 32767.0)
            }
            ComponentType::U16 => {
                scaled(f32::from(u16::from_le_bytes([bytes[0], bytes[1]])), 65535.0)
            }
            ComponentType::U32 => {
                u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]) as f32
            }
            ComponentType::F32 => f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
        }
    }

    /// The index at the start of `bytes`; 0 for kinds that are no index, which callers have refused.
    fn to_u32(self, bytes: &[u8]) -> u32 {
        match self.kind {
            ComponentType::U8 => bytes[0].into(),
            ComponentType::U16 => u16::from_le_bytes([bytes[0], bytes[1]]).into(),
            ComponentType::U32 => u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]),
            ComponentType::I8 | ComponentType::I16 | ComponentType::F32 => 0,
        }
    }
}

impl<'a> Arrays<'a> {
    /// The bytes of a buffer view.
    ///
    /// # Errors
    /// [`SceneError::Format`] if the view or its buffer doesn't exist, or the view ends outside its buffer.
    pub fn view(&self, index: usize) -> Result<&'a [u8], SceneError> {
        let place = format!("bufferView {index}");
        let view = self.root.buffer_views.get(index);
        let view = view.ok_or_else(|| self.missing(&place, self.root.buffer_views.len()))?;
        let buffer = view.buffer.value();
        let bytes = self.buffers.get(buffer);
        let bytes = bytes.ok_or_else(|| {
            self.missing(&format!("{place}, buffer {buffer}"), self.buffers.len())
        })?;
        let start = view.byte_offset.map_or(0, |o| o.0);
        let range = usize::try_from(start).ok().zip(
            start
                .checked_add(view.byte_length.0)
                .and_then(|end| usize::try_from(end).ok()),
        );
        range
            .and_then(|(start, end)| bytes.get(start..end))
            .ok_or_else(|| {
                let found = format!("byteOffset {start} and byteLength {}", view.byte_length.0);
                let expected = format!(
                    "a range inside the {} bytes of buffer {buffer}",
                    bytes.len()
                );
                SceneError::format(self.path, place, found, expected)
            })
    }

    /// Accessor `index` as rows of `N` numbers; where it has more or fewer components than N, see `types`.
    ///
    /// - `types`: the accessor types that are welcome; components beyond N are dropped, missing ones are `fill`
    ///
    /// # Errors
    /// [`SceneError::Format`] if the accessor doesn't exist, has another type, or ends outside its view.
    pub fn rows<const N: usize>(
        &self,
        index: usize,
        types: &[Type],
        fill: f32,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let (accessor, place) = self.accessor(index)?;
        let kind = self.checked(&accessor.type_, &place, "type")?;
        if !types.contains(&kind) {
            let found = format!("type {kind:?}");
            return Err(SceneError::format(
                self.path,
                place,
                found,
                format!("one of {types:?}"),
            ));
        }
        let component = self.component(accessor, &place)?;
        let (size, columns) = (component.kind.size(), kind.multiplicity());
        let read = |bytes: &[u8]| -> [f32; N] {
            std::array::from_fn(|k| {
                if k < columns {
                    component.to_f32(&bytes[k * size..])
                } else {
                    fill
                }
            })
        };
        let zero = std::array::from_fn(|k| if k < columns { 0.0 } else { fill });
        self.elements(accessor, &place, size * columns, zero, read)
    }

    /// Accessor `index` as whole numbers.
    ///
    /// # Errors
    /// [`SceneError::Format`] if the accessor doesn't exist, isn't a scalar of unsigned integers, or ends outside its view.
    pub fn indices(&self, index: usize) -> Result<Vec<u32>, SceneError> {
        let (accessor, place) = self.accessor(index)?;
        let kind = self.checked(&accessor.type_, &place, "type")?;
        let component = self.component(accessor, &place)?;
        if kind != Type::Scalar || !is_index(component.kind) {
            let found = format!("{kind:?} of {:?}", component.kind);
            return Err(SceneError::format(
                self.path,
                place,
                found,
                "indices: SCALAR of unsigned integers",
            ));
        }
        self.elements(accessor, &place, component.kind.size(), 0, |bytes| {
            component.to_u32(bytes)
        })
    }

    fn elements<T: Copy>(
        &self,
        accessor: &json::Accessor,
        place: &str,
        size: usize,
        zero: T,
        read: impl Fn(&[u8]) -> T,
    ) -> Result<Vec<T>, SceneError> {
        let count = accessor.count.0;
        let mut out = match accessor.buffer_view {
            Some(view) => {
                let offset = accessor.byte_offset.map_or(0, |o| o.0);
                let data = self.strided(place, view, offset, count, size)?;
                (0..count as usize)
                    .map(|i| read(&data.bytes[i * data.stride..]))
                    .collect()
            }
            None if count > MAX_ELEMENTS => {
                return Err(SceneError::Limit {
                    path: self.path.to_owned(),
                    place: place.into(),
                    found: format!("{count} elements"),
                    limit: format!("{MAX_ELEMENTS} elements without bytes of their own"),
                });
            }
            None => vec![zero; count as usize],
        };
        if let Some(sparse) = &accessor.sparse {
            let place = format!("{place}, sparse");
            let kind = self
                .checked(&sparse.indices.component_type, &place, "componentType")?
                .0;
            if !is_index(kind) {
                let found = format!("indices of {kind:?}");
                return Err(SceneError::format(
                    self.path,
                    place,
                    found,
                    "unsigned integers",
                ));
            }
            let index = Component {
                kind,
                normalized: false,
            };
            let (at, n) = (&sparse.indices, sparse.count.0);
            let where_ = self.strided(&place, at.buffer_view, at.byte_offset.0, n, kind.size())?;
            let at = &sparse.values;
            let what = self.strided(&place, at.buffer_view, at.byte_offset.0, n, size)?;
            for i in 0..n as usize {
                let target = index.to_u32(&where_.bytes[i * where_.stride..]) as usize;
                let slot = out.get_mut(target).ok_or_else(|| {
                    let found = format!("index {target}");
                    SceneError::format(
                        self.path,
                        place.clone(),
                        found,
                        format!("an index below {count}"),
                    )
                })?;
                *slot = read(&what.bytes[i * what.stride..]);
            }
        }
        Ok(out)
    }

    /// The part of a view that holds `count` elements of `size` bytes from `offset` on.
    fn strided(
        &self,
        place: &str,
        view: Index<json::buffer::View>,
        offset: u64,
        count: u64,
        size: usize,
    ) -> Result<Strided<'a>, SceneError> {
        let bytes = self.view(view.value())?;
        let stride = self.root.buffer_views[view.value()]
            .byte_stride
            .map_or(size, |s| s.0);
        let end = count
            .checked_sub(1)
            .map_or(Some(0), |last| {
                last.checked_mul(stride as u64)?.checked_add(size as u64)
            })
            .and_then(|length| length.checked_add(offset));
        let fits = stride >= size && end.is_some_and(|end| end <= bytes.len() as u64);
        let part = fits.then(|| bytes.get(offset as usize..)).flatten();
        let part = part.ok_or_else(|| {
            let found =
                format!("{count} elements of {size} bytes, stride {stride}, from byte {offset}");
            let expected = format!(
                "elements inside the {} bytes of bufferView {}",
                bytes.len(),
                view.value()
            );
            SceneError::format(self.path, place, found, expected)
        })?;
        Ok(Strided {
            bytes: part,
            stride,
        })
    }

    fn accessor(&self, index: usize) -> Result<(&'a json::Accessor, String), SceneError> {
        let place = format!("accessor {index}");
        match self.root.accessors.get(index) {
            Some(accessor) => Ok((accessor, place)),
            None => Err(self.missing(&place, self.root.accessors.len())),
        }
    }

    fn component(&self, accessor: &json::Accessor, place: &str) -> Result<Component, SceneError> {
        Ok(Component {
            kind: self
                .checked(&accessor.component_type, place, "componentType")?
                .0,
            normalized: accessor.normalized,
        })
    }

    /// The value of a field, which must be one that glTF knows.
    pub fn checked<T: Copy>(
        &self,
        value: &Checked<T>,
        place: &str,
        field: &str,
    ) -> Result<T, SceneError> {
        match value {
            Checked::Valid(value) => Ok(*value),
            Checked::Invalid => {
                let found = format!("an unknown {field}");
                Err(SceneError::format(
                    self.path,
                    place,
                    found,
                    format!("a {field} of glTF 2.0"),
                ))
            }
        }
    }

    /// The error of an index without an object.
    pub fn missing(&self, place: &str, count: usize) -> SceneError {
        let found = "no such object";
        SceneError::format(self.path, place, found, format!("an index below {count}"))
    }
}

fn is_index(kind: ComponentType) -> bool {
    matches!(
        kind,
        ComponentType::U8 | ComponentType::U16 | ComponentType::U32
    )
}

#[cfg(test)]
#[path = "accessor_tests.rs"]
mod tests;

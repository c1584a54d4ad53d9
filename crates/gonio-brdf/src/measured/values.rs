//! [`Values`], the numbers of a table: in memory of their own, or in a file that is mapped.

use memmap2::Mmap;
use std::ops::{Deref, Range};
use std::sync::Arc;

/// The numbers of a table.
#[derive(Clone)]
pub struct Values(Store);

#[derive(Clone)]
enum Store {
    Owned(Arc<Vec<f32>>),
    /// Bytes of a mapped file that were found to be aligned and whole numbers of `f32`.
    Mapped(Arc<Mmap>, Range<usize>),
}

impl Values {
    /// The numbers in the bytes `range` of a mapped file, little-endian; copied if the file hasn't aligned them for this machine.
    pub(super) fn mapped(map: &Arc<Mmap>, range: Range<usize>) -> Self {
        let bytes = &map[range.clone()];
        if cfg!(target_endian = "little") && bytemuck::try_cast_slice::<u8, f32>(bytes).is_ok() {
            return Self(Store::Mapped(Arc::clone(map), range));
        }
        Self::from_bytes(bytes)
    }

    /// A copy of little-endian numbers.
    pub(super) fn from_bytes(bytes: &[u8]) -> Self {
        let (fours, _) = bytes.as_chunks::<4>();
        fours.iter().map(|b| f32::from_le_bytes(*b)).collect()
    }

    /// Whether they are read in place from a file.
    pub fn is_mapped(&self) -> bool {
        matches!(self.0, Store::Mapped(..))
    }
}

impl Deref for Values {
    type Target = [f32];

    fn deref(&self) -> &[f32] {
        match &self.0 {
            Store::Owned(v) => v,
            Store::Mapped(map, range) => bytemuck::try_cast_slice(&map[range.clone()])
                .expect("invariant: checked when it was mapped"),
        }
    }
}

impl From<Vec<f32>> for Values {
    fn from(values: Vec<f32>) -> Self {
        Self(Store::Owned(Arc::new(values)))
    }
}

impl FromIterator<f32> for Values {
    fn from_iter<T: IntoIterator<Item = f32>>(iter: T) -> Self {
        iter.into_iter().collect::<Vec<_>>().into()
    }
}

impl PartialEq for Values {
    fn eq(&self, other: &Self) -> bool {
        **self == **other
    }
}

impl std::fmt::Debug for Values {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let kind = if self.is_mapped() { "mapped" } else { "owned" };
        write!(f, "Values({} {kind})", self.len())
    }
}

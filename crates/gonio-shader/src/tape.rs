//! The compact form that a function of a shader is compiled to: a list of operations on registers.
//!
//! There are three files of registers: numbers, whole numbers (32 bits, signed or not) and masks. A vector, matrix, structure or
//! array is as many registers as it has scalars. A function's branches are masks: an operation that must not touch all lanes has
//! the mask of those that it may touch.

/// The index of a register in its file.
pub(crate) type Reg = u32;

/// A function of one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Unary {
    Negate,
    Abs,
    Floor,
    Sqrt,
    Exp,
    Ln,
    Sin,
    Cos,
    Acos,
}

/// A function of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Min,
    Max,
    Atan2,
}

/// A comparison of two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Compare {
    Less,
    LessEqual,
    Equal,
}

/// A function of two masks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Logic {
    And,
    Or,
    AndNot,
    Equal,
}

/// A function of two whole numbers that loops need; the others are `IntZip`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum IntBinary {
    Add,
    Subtract,
    Multiply,
}

/// Which file a register belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum File {
    Real,
    Int,
    Mask,
}

/// One operation. The first register is the one that is written.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Op {
    Unary(Unary, Reg, Reg),
    Binary(Binary, Reg, Reg, Reg),
    /// a·b + c, rounded twice.
    MultiplyAdd(Reg, Reg, Reg, Reg),
    Compare(Compare, Reg, Reg, Reg),
    /// (written, mask, where true, elsewhere)
    Select(File, Reg, Reg, Reg, Reg),
    Copy(File, Reg, Reg),
    /// (written, mask, source): only where the mask is true.
    CopyWhere(File, Reg, Reg, Reg),
    Logic(Logic, Reg, Reg, Reg),
    Not(Reg, Reg),
    IntBinary(IntBinary, Reg, Reg, Reg),
    IntMap(fn(u32) -> u32, Reg, Reg),
    IntZip(fn(u32, u32) -> u32, Reg, Reg, Reg),
    IntTest(fn(u32, u32) -> bool, Reg, Reg, Reg),
    ToInt(fn(f64) -> u32, Reg, Reg),
    FromInt(fn(u32) -> f64, Reg, Reg),
    /// (written, first register, whole number that counts registers from it, largest such number)
    Gather(File, Reg, Reg, Reg, u32),
    /// (first register, whole number as above, source, mask, largest such number)
    Scatter(File, Reg, Reg, Reg, Reg, u32),
    /// Goes on at `to` unless the mask is true in any lane.
    JumpUnless {
        mask: Reg,
        to: u32,
    },
    /// Goes back to `to` if the mask is true in any lane: the end of a loop.
    Loop {
        mask: Reg,
        to: u32,
        source: u32,
    },
}

/// A compiled function.
#[derive(Debug, Clone, Default)]
pub(crate) struct Tape {
    pub ops: Vec<Op>,
    /// How many registers there are of each file.
    pub reals: usize,
    pub ints: usize,
    pub masks: usize,
    /// Registers that never change.
    pub real_constants: Vec<(Reg, f64)>,
    pub int_constants: Vec<(Reg, u32)>,
    pub mask_constants: Vec<(Reg, bool)>,
    /// Where each component of a parameter goes.
    pub parameters: Vec<Reg>,
    /// Where each component of the arguments goes.
    pub inputs: Vec<Reg>,
    /// Where each component of what it gives is found.
    pub outputs: Vec<Reg>,
    /// The byte of the source at which each loop begins.
    pub loops: Vec<u32>,
}

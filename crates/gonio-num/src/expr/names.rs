//! Names that shader code may use.

use super::RecordError;

/// Words with a meaning in WGSL, or kept for one (W3C, "WebGPU Shading Language", sections 16.1 and 16.2), and the
/// predeclared names that recorded code calls.
const TAKEN: &str = "\
alias break case const const_assert continue continuing default diagnostic discard else enable false fn for if let loop
override requires return struct switch true var while
NULL Self abstract active alignas alignof as asm asm_fragment async attribute auto await become cast catch class co_await
co_return co_yield coherent column_major common compile compile_fragment concept const_cast consteval constexpr constinit
crate debugger decltype delete demote demote_to_helper do dynamic_cast enum explicit export extends extern external
fallthrough filter final finally friend from fxgroup get goto groupshared highp impl implements import inline instanceof
interface layout lowp macro macro_rules match mediump meta mod module move mut mutable namespace new nil noexcept noinline
nointerpolation non_coherent noncoherent noperspective null nullptr of operator package packoffset partial pass patch
pixelfragment precise precision premerge priv protected pub public readonly ref regardless register reinterpret_cast
require resource restrict self set shared sizeof smooth snorm static static_assert static_cast std subroutine super target
template this thread_local throw trait try type typedef typeid typename typeof union unless unorm unsafe unsized use using
varying virtual volatile wgsl where with writeonly yield
array bool f16 f32 i32 u32 vec2 vec3 vec4 mat2x2 mat3x3 mat4x4 ptr sampler atomic
abs acos atan2 bitcast clamp cos exp floor log max min select sin sqrt";

/// Whether `name` may name a function, a parameter, a table or a field.
pub(super) fn check(name: &str) -> Result<(), RecordError> {
    let mut letters = name.chars();
    let starts_well = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
    let goes_on_well = letters.all(|c| c.is_ascii_alphanumeric() || c == '_');
    let free = !name.starts_with("gonio_") && TAKEN.split_whitespace().all(|t| t != name);
    if starts_well && goes_on_well && free {
        Ok(())
    } else {
        Err(RecordError::Name { name: name.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::check;

    #[test]
    fn names_are_checked() {
        for good in ["x", "alpha_x", "wi", "Sample2", "f0"] {
            assert!(check(good).is_ok(), "{good}");
        }
        for bad in [
            "", "2x", "a-b", "a b", "_x", "é", "fn", "self", "f32", "max", "gonio_x", "x;",
        ] {
            assert!(check(bad).is_err(), "{bad}");
        }
    }
}

//! Names that shader code may use.

use super::{Language, RecordError};

/// Words with a meaning in WGSL, or kept for one (W3C, "WebGPU Shading Language", sections 16.1 and 16.2), and the
/// predeclared names that recorded code calls.
const WGSL: &str = "\
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
abs acos atan2 bitcast clamp cos dot exp floor log max min select sin sqrt";

/// The OpenGL Shading Language 4.60, section 3.6.
const GLSL: &str = "\
const uniform buffer shared attribute varying coherent volatile restrict readonly writeonly atomic_uint layout centroid flat
smooth noperspective patch sample invariant precise break continue do for while switch case default if else subroutine in
out inout int void bool true false float double discard return lowp mediump highp precision struct uint common partition
active asm class union enum typedef template this resource goto inline noinline public static extern external interface
long short half fixed unsigned superp input output filter sizeof cast namespace using
vec2 vec3 vec4 ivec2 ivec3 ivec4 uvec2 uvec3 uvec4 bvec2 bvec3 bvec4 dvec2 dvec3 dvec4 hvec2 hvec3 hvec4 fvec2 fvec3 fvec4
mat2 mat3 mat4 sampler1D sampler2D sampler3D samplerCube image2D texture2D sampler
abs acos atan clamp cos dot exp floor log max min sin sqrt main";

/// Microsoft, "HLSL keywords" and "reserved words".
const HLSL: &str = "\
AppendStructuredBuffer asm asm_fragment BlendState bool break Buffer ByteAddressBuffer case cbuffer centroid class
column_major compile compile_fragment CompileShader const continue ComputeShader ConsumeStructuredBuffer default
DepthStencilState DepthStencilView discard do double DomainShader dword else export extern false float for fxgroup
GeometryShader groupshared half Hullshader if in inline inout InputPatch int interface line lineadj linear LineStream matrix
namespace nointerpolation noperspective NULL out OutputPatch packoffset pass pixelfragment PixelShader point PointStream
precise RasterizerState RenderTargetView return register row_major RWBuffer RWTexture2D sample sampler SamplerState shared
snorm stateblock static string struct switch StructuredBuffer tbuffer technique texture Texture1D Texture2D Texture3D true
typedef triangle TriangleStream uint uniform unorm unsigned vector vertexfragment VertexShader void volatile while
auto catch char class const_cast delete dynamic_cast enum explicit friend goto long mutable new operator private protected
public reinterpret_cast short signed sizeof static_cast template this throw try typename union using virtual
float1 float2 float3 float4 int1 int2 int3 int4 uint2 uint3 uint4 bool2 bool3 bool4 half2 half3 half4 float3x3 float4x4
abs acos atan2 clamp cos dot exp floor log max min sin sqrt asfloat";

/// The words of C++14, and those that Metal adds.
const MSL: &str = "\
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t class compl const constexpr
const_cast continue decltype default delete do double dynamic_cast else enum explicit export extern false float for friend
goto if inline int long mutable namespace new noexcept not not_eq nullptr operator or or_eq private protected public register
reinterpret_cast return short signed sizeof static static_assert static_cast struct switch template this thread_local throw
true try typedef typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq
kernel vertex fragment constant device thread threadgroup threadgroup_imageblock ray_data object_data visible intersection
half uint uchar ushort ulong size_t sampler texture2d texture3d metal main
float2 float3 float4 half2 half3 half4 int2 int3 int4 uint2 uint3 uint4 bool2 bool3 bool4 float3x3 float4x4
abs acos atan2 clamp cos dot exp floor log max min sin sqrt as_type";

/// The language specification of OSL, \"Keywords and reserved words\", and the types of shaders.
const OSL: &str = "\
and break closure color continue do else emit float for if illuminance illuminate int matrix normal not or output point
public return string struct vector void while
bool case catch char class const delete default double enum extern false friend goto inline long new operator private
protected short signed sizeof static switch template this throw true try typedef uniform union unsigned varying virtual
volatile displacement shader surface volume
abs acos atan2 clamp cos dot exp floor log max min sin sqrt";

/// Whether `name` has a meaning in the language, or is kept for one.
pub(super) fn is_word(language: Language, name: &str) -> bool {
    let words = match language {
        Language::Wgsl => WGSL,
        Language::Glsl => GLSL,
        Language::Hlsl => HLSL,
        Language::Msl => MSL,
        Language::Osl => OSL,
    };
    words.split_whitespace().any(|word| word == name)
}

/// Whether `name` may name a function, a parameter, a table or a field in this language.
pub(super) fn check(language: Language, name: &str) -> Result<(), RecordError> {
    let mut letters = name.chars();
    let starts_well = letters.next().is_some_and(|c| c.is_ascii_alphabetic());
    let goes_on_well = letters.all(|c| c.is_ascii_alphanumeric() || c == '_');
    let free = !name.starts_with("gonio_") && !is_word(language, name);
    if starts_well && goes_on_well && free {
        Ok(())
    } else {
        Err(RecordError::Name {
            name: name.into(),
            language,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_checked() {
        for language in Language::ALL {
            for good in ["x", "alpha_x", "wi", "Sample2", "f0"] {
                assert!(check(language, good).is_ok(), "{good}");
            }
            for bad in [
                "", "2x", "a-b", "a b", "_x", "é", "for", "max", "gonio_x", "x;",
            ] {
                assert!(check(language, bad).is_err(), "{bad}");
            }
        }
        assert!(check(Language::Wgsl, "f32").is_err());
        assert!(check(Language::Glsl, "vec3").is_err());
        assert!(check(Language::Msl, "float3").is_err());
    }
}

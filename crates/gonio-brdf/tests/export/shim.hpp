// What HLSL, MSL and OSL have and C++ lacks, as far as exported code uses it.

#include <cmath>

// Operations on three numbers.
#define OPERATIONS(T)                                                                              \
    inline T operator+(T a, T b) { return T(a.x + b.x, a.y + b.y, a.z + b.z); }                    \
    inline T operator-(T a, T b) { return T(a.x - b.x, a.y - b.y, a.z - b.z); }                    \
    inline T operator*(T a, T b) { return T(a.x * b.x, a.y * b.y, a.z * b.z); }                    \
    inline T operator/(T a, T b) { return T(a.x / b.x, a.y / b.y, a.z / b.z); }                    \
    inline T operator+(T a, float b) { return a + T(b, b, b); }                                    \
    inline T operator-(T a, float b) { return a - T(b, b, b); }                                    \
    inline T operator*(T a, float b) { return a * T(b, b, b); }                                    \
    inline T operator/(T a, float b) { return a / T(b, b, b); }                                    \
    inline T operator+(float a, T b) { return T(a, a, a) + b; }                                    \
    inline T operator-(float a, T b) { return T(a, a, a) - b; }                                    \
    inline T operator*(float a, T b) { return T(a, a, a) * b; }                                    \
    inline T operator/(float a, T b) { return T(a, a, a) / b; }                                    \
    inline T operator-(T a) { return T(-a.x, -a.y, -a.z); }                                        \
    inline T min(T a, T b) { return T(min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)); }              \
    inline T max(T a, T b) { return T(max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)); }              \
    inline T sqrt(T a) { return T(sqrt(a.x), sqrt(a.y), sqrt(a.z)); }                              \
    inline T exp(T a) { return T(exp(a.x), exp(a.y), exp(a.z)); }                                  \
    inline T log(T a) { return T(log(a.x), log(a.y), log(a.z)); }                                  \
    inline T abs(T a) { return T(abs(a.x), abs(a.y), abs(a.z)); }                                  \
    inline T floor(T a) { return T(floor(a.x), floor(a.y), floor(a.z)); }

#define NUMBERS                                                                                    \
    inline float min(float a, float b) { return b < a ? b : a; }                                   \
    inline float max(float a, float b) { return a < b ? b : a; }                                   \
    inline float clamp(float x, float a, float b) { return min(max(x, a), b); }                    \
    inline float abs(float x) { return std::fabs(x); }                                             \
    inline float sqrt(float x) { return std::sqrt(x); }                                            \
    inline float exp(float x) { return std::exp(x); }                                              \
    inline float log(float x) { return std::log(x); }                                              \
    inline float sin(float x) { return std::sin(x); }                                              \
    inline float cos(float x) { return std::cos(x); }                                              \
    inline float acos(float x) { return std::acos(x); }                                            \
    inline float atan2(float y, float x) { return std::atan2(y, x); }                              \
    inline float floor(float x) { return std::floor(x); }

namespace hlsl {
NUMBERS
// No constructor from one number.
struct float3 {
    float x, y, z;
    float3() {}
    float3(float x, float y, float z) : x(x), y(y), z(z) {}
};
OPERATIONS(float3)
inline float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
}

namespace metal {
NUMBERS
struct float3 {
    float x, y, z;
    float3() {}
    explicit float3(float x) : x(x), y(x), z(x) {}
    float3(float x, float y, float z) : x(x), y(y), z(z) {}
};
OPERATIONS(float3)
inline float dot(float3 a, float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
}

namespace osl {
NUMBERS
// Components by index only; directions and colours don't mix.
#define TRIPLE(T)                                                                                  \
    class T {                                                                                      \
        float c[3];                                                                                \
      public:                                                                                      \
        T() {}                                                                                     \
        explicit T(float x) : c{x, x, x} {}                                                        \
        T(float x, float y, float z) : c{x, y, z} {}                                               \
        float operator[](int i) const { return c[i]; }                                             \
    };                                                                                             \
    inline T operator+(T a, T b) { return T(a[0] + b[0], a[1] + b[1], a[2] + b[2]); }              \
    inline T operator-(T a, T b) { return T(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }              \
    inline T operator*(T a, T b) { return T(a[0] * b[0], a[1] * b[1], a[2] * b[2]); }              \
    inline T operator/(T a, T b) { return T(a[0] / b[0], a[1] / b[1], a[2] / b[2]); }              \
    inline T operator+(T a, float b) { return a + T(b); }                                          \
    inline T operator-(T a, float b) { return a - T(b); }                                          \
    inline T operator*(T a, float b) { return a * T(b); }                                          \
    inline T operator/(T a, float b) { return a / T(b); }                                          \
    inline T operator+(float a, T b) { return T(a) + b; }                                          \
    inline T operator-(float a, T b) { return T(a) - b; }                                          \
    inline T operator*(float a, T b) { return T(a) * b; }                                          \
    inline T operator/(float a, T b) { return T(a) / b; }                                          \
    inline T operator-(T a) { return T(-a[0], -a[1], -a[2]); }                                     \
    inline T min(T a, T b) { return T(min(a[0], b[0]), min(a[1], b[1]), min(a[2], b[2])); }        \
    inline T max(T a, T b) { return T(max(a[0], b[0]), max(a[1], b[1]), max(a[2], b[2])); }        \
    inline T sqrt(T a) { return T(sqrt(a[0]), sqrt(a[1]), sqrt(a[2])); }                           \
    inline T exp(T a) { return T(exp(a[0]), exp(a[1]), exp(a[2])); }                               \
    inline T log(T a) { return T(log(a[0]), log(a[1]), log(a[2])); }                               \
    inline T abs(T a) { return T(abs(a[0]), abs(a[1]), abs(a[2])); }
TRIPLE(vector)
TRIPLE(color)
inline float dot(vector a, vector b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
}

// The metal of ggx.py in C++:
//
//     c++ -O2 -std=c++17 ggx.cpp -o ggx
//     gonio brdf check --exec './ggx 0.5'
//
// Numbers are little-endian, as on x86 and ARM.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

struct Vec { double x, y, z; };

double dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

const double pi = 3.14159265358979323846;
const double f0[3] = {1.0, 0.78, 0.34};
double roughness = 0.5;
double a2 = 0.0625;  // alpha = roughness², and here its square

// The half vector, and the cosine between it and either direction: |wi + wo| / 2, which can't be negative.
Vec half(Vec wi, Vec wo, double& cos) {
    Vec h = {wi.x + wo.x, wi.y + wo.y, wi.z + wo.z};
    double length = std::sqrt(dot(h, h));
    cos = length / 2;
    return {h.x / length, h.y / length, h.z / length};
}

double distribution(Vec h) {
    double d = h.z * h.z * (a2 - 1) + 1;
    return a2 / (pi * d * d);
}

// f in sr⁻¹, without the cosine.
void evaluate(Vec wi, Vec wo, double* f) {
    if (wi.z <= 0 || wo.z <= 0) {
        f[0] = f[1] = f[2] = 0;
        return;
    }
    double cos;
    Vec h = half(wi, wo, cos);
    double schlick = std::pow(1 - cos, 5);
    double a = wo.z * std::sqrt(a2 + (1 - a2) * wi.z * wi.z);
    double b = wi.z * std::sqrt(a2 + (1 - a2) * wo.z * wo.z);
    double common = distribution(h) / (2 * (a + b));
    for (int k = 0; k < 3; ++k) f[k] = common * (f0[k] + (1 - f0[k]) * schlick);
}

// Density per solid angle with which `sample` draws wi.
double density(Vec wi, Vec wo) {
    if (wi.z <= 0 || wo.z <= 0) return 0;
    double cos;
    Vec h = half(wi, wo, cos);
    return distribution(h) * h.z / (4 * cos);
}

// Eight numbers: wi, weight f cosθi / pdf, pdf, and whether it is a Dirac delta. A pdf of 0 says that nothing was drawn.
void sample(Vec wo, Vec u, double* out) {
    std::fill(out, out + 8, 0.0);
    double z = std::sqrt((1 - u.x) / (1 + (a2 - 1) * u.x));
    double r = std::sqrt(std::max(0.0, 1 - z * z)), phi = 2 * pi * u.y;
    Vec h = {r * std::cos(phi), r * std::sin(phi), z};
    double d = 2 * dot(wo, h);
    Vec wi = {d * h.x - wo.x, d * h.y - wo.y, d * h.z - wo.z};
    double pdf = density(wi, wo);
    if (pdf <= 0) return;
    out[0] = wi.x, out[1] = wi.y, out[2] = wi.z;
    evaluate(wi, wo, out + 3);
    for (int k = 3; k < 6; ++k) out[k] *= wi.z / pdf;
    out[6] = pdf;
}

int main(int argc, char** argv) {
    if (argc > 1) roughness = std::atof(argv[1]);
    a2 = std::pow(roughness, 4);

    // The hello is a line of JSON. It asks for batches of numbers.
    for (int c; (c = std::getchar()) != '\n';)
        if (c == EOF) return 0;
    std::printf(
        "{\"id\": 0, \"name\": \"ggx.cpp\", \"offers\": [\"eval\", \"pdf\", \"sample\"], "
        "\"batches\": \"float64\", \"parameters\": {\"roughness\": %g}}\n",
        roughness);
    std::fflush(stdout);

    char header[12];
    std::vector<Vec> in;
    std::vector<double> out;
    while (std::fread(header, 1, 12, stdin) == 12) {
        std::uint32_t count;
        std::memcpy(&count, header + 4, 4);
        in.resize(2 * count);
        if (std::fread(in.data(), sizeof(Vec), in.size(), stdin) != in.size()) return 1;
        const Vec *a = in.data(), *b = a + count;
        std::size_t row = header[0] == 'e' ? 3 : header[0] == 'p' ? 1 : 8;
        out.resize(row * count);
        for (std::uint32_t k = 0; k < count; ++k) {
            double* o = &out[row * k];
            if (row == 3) evaluate(a[k], b[k], o);
            else if (row == 1) *o = density(a[k], b[k]);
            else sample(a[k], b[k], o);
        }
        std::fwrite(header, 1, 12, stdout);
        std::fwrite(out.data(), sizeof(double), out.size(), stdout);
        std::fflush(stdout);
    }
}

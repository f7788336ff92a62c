// The vectors of unit_kernel_source.h, as wide as the file that includes this is compiled for: Floats hold squared
// distances, Keys hold entries of sorted lists.
//
// A key is a square and an index: (bits of the float + key_bias) << 32 | index, compared as a double. Squares are not
// negative, so that the order of the keys is that of the squares, then of the indices; the bias keeps keys clear of
// denormal doubles, which a host program may have switched off.
#pragma once

#include <cstdint>
#include <cstring>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace pcm {
namespace {

constexpr std::uint64_t key_bias = std::uint64_t(0x00100000) << 32;

inline std::uint64_t key_of(float square, std::uint32_t index)
{
    std::uint32_t bits;
    std::memcpy(&bits, &square, sizeof bits);
    return ((static_cast<std::uint64_t>(bits) << 32) | index) + key_bias;
}

inline float square_of(std::uint64_t key)
{
    const std::uint32_t bits = static_cast<std::uint32_t>((key - key_bias) >> 32);
    float square;
    std::memcpy(&square, &bits, sizeof square);
    return square;
}

#if defined(__AVX512F__)

struct Floats {
    static constexpr std::uint32_t width = 16;
    __m512 v;
    static Floats load(const float* p) { return {_mm512_load_ps(p)}; }
    static Floats all(float f) { return {_mm512_set1_ps(f)}; }
    void store(float* p) const { _mm512_store_ps(p, v); }
};
inline Floats operator-(Floats a, Floats b) { return {_mm512_sub_ps(a.v, b.v)}; }
inline Floats operator*(Floats a, Floats b) { return {_mm512_mul_ps(a.v, b.v)}; }
inline Floats multiply_add(Floats a, Floats b, Floats c) { return {_mm512_fmadd_ps(a.v, b.v, c.v)}; }
inline Floats larger(Floats a, Floats b) { return {_mm512_max_ps(a.v, b.v)}; }
inline std::uint32_t less_bits(Floats a, Floats b) { return _mm512_cmp_ps_mask(a.v, b.v, _CMP_LT_OQ); }

struct Keys {
    static constexpr std::size_t width = 8;
    __m512d v;
    static Keys load(const std::uint64_t* p) { return {_mm512_load_pd(reinterpret_cast<const double*>(p))}; }
    static Keys all(std::uint64_t key) { return {_mm512_castsi512_pd(_mm512_set1_epi64(static_cast<long long>(key)))}; }
    void store(std::uint64_t* p) const { _mm512_store_pd(reinterpret_cast<double*>(p), v); }
};
inline Keys smaller(Keys a, Keys b) { return {_mm512_min_pd(a.v, b.v)}; }
inline Keys larger(Keys a, Keys b) { return {_mm512_max_pd(a.v, b.v)}; }
// The last key of `before`, then those of `a` but its last.
inline Keys shifted(Keys before, Keys a)
{
    return {_mm512_castsi512_pd(_mm512_alignr_epi64(_mm512_castpd_si512(a.v), _mm512_castpd_si512(before.v), 7))};
}

#elif defined(__AVX2__)

struct Floats {
    static constexpr std::uint32_t width = 8;
    __m256 v;
    static Floats load(const float* p) { return {_mm256_load_ps(p)}; }
    static Floats all(float f) { return {_mm256_set1_ps(f)}; }
    void store(float* p) const { _mm256_store_ps(p, v); }
};
inline Floats operator-(Floats a, Floats b) { return {_mm256_sub_ps(a.v, b.v)}; }
inline Floats operator*(Floats a, Floats b) { return {_mm256_mul_ps(a.v, b.v)}; }
inline Floats multiply_add(Floats a, Floats b, Floats c) { return {_mm256_fmadd_ps(a.v, b.v, c.v)}; }
inline Floats larger(Floats a, Floats b) { return {_mm256_max_ps(a.v, b.v)}; }
inline std::uint32_t less_bits(Floats a, Floats b)
{
    return static_cast<std::uint32_t>(_mm256_movemask_ps(_mm256_cmp_ps(a.v, b.v, _CMP_LT_OQ)));
}

struct Keys {
    static constexpr std::size_t width = 4;
    __m256d v;
    static Keys load(const std::uint64_t* p) { return {_mm256_load_pd(reinterpret_cast<const double*>(p))}; }
    static Keys all(std::uint64_t key)
    {
        return {_mm256_castsi256_pd(_mm256_set1_epi64x(static_cast<long long>(key)))};
    }
    void store(std::uint64_t* p) const { _mm256_store_pd(reinterpret_cast<double*>(p), v); }
};
inline Keys smaller(Keys a, Keys b) { return {_mm256_min_pd(a.v, b.v)}; }
inline Keys larger(Keys a, Keys b) { return {_mm256_max_pd(a.v, b.v)}; }
inline Keys shifted(Keys before, Keys a)
{
    const __m256d middle = _mm256_permute2f128_pd(before.v, a.v, 0x21);
    return {_mm256_shuffle_pd(middle, a.v, 0x5)};
}

#elif defined(__SSE2__)

struct Floats {
    static constexpr std::uint32_t width = 4;
    __m128 v;
    static Floats load(const float* p) { return {_mm_load_ps(p)}; }
    static Floats all(float f) { return {_mm_set1_ps(f)}; }
    void store(float* p) const { _mm_store_ps(p, v); }
};
inline Floats operator-(Floats a, Floats b) { return {_mm_sub_ps(a.v, b.v)}; }
inline Floats operator*(Floats a, Floats b) { return {_mm_mul_ps(a.v, b.v)}; }
inline Floats multiply_add(Floats a, Floats b, Floats c) { return {_mm_add_ps(_mm_mul_ps(a.v, b.v), c.v)}; }
inline Floats larger(Floats a, Floats b) { return {_mm_max_ps(a.v, b.v)}; }
inline std::uint32_t less_bits(Floats a, Floats b)
{
    return static_cast<std::uint32_t>(_mm_movemask_ps(_mm_cmplt_ps(a.v, b.v)));
}

struct Keys {
    static constexpr std::size_t width = 2;
    __m128d v;
    static Keys load(const std::uint64_t* p) { return {_mm_load_pd(reinterpret_cast<const double*>(p))}; }
    static Keys all(std::uint64_t key) { return {_mm_castsi128_pd(_mm_set1_epi64x(static_cast<long long>(key)))}; }
    void store(std::uint64_t* p) const { _mm_store_pd(reinterpret_cast<double*>(p), v); }
};
inline Keys smaller(Keys a, Keys b) { return {_mm_min_pd(a.v, b.v)}; }
inline Keys larger(Keys a, Keys b) { return {_mm_max_pd(a.v, b.v)}; }
inline Keys shifted(Keys before, Keys a) { return {_mm_shuffle_pd(before.v, a.v, 1)}; }

#else

struct Floats {
    static constexpr std::uint32_t width = 4;
    float v[4];
    static Floats load(const float* p) { return {{p[0], p[1], p[2], p[3]}}; }
    static Floats all(float f) { return {{f, f, f, f}}; }
    void store(float* p) const { std::memcpy(p, v, sizeof v); }
};
template <class Operation>
inline Floats each(Floats a, Floats b, Operation operation)
{
    for (int i = 0; i < 4; ++i) a.v[i] = operation(a.v[i], b.v[i]);
    return a;
}
inline Floats operator-(Floats a, Floats b)
{
    return each(a, b, [](float x, float y) { return x - y; });
}
inline Floats operator*(Floats a, Floats b)
{
    return each(a, b, [](float x, float y) { return x * y; });
}
inline Floats multiply_add(Floats a, Floats b, Floats c)
{
    return each(a * b, c, [](float x, float y) { return x + y; });
}
inline Floats larger(Floats a, Floats b)
{
    return each(a, b, [](float x, float y) { return x < y ? y : x; });
}
inline std::uint32_t less_bits(Floats a, Floats b)
{
    std::uint32_t bits = 0;
    for (std::uint32_t i = 0; i < 4; ++i) bits |= std::uint32_t(a.v[i] < b.v[i]) << i;
    return bits;
}

struct Keys {
    static constexpr std::size_t width = 1;
    std::uint64_t v;
    static Keys load(const std::uint64_t* p) { return {*p}; }
    static Keys all(std::uint64_t key) { return {key}; }
    void store(std::uint64_t* p) const { *p = v; }
};
inline Keys smaller(Keys a, Keys b) { return {a.v < b.v ? a.v : b.v}; }
inline Keys larger(Keys a, Keys b) { return {a.v < b.v ? b.v : a.v}; }
inline Keys shifted(Keys before, Keys) { return before; }

#endif

}  // namespace
}  // namespace pcm

// The sorted lists of unit_kernel_source.h: the nearest candidates that each query has met so far.
#pragma once

#include "pcm/knn/unit_vectors.h"

#include <cstddef>

namespace pcm {
namespace {

constexpr float infinite = __builtin_inff();
constexpr std::uint64_t empty_slot = 0xffffffff;  // the index in the keys of free places

template <class T>
inline T larger_of(T a, T b)
{
    return a < b ? b : a;
}

inline std::uint32_t lowest_bit(std::uint32_t bits) { return static_cast<std::uint32_t>(__builtin_ctz(bits)); }

// The ascending list of `8 * Eights` keys, or of any multiple of 8 for 0, in which the candidates in `bits` are
// inserted. What falls out lowers *dropped.
template <int Eights>
inline void insert(std::uint64_t* list, std::size_t capacity, std::uint32_t bits, const float* squares,
                   std::uint32_t first, std::uint64_t* dropped)
{
    if constexpr (Eights != 0) {
        constexpr std::size_t vectors = Eights * 8 / Keys::width;
        Keys a[vectors];
        for (std::size_t i = 0; i < vectors; ++i) a[i] = Keys::load(list + i * Keys::width);
        Keys out = Keys::all(*dropped);
        for (; bits; bits &= bits - 1) {
            const std::uint32_t t = lowest_bit(bits);
            const Keys x = Keys::all(key_of(squares[t], first + t));
            out = smaller(out, larger(a[vectors - 1], x));
            for (std::size_t i = vectors - 1; i > 0; --i) a[i] = larger(shifted(a[i - 1], a[i]), smaller(a[i], x));
            a[0] = larger(shifted(Keys::all(0), a[0]), smaller(a[0], x));
        }
        for (std::size_t i = 0; i < vectors; ++i) a[i].store(list + i * Keys::width);
        alignas(64) std::uint64_t keys[Keys::width];
        out.store(keys);
        *dropped = keys[Keys::width - 1];
    } else {
        // Taken in full: that is quicker than to guess where the new key belongs.
        const bool short_list = Keys::width >= 4 && capacity <= 24 * Keys::width;
        for (; bits; bits &= bits - 1) {
            const std::uint32_t t = lowest_bit(bits);
            const std::uint64_t key = key_of(squares[t], first + t);
            const std::uint64_t last = list[capacity - 1], out = larger_of(last, key);
            if (out < *dropped) *dropped = out;
            if (key >= last) continue;
            const Keys x = Keys::all(key);
            std::uint64_t* at = list + capacity - Keys::width;
            for (; at > list && (short_list || at[-1] > key); at -= Keys::width) {
                const Keys a = Keys::load(at);
                larger(shifted(Keys::load(at - Keys::width), a), smaller(a, x)).store(at);
            }
            const Keys a = Keys::load(at), before = Keys::all(at > list ? at[-1] : 0);
            larger(shifted(before, a), smaller(a, x)).store(at);
        }
    }
}

}  // namespace
}  // namespace pcm

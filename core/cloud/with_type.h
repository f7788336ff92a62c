// Dispatch from a ScalarType to the C++ type.
#pragma once

#include "pcm/cloud/attribute.h"

#include <cstdint>

namespace pcm {

// Calls `use` with a zero of the C++ type that `type` names, and returns its result.
template <class Use>
auto with_type(ScalarType type, Use&& use)
{
    switch (type) {
        case ScalarType::i8:
            return use(std::int8_t{});
        case ScalarType::u8:
            return use(std::uint8_t{});
        case ScalarType::i16:
            return use(std::int16_t{});
        case ScalarType::u16:
            return use(std::uint16_t{});
        case ScalarType::i32:
            return use(std::int32_t{});
        case ScalarType::u32:
            return use(std::uint32_t{});
        case ScalarType::i64:
            return use(std::int64_t{});
        case ScalarType::u64:
            return use(std::uint64_t{});
        case ScalarType::f32:
            return use(float{});
        case ScalarType::f64:
            break;
    }
    return use(double{});
}

}  // namespace pcm

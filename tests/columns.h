// Columns of given values.
#pragma once

#include "pcm/bpc/chunk.h"

#include <cstring>
#include <vector>

namespace pcm {

template <class T>
Column column_of(ScalarType type, std::uint32_t components, const std::vector<T>& values)
{
    Column column(type, components);
    column.resize(values.size() / components);
    std::memcpy(column.data(), values.data(), values.size() * sizeof(T));
    return column;
}

}  // namespace pcm

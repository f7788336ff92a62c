#include "bpc/chunk.h"

namespace pcm {

std::size_t Chunk::bytes() const
{
    std::size_t sum = positions ? positions->bytes() : 0;
    for (const auto& column : attributes)
        if (column) sum += column->bytes();
    return sum;
}

ColumnSet Chunk::columns() const
{
    ColumnSet set;
    set.positions = positions != nullptr;
    for (std::size_t i = 0; i < attributes.size(); ++i)
        if (attributes[i]) set.attributes.set(i);
    return set;
}

}  // namespace pcm

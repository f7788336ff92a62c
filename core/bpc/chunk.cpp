#include "pcm/bpc/chunk.h"

namespace pcm {

std::size_t Chunk::bytes() const
{
    std::size_t sum = (positions ? positions->bytes() : 0) + (sizes ? sizes->bytes() : 0);
    for (const auto& column : attributes)
        if (column) sum += column->bytes();
    return sum;
}

ColumnSet Chunk::columns() const
{
    ColumnSet set;
    set.positions = positions != nullptr;
    set.sizes = sizes != nullptr;
    for (std::size_t i = 0; i < attributes.size(); ++i)
        if (attributes[i]) set.attributes.set(i);
    return set;
}

const Attribute& attribute_of_sizes()
{
    static const Attribute attribute = [] {
        Attribute made;
        made.name = "point sizes";
        made.type = ScalarType::u8;
        return made;
    }();
    return attribute;
}

void add_missing_columns(Chunk& chunk, const Schema& schema, const ColumnSet& asked)
{
    if (asked.sizes && !chunk.sizes) {
        const auto column = std::make_shared<Column>(attribute_of_sizes());
        column->resize(chunk.points);
        chunk.sizes = column;
    }
    for (std::size_t k = chunk.attributes.size(); k < schema.size(); ++k) {
        chunk.attributes.emplace_back();
        if (!asked.attributes.test(k)) continue;
        const auto column = std::make_shared<Column>(schema[k]);
        column->resize(chunk.points);
        chunk.attributes.back() = column;
    }
}

}  // namespace pcm

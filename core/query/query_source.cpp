#include "pcm/query/query_source.h"

#include "pcm/system/error.h"

namespace pcm {

std::vector<std::size_t> slots_of(const QuerySource& source, const Query& query)
{
    std::vector<std::size_t> slots;
    for (const std::string& name : query.attributes) {
        const auto slot = source.info().schema.find(name);
        if (!slot)
            throw Error(ErrorCode::invalid_argument, source.folder, "this cloud has no attribute '" + name + "'");
        slots.push_back(*slot);
    }
    return slots;
}

ColumnSet columns_of(const std::vector<std::size_t>& slots, const Selector& selector)
{
    ColumnSet columns;
    for (const std::size_t slot : slots) columns.attributes.set(slot);
    for (const std::size_t slot : selector.tested()) columns.attributes.set(slot);
    return columns;
}

}  // namespace pcm

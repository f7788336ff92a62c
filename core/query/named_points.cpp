#include "pcm/query/named_points.h"

#include "pcm/query/query_source.h"
#include "pcm/system/error.h"
#include "pcm/tree/source_rounding.h"

#include <algorithm>
#include <cstring>
#include <numeric>

namespace pcm {

NamedPoints named_points(QuerySource& source, const std::vector<PointName>& names,
                         const std::vector<std::string>& attributes)
{
    Query query;
    query.attributes = attributes;
    const std::vector<std::size_t> slots = slots_of(source, query);
    const TreeInfo& info = source.info();
    NamedPoints points;
    points.positions.resize(names.size());
    ColumnSet columns;
    for (const std::size_t slot : slots) {
        columns.attributes.set(slot);
        points.columns.emplace_back(info.schema[slot]).resize(names.size());
    }
    std::vector<std::size_t> order(names.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return names[a].node < names[b].node; });
    const auto tree = source.store->tree();
    const SourceRounding rounding(info);
    L2Cache::Handle chunk;
    NodeId held = no_node;
    for (const std::size_t i : order) {
        const auto [node, number] = names[i];
        if (node >= tree->nodes().size() || number >= tree->node(node).points)
            throw Error(ErrorCode::invalid_argument, source.folder,
                        "there is no point " + std::to_string(number) + " of node " + std::to_string(node),
                        "take node and number from a query of this cloud as it is now");
        if (node != held) chunk = source.cache.get(held = node, columns);
        points.positions[i] = rounding(info.grid.to_source(chunk->positions->grid(number)));
        for (std::size_t a = 0; a < slots.size(); ++a) {
            const std::size_t bytes = points.columns[a].point_bytes();
            std::memcpy(points.columns[a].data() + i * bytes, chunk->attributes[slots[a]]->data() + number * bytes,
                        bytes);
        }
    }
    return points;
}

}  // namespace pcm

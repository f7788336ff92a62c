// The chunks of a tree with the values that units have given their points, for a cache.
#pragma once

#include "pcm/cache/chunk_store.h"
#include "pcm/cluster/filter/unit_results.h"

#include <memory>
#include <utility>
#include <vector>

namespace pcm {

class ResultStore final : public ChunkStore {
public:
    // `places`: in the tree's schema, keyed by column of the results.
    ResultStore(std::shared_ptr<const Tree> tree, const UnitResults& results, std::vector<std::size_t> places)
        : tree_(std::move(tree)), results_(results), places_(std::move(places))
    {
    }

    std::shared_ptr<const Tree> tree() const override { return tree_; }
    Chunk read(NodeId node, const ColumnSet& columns) const override
    {
        ColumnSet others = columns;
        for (const std::size_t place : places_) others.attributes.reset(place);
        Chunk chunk = tree_->read_chunk(node, others);
        for (std::size_t c = 0; c < places_.size(); ++c)
            if (columns.attributes.test(places_[c]))
                chunk.attributes[places_[c]] =
                    std::make_shared<const Column>(results_.column(node, c, tree_->info().schema[places_[c]]));
        return chunk;
    }
    // The tree's own columns alone.
    ChunkPart read_part(NodeId node, const ColumnSet& columns,
                        const std::function<bool(const Box3i& box, std::uint16_t level)>& wanted) const override
    {
        return tree_->read_chunk_part(node, columns, wanted);
    }

private:
    const std::shared_ptr<const Tree> tree_;
    const UnitResults& results_;
    const std::vector<std::size_t> places_;
};

}  // namespace pcm

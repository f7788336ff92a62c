// An open tree as its queries see it.
#pragma once

#include "pcm/cache/l2_cache.h"
#include "pcm/knn/point_blocks.h"
#include "pcm/query/query.h"
#include "pcm/query/read_rates.h"
#include "pcm/threads/task_pool.h"

#include <cstddef>
#include <filesystem>
#include <memory>
#include <vector>

namespace pcm {

// What all queries of one open tree share; its cursors keep it alive. Any number of threads.
struct QuerySource {
    QuerySource(std::shared_ptr<ChunkStore> chunks, const L2Options& options)
        : folder(chunks->tree()->folder()), store(std::move(chunks)), cache(store, options)
    {
    }
    QuerySource(const QuerySource&) = delete;
    QuerySource& operator=(const QuerySource&) = delete;

    // With the attributes that were added.
    const TreeInfo& info() const { return cache.tree().info(); }

    const std::filesystem::path folder;
    const std::shared_ptr<ChunkStore> store;
    L2Cache cache;
    ReadRates rates;
    BlockCache blocks;
    TaskPool pool;  // its threads use all of the above
};

// The places in the schema of the attributes that a query names, in its order. Throws Error(invalid_argument) for an
// unknown one.
std::vector<std::size_t> slots_of(const QuerySource& source, const Query& query);

// The columns that a query reads: positions, the attributes in `slots`, and those that its conditions test.
ColumnSet columns_of(const std::vector<std::size_t>& slots, const Selector& selector);

}  // namespace pcm

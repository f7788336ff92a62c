#include "pcm/cache/chunk_store.h"

#include "pcm/system/error.h"

namespace pcm {

void ChunkStore::write(NodeId, const Chunk&, const ColumnSet&)
{
    throw Error(ErrorCode::invalid_argument, tree()->folder(), "this point cloud was opened for reading only",
                "open it for writing");
}

void ChunkStore::read_many(const std::vector<ChunkRequest>& requests, const TakeChunk& take) const
{
    for (std::size_t i = 0; i < requests.size(); ++i) {
        Chunk chunk;
        std::exception_ptr failure;
        try {
            chunk = read(requests[i].node, requests[i].columns);
        } catch (const std::exception&) {
            failure = std::current_exception();
        }
        take(i, std::move(chunk), failure);
    }
}

}  // namespace pcm

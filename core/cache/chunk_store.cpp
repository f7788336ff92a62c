#include "pcm/cache/chunk_store.h"

#include "pcm/system/error.h"

namespace pcm {

void ChunkStore::write(NodeId, const Chunk&, const ColumnSet&)
{
    throw Error(ErrorCode::invalid_argument, tree()->folder(), "this point cloud was opened for reading only",
                "open it for writing");
}

}  // namespace pcm

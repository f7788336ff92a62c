// The index of a tree. An accepted index is written again as the same bytes, and its nodes can be traversed.

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_index.h"

#include <cstdlib>
#include <cstring>

namespace {

using namespace pcm;

void require(bool holds)
{
    if (!holds) std::abort();
}

void walk(const TreeIndex& index)
{
    std::uint64_t points = 0;
    for (NodeId id = 0; id < index.nodes.size(); ++id) {
        const Node& node = index.nodes[id];
        require(id == 0 ? node.parent == no_node : node.parent < id);
        for (const NodeId child : node.children) require(child == no_node || index.nodes[child].parent == id);
        if (node.part == no_part)
            require(node.points == 0);
        else
            require(node.depth - index.nodes[index.part_roots[node.part]].depth <= NodePath::max_depth);
        if (node.points > 0) require(node.first_level + node.level_points.size() <= index.info.spacings.size());
        if (node.extent.bytes > 0)
            require(node.extent.offset + node.extent.bytes <= index.data_files[node.extent.file].bytes);
        points += node.points;
    }
    require(points == index.info.points);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    std::vector<std::byte> bytes(size);
    if (size) std::memcpy(bytes.data(), data, size);
    if (size >= 8) {
        const std::uint64_t sum = checksum(bytes.data(), size - 8);
        std::memcpy(bytes.data() + size - 8, &sum, 8);
    }
    try {
        const TreeIndex index = decode_index(bytes, "index");
        require(encode_index(index) == bytes);
        walk(index);
    } catch (const Error&) {
    }
    return 0;
}

// The index of a tree, of both versions, with checksums that match. An accepted index is written again as the same
// bytes, and its nodes can be traversed.

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

void put_sum(std::vector<std::byte>& bytes, std::size_t at, const std::byte* from, std::size_t size)
{
    const std::uint64_t sum = checksum(from, size);
    std::memcpy(bytes.data() + at, &sum, sizeof sum);
}

// Makes the checksums those of the bytes, as far as the bytes say where there are some.
void seal(std::vector<std::byte>& bytes)
{
    constexpr std::size_t head_bytes_at = 12, page_entry = 20;
    if (bytes.size() < head_bytes_at + 8) return;
    std::uint64_t head_bytes;
    std::memcpy(&head_bytes, bytes.data() + head_bytes_at, sizeof head_bytes);
    if (bytes[8] == std::byte{3} || head_bytes < head_bytes_at + 16 || head_bytes > bytes.size())
        return put_sum(bytes, bytes.size() - 8, bytes.data(), bytes.size() - 8);
    const auto seal_head = [&] {
        put_sum(bytes, static_cast<std::size_t>(head_bytes) - 8, bytes.data(),
                static_cast<std::size_t>(head_bytes) - 8);
    };
    seal_head();
    const IndexHead head = decode_head(bytes, "index");
    std::size_t entry = static_cast<std::size_t>(head_bytes) - 8 - page_entry * head.pages.size();
    for (const NodePage& page : head.pages) {
        put_sum(bytes, entry + 12, bytes.data() + page.offset, static_cast<std::size_t>(page.bytes));
        entry += page_entry;
    }
    seal_head();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    std::vector<std::byte> bytes(size);
    if (size) std::memcpy(bytes.data(), data, size);
    try {
        seal(bytes);
        const TreeIndex index = decode_index(bytes, "index");
        if (bytes[8] != std::byte{3}) require(encode_index(index) == bytes);
        walk(index);
    } catch (const Error&) {
    }
    return 0;
}

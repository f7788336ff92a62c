// The bytes of an index as programs wrote it before indexes had pages; FORMAT.md has the layout.
#pragma once

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/tree/about.h"
#include "pcm/tree/tree_index.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pcm::test {

inline std::vector<std::byte> index_of_version_3(const TreeIndex& index)
{
    ByteWriter out;
    out.put_bytes(index_magic, sizeof index_magic);
    out.put(std::uint32_t(3));
    put_tree_info(out, index.info);
    out.put(static_cast<std::uint32_t>(index.data_files.size()));
    for (const DataFile& file : index.data_files) {
        out.put(file.bytes);
        out.put(file.generation);
    }
    const std::vector<NodeId> roots = index.nodes.empty() ? std::vector<NodeId>() : index.part_roots;
    out.put(static_cast<std::uint32_t>(roots.size()));
    for (const NodeId root : roots) out.put(root);
    out.put(static_cast<std::uint32_t>(index.nodes.size()));
    for (const Node& node : index.nodes) {
        for (const NodeId id : {node.parent, node.children[0], node.children[1]}) out.put(id);
        out.put(static_cast<std::uint32_t>(node.depth));
        out.put(node.points);
        out.put(node.extent.file);
        out.put(node.extent.header_bytes);
        out.put(node.first_level);
        out.put(static_cast<std::uint16_t>(node.level_points.size()));
        out.put(node.subtree_points);
        put_vec(out, node.box.min);
        put_vec(out, node.box.max);
        out.put(node.spacing);
        out.put(node.extent.offset);
        out.put(node.extent.bytes);
    }
    for (const Node& node : index.nodes)
        for (const std::uint32_t points : node.level_points) out.put(points);
    out.put(checksum(out.bytes().data(), out.size()));
    return out.bytes();
}

}  // namespace pcm::test

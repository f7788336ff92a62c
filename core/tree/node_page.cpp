#include "pcm/tree/node_page.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"

namespace pcm {

std::vector<std::byte> encode_page(const std::vector<Node>& nodes, std::size_t first, std::size_t count)
{
    ByteWriter out;
    for (std::size_t id = first; id < first + count; ++id) {
        const Node& node = nodes[id];
        out.put(node.parent);
        out.put(node.children[0]);
        out.put(node.children[1]);
        out.put(static_cast<std::uint32_t>(node.depth));
        out.put(node.part);
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
    for (std::size_t id = first; id < first + count; ++id)
        for (const std::uint32_t points : nodes[id].level_points) out.put(points);
    return std::move(out.bytes());
}

std::vector<Node> decode_page(const std::byte* bytes, std::size_t size, std::uint32_t count, std::uint32_t levels,
                              const std::filesystem::path& path)
{
    ByteReader in(bytes, size, path);
    if (size < std::size_t(count) * node_bytes)
        throw Error(ErrorCode::corrupt, path, "a page of the index is too short for its nodes");
    std::vector<Node> nodes(count);
    for (Node& node : nodes) {
        node.parent = in.get<std::uint32_t>();
        node.children[0] = in.get<std::uint32_t>();
        node.children[1] = in.get<std::uint32_t>();
        const auto depth = in.get<std::uint32_t>();
        if (depth > 0xffff) throw Error(ErrorCode::corrupt, path, "a node is too deep");
        node.depth = static_cast<std::uint16_t>(depth);
        node.part = in.get<std::uint32_t>();
        node.points = in.get<std::uint32_t>();
        node.extent.file = in.get<std::uint32_t>();
        node.extent.header_bytes = in.get<std::uint32_t>();
        node.first_level = in.get<std::uint16_t>();
        const auto of_levels = in.get<std::uint16_t>();
        if (of_levels > levels) throw Error(ErrorCode::corrupt, path, "a node has points of no level");
        node.level_points.resize(of_levels);
        node.subtree_points = in.get<std::uint64_t>();
        node.box.min = get_vec(in);
        node.box.max = get_vec(in);
        node.spacing = in.get<double>();
        node.extent.offset = in.get<std::uint64_t>();
        node.extent.bytes = in.get<std::uint64_t>();
    }
    for (Node& node : nodes)
        for (std::uint32_t& points : node.level_points) points = in.get<std::uint32_t>();
    if (in.left() != 0) throw Error(ErrorCode::corrupt, path, "a page of the index has bytes after its end");
    return nodes;
}

}  // namespace pcm

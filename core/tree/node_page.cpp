#include "pcm/tree/node_page.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/index_head.h"

#include <string>

namespace pcm {

std::vector<std::byte> encode_page(const std::vector<Node>& nodes, const std::vector<std::uint32_t>& parts,
                                   std::size_t first, std::size_t count)
{
    ByteWriter out;
    for (std::size_t id = first; id < first + count; ++id) {
        const Node& node = nodes[id];
        out.put(node.parent);
        out.put(node.children[0]);
        out.put(node.children[1]);
        out.put(static_cast<std::uint32_t>(node.depth));
        out.put(parts[id]);
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

std::vector<Node> get_nodes(ByteReader& in, std::uint32_t count, std::uint32_t levels, bool have_parts,
                            const std::filesystem::path& path)
{
    const std::size_t bytes = have_parts ? node_bytes : node_bytes_without_part;
    if (in.left() < count * bytes)
        throw Error(ErrorCode::corrupt, path, "the index is too short for the number of nodes that it states");
    std::vector<Node> nodes(count);
    for (Node& node : nodes) {
        node.parent = in.get<std::uint32_t>();
        node.children[0] = in.get<std::uint32_t>();
        node.children[1] = in.get<std::uint32_t>();
        const auto depth = in.get<std::uint32_t>();
        if (depth > 0xffff) throw Error(ErrorCode::corrupt, path, "a node is too deep");
        node.depth = static_cast<std::uint16_t>(depth);
        if (have_parts) node.part = in.get<std::uint32_t>();
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
    return nodes;
}

std::vector<Node> decode_page(const NodePage& page, const std::byte* bytes, std::uint32_t levels,
                              const std::filesystem::path& path)
{
    const auto size = static_cast<std::size_t>(page.bytes);
    if (checksum(bytes, size) != page.checksum)
        throw Error(
            ErrorCode::corrupt, path,
            "the checksum of the index's page that begins with node " + std::to_string(page.first) + " does not match");
    ByteReader in(bytes, size, path);
    std::vector<Node> nodes = get_nodes(in, page.nodes, levels, true, path);
    if (in.left() != 0) throw Error(ErrorCode::corrupt, path, "a page of the index has bytes after its end");
    return nodes;
}

}  // namespace pcm

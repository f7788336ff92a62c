#include "tree/tree_index.h"

#include "bpc/bpc.h"
#include "bpc/byte_order.h"
#include "cloud/error.h"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace pcm {
namespace {

constexpr char magic[8] = {'P', 'C', 'M', 'T', 'R', 'E', 'E', '\n'};
constexpr std::uint32_t version = 2;
constexpr std::size_t node_bytes = 112;

void put_vec(ByteWriter& out, const Vec3i& v)
{
    for (const std::int64_t c : v) out.put(c);
}
Vec3i get_vec(ByteReader& in)
{
    Vec3i v;
    for (std::int64_t& c : v) c = in.get<std::int64_t>();
    return v;
}

// Every promise that tree.h makes about nodes; a tree that passes can be walked without further checks.
void check(const TreeIndex& index, const std::filesystem::path& path)
{
    const auto refuse = [&](std::size_t node, const std::string& what) {
        return Error(ErrorCode::corrupt, path, "node " + std::to_string(node) + ": " + what);
    };
    const std::vector<Node>& nodes = index.nodes;
    if (nodes.empty() != (index.info.points == 0)) throw Error(ErrorCode::corrupt, path, "points without nodes");
    if (!nodes.empty() && (nodes[0].subtree_points != index.info.points || !(nodes[0].box == index.info.box)))
        throw Error(ErrorCode::corrupt, path, "the root does not hold the cloud's points");
    if (index.info.spacings.size() != index.info.levels || index.info.levels > 256)
        throw Error(ErrorCode::corrupt, path, "the number of levels is wrong");
    for (std::size_t k = 0; k < index.info.spacings.size(); ++k) {
        const double spacing = index.info.spacings[k];
        const bool last = k + 1 == index.info.spacings.size();
        if (!std::isfinite(spacing) || spacing < 0 || (spacing == 0 && !last) || (k > 0 && spacing >= index.info.spacings[k - 1]))
            throw Error(ErrorCode::corrupt, path, "level " + std::to_string(k) + " has a spacing out of order");
    }
    for (std::size_t id = 0; id < nodes.size(); ++id) {
        const Node& node = nodes[id];
        if ((id == 0) != (node.parent == no_node)) throw refuse(id, "has no place under the root");
        if (id > 0) {
            if (node.parent >= id) throw refuse(id, "comes before its parent");
            const Node& parent = nodes[node.parent];
            if (parent.children[0] != id && parent.children[1] != id) throw refuse(id, "is not its parent's child");
            if (node.depth != parent.depth + 1) throw refuse(id, "is not one step below its parent");
            if (!parent.box.contains(node.box.min) || !parent.box.contains(node.box.max))
                throw refuse(id, "reaches out of its parent's box");
        } else if (node.depth != 0) {
            throw refuse(id, "is a root at a depth");
        }
        std::uint64_t below = node.points;
        for (const NodeId child : node.children) {
            if (child == no_node) continue;
            if (child <= id || child >= nodes.size() || nodes[child].parent != id) throw refuse(id, "has a false child");
            below += nodes[child].subtree_points;
        }
        if (node.children[0] != no_node && node.children[0] == node.children[1]) throw refuse(id, "has one child twice");
        if (below != node.subtree_points) throw refuse(id, "does not hold as many points as it says");
        if (node.box.empty()) throw refuse(id, "has no box");
        if ((node.points == 0) != (node.extent.bytes == 0)) throw refuse(id, "has points without a chunk");
        if (node.extent.bytes) {
            if (node.extent.file >= index.data_file_bytes.size() ||
                node.extent.offset > index.data_file_bytes[node.extent.file] ||
                node.extent.bytes > index.data_file_bytes[node.extent.file] - node.extent.offset)
                throw refuse(id, "has its chunk outside the data files");
        }
        if (!(node.spacing >= 0)) throw refuse(id, "has no spacing");
        if (node.first_level + node.level_points.size() > index.info.levels) throw refuse(id, "has points of no level");
        std::uint64_t of_levels = 0;
        for (const std::uint32_t points : node.level_points) of_levels += points;
        if (of_levels != node.points) throw refuse(id, "does not say of which levels its points are");
    }
}

}  // namespace

std::string data_file_name(std::uint32_t number)
{
    char name[32];
    std::snprintf(name, sizeof name, "chunks-%03u.bpc", number);
    return name;
}

std::vector<std::byte> encode_index(const TreeIndex& index)
{
    const TreeInfo& info = index.info;
    ByteWriter out;
    out.put_bytes(magic, sizeof magic);
    out.put(version);
    out.put(static_cast<std::uint32_t>(info.levels));
    out.put(info.points);
    out.put(info.points_skipped);
    out.put(info.content_hash);
    out.put(info.position_error);
    for (const double s : info.grid.scale) out.put(s);
    for (const double o : info.grid.offset) out.put(o);
    put_vec(out, info.box.min);
    put_vec(out, info.box.max);
    for (const Vec3i& extreme : info.extremes) put_vec(out, extreme);
    out.put(static_cast<std::uint8_t>(info.position_type));
    out.put(static_cast<std::uint8_t>(info.wide));
    out.put(static_cast<std::uint8_t>(info.sampling));
    out.put(std::uint8_t(0));
    for (const double spacing : info.spacings) out.put(spacing);
    out.put(static_cast<std::uint32_t>(info.schema.size()));
    for (const Attribute& attribute : info.schema) put_attribute(out, attribute);
    out.put(static_cast<std::uint32_t>(info.metadata.size()));
    for (const Metadata& block : info.metadata) {
        out.put_string(block.key);
        out.put(static_cast<std::uint64_t>(block.value.size()));
        out.put_bytes(block.value.data(), block.value.size());
    }
    out.put(static_cast<std::uint32_t>(info.sources.size()));
    for (const std::string& source : info.sources) out.put_string(source);
    out.put(static_cast<std::uint32_t>(index.data_file_bytes.size()));
    for (const std::uint64_t bytes : index.data_file_bytes) out.put(bytes);
    out.put(static_cast<std::uint32_t>(index.nodes.size()));
    for (const Node& node : index.nodes) {
        out.put(node.parent);
        out.put(node.children[0]);
        out.put(node.children[1]);
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
    return std::move(out.bytes());
}

TreeIndex decode_index(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
{
    if (bytes.size() < sizeof magic + 12 || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
        throw Error(ErrorCode::not_a_tree, path, "this is not the index of a point cloud tree");
    ByteReader in(bytes.data(), bytes.size(), path);
    in.get_bytes(sizeof magic);
    const auto found = in.get<std::uint32_t>();
    if (found != version)
        throw Error(ErrorCode::unsupported, path,
                    "tree format version " + std::to_string(found) + ", this program reads version " +
                        std::to_string(version),
                    found < version ? "build the tree again from its files" : "");
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + bytes.size() - 8, 8);
    if (stored != checksum(bytes.data(), bytes.size() - 8))
        throw Error(ErrorCode::corrupt, path, "the index's checksum does not hold");

    TreeIndex index;
    TreeInfo& info = index.info;
    const auto levels = in.get<std::uint32_t>();
    if (levels > 256) throw Error(ErrorCode::corrupt, path, "the number of levels is wrong");
    info.levels = static_cast<std::uint16_t>(levels);
    info.points = in.get<std::uint64_t>();
    info.points_skipped = in.get<std::uint64_t>();
    info.content_hash = in.get<std::uint64_t>();
    info.position_error = in.get<double>();
    for (double& s : info.grid.scale) s = in.get<double>();
    for (double& o : info.grid.offset) o = in.get<double>();
    info.box.min = get_vec(in);
    info.box.max = get_vec(in);
    for (Vec3i& extreme : info.extremes) extreme = get_vec(in);
    info.position_type = static_cast<ScalarType>(in.get<std::uint8_t>());
    info.wide = in.get<std::uint8_t>() != 0;
    const auto sampling = in.get<std::uint8_t>();
    if (sampling > static_cast<std::uint8_t>(Sampling::grid))
        throw Error(ErrorCode::corrupt, path, "the levels are of a kind that does not exist");
    info.sampling = static_cast<Sampling>(sampling);
    in.get<std::uint8_t>();
    info.spacings.resize(info.levels);
    for (double& spacing : info.spacings) spacing = in.get<double>();
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) info.schema.add(get_attribute(in));
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
        Metadata block;
        block.key = in.get_string();
        const auto size = in.get<std::uint64_t>();
        if (size > in.left()) throw Error(ErrorCode::corrupt, path, "a metadata block runs over the end");
        const std::byte* from = in.get_bytes(static_cast<std::size_t>(size));
        block.value.assign(from, from + size);
        info.metadata.push_back(std::move(block));
    }
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) info.sources.push_back(in.get_string());
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) index.data_file_bytes.push_back(in.get<std::uint64_t>());
    const auto count = in.get<std::uint32_t>();
    if (in.left() < count * node_bytes + 8)
        throw Error(ErrorCode::corrupt, path, "the index does not hold as many nodes as it says");
    index.nodes.resize(count);
    for (Node& node : index.nodes) {
        node.parent = in.get<std::uint32_t>();
        node.children[0] = in.get<std::uint32_t>();
        node.children[1] = in.get<std::uint32_t>();
        node.depth = static_cast<std::uint16_t>(in.get<std::uint32_t>());
        node.points = in.get<std::uint32_t>();
        node.extent.file = in.get<std::uint32_t>();
        node.extent.header_bytes = in.get<std::uint32_t>();
        node.first_level = in.get<std::uint16_t>();
        node.level_points.resize(in.get<std::uint16_t>());
        node.subtree_points = in.get<std::uint64_t>();
        node.box.min = get_vec(in);
        node.box.max = get_vec(in);
        node.spacing = in.get<double>();
        node.extent.offset = in.get<std::uint64_t>();
        node.extent.bytes = in.get<std::uint64_t>();
    }
    for (Node& node : index.nodes)
        for (std::uint32_t& points : node.level_points) points = in.get<std::uint32_t>();
    if (in.left() != 8) throw Error(ErrorCode::corrupt, path, "the index does not end where it says");
    info.bytes = bytes.size();
    for (const Node& node : index.nodes) info.bytes += node.extent.bytes;
    check(index, path);
    return index;
}

}  // namespace pcm

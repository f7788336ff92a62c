#include "pcm/tree/tree_index.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/parse_beginning.h"

#include <cmath>
#include <cstdio>
#include <cstring>

namespace pcm {
namespace {

constexpr std::uint32_t index_version = 3;
constexpr std::size_t node_bytes = 112, data_file_bytes = 12;

[[noreturn]] void refuse_version(std::uint32_t found, const std::filesystem::path& path)
{
    throw Error(ErrorCode::unsupported, path,
                "tree format version " + std::to_string(found) + ", this program reads version " +
                    std::to_string(index_version),
                found < index_version ? "build the tree again from its files" : "");
}

[[noreturn]] void refuse_version(std::uint32_t found, std::vector<std::byte> bytes, const std::filesystem::path& path)
{
    // Where everything else is of this version, the version is damaged.
    std::memcpy(bytes.data() + sizeof index_magic, &index_version, sizeof index_version);
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + bytes.size() - 8, 8);
    if (stored == checksum(bytes.data(), bytes.size() - 8))
        throw Error(ErrorCode::corrupt, path, "the version in the index is damaged");
    refuse_version(found, path);
}

// Checks every invariant that tree.h states for nodes: a tree that passes can be walked without further checks.
void check(const TreeIndex& index, const std::filesystem::path& path)
{
    const auto refuse = [&](std::size_t node, const std::string& what) {
        return Error(ErrorCode::corrupt, path, "node " + std::to_string(node) + ": " + what);
    };
    const std::vector<Node>& nodes = index.nodes;
    if (nodes.empty() != (index.info.points == 0)) throw Error(ErrorCode::corrupt, path, "points without nodes");
    if (nodes.empty() != index.part_roots.empty()) throw Error(ErrorCode::corrupt, path, "parts without nodes");
    if (!nodes.empty() && (nodes[0].subtree_points != index.info.points || !(nodes[0].box == index.info.box)))
        throw Error(ErrorCode::corrupt, path, "the root does not hold the cloud's points");
    for (std::size_t i = 0; i < index.data_files.size(); ++i)
        if (index.data_files[i].generation == 0 || index.data_files[i].generation > index.info.generation)
            throw Error(ErrorCode::corrupt, path,
                        "data file " + std::to_string(i) + " is of generation " +
                            std::to_string(index.data_files[i].generation) + ", the tree of generation " +
                            std::to_string(index.info.generation));
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
            throw refuse(id, "is a root whose depth is not 0");
        }
        std::uint64_t below = node.points;
        for (const NodeId child : node.children) {
            if (child == no_node) continue;
            if (child <= id || child >= nodes.size() || nodes[child].parent != id)
                throw refuse(id, "has a false child");
            below += nodes[child].subtree_points;
        }
        if (node.children[0] != no_node && node.children[0] == node.children[1])
            throw refuse(id, "has one child twice");
        if (below != node.subtree_points) throw refuse(id, "does not hold as many points as it says");
        if (node.box.empty()) throw refuse(id, "has no box");
        if ((node.points == 0) != (node.extent.bytes == 0)) throw refuse(id, "has points without a chunk");
        if (node.extent.bytes) {
            const Extent& extent = node.extent;
            if (extent.file >= index.data_files.size() || extent.offset > index.data_files[extent.file].bytes ||
                extent.bytes > index.data_files[extent.file].bytes - extent.offset ||
                extent.header_bytes > extent.bytes)
                throw refuse(id, "has its chunk outside the data files");
        }
        if (!(node.spacing >= 0)) throw refuse(id, "has no spacing");
        if (node.first_level + node.level_points.size() > index.info.levels) throw refuse(id, "has points of no level");
        std::uint64_t of_levels = 0;
        for (const std::uint32_t points : node.level_points) of_levels += points;
        if (of_levels != node.points) throw refuse(id, "does not state of which levels its points are");
    }
}

void check_magic(ByteReader& in, const std::filesystem::path& path)
{
    if (in.left() < sizeof index_magic + 12 || std::memcmp(in.get_bytes(sizeof index_magic), index_magic, 8) != 0)
        throw Error(ErrorCode::not_a_tree, path, "this is not the index of a point cloud tree");
}

// The largest size that the counts at the beginning of an index allow.
std::uint64_t most_bytes_of(const File& file)
{
    return parse_beginning(file, [&](ByteReader& in) {
        check_magic(in, file.path());
        if (const auto found = in.get<std::uint32_t>(); found != index_version) refuse_version(found, file.path());
        const std::uint64_t levels = get_tree_info(in, file.path()).levels;
        in.get_bytes(in.get<std::uint32_t>() * data_file_bytes);
        in.get_bytes(in.get<std::uint32_t>() * sizeof(NodeId));
        const std::uint64_t nodes = in.get<std::uint32_t>();
        return in.position() + nodes * (node_bytes + levels * sizeof(std::uint32_t)) + sizeof(std::uint64_t);
    });
}

}  // namespace

void find_parts(TreeIndex& index, const std::filesystem::path& path)
{
    std::vector<Node>& nodes = index.nodes;
    const auto refuse = [&](std::size_t node, const std::string& what) {
        return Error(ErrorCode::corrupt, path, "node " + std::to_string(node) + ": " + what);
    };
    for (Node& node : nodes) node.part = no_part;
    for (std::size_t part = 0; part < index.part_roots.size(); ++part) {
        const NodeId root = index.part_roots[part];
        if (root == no_node) continue;
        if (root >= nodes.size())
            throw Error(ErrorCode::corrupt, path, "the root of part " + std::to_string(part) + " does not exist");
        if (nodes[root].part != no_part) throw refuse(root, "is the root of two parts");
        nodes[root].part = static_cast<std::uint32_t>(part);
    }
    for (std::size_t id = 0; id < nodes.size(); ++id) {
        Node& node = nodes[id];
        if (id > 0 && node.parent < id && nodes[node.parent].part != no_part) {
            if (node.part != no_part) throw refuse(id, "is the root of a part inside another part");
            node.part = nodes[node.parent].part;
        }
        if (node.part != no_part) {
            if (node.depth - nodes[index.part_roots[node.part]].depth > NodePath::max_depth)
                throw refuse(id, "is too deep in its part");
        } else if (node.points > 0 || node.is_leaf()) {
            throw refuse(id, "belongs to no part");
        }
    }
}

void write_commit(const std::filesystem::path& folder, TreeIndex& index)
{
    CommitRecord record;
    record.generation = index.info.generation;
    record.coverage_kept = index.info.coverage_kept;
    record.points = index.info.points;
    record.content_hash = index.info.content_hash;
    record.parts = static_cast<std::uint32_t>(index.nodes.empty() ? 0 : index.part_roots.size());
    for (const Node& node : index.nodes) record.chunks += node.extent.bytes ? 1 : 0;
    DataFile& last = index.data_files.back();
    File file(folder / data_file_name(static_cast<std::uint32_t>(index.data_files.size() - 1)), File::Mode::change);
    const std::uint64_t at = last.bytes;
    last.bytes += commit_bytes(index.data_files.size());
    record.data_files = index.data_files;
    const std::vector<std::byte> bytes = encode_commit(record);
    file.write_at(bytes.data(), bytes.size(), at);
    file.sync();
    file.close();
}

std::string data_file_name(std::uint32_t number)
{
    char name[32];
    std::snprintf(name, sizeof name, "chunks-%03u.bpc", number);
    return name;
}

std::vector<std::byte> encode_index(const TreeIndex& index)
{
    ByteWriter out;
    out.put_bytes(index_magic, sizeof index_magic);
    out.put(index_version);
    put_tree_info(out, index.info);
    out.put(static_cast<std::uint32_t>(index.data_files.size()));
    for (const DataFile& file : index.data_files) {
        out.put(file.bytes);
        out.put(file.generation);
    }
    out.put(static_cast<std::uint32_t>(index.nodes.empty() ? 0 : index.part_roots.size()));
    if (!index.nodes.empty())
        for (const NodeId root : index.part_roots) out.put(root);
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

std::vector<std::byte> read_index(const File& file)
{
    const std::uint64_t size = file.size();
    if (size > first_beginning_bytes) {
        const std::uint64_t most = most_bytes_of(file);
        if (size > most)
            throw Error(ErrorCode::corrupt, file.path(),
                        "the index has " + std::to_string(size) +
                            " bytes; with the nodes that it states it has at most " + std::to_string(most));
    }
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    file.read_at(bytes.data(), bytes.size(), 0);
    return bytes;
}

TreeIndex decode_index(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
{
    ByteReader in(bytes.data(), bytes.size(), path);
    check_magic(in, path);
    const auto found = in.get<std::uint32_t>();
    if (found != index_version) refuse_version(found, bytes, path);
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + bytes.size() - 8, 8);
    if (stored != checksum(bytes.data(), bytes.size() - 8))
        throw Error(ErrorCode::corrupt, path, "the checksum of the index does not match");

    TreeIndex index;
    index.info = get_tree_info(in, path);
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
        DataFile file;
        file.bytes = in.get<std::uint64_t>();
        file.generation = in.get<std::uint32_t>();
        index.data_files.push_back(file);
    }
    index.part_roots.clear();
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) index.part_roots.push_back(in.get<std::uint32_t>());
    const auto count = in.get<std::uint32_t>();
    if (in.left() < std::uint64_t{count} * node_bytes + 8)
        throw Error(ErrorCode::corrupt, path, "the index is too short for the number of nodes that it states");
    index.nodes.resize(count);
    for (Node& node : index.nodes) {
        node.parent = in.get<std::uint32_t>();
        node.children[0] = in.get<std::uint32_t>();
        node.children[1] = in.get<std::uint32_t>();
        const auto depth = in.get<std::uint32_t>();
        if (depth > 0xffff) throw Error(ErrorCode::corrupt, path, "a node is too deep");
        node.depth = static_cast<std::uint16_t>(depth);
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
    if (in.left() != 8) throw Error(ErrorCode::corrupt, path, "the index has bytes after its end");
    index.info.bytes = bytes.size();
    for (const DataFile& file : index.data_files) index.info.bytes += file.bytes;
    check(index, path);
    find_parts(index, path);
    return index;
}

}  // namespace pcm

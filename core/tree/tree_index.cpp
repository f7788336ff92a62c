#include "pcm/tree/tree_index.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/system/file.h"
#include "pcm/tree/index_version_3.h"
#include "pcm/tree/node_checks.h"
#include "pcm/tree/node_order.h"
#include "pcm/tree/node_page.h"

#include <cstdio>
#include <numeric>
#include <utility>

namespace pcm {
namespace {

// Node::part of all nodes, as it follows from the roots of the parts; what is false stays so, for the checks to find.
std::vector<std::uint32_t> parts_of(const std::vector<Node>& nodes, const std::vector<NodeId>& part_roots)
{
    std::vector<std::uint32_t> parts(nodes.size(), no_part);
    for (std::size_t part = 0; part < part_roots.size(); ++part)
        if (part_roots[part] < nodes.size()) parts[part_roots[part]] = static_cast<std::uint32_t>(part);
    for (std::size_t id = 1; id < nodes.size(); ++id)
        if (parts[id] == no_part && nodes[id].parent < id) parts[id] = parts[nodes[id].parent];
    return parts;
}

void check(const TreeIndex& index, const std::filesystem::path& path)
{
    const std::vector<Node>& nodes = index.nodes;
    const NodeChecks checks(index.info, index.data_files, index.part_roots, nodes.size(), path);
    const NodeChecks::NodeAt at = [&](NodeId id) -> const Node& { return nodes[id]; };
    for (NodeId id = 0; id < nodes.size(); ++id) checks.check(id, nodes[id], at);
    for (NodeId id = 0; id < nodes.size(); ++id) {
        for (const NodeId child : nodes[id].children)
            if (child != no_node) checks.check_child(id, nodes[child]);
        checks.check_points(id, nodes[id], at);
    }
}

TreeIndex decode_pages(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
{
    IndexHead head = decode_head(bytes, path);
    TreeIndex index;
    index.nodes.reserve(head.nodes);
    for (const NodePage& at : head.pages) {
        for (Node& node : decode_page(at, bytes.data() + at.offset, head.info.levels, path))
            index.nodes.push_back(std::move(node));
        index.pages.push_back(at.nodes);
    }
    index.info = std::move(head.info);
    index.data_files = std::move(head.data_files);
    index.part_roots = std::move(head.part_roots);
    check(index, path);
    const std::vector<LevelSummary> levels = summaries_of_levels(index.nodes, index.info.spacings);
    for (std::size_t k = 0; k < levels.size(); ++k)
        if (levels[k].nodes != head.levels[k].nodes || levels[k].points != head.levels[k].points)
            throw Error(ErrorCode::corrupt, path, "level " + std::to_string(k) + " has not the points of its nodes");
    return index;
}

}  // namespace

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

std::vector<LevelSummary> summaries_of_levels(const std::vector<Node>& nodes, const std::vector<double>& spacings)
{
    std::vector<LevelSummary> levels(spacings.size());
    for (const Node& node : nodes)
        for (std::size_t k = 0; k < node.level_points.size() && node.first_level + k < levels.size(); ++k) {
            LevelSummary& level = levels[node.first_level + k];
            level.nodes += node.level_points[k] ? 1 : 0;
            level.points += node.level_points[k];
        }
    std::uint64_t sum = 0;
    for (std::size_t k = 0; k < levels.size(); ++k) {
        levels[k].spacing = spacings[k];
        levels[k].points_to_here = sum += levels[k].points;
    }
    return levels;
}

std::vector<std::byte> encode_index(const TreeIndex& index)
{
    IndexHead head;
    head.info = index.info;
    head.data_files = index.data_files;
    if (!index.nodes.empty()) head.part_roots = index.part_roots;
    head.levels = summaries_of_levels(index.nodes, index.info.spacings);
    head.nodes = static_cast<std::uint32_t>(index.nodes.size());
    const std::vector<Node>& nodes = index.nodes;
    const std::vector<std::uint32_t> parts = parts_of(nodes, head.part_roots);
    std::vector<std::byte> pages;
    NodeId first = 0;
    const bool divided = std::accumulate(index.pages.begin(), index.pages.end(), std::size_t(0)) == nodes.size();
    for (const std::uint32_t count : divided ? index.pages : divide_into_pages(nodes)) {
        const std::vector<std::byte> bytes = encode_page(nodes, parts, first, count);
        head.pages.push_back({first, count, 0, bytes.size(), checksum(bytes.data(), bytes.size())});
        pages.insert(pages.end(), bytes.begin(), bytes.end());
        first += count;
    }
    std::vector<std::byte> bytes = encode_head(head);
    bytes.insert(bytes.end(), pages.begin(), pages.end());
    return bytes;
}

std::vector<std::byte> read_index(const ByteSource& file)
{
    std::vector<std::byte> bytes = read_beginning(file);
    if (version_of_index(bytes, file.path()) == index_version_without_pages) return read_index_of_version_3(file);
    const IndexHead head = read_head(file, bytes);  // throws where the file has not the size that it states
    if (const std::size_t have = bytes.size(); have < head.file_bytes) {
        bytes.resize(static_cast<std::size_t>(head.file_bytes));
        file.read_at(bytes.data() + have, bytes.size() - have, have);
    }
    return bytes;
}

TreeIndex decode_index(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
{
    if (version_of_index(bytes, path) == index_version) return decode_pages(bytes, path);
    TreeIndex index = decode_index_of_version_3(bytes, path);
    const std::vector<std::uint32_t> parts = parts_of(index.nodes, index.part_roots);
    for (std::size_t id = 0; id < parts.size(); ++id) index.nodes[id].part = parts[id];
    check(index, path);
    return index;
}

OpenIndex in_memory(TreeIndex index)
{
    auto head = std::make_shared<IndexHead>();
    head->levels = summaries_of_levels(index.nodes, index.info.spacings);
    head->nodes = static_cast<std::uint32_t>(index.nodes.size());
    head->info = std::move(index.info);
    head->data_files = std::move(index.data_files);
    head->part_roots = std::move(index.part_roots);
    return {std::move(head), NodeTable(std::move(index.nodes))};
}

OpenIndex open_index(std::shared_ptr<const ByteSource> file)
{
    std::vector<std::byte> beginning = read_beginning(*file);
    if (version_of_index(beginning, file->path()) == index_version_without_pages)
        return in_memory(decode_index(read_index_of_version_3(*file), file->path()));
    const auto head = std::make_shared<const IndexHead>(read_head(*file, beginning));
    return {head, NodeTable(head, std::move(file), beginning)};
}

}  // namespace pcm

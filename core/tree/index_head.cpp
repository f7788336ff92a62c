#include "pcm/tree/index_head.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/node_page.h"

#include <algorithm>
#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr std::size_t version_at = sizeof index_magic, head_bytes_at = version_at + 4, info_at = head_bytes_at + 8;
constexpr std::size_t page_bytes = 20, checksum_bytes = 8;
// What the first read of an index takes: the head and the first page of any but the largest trees.
constexpr std::size_t first_read = 256 * 1024;

std::uint64_t stated_checksum(const std::vector<std::byte>& bytes, std::size_t size)
{
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + size - checksum_bytes, checksum_bytes);
    return stored;
}

// Whether the bytes would be those of an index, or of its head, with this version and this size.
bool fits_version(std::vector<std::byte> bytes, std::uint32_t version, std::uint64_t size)
{
    if (size < info_at + checksum_bytes || size > bytes.size()) return false;
    std::memcpy(bytes.data() + version_at, &version, sizeof version);
    return stated_checksum(bytes, static_cast<std::size_t>(size)) ==
           checksum(bytes.data(), static_cast<std::size_t>(size) - checksum_bytes);
}

std::uint64_t stated_head_bytes(const std::vector<std::byte>& beginning, const std::filesystem::path& path)
{
    std::uint64_t bytes = 0;
    if (beginning.size() >= info_at) std::memcpy(&bytes, beginning.data() + head_bytes_at, sizeof bytes);
    if (bytes < info_at + checksum_bytes) throw Error(ErrorCode::corrupt, path, "the index is too short for its head");
    return bytes;
}

void get_levels(ByteReader& in, IndexHead& head)
{
    std::uint64_t sum = 0;
    for (std::size_t k = 0; k < head.info.levels; ++k) {
        LevelSummary level;
        level.nodes = in.get<std::uint64_t>();
        level.points = in.get<std::uint64_t>();
        level.points_to_here = sum += level.points;
        level.spacing = head.info.spacings[k];
        head.levels.push_back(level);
    }
}

void get_pages(ByteReader& in, IndexHead& head, const std::filesystem::path& path)
{
    head.nodes = in.get<std::uint32_t>();
    const auto pages = in.get<std::uint32_t>();
    if (in.left() / page_bytes < pages)
        throw Error(ErrorCode::corrupt, path, "the index is too short for the number of pages that it states");
    head.pages.resize(pages);
    std::uint64_t nodes = 0;
    for (NodePage& page : head.pages) {
        page.nodes = in.get<std::uint32_t>();
        page.bytes = in.get<std::uint64_t>();
        page.checksum = in.get<std::uint64_t>();
        page.first = static_cast<NodeId>(nodes);
        page.offset = head.file_bytes;
        nodes += page.nodes;
        if (page.nodes == 0 || page.nodes > most_nodes_of_page || nodes > head.nodes ||
            page.bytes < page.nodes * std::uint64_t(node_bytes) ||
            page.bytes > page.nodes * (node_bytes + head.info.levels * sizeof(std::uint32_t)))
            throw Error(ErrorCode::corrupt, path, "a page of the index has a false size");
        head.file_bytes += page.bytes;
    }
    if (nodes != head.nodes) throw Error(ErrorCode::corrupt, path, "the pages of the index do not hold its nodes");
}

// `file_bytes`: the size of the whole index file.
IndexHead get_head(const std::vector<std::byte>& bytes, std::size_t head_bytes, std::uint64_t file_bytes,
                   const std::filesystem::path& path)
{
    if (stated_checksum(bytes, head_bytes) != checksum(bytes.data(), head_bytes - checksum_bytes))
        throw Error(ErrorCode::corrupt, path, "the checksum of the index does not match");
    ByteReader in(bytes.data(), head_bytes - checksum_bytes, path);
    in.get_bytes(info_at);
    IndexHead head;
    head.file_bytes = head_bytes;
    head.info = get_tree_info(in, path);
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) {
        DataFile file;
        file.bytes = in.get<std::uint64_t>();
        file.generation = in.get<std::uint32_t>();
        head.data_files.push_back(file);
    }
    for (auto n = in.get<std::uint32_t>(); n > 0; --n) head.part_roots.push_back(in.get<std::uint32_t>());
    get_levels(in, head);
    get_pages(in, head, path);
    if (in.left() != 0) throw Error(ErrorCode::corrupt, path, "the head of the index has bytes after its end");
    if (head.file_bytes != file_bytes)
        throw Error(ErrorCode::corrupt, path,
                    "the index has " + std::to_string(file_bytes) + " bytes; with the pages that it states it has " +
                        std::to_string(head.file_bytes));
    head.info.bytes = head.file_bytes;
    for (const DataFile& file : head.data_files) head.info.bytes += file.bytes;
    return head;
}

}  // namespace

std::vector<std::byte> encode_head(const IndexHead& head)
{
    ByteWriter out;
    out.put_bytes(index_magic, sizeof index_magic);
    out.put(index_version);
    out.put(std::uint64_t(0));
    put_tree_info(out, head.info);
    out.put(static_cast<std::uint32_t>(head.data_files.size()));
    for (const DataFile& file : head.data_files) {
        out.put(file.bytes);
        out.put(file.generation);
    }
    out.put(static_cast<std::uint32_t>(head.part_roots.size()));
    for (const NodeId root : head.part_roots) out.put(root);
    for (const LevelSummary& level : head.levels) {
        out.put(level.nodes);
        out.put(level.points);
    }
    out.put(head.nodes);
    out.put(static_cast<std::uint32_t>(head.pages.size()));
    for (const NodePage& page : head.pages) {
        out.put(page.nodes);
        out.put(page.bytes);
        out.put(page.checksum);
    }
    out.set(head_bytes_at, static_cast<std::uint64_t>(out.size() + checksum_bytes));
    out.put(checksum(out.bytes().data(), out.size()));
    return std::move(out.bytes());
}

std::vector<std::byte> read_beginning(const ByteSource& file)
{
    std::vector<std::byte> bytes(static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), first_read)));
    file.read_at(bytes.data(), bytes.size(), 0);
    return bytes;
}

std::uint32_t version_of_index(const std::vector<std::byte>& beginning, const std::filesystem::path& path)
{
    if (beginning.size() < info_at || std::memcmp(beginning.data(), index_magic, sizeof index_magic) != 0)
        throw Error(ErrorCode::not_a_tree, path, "this is not the index of a point cloud tree");
    std::uint32_t found;
    std::memcpy(&found, beginning.data() + version_at, sizeof found);
    if (found == index_version || found == index_version_without_pages) return found;
    std::uint64_t head_bytes;
    std::memcpy(&head_bytes, beginning.data() + head_bytes_at, sizeof head_bytes);
    if (fits_version(beginning, index_version, head_bytes) ||
        fits_version(beginning, index_version_without_pages, beginning.size()))
        throw Error(ErrorCode::corrupt, path, "the version in the index is damaged");
    throw Error(ErrorCode::unsupported, path,
                "tree format version " + std::to_string(found) + ", this program reads versions " +
                    std::to_string(index_version_without_pages) + " and " + std::to_string(index_version),
                found < index_version ? "build the tree again from its files" : "");
}

IndexHead read_head(const ByteSource& file, std::vector<std::byte>& beginning)
{
    const std::uint64_t size = file.size();
    const std::uint64_t head_bytes = stated_head_bytes(beginning, file.path());
    if (head_bytes > size) throw Error(ErrorCode::corrupt, file.path(), "the index is too short for its head");
    if (const std::size_t have = beginning.size(); head_bytes > have) {
        beginning.resize(static_cast<std::size_t>(head_bytes));
        file.read_at(beginning.data() + have, beginning.size() - have, have);
    }
    IndexHead head = get_head(beginning, static_cast<std::size_t>(head_bytes), size, file.path());
    if (head.info.points != (head.levels.empty() ? 0 : head.levels.back().points_to_here))
        throw Error(ErrorCode::corrupt, file.path(), "the levels do not hold as many points as the tree");
    return head;
}

IndexHead decode_head(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
{
    const std::uint64_t head_bytes = stated_head_bytes(bytes, path);
    if (head_bytes > bytes.size()) throw Error(ErrorCode::corrupt, path, "the index is too short for its head");
    return get_head(bytes, static_cast<std::size_t>(head_bytes), bytes.size(), path);
}

}  // namespace pcm

#include "pcm/tree/index_version_3.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"
#include "pcm/tree/about.h"
#include "pcm/tree/node_page.h"
#include "pcm/tree/parse_beginning.h"

#include <cstring>

namespace pcm {
namespace {

constexpr std::size_t bytes_before_info = sizeof index_magic + 4, bytes_of_data_file = 12;

// The largest size that the counts at the beginning of an index allow.
std::uint64_t most_bytes_of(const ByteSource& file)
{
    return parse_beginning(file, [&](ByteReader& in) {
        in.get_bytes(bytes_before_info);
        const std::uint64_t levels = get_tree_info(in, file.path()).levels;
        in.get_bytes(in.get<std::uint32_t>() * bytes_of_data_file);
        in.get_bytes(in.get<std::uint32_t>() * sizeof(NodeId));
        const std::uint64_t nodes = in.get<std::uint32_t>();
        return in.position() + nodes * (node_bytes_without_part + levels * sizeof(std::uint32_t)) +
               sizeof(std::uint64_t);
    });
}

}  // namespace

std::vector<std::byte> read_index_of_version_3(const ByteSource& file)
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

TreeIndex decode_index_of_version_3(const std::vector<std::byte>& bytes, const std::filesystem::path& path)
{
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + bytes.size() - 8, 8);
    if (stored != checksum(bytes.data(), bytes.size() - 8))
        throw Error(ErrorCode::corrupt, path, "the checksum of the index does not match");
    ByteReader in(bytes.data(), bytes.size() - 8, path);
    in.get_bytes(bytes_before_info);
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
    index.nodes = get_nodes(in, count, index.info.levels, false, path);
    if (in.left() != 0) throw Error(ErrorCode::corrupt, path, "the index has bytes after its end");
    index.info.bytes = bytes.size();
    for (const DataFile& file : index.data_files) index.info.bytes += file.bytes;
    return index;
}

}  // namespace pcm

#include "pcm/update/chunk_scan.h"

#include "pcm/bpc/chunk_header.h"
#include "pcm/system/error.h"
#include "pcm/system/text.h"
#include "pcm/tree/tree_index.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <utility>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint32_t most_data_files = 1'000'000;  // bounds the list of files, whatever their names are

// Each generation has data files of its own, and each but the first may add a part. Other numbers are damage, even when
// the checksum matches.
void check_numbers(std::uint32_t generation, std::uint32_t parts, std::uint32_t file)
{
    if (generation == 0 || generation > file + std::uint64_t(1) || parts > generation)
        throw Error(ErrorCode::corrupt, {},
                    "generation " + std::to_string(generation) + " and " + std::to_string(parts) +
                        " parts cannot be in data file " + std::to_string(file));
}

// Searches damaged bytes for places where a chunk or a commit record may begin. A place that cannot be the start of a
// header is skipped without reading the whole header: damaged bytes may look like the start of a header many times.
class Beginnings {
public:
    explicit Beginnings(const File& file, std::uint64_t end) : file_(file), end_(end), bytes_(std::size_t(1) << 20) {}

    // The next such place from `at` on; the end when there is none.
    std::uint64_t next(std::uint64_t at)
    {
        for (; at + head <= end_; ++at) {
            if (at < from_ || at + head > from_ + filled_) {
                from_ = at;
                filled_ = file_.read_some_at(
                    bytes_.data(), static_cast<std::size_t>(std::min<std::uint64_t>(bytes_.size(), end_ - at)), at);
                if (filled_ < head) break;
            }
            const char* const found = bytes_.data() + (at - from_);
            if (std::memcmp(found, "BPC", 3) != 0) continue;
            if (found[3] == '1' && number<std::uint16_t>(found + 4) == 3 &&
                number<std::uint32_t>(found + 24) <= most_header)
                return at;
            if (found[3] == 'G' && number<std::uint16_t>(found + 4) == 1 &&
                number<std::uint32_t>(found + 8) <= most_header)
                return at;
        }
        return end_;
    }

private:
    static constexpr std::size_t head = 28;
    static constexpr std::uint32_t most_header = std::uint32_t(1) << 20;
    template <class T>
    static T number(const char* at)
    {
        T value;
        std::memcpy(&value, at, sizeof value);
        return value;
    }
    const File& file_;
    const std::uint64_t end_;
    std::vector<char> bytes_;
    std::uint64_t from_ = 0;
    std::size_t filled_ = 0;
};

// The chunk or tombstone with this header, of the expected kind, at byte `at` of data file number `file`.
FoundChunk chunk_of(const BpcHeader& header, std::uint32_t file, std::uint64_t at, std::optional<ChunkKind>& expected)
{
    if (!expected) expected = ChunkKind{header.schema, header.grid};
    if (expected->schema.is_beginning_of(header.schema)) expected->schema = header.schema;
    const ChunkIdentity& identity = *header.identity;
    check_numbers(identity.generation, identity.part == no_part ? identity.part : identity.part + 1, file);
    FoundChunk chunk;
    chunk.generation = identity.generation;
    PartNode& node = chunk.node;
    node.part = identity.part;
    node.path = identity.path;
    node.points = header.points;
    node.first_level = identity.first_level;
    node.level_points = identity.level_points;
    node.spacing = identity.spacing;
    if (header.points) {
        node.box = header.box;
        node.extent = {file, at, header.total_bytes, header.header_bytes};
    }
    return chunk;
}

}  // namespace

bool is_of(const BpcHeader& header, const ChunkKind& expected)
{
    return header.identity && expected.grid == header.grid &&
           (header.schema.is_beginning_of(expected.schema) || expected.schema.is_beginning_of(header.schema));
}

std::vector<FoundFile> list_data_files(const fs::path& folder)
{
    std::vector<FoundFile> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder)) {
        const std::string name = entry.path().filename().string();
        FoundFile file;
        if (std::sscanf(name.c_str(), "chunks-%u.bpc", &file.number) != 1 || name != data_file_name(file.number) ||
            file.number >= most_data_files || !entry.is_regular_file(error))
            continue;
        file.path = entry.path();
        files.push_back(std::move(file));
    }
    std::sort(files.begin(), files.end(), [](const FoundFile& a, const FoundFile& b) { return a.number < b.number; });
    return files;
}

void scan(FoundFile& found, std::optional<ChunkKind>& expected, const std::function<void(std::uint64_t)>& tick)
{
    const File file(found.path, File::Mode::read);
    found.size = file.size();
    std::uint64_t at = 0, lost_from = 0;
    bool lost = false;
    std::string why;
    Beginnings beginnings(file, found.size);
    const auto report_lost = [&](std::uint64_t to) {
        if (lost)
            found.faults.push_back(found.path.filename().string() + ": bytes " + grouped(lost_from) + " to " +
                                   grouped(to - 1) + " are not a whole chunk: " + why);
        lost = false;
    };
    while (at < found.size) {
        std::uint64_t bytes = 0;
        try {
            if (auto commit = read_commit(file, at, found.size - at, bytes)) {
                check_numbers(commit->generation, commit->parts, found.number);
                found.commit = std::move(commit);
            } else {
                const BpcHeader header = read_header(file, at, found.size - at);
                if (!header.identity || (expected && !is_of(header, *expected))) {
                    ++found.other_chunks;
                    throw Error(ErrorCode::corrupt, {},
                                header.identity ? "it belongs to another tree" : "it is not a chunk of a tree");
                }
                bytes = header.total_bytes;
                found.chunks.push_back(chunk_of(header, found.number, at, expected));
            }
            report_lost(at);
        } catch (const Error& error) {
            if (error.code() == ErrorCode::io) throw;
            if (!lost) {
                lost = true;
                lost_from = at;
                why = error.what();
            }
            bytes = beginnings.next(at + 1) - at;
        }
        at += bytes;
        tick(bytes);
    }
    report_lost(found.size);
}

}  // namespace pcm

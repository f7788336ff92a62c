#include "pcm/bpc/commit_record.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"

#include <cstring>
#include <string>

namespace pcm {
namespace {

constexpr char magic[4] = {'B', 'P', 'C', 'G'};
constexpr std::uint16_t record_version = 1;
constexpr std::size_t record_head_bytes = 44, file_bytes = 12, checksum_bytes = 8;

CommitRecord decode(const std::vector<std::byte>& bytes)
{
    std::uint64_t stored;
    std::memcpy(&stored, bytes.data() + bytes.size() - checksum_bytes, checksum_bytes);
    if (stored != checksum(bytes.data(), bytes.size() - checksum_bytes))
        throw Error(ErrorCode::corrupt, {}, "its checksum does not match");
    const std::filesystem::path unnamed;
    ByteReader in(bytes.data(), bytes.size() - checksum_bytes, unnamed);
    in.get_bytes(sizeof magic);
    const auto found = in.get<std::uint16_t>();
    if (found != record_version)
        throw Error(ErrorCode::unsupported, {},
                    "its version is " + std::to_string(found) + ", this program reads version 1");
    CommitRecord record;
    const auto flags = in.get<std::uint16_t>();
    if (flags > 1) throw Error(ErrorCode::corrupt, {}, "it has invalid values");
    record.coverage_kept = flags & 1;
    in.get_bytes(4);
    record.generation = in.get<std::uint32_t>();
    record.points = in.get<std::uint64_t>();
    record.content_hash = in.get<std::uint64_t>();
    record.parts = in.get<std::uint32_t>();
    record.chunks = in.get<std::uint32_t>();
    const auto files = in.get<std::uint32_t>();
    if (record.generation == 0 || in.left() != std::uint64_t{files} * file_bytes)
        throw Error(ErrorCode::corrupt, {}, "it has invalid values");
    for (std::uint32_t i = 0; i < files; ++i) {
        CommitRecord::DataFile file;
        file.bytes = in.get<std::uint64_t>();
        file.generation = in.get<std::uint32_t>();
        record.data_files.push_back(file);
    }
    return record;
}

}  // namespace

std::size_t commit_bytes(std::size_t data_files)
{
    return record_head_bytes + data_files * file_bytes + checksum_bytes;
}

std::vector<std::byte> encode_commit(const CommitRecord& record)
{
    ByteWriter out;
    out.put_bytes(magic, sizeof magic);
    out.put(record_version);
    out.put(static_cast<std::uint16_t>(record.coverage_kept));
    out.put(static_cast<std::uint32_t>(commit_bytes(record.data_files.size())));
    out.put(record.generation);
    out.put(record.points);
    out.put(record.content_hash);
    out.put(record.parts);
    out.put(record.chunks);
    out.put(static_cast<std::uint32_t>(record.data_files.size()));
    for (const CommitRecord::DataFile& file : record.data_files) {
        out.put(file.bytes);
        out.put(file.generation);
    }
    out.put(checksum(out.bytes().data(), out.size()));
    return std::move(out.bytes());
}

std::optional<CommitRecord> read_commit(const ByteSource& file, std::uint64_t offset, std::uint64_t available,
                                        std::uint64_t& bytes)
{
    char head[12];
    if (available < sizeof head) return std::nullopt;
    file.read_at(head, sizeof head, offset);
    if (std::memcmp(head, magic, sizeof magic) != 0) return std::nullopt;
    try {
        std::uint32_t size;
        std::memcpy(&size, head + 8, 4);
        if (size < commit_bytes(0)) throw Error(ErrorCode::corrupt, {}, "its length is impossible");
        if (size > available)
            throw Error(ErrorCode::truncated, {},
                        "it states " + std::to_string(size) + " bytes; " + std::to_string(available) + " are left");
        std::vector<std::byte> record(size);
        file.read_at(record.data(), record.size(), offset);
        bytes = size;
        return decode(record);
    } catch (const Error& error) {
        if (!error.path().empty()) throw;
        throw Error(error.code(), file.path(), "commit record at byte " + std::to_string(offset) + ": " + error.what());
    }
}

}  // namespace pcm

#include "pcm/build/levels/list_file.h"

#include "pcm/bpc/checksum.h"
#include "pcm/build/bins/scratch_file.h"

#include <system_error>

namespace pcm {

ListFile::ListFile(const std::filesystem::path& path, File::Mode mode)
    : file_(path, mode), remove_(mode == File::Mode::create_new)
{
}

ListFile::~ListFile()
{
    std::error_code ignored;
    if (remove_) std::filesystem::remove(file_.path(), ignored);
}

bool ListFile::reopen(std::uint64_t bytes)
{
    end_ = bytes;
    return bytes <= file_.size();
}

std::uint64_t ListFile::append(const void* data, std::size_t bytes)
{
    std::uint64_t offset;
    {
        const std::lock_guard lock(mutex_);
        offset = end_;
        end_ += bytes;
    }
    file_.write_at(data, bytes, offset);
    return offset;
}

ListFile::Place ListFile::write(const std::vector<std::uint32_t>& indices)
{
    const std::size_t bytes = indices.size() * sizeof indices[0];
    return {append(indices.data(), bytes), static_cast<std::uint32_t>(indices.size()), checksum(indices.data(), bytes)};
}

std::uint64_t ListFile::write(const std::vector<std::uint8_t>& bytes) { return append(bytes.data(), bytes.size()); }

std::vector<std::uint32_t> ListFile::read(const Place& place) const
{
    std::vector<std::uint32_t> indices(place.count);
    const std::size_t bytes = indices.size() * sizeof indices[0];
    file_.read_at(indices.data(), bytes, place.offset);
    if (checksum(indices.data(), bytes) != place.checksum) throw scratch_changed(file_.path(), place.offset);
    return indices;
}

std::vector<std::uint8_t> ListFile::read(std::uint64_t offset, std::size_t count) const
{
    std::vector<std::uint8_t> bytes(count);
    file_.read_at(bytes.data(), count, offset);
    return bytes;
}

}  // namespace pcm

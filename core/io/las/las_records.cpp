#include "pcm/io/las/las_records.h"

#include <algorithm>
#include <vector>

namespace pcm::las {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

class PlainRecords final : public RecordSource {
public:
    PlainRecords(const File& file, const Header& header) : file_(file), header_(header) {}

    RecordSpan next(std::size_t most) override
    {
        const std::size_t stride = header_.record_length;
        const std::size_t count = std::clamp<std::size_t>(buffer_bytes / stride, 1, most);
        if (buffer_.size() < count * stride) buffer_.resize(count * stride);
        file_.read_at(buffer_.data(), count * stride, header_.point_offset + next_ * stride);
        next_ += count;
        return {buffer_.data(), count};
    }
    bool seekable() const override { return true; }
    void seek(std::uint64_t index) override { next_ = index; }

private:
    const File& file_;
    const Header& header_;
    std::uint64_t next_ = 0;
    std::vector<std::byte> buffer_;
};

}  // namespace

std::unique_ptr<RecordSource> plain_records(const File& file, const Header& header)
{
    return std::make_unique<PlainRecords>(file, header);
}

}  // namespace pcm::las

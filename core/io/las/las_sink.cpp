#include "pcm/io/las/las_sink.h"

#include <algorithm>
#include <cstring>

namespace pcm::las {
namespace {

class PlainSink final : public RecordSink {
public:
    PlainSink(OutputFile& out, std::size_t record_length) : out_(out), record_length_(record_length) {}

    RecordRoom room(std::size_t most) override
    {
        // Encoded field by field: records stay in the first-level cache between the fields.
        const std::size_t count = std::clamp<std::size_t>(16384 / record_length_, 1, most);
        std::byte* const records = out_.extend(count * record_length_);
        std::memset(records, 0, count * record_length_);
        return {records, count};
    }
    void finish() override {}

private:
    OutputFile& out_;
    std::size_t record_length_;
};

}  // namespace

std::unique_ptr<RecordSink> plain_sink(OutputFile& out, std::size_t record_length)
{
    return std::make_unique<PlainSink>(out, record_length);
}

}  // namespace pcm::las

#include "pcm/build/journal.h"

#include "pcm/bpc/checksum.h"
#include "pcm/system/error.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace pcm {
namespace {

struct Head {
    std::uint32_t kind = 0, zero = 0;
    std::uint64_t bytes = 0;
    std::uint64_t checksum = 0;
};

std::uint64_t checksum_of(const Head& head, const std::byte* bytes)
{
    std::uint64_t both[2] = {checksum(&head, offsetof(Head, checksum)), checksum(bytes, head.bytes)};
    return checksum(both, sizeof both);
}

}  // namespace

Journal::Journal(const std::filesystem::path& path)
{
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
        file_ = File(path, File::Mode::create_new);
        return;
    }
    file_ = File(path, File::Mode::change);
    const std::uint64_t size = file_.size();
    while (size - end_ >= sizeof(Head)) {
        Head head;
        file_.read_at(&head, sizeof head, end_);
        if (head.zero != 0 || head.bytes > size - end_ - sizeof head) break;
        Record record;
        record.kind = head.kind;
        record.bytes.resize(head.bytes);
        file_.read_at(record.bytes.data(), record.bytes.size(), end_ + sizeof head);
        if (checksum_of(head, record.bytes.data()) != head.checksum) break;
        starts_.push_back(end_);
        records_.push_back(std::move(record));
        end_ += sizeof head + head.bytes;
    }
    if (end_ != size) truncate(end_);
}

void Journal::truncate(std::uint64_t end)
{
    int result;
    do result = ::ftruncate(file_.descriptor(), static_cast<off_t>(end));
    while (result != 0 && errno == EINTR);
    if (result != 0) throw Error::from_errno(errno, file_.path(), "removing an incomplete record");
    file_.sync();
    end_ = end;
}

void Journal::cut(std::size_t from)
{
    if (from >= records_.size()) return;
    truncate(starts_[from]);
    records_.resize(from);
    starts_.resize(from);
}

void Journal::append(std::uint32_t kind, const std::vector<std::byte>& bytes)
{
    Head head;
    head.kind = kind;
    head.bytes = bytes.size();
    head.checksum = checksum_of(head, bytes.data());
    std::vector<std::byte> record(sizeof head + bytes.size());
    std::memcpy(record.data(), &head, sizeof head);
    if (!bytes.empty()) std::memcpy(record.data() + sizeof head, bytes.data(), bytes.size());
    file_.write_at(record.data(), record.size(), end_);
    file_.sync();
    end_ += record.size();
}

}  // namespace pcm

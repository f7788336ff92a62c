#include "tree/data_files.h"

#include "tree/tree_index.h"

#include <algorithm>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t data_file_limit = std::uint64_t(1) << 30;  // a new data file is begun beyond this
constexpr std::uint16_t front_depth = 6;  // chunks above this depth lie together at the front, parents first

}  // namespace

DataFiles::DataFiles(const fs::path& folder, const fs::path& work, std::uint32_t first)
    : folder_(folder), first_(first), front_(work / "front.tmp", File::Mode::create_new)
{
    bytes_.push_back(0);  // the first file is the front, written last
}

void DataFiles::append(Draft& draft, const std::byte* bytes, std::size_t size)
{
    if (draft.path.depth <= front_depth) {
        front_.write_at(bytes, size, front_bytes_);
        draft.extent.file = first_;
        draft.extent.offset = front_bytes_;
        front_bytes_ += size;
        fronted_.push_back(&draft);
        return;
    }
    if (!file_.is_open() || bytes_.back() + size > data_file_limit) {
        finish_file();
        file_ = File(folder_ / data_file_name(first_ + static_cast<std::uint32_t>(bytes_.size())), File::Mode::create_new);
        bytes_.push_back(0);
    }
    file_.write_at(bytes, size, bytes_.back());
    draft.extent.file = first_ + static_cast<std::uint32_t>(bytes_.size() - 1);
    draft.extent.offset = bytes_.back();
    bytes_.back() += size;
}

void DataFiles::finish()
{
    finish_file();
    std::sort(fronted_.begin(), fronted_.end(), [](const Draft* p, const Draft* q) {
        if (p->path.depth != q->path.depth) return p->path.depth < q->path.depth;
        return p->path.bits < q->path.bits;
    });
    File front(folder_ / data_file_name(first_), File::Mode::create_new);
    std::vector<std::byte> buffer;
    for (Draft* draft : fronted_) {
        buffer.resize(draft->extent.bytes);
        front_.read_at(buffer.data(), buffer.size(), draft->extent.offset);
        front.write_at(buffer.data(), buffer.size(), bytes_[0]);
        draft->extent.offset = bytes_[0];
        bytes_[0] += buffer.size();
    }
    front.sync();
    front.close();
    const fs::path front_path = front_.path();
    front_.close();
    fs::remove(front_path);
}

void DataFiles::finish_file()
{
    if (!file_.is_open()) return;
    file_.sync();
    file_.close();
}

}  // namespace pcm

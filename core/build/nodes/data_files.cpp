#include "pcm/build/nodes/data_files.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/system/error.h"
#include "pcm/tree/tree_index.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace pcm {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t data_file_limit = std::uint64_t(1) << 30;  // larger ones are not begun
// The front has all chunks of the levels that have at most this many points together: of about 2 to 8 million, since a
// level has three to four times the points of the one before. A view of the whole cloud draws one or two million.
constexpr std::uint64_t front_points = 8'000'000;

std::shared_ptr<File> cut_off(const fs::path& path, std::uint64_t bytes)
{
    auto file = std::make_shared<File>(path, File::Mode::change);
    if (file->size() < bytes)
        throw Error(
            ErrorCode::truncated, path,
            "the file has " + std::to_string(file->size()) + " bytes, " + std::to_string(bytes) + " were expected");
    int result;
    do result = ::ftruncate(file->descriptor(), static_cast<off_t>(bytes));
    while (result != 0 && errno == EINTR);
    if (result != 0) throw Error::from_errno(errno, path, "truncating the file");
    return file;
}

// Nodes before those below them, and those below a node's first child before those below its second one.
bool comes_before(const NodePath& a, const NodePath& b)
{
    const auto side = [](const NodePath& path, unsigned depth) { return path.bits[depth / 64] >> (depth % 64) & 1; };
    for (unsigned depth = 0; depth < std::min(a.depth, b.depth); ++depth)
        if (side(a, depth) != side(b, depth)) return side(a, depth) < side(b, depth);
    return a.depth < b.depth;
}

}  // namespace

DataFiles::DataFiles(const fs::path& folder, const fs::path& work, std::uint32_t first)
    : folder_(folder), front_path_(work / "front.tmp"), first_(first), places_(first)
{
}

void ChunkPlaces::choose_front(const std::vector<std::uint64_t>& points_of_levels)
{
    std::uint64_t points = 0;
    for (std::size_t level = 0; level < points_of_levels.size(); ++level) {
        points += points_of_levels[level];
        if (points <= front_points) front_level_ = static_cast<std::uint16_t>(level);
    }
}

void ChunkPlaces::place(Draft& draft, std::uint64_t size)
{
    if (bytes_.size() == 1 || bytes_.back() + size > data_file_limit) bytes_.push_back(0);
    draft.extent.file = first_ + static_cast<std::uint32_t>(bytes_.size() - 1);
    draft.extent.offset = bytes_.back();
    bytes_.back() += size;
}

void sort_front(std::vector<Draft*>& front)
{
    std::sort(front.begin(), front.end(), [](const Draft* p, const Draft* q) {
        if (p->first_level != q->first_level) return p->first_level < q->first_level;
        return comes_before(p->path, q->path);
    });
}

void DataFiles::append(Draft& draft, const std::byte* bytes, std::size_t size)
{
    appended_ += size;
    if (places_.is_in_front(draft)) {
        if (!front_) front_ = std::make_shared<File>(front_path_, File::Mode::create_or_truncate);
        front_->write_at(bytes, size, front_bytes_);
        draft.extent.file = first_;
        draft.extent.offset = front_bytes_;
        front_bytes_ += size;
        fronted_.push_back(&draft);
        return;
    }
    places_.place(draft, size);
    if (draft.extent.offset == 0) {
        finish_file();
        file_ = std::make_shared<File>(folder_ / data_file_name(draft.extent.file), File::Mode::create_or_truncate);
    }
    file_->write_at(bytes, size, draft.extent.offset);
}

void DataFiles::finish()
{
    finish_file();
    sort_front(fronted_);
    File front(folder_ / data_file_name(first_), File::Mode::create_or_truncate);
    std::vector<std::byte> buffer;
    std::uint64_t& end = places_.bytes()[0];
    for (Draft* draft : fronted_) {
        buffer.resize(draft->extent.bytes);
        front_->read_at(buffer.data(), buffer.size(), draft->extent.offset);
        front.write_at(buffer.data(), buffer.size(), end);
        draft->extent.offset = end;
        end += buffer.size();
    }
    front.sync();
    front.close();
    front_.reset();
}

void DataFiles::finish_file()
{
    if (!file_) return;
    file_->sync();
    file_.reset();
}

void DataFiles::save(ByteWriter& out) const
{
    out.put(front_bytes_);
    out.put(static_cast<std::uint64_t>(bytes().size()));
    for (const std::uint64_t size : bytes()) out.put(size);
}

void DataFiles::load(ByteReader& in)
{
    front_bytes_ = in.get<std::uint64_t>();
    const auto files = in.get<std::uint64_t>();
    std::vector<std::uint64_t>& bytes = places_.bytes();
    bytes.clear();
    for (std::uint64_t i = 0; i < files; ++i) bytes.push_back(in.get<std::uint64_t>());
    if (bytes.empty()) throw Error(ErrorCode::corrupt, folder_, "a checkpoint names no data files");
    bytes[0] = 0;
    if (front_bytes_) front_ = cut_off(front_path_, front_bytes_);
    for (std::size_t number = 1; number < bytes.size(); ++number)
        file_ = cut_off(folder_ / data_file_name(first_ + static_cast<std::uint32_t>(number)), bytes[number]);
}

void DataFiles::written(Draft& draft)
{
    if (draft.extent.bytes && draft.extent.file == first_) fronted_.push_back(&draft);
}

std::function<void()> DataFiles::syncer() const
{
    return [folder = folder_, front = front_, file = file_] {
        if (front) front->sync();
        if (file) file->sync();
        sync_folder(folder);
    };
}

}  // namespace pcm

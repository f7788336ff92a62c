#include "pcm/cluster/filter/selected_points.h"

#include "pcm/bpc/byte_order.h"
#include "pcm/io/pipe/batch_shape.h"

#include <algorithm>
#include <utility>

namespace pcm {
namespace {

constexpr const char* selected_stage = "selected";

// Calls f(column's bytes, bytes of a point) for each column of a batch.
template <class Batch, class F>
void for_each_column(Batch& batch, const F& f)
{
    for (std::size_t a = 0; a < 3; ++a) {
        if (batch.gridded)
            f(batch.grid_xyz[a].data(), sizeof(std::int32_t));
        else
            f(batch.xyz[a].data(), sizeof(double));
    }
    for (auto& column : batch.attributes) f(column.data(), column.point_bytes());
}

}  // namespace

void begin_selected(const JobFolder& jobs) { jobs.begin(selected_stage); }

bool is_selected(const JobFolder& jobs, std::size_t job) { return jobs.is_done({selected_stage, job}); }

void write_selected(const JobFolder& jobs, std::size_t job, TreeReader& reader, std::size_t first, std::size_t end)
{
    const JobFolder::Key key{selected_stage, job};
    const std::filesystem::path path = jobs.unfinished(key);
    std::uint64_t at = 0;
    ByteWriter sizes;
    {
        File file(path, File::Mode::create_new);
        reader.keep_nodes(first, end);
        for (PointBatch batch; reader.read(batch, default_batch_points);) {
            for_each_column(batch, [&](const auto* column, std::size_t width) {
                file.write_at(column, batch.size * width, at);
                at += batch.size * width;
            });
            sizes.put(static_cast<std::uint32_t>(batch.size));
        }
    }
    jobs.finish(key, path, at, sizes.bytes());
}

SelectedPoints::SelectedPoints(std::unique_ptr<PointReader> tree, const JobFolder& jobs, std::size_t count)
    : tree_(std::move(tree)), jobs_(jobs), count_(count)
{
}

bool SelectedPoints::next_batch()
{
    offset_ += bytes_;
    while (batch_ == sizes_.size()) {
        if (job_ == count_) return false;
        const JobFolder::Key key{selected_stage, job_++};
        const std::vector<std::byte> record = jobs_.record(key);
        file_ = File(jobs_.file(key), File::Mode::read);
        ByteReader in(record.data(), record.size(), file_.path());
        sizes_.clear();
        while (in.left()) sizes_.push_back(in.get<std::uint32_t>());
        batch_ = 0;
        offset_ = 0;
    }
    points_ = sizes_[batch_++];
    next_ = 0;
    bytes_ = 0;
    return true;
}

bool SelectedPoints::read(PointBatch& batch, std::size_t max_points)
{
    const bool gridded = info().grid.has_value();
    if (next_ == points_ && !next_batch()) {
        next_ = points_ = 0;
        bytes_ = 0;
        shape_batch(batch, info().schema, gridded, 0);
        return false;
    }
    const std::size_t count = std::min(std::max<std::size_t>(max_points, 1), points_ - next_);
    shape_batch(batch, info().schema, gridded, count);
    bytes_ = 0;
    for_each_column(batch, [&](auto* column, std::size_t width) {
        file_.read_at(column, count * width, offset_ + bytes_ + next_ * width);
        bytes_ += points_ * width;
    });
    next_ += count;
    return true;
}

double SelectedPoints::fraction_read() const
{
    return count_ == 0 ? 1.0 : static_cast<double>(job_) / static_cast<double>(count_);
}

}  // namespace pcm

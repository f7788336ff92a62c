#include "pcm/io/las/las_reader.h"

#include "pcm/io/las/las_fields.h"
#include "pcm/io/las/las_header.h"
#include "pcm/io/las/las_layout.h"
#include "pcm/io/las/las_records.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/io/record_batch.h"
#include "pcm/system/file.h"

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>
#include <utility>

namespace pcm {
namespace {

// Records decoded at a time, field by field: they stay in the first-level cache between the fields.
constexpr std::size_t block_bytes = 16384;

bool is_laszip(const las::Vlr& vlr) { return vlr.user_id == las::laszip_user_id && vlr.id == las::laszip_record_id; }

class LasReader final : public PointReader {
public:
    LasReader(const std::filesystem::path& path, const ReadOptions& options) : file_(path, File::Mode::read)
    {
        const std::uint64_t file_size = file_.size();
        header_ = las::read_header(file_, file_size, info_.notes);
        const std::vector<las::Vlr> vlrs = las::read_vlrs(file_, file_size, header_, info_.notes);
        las::Fields plan = las::fields_of_file(header_, vlrs, info_.notes);
        records_ = header_.compressed ? las::laz_records(file_, file_size, header_, vlrs, options.threads, info_.notes)
                                      : las::plain_records(file_, header_);

        info_.format = (header_.compressed ? "LAZ 1." : "LAS 1.") + std::to_string(header_.version_minor) +
                       ", point format " + std::to_string(header_.format);
        info_.points = header_.points;
        info_.schema = std::move(plan.schema);
        fields_ = std::make_shared<const std::vector<las::Field>>(std::move(plan.fields));
        info_.position_type = ScalarType::i32;
        info_.grid = header_.grid;
        info_.promised_box = header_.box;
        info_.metadata.push_back({las::header_key, header_.raw});
        // How points are compressed is not metadata of the cloud.
        for (const las::Vlr& vlr : vlrs)
            if (!is_laszip(vlr)) info_.metadata.push_back(las::to_metadata(vlr));
        batch_points_ = points_that_fit_a_batch(info_.schema);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool has_records() const override { return true; }
    bool read_records(RecordBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return records_->seekable(); }
    void seek(std::uint64_t index) override;
    double fraction_read() const override
    {
        return info_.points ? static_cast<double>(next_) / static_cast<double>(info_.points) : 1.0;
    }

private:
    std::size_t points_of_batch(std::size_t max_points) const
    {
        const std::size_t most = std::min(std::max<std::size_t>(max_points, 1), batch_points_);
        return static_cast<std::size_t>(std::min<std::uint64_t>(info_.points - next_, most));
    }

    File file_;
    las::Header header_;
    FileInfo info_;
    std::shared_ptr<const std::vector<las::Field>> fields_;  // one for each attribute of the schema
    std::size_t batch_points_ = 1;
    std::uint64_t next_ = 0;
    std::unique_ptr<las::RecordSource> records_;  // uses file_ and header_
};

bool LasReader::read(PointBatch& batch, std::size_t max_points)
{
    const std::size_t count = points_of_batch(max_points);
    shape_batch(batch, info_.schema, true, count);
    if (count == 0) return false;

    const std::size_t stride = header_.record_length;
    const std::size_t block_points = std::max<std::size_t>(1, block_bytes / stride);
    for (std::size_t done = 0; done < count;) {
        const las::RecordSpan span = records_->next(count - done);
        for (std::size_t block = 0; block < span.count; block += block_points) {
            const std::size_t size = std::min(block_points, span.count - block);
            const std::byte* records = span.records + block * stride;
            for (std::size_t a = 0; a < 3; ++a)
                las::gather({4 * a, 4, 0, 0}, records, stride, size,
                            reinterpret_cast<std::byte*>(batch.grid_xyz[a].data() + done + block));
            for (std::size_t f = 0; f < fields_->size(); ++f)
                las::gather((*fields_)[f], records, stride, size,
                            batch.attributes[f].data() + (done + block) * (*fields_)[f].bytes);
        }
        done += span.count;
        next_ += span.count;
    }
    return true;
}

bool LasReader::read_records(RecordBatch& batch, std::size_t max_points)
{
    batch.size = points_of_batch(max_points);
    batch.stride = header_.record_length;
    batch.fields = fields_;
    if (batch.bytes.size() < batch.size * batch.stride) batch.bytes.resize(batch.size * batch.stride);
    for (std::size_t done = 0; done < batch.size;) {
        const las::RecordSpan span = records_->next(batch.size - done);
        std::memcpy(batch.bytes.data() + done * batch.stride, span.records, span.count * batch.stride);
        done += span.count;
        next_ += span.count;
    }
    return batch.size > 0;
}

void LasReader::seek(std::uint64_t index)
{
    if (!seekable()) return PointReader::seek(index);
    if (index > info_.points)
        throw Error(ErrorCode::invalid_argument, file_.path(),
                    "point " + std::to_string(index) + " was requested, the file has " + std::to_string(info_.points));
    next_ = index;
    records_->seek(index);
}

}  // namespace

std::unique_ptr<PointReader> open_las(const std::filesystem::path& path, const ReadOptions& options)
{
    return std::make_unique<LasReader>(path, options);
}

}  // namespace pcm

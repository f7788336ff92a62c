#include "pcm/io/bpc/bpc_reader.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/bpc_file.h"
#include "pcm/io/pipe/batch_shape.h"
#include "pcm/system/text.h"
#include "pcm/threads/task_pool.h"
#include "pcm/threads/thread_count.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <string>

namespace pcm {
namespace {

// Limit for all chunks that are decoded ahead.
constexpr std::uint64_t most_ahead_bytes = std::uint64_t{64} << 20;

class BpcReader final : public PointReader {
public:
    BpcReader(const std::filesystem::path& path, unsigned threads)
        : file_(path), columns_(ColumnSet::all(file_.cloud().schema)), most_ahead_(threads - 1)
    {
        const BpcCloud& cloud = file_.cloud();
        info_.format = "BPC, " + grouped(cloud.chunks) + (cloud.chunks == 1 ? " chunk" : " chunks");
        info_.points = cloud.points;
        info_.schema = cloud.schema;
        info_.position_type = cloud.position_type;
        info_.grid = cloud.grid;
        info_.promised_box = cloud.box;
        info_.metadata = cloud.metadata;
        batch_points_ = points_that_fit_a_batch(info_.schema);
    }

    const FileInfo& info() const override { return info_; }
    bool read(PointBatch& batch, std::size_t max_points) override;
    bool seekable() const override { return true; }
    void seek(std::uint64_t index) override { next_ = std::min(index, info_.points); }
    double fraction_read() const override
    {
        return info_.points ? static_cast<double>(next_) / static_cast<double>(info_.points) : 1.0;
    }

private:
    struct Ahead {
        ChunkPlace place, after;
        Pending<DecodedChunk> decoded;
    };

    void load();
    void read_ahead();

    BpcFile file_;
    ColumnSet columns_;
    FileInfo info_;
    std::size_t batch_points_ = 1;
    std::uint64_t next_ = 0;
    // The chunk of point next_, or the one before it; none before the first read.
    bool loaded_ = false;
    ChunkPlace place_, place_after_;
    DecodedChunk decoded_;
    // The following chunks, being decoded; their destructors wait.
    std::size_t most_ahead_ = 0;
    TaskPool pool_;
    std::deque<Ahead> ahead_;
};

// The chunk of the next point.
void BpcReader::load()
{
    if (loaded_ && next_ >= place_.first_point && next_ < place_after_.first_point) return;
    const ChunkPlace place = loaded_ && next_ == place_after_.first_point ? place_after_ : file_.find(next_);
    decoded_ = {};  // frees its memory first
    loaded_ = false;
    if (!ahead_.empty() && ahead_.front().place.number != place.number) ahead_.clear();
    if (ahead_.empty()) {
        decoded_ = file_.read(place, columns_);
    } else {
        Pending<DecodedChunk> decoded = std::move(ahead_.front().decoded);
        ahead_.pop_front();
        decoded_ = decoded.get();
    }
    place_ = place;
    place_after_ = file_.after(place, decoded_.header);
    loaded_ = true;
    if (most_ahead_ > 0) read_ahead();
}

void BpcReader::read_ahead()
{
    try {
        while (ahead_.size() < most_ahead_) {
            const ChunkPlace place = ahead_.empty() ? place_after_ : ahead_.back().after;
            if (place.first_point >= info_.points) return;
            const BpcHeader header = file_.header(place);
            if (decoded_bytes(header) > most_ahead_bytes / most_ahead_) return;
            ahead_.push_back({place, file_.after(place, header),
                              Pending<DecodedChunk>(pool_, static_cast<unsigned>(most_ahead_),
                                                    [this, place] { return file_.read(place, columns_); })});
        }
    } catch (const Error&) {
        // Decoding it again throws, after the points before it have been read.
    }
}

bool BpcReader::read(PointBatch& batch, std::size_t max_points)
{
    if (next_ >= info_.points) {
        shape_batch(batch, info_.schema, info_.grid.has_value(), 0);
        return false;
    }
    load();
    const auto first = static_cast<std::size_t>(next_ - place_.first_point);
    const std::size_t count = std::min({max_points, batch_points_, decoded_.header.points - first});
    shape_batch(batch, info_.schema, info_.grid.has_value(), count);
    for (std::size_t a = 0; a < 3; ++a) {
        const ChunkPositions& positions = *decoded_.chunk.positions;
        if (batch.gridded)
            positions_to(decoded_.header, positions, a, first, count, batch.grid_xyz[a].data());
        else
            positions_to(decoded_.header, positions, a, first, count, batch.xyz[a].data());
    }
    for (std::size_t i = 0; i < batch.attributes.size(); ++i) {
        const Column& from = *decoded_.chunk.attributes[i];
        std::memcpy(batch.attributes[i].data(), from.data() + first * from.point_bytes(), batch.attributes[i].bytes());
    }
    next_ += count;
    return true;
}

}  // namespace

std::unique_ptr<PointReader> open_bpc(const std::filesystem::path& path, const ReadOptions& options)
{
    return std::make_unique<BpcReader>(path, std::min(thread_count(options.threads), 64u));
}

}  // namespace pcm

#include "pcm/io/bpc/bpc_writer.h"

#include "pcm/bpc/batch_chunk.h"
#include "pcm/bpc/bpc_file_writer.h"
#include "pcm/system/error.h"
#include "pcm/threads/task_pool.h"
#include "pcm/threads/thread_count.h"

#include <algorithm>
#include <cstring>
#include <deque>
#include <memory>
#include <string>

namespace pcm {
namespace {

BpcCloud cloud_of(const FileInfo& info)
{
    BpcCloud cloud;
    cloud.position_type = info.position_type;
    cloud.grid = info.grid;
    cloud.schema = info.schema;
    cloud.metadata = info.metadata;
    return cloud;
}

class BpcWriter final : public PointWriter {
public:
    BpcWriter(const std::filesystem::path& path, const FileInfo& cloud, unsigned threads)
        : schema_(cloud.schema),
          grid_(cloud.grid),
          chunk_points_(default_cloud_chunk_points(cloud.schema)),
          threads_(threads),
          path_(path),
          file_(path, cloud_of(cloud))
    {
        pending_.reset(schema_, grid_.has_value(), chunk_points_);
    }

    void write(const PointBatch& batch) override;
    void finish() override;

private:
    void check(const PointBatch& batch) const;
    void flush();
    void append_encoded();

    Schema schema_;
    std::optional<Grid> grid_;
    std::size_t chunk_points_;
    unsigned threads_;
    std::filesystem::path path_;
    BpcFileWriter file_;
    PointBatch pending_;      // room for chunk_points_ points
    std::size_t filled_ = 0;  // points in it
    TaskPool pool_;
    std::deque<Pending<std::vector<std::byte>>> encoding_;  // chunks in order, with more than one thread
};

void BpcWriter::check(const PointBatch& batch) const
{
    bool same = batch.gridded == grid_.has_value() && batch.attributes.size() == schema_.size();
    for (std::size_t i = 0; same && i < schema_.size(); ++i)
        same =
            batch.attributes[i].type() == schema_[i].type && batch.attributes[i].components() == schema_[i].components;
    if (!same)
        throw Error(ErrorCode::invalid_argument, path_,
                    "the batch has other attributes than the cloud that the file was created for");
}

void BpcWriter::write(const PointBatch& batch)
{
    check(batch);
    for (std::size_t done = 0; done < batch.size;) {
        const std::size_t now = std::min(batch.size - done, chunk_points_ - filled_);
        const auto copy = [&](const auto& from, auto& to) {
            std::copy_n(from.data() + done, now, to.data() + filled_);
        };
        for (std::size_t a = 0; a < 3; ++a) {
            if (batch.gridded)
                copy(batch.grid_xyz[a], pending_.grid_xyz[a]);
            else
                copy(batch.xyz[a], pending_.xyz[a]);
        }
        for (std::size_t i = 0; i < schema_.size(); ++i) {
            const std::size_t bytes = schema_[i].bytes();
            std::memcpy(pending_.attributes[i].data() + filled_ * bytes, batch.attributes[i].data() + done * bytes,
                        now * bytes);
        }
        done += now;
        filled_ += now;
        if (filled_ == chunk_points_) flush();
    }
}

void BpcWriter::flush()
{
    if (filled_ == 0) return;
    pending_.resize(filled_);
    if (threads_ == 1) {
        file_.append(encode_batch(pending_, schema_, grid_));
        pending_.resize(chunk_points_);
    } else {
        while (encoding_.size() >= threads_) append_encoded();
        auto batch = std::make_shared<PointBatch>(std::move(pending_));
        pending_ = {};
        encoding_.emplace_back(pool_, threads_, [this, batch] { return encode_batch(*batch, schema_, grid_); });
        pending_.reset(schema_, grid_.has_value(), chunk_points_);
    }
    filled_ = 0;
}

void BpcWriter::append_encoded()
{
    Pending<std::vector<std::byte>> first = std::move(encoding_.front());
    encoding_.pop_front();
    file_.append(first.get());
}

void BpcWriter::finish()
{
    flush();
    while (!encoding_.empty()) append_encoded();
    file_.finish();
}

}  // namespace

std::unique_ptr<PointWriter> create_bpc(const std::filesystem::path& path, const FileInfo& cloud,
                                        const WriteOptions& options)
{
    // Encoding a chunk takes some 20 MB.
    return std::make_unique<BpcWriter>(path, cloud, std::min(thread_count(options.threads), 8u));
}

}  // namespace pcm

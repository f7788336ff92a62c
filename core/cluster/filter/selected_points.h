// The selected points of a tree as files of jobs: batch after batch, column after column.
#pragma once

#include "pcm/cluster/job_folder.h"
#include "pcm/io/reader.h"
#include "pcm/system/file.h"
#include "pcm/tree/tree_reader.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

namespace pcm {

// Writes the points of the nodes [first, end) of TreeReader::nodes() as the file of a job.
void write_selected(const JobFolder& jobs, std::size_t job, TreeReader& reader, std::size_t first, std::size_t end);
void begin_selected(const JobFolder& jobs);
bool is_selected(const JobFolder& jobs, std::size_t job);

// The points of all jobs, one after the other.
class SelectedPoints final : public PointReader {
public:
    // `tree`: reader of the points, for what is known of them.
    SelectedPoints(std::unique_ptr<PointReader> tree, const JobFolder& jobs, std::size_t count);

    const FileInfo& info() const override { return tree_->info(); }
    bool read(PointBatch& batch, std::size_t max_points) override;
    double fraction_read() const override;

private:
    bool next_batch();

    const std::unique_ptr<PointReader> tree_;
    const JobFolder& jobs_;
    const std::size_t count_;
    std::size_t job_ = 0;  // number of jobs that were opened
    File file_;
    std::vector<std::uint32_t> sizes_;  // points of each batch of the file
    std::size_t batch_ = 0;             // number of its batches that were begun
    std::uint64_t offset_ = 0, bytes_ = 0;
    std::size_t next_ = 0, points_ = 0;  // in the batch
};

}  // namespace pcm

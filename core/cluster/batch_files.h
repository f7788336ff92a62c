// The files of batches of the input: rows in bins, and what was found while they were read.
#pragma once

#include "pcm/build/bins/bins.h"
#include "pcm/cluster/bin_rows.h"
#include "pcm/cluster/job_folder.h"
#include "pcm/threads/team.h"

#include <cstddef>
#include <string>
#include <vector>

namespace pcm {

// Notes and metadata that a reader finds while it reads points.
struct LateFacts {
    std::vector<std::string> notes;
    std::vector<Metadata> metadata;

    // What a reader has beyond its first `notes` notes and `blocks` blocks of metadata.
    static LateFacts since(const FileInfo& now, std::size_t notes, std::size_t blocks);
    static LateFacts load(ByteReader& in);
    void save(ByteWriter& out) const;
    // Adds what `info` has not.
    void add_to(FileInfo& info) const;
};

struct BatchFacts {
    bool kept = true;      // integers: false when one was lost, and the batch is of no use
    bool rounded = false;  // whether a position is not on the grid
    Observed observed;
    LateFacts late;
};

// For the record of a batch whose rows are in `scratch`.
void save_batch(const BatchFacts& batch, const Scratch& scratch, ByteWriter& record);

// Collective: adds the rows of batches 0 .. batches - 1 of a stage to `bins` new bins of `rows`, unless integers were
// lost, and their late facts to `info`, in their order. Returns what they have in common.
BatchFacts take_batches(Team& team, const JobFolder& jobs, const char* stage, std::size_t batches, std::size_t bins,
                        BinRows& rows, FileInfo& info);

}  // namespace pcm

// Operations done one after the other on one cloud: files, folders or trees go in, one tree or file comes out.
#pragma once

#include "pcm/convert/open_cloud.h"
#include "pcm/ops/operation.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace pcm {
class ScratchFolder;
}

namespace pcm::ops {

// An operation that is ready to run: its arguments are set, but for what it reads and writes.
struct Link {
    const Row* row = nullptr;
    Operation* operation = nullptr;
    std::string name;  // put in front of its errors and its progress: "step 2, subsample 0.05"; empty: nothing is
};

struct ChainOptions {
    std::vector<std::string> inputs;
    std::string output;  // a tree or a file, by its extension
    bool overwrite = false;
    CloudOptions reading;
    std::uint64_t memory_bytes = std::uint64_t(1) << 30;
    unsigned threads = 0;  // 0: one per processor
};

// What lies between is in a scratch folder next to the output (system/scratch_folder.h), which the destructor removes;
// the output gets its name when it is complete. A tree that is an input is not changed. One thread.
class Chain {
public:
    Chain(ChainOptions options, std::vector<Link> links);
    ~Chain();
    Chain(const Chain&) = delete;
    Chain& operator=(const Chain&) = delete;

    // The operations' own answers, in their order; lines that name what an operation wrote name the output. Once.
    // Throws Error(invalid_argument) for an output that is an input, ArgumentError for an operation that writes
    // nothing, and what result_place(), CloudSources, build_tree(), convert() and the operations throw.
    std::vector<Result> run(const Context& context);

    // After run(): the head of an answer about all of it. Values and accuracy are those of
    // reading and writing: points_skipped, skipped; rounding.
    const Result& summary() const { return summary_; }
    std::string path() const { return place_.string(); }  // where the output is

private:
    bool is_file() const;
    bool keeps_levels(std::size_t i) const;
    ProgressFunction part(const Context& context, std::size_t i, const std::string& name) const;
    std::filesystem::path next_folder();
    void take_inputs(CloudSources& sources, bool selected, const Context& context);
    void connect(const Link& link, bool last);
    void copy_tree();
    Result run_link(std::size_t i, const Context& context);
    void add_outcome(const Result& answer);
    Error about(const Error& error, const Link& link) const;
    void write_file(const Context& context);

    ChainOptions options_;
    std::vector<Link> links_;
    Result summary_;
    std::filesystem::path place_;             // where the output goes
    std::unique_ptr<ScratchFolder> scratch_;  // next to it
    std::size_t folders_ = 0;                 // made in it
    std::filesystem::path tree_, target_;     // what the next operation reads; what it writes
    bool is_scratch_ = false;                 // the tree may be changed: it is not the user's
    bool written_ = false;                    // the output is
};

// operation.run(). For an operation that changes a tree (a step of a chain), in addition on files and folders, and with
// an output that is a file, which other programs can read: then by way of a scratch tree. Throws what Chain::run()
// does, and ArgumentError for files without an output.
Result run_on_files_too(const Row& row, Operation& operation, const Context& context);

}  // namespace pcm::ops

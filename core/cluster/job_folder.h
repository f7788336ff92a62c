// The files of a team's finished jobs, in a folder that all ranks see.
//
// A job has a key of a stage and a number, never of a rank. It writes one file: its data, then its record. The file is
// written under a name of its own, synced, and then renamed to the job's: a job is done when a file of its name exists.
// Jobs always write the same bytes, so that one that is done twice does no harm. Nothing but regular files that are
// written from their beginning to their end by one process, rename() and fsync() is asked of the file system: no locks,
// no holes, no exchange of names.
//
// Data, record, u64 size of the record, u64 checksum of the record, u64 magic number.
#pragma once

#include "pcm/system/file.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace pcm {

class JobFolder {
public:
    // `rank`: that of this process, for the names of unfinished files. `durable`: files are synced before they get
    // their names, so that those of a machine that fails are whole.
    JobFolder(std::filesystem::path folder, unsigned rank, bool durable)
        : folder_(std::move(folder)), rank_(rank), durable_(durable)
    {
    }

    struct Key {
        const char* stage;
        std::uint64_t number = 0;
    };

    // Makes the stage's folder where there is none.
    void begin(const char* stage) const;
    std::filesystem::path file(const Key& job) const;
    // A name for the job's file until it is finished, of no other process or thread.
    std::filesystem::path unfinished(const Key& job) const;
    bool is_done(const Key& job) const;
    // The record of a job that is done. Throws Error(corrupt) for a file that finish() has not written,
    // Error(not_found) where there is none.
    std::vector<std::byte> record(const Key& job) const;
    std::optional<std::vector<std::byte>> record_if_done(const Key& job) const;

    // Puts the record behind `bytes` of data of an unfinished file, syncs it and gives it its name.
    void finish(const Key& job, const std::filesystem::path& unfinished, std::uint64_t bytes,
                const std::vector<std::byte>& record) const;
    // The same for data in memory.
    void write(const Key& job, const std::vector<std::byte>& data, const std::vector<std::byte>& record) const;

    // Removes the unfinished files of processes that were killed.
    void remove_unfinished() const;

    // Removes the files of stages that nothing reads any more, since all jobs of the stage `done`, which did, are done.
    // Those keep their names also where a machine fails. By one process.
    void give_up(const std::vector<const char*>& stages, const char* done) const;
    // Room on disk that all files took when give_up() or this was called in this process, the most.
    std::uint64_t most_bytes() const;

private:
    std::string how_to_go_on() const;

    const std::filesystem::path folder_;
    const unsigned rank_;
    const bool durable_;
    mutable std::atomic<std::uint64_t> most_bytes_{0};
};

}  // namespace pcm

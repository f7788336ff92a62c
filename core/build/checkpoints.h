// The checkpoints of a build: records of finished work whose data are safely on disk, so that a build that was killed
// can be resumed.
//
// A checkpoint syncs data first, then writes a record into the journal; only then may the data that it replaces be
// removed. A thread of its own does all this, in order, while the build continues.
#pragma once

#include "pcm/build/journal.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

namespace pcm {

class Checkpoints {
public:
    enum Kind : std::uint32_t { identity = 1, partitioned, sorted, levelled, committed };

    // Makes no checkpoints: post() only calls `then`.
    Checkpoints() = default;
    // `build`: see identity_of_build(). Records of another build are removed. due() holds every `seconds`.
    Checkpoints(const std::filesystem::path& journal, const std::vector<std::byte>& build, double seconds);
    // Drops the tasks that wait, and waits for the one that runs.
    ~Checkpoints();
    Checkpoints(const Checkpoints&) = delete;

    bool on() const { return journal_ != nullptr; }
    bool same_build() const { return same_build_; }  // the journal found is of this build
    void off();                                      // no more checkpoints; call it before the first post()
    double seconds() const { return seconds_; }

    // Records of an interrupted build. The pointers are valid until forget_found() or cut().
    std::vector<const std::vector<std::byte>*> found(Kind kind) const;
    // Removes the records of this kind and all later ones.
    void cut(Kind kind);
    void forget_found();

    // Whether it is time for the next checkpoint. Any thread.
    bool due() const;
    // Queues a checkpoint: calls `sync`, writes the record, calls `then`. Blocks while two others wait. Any thread.
    // Throws the exception of an earlier checkpoint.
    void post(std::function<void()> sync, Kind kind, std::vector<std::byte> record, std::function<void()> then = {});
    // The same without a record: calls `work` after all checkpoints before it.
    void post(std::function<void()> work);
    void wait();  // until all are done; throws the exception of any

private:
    void run();
    void push(std::function<void()> task);

    std::unique_ptr<Journal> journal_;
    double seconds_ = 0;
    bool same_build_ = false;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::deque<std::function<void()>> tasks_;
    std::exception_ptr error_;
    bool working_ = false, ended_ = false;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
    std::thread thread_;
};

}  // namespace pcm

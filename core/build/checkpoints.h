// The checkpoints of a build: what is on disk for good, and what was done with it, so that a build that was killed goes
// on from there.
//
// A checkpoint syncs data first, then writes a record into the journal; only then may data that it replaces be given
// up. All this is done by a thread of its own, in order, while the build goes on.
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

    // None are made: post() does only what comes after the record.
    Checkpoints() = default;
    // `build` says what is built from what, in which way: records of another one are forgotten. `seconds` is how often
    // due() holds.
    Checkpoints(const std::filesystem::path& journal, const std::vector<std::byte>& build, double seconds);
    // Whatever waits is dropped.
    ~Checkpoints();
    Checkpoints(const Checkpoints&) = delete;

    bool on() const { return journal_ != nullptr; }
    bool same_build() const { return same_build_; }  // as the one whose journal was found
    void off();                                      // from now on, before anything was posted
    double seconds() const { return seconds_; }

    // What was found of an interrupted build. The pointers hold until forget_found() or cut().
    std::vector<const std::vector<std::byte>*> found(Kind kind) const;
    // Records of this kind and all later ones are void.
    void cut(Kind kind);
    void forget_found();

    // It is time for the next one, where there is no other reason for it. Any thread.
    bool due() const;
    // Syncs, writes the record, does `then`; soon: it waits while two others wait. Any thread. Throws what an earlier
    // one has thrown.
    void post(std::function<void()> sync, Kind kind, std::vector<std::byte> record, std::function<void()> then = {});
    // The same without a record: `work` is done when all before it is.
    void post(std::function<void()> work);
    void wait();  // until all is done; throws what was thrown

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

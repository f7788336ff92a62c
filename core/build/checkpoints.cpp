#include "pcm/build/checkpoints.h"

#include "pcm/system/seconds.h"

namespace pcm {

Checkpoints::Checkpoints(const std::filesystem::path& journal, const std::vector<std::byte>& build, double seconds)
    : journal_(std::make_unique<Journal>(journal)), seconds_(seconds)
{
    const auto& records = journal_->records();
    same_build_ = !records.empty() && records[0].kind == identity && records[0].bytes == build;
    if (!same_build_) {
        journal_->cut(0);
        journal_->append(identity, build);
    }
}

Checkpoints::~Checkpoints()
{
    {
        const std::lock_guard lock(mutex_);
        ended_ = true;
        tasks_.clear();
    }
    wake_.notify_all();
    if (thread_.joinable()) thread_.join();
}

void Checkpoints::off() { journal_.reset(); }

std::vector<const std::vector<std::byte>*> Checkpoints::found(Kind kind) const
{
    std::vector<const std::vector<std::byte>*> all;
    if (journal_)
        for (const Journal::Record& record : journal_->records())
            if (record.kind == kind) all.push_back(&record.bytes);
    return all;
}

void Checkpoints::cut(Kind kind)
{
    if (!journal_) return;
    const auto& records = journal_->records();
    std::size_t from = 0;
    while (from < records.size() && records[from].kind < static_cast<std::uint32_t>(kind)) ++from;
    journal_->cut(from);
}

void Checkpoints::forget_found()
{
    if (journal_) journal_->forget_found();
}

bool Checkpoints::due() const
{
    const std::lock_guard lock(mutex_);
    return journal_ && seconds_since(last_) >= seconds_;
}

void Checkpoints::push(std::function<void()> task)
{
    std::unique_lock lock(mutex_);
    // Queued checkpoints delay the release of disk space, so few may wait for a slow disk.
    wake_.wait(lock, [&] { return error_ || tasks_.size() < 2; });
    if (error_) std::rethrow_exception(error_);
    tasks_.push_back(std::move(task));
    last_ = std::chrono::steady_clock::now();
    if (!thread_.joinable()) thread_ = std::thread([this] { run(); });
    wake_.notify_all();
}

void Checkpoints::post(std::function<void()> sync, Kind kind, std::vector<std::byte> record, std::function<void()> then)
{
    if (!journal_) {
        if (then) then();
        return;
    }
    push([this, sync = std::move(sync), kind, record = std::move(record), then = std::move(then)] {
        sync();
        journal_->append(kind, record);
        if (then) then();
    });
}

void Checkpoints::post(std::function<void()> work)
{
    if (journal_)
        push(std::move(work));
    else
        work();
}

void Checkpoints::wait()
{
    std::unique_lock lock(mutex_);
    wake_.wait(lock, [&] { return error_ || (tasks_.empty() && !working_); });
    if (error_) std::rethrow_exception(error_);
}

void Checkpoints::run()
{
    std::unique_lock lock(mutex_);
    for (;;) {
        wake_.wait(lock, [&] { return ended_ || !tasks_.empty(); });
        if (ended_) return;
        const std::function<void()> task = std::move(tasks_.front());
        tasks_.pop_front();
        working_ = true;
        lock.unlock();
        std::exception_ptr error;
        try {
            task();
        } catch (...) {
            error = std::current_exception();
        }
        lock.lock();
        working_ = false;
        if (error) {
            error_ = error;
            tasks_.clear();
        }
        wake_.notify_all();
        if (error) return;
    }
}

}  // namespace pcm

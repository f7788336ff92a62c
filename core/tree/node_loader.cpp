#include "pcm/tree/node_loader.h"

#include "pcm/system/seconds.h"

#include <algorithm>
#include <exception>
#include <system_error>
#include <utility>

namespace pcm {

NodeLoader::NodeLoader(NodeTable nodes, double retry_after) : nodes_(std::move(nodes)), retry_after_(retry_after) {}

NodeLoader::~NodeLoader() { set_wake({}); }

// The first wanted node that has not been read, taken from the list; no_node: none. With the mutex held.
NodeId NodeLoader::next()
{
    while (!wanted_.empty()) {
        const NodeId node = wanted_.back();
        wanted_.pop_back();
        if (!nodes_.find(node)) return node;
    }
    return no_node;
}

void NodeLoader::read(NodeId node)
{
    std::string failure;
    try {
        nodes_[node];
    } catch (const std::exception& error) {
        failure = error.what();
    }
    const std::lock_guard lock(signal_.mutex);
    reading_ = false;
    if (!failure.empty()) {
        failed_ = Clock::now();
        refused_.insert(node);
        wanted_.clear();
    } else {
        refused_.erase(node);
    }
    error_ = std::move(failure);
    if (wake_) wake_();
}

void NodeLoader::run()
{
    for (;;) {
        NodeId node = no_node;
        {
            std::unique_lock lock(signal_.mutex);
            signal_.wake.wait(lock, [&] { return signal_.stopped || (node = next()) != no_node; });
            if (signal_.stopped) return;
            reading_ = true;
        }
        read(node);
    }
}

void NodeLoader::request(std::vector<NodeId> nodes)
{
    nodes.erase(std::remove_if(nodes.begin(), nodes.end(), [&](NodeId node) { return nodes_.find(node) != nullptr; }),
                nodes.end());
    {
        const std::lock_guard lock(signal_.mutex);
        wanted_.clear();
        if (failed_ && seconds_left() > 0) return;
        failed_.reset();
        if (nodes.empty()) return;
        std::stable_partition(nodes.begin(), nodes.end(), [&](NodeId node) { return refused_.count(node) == 0; });
        wanted_.assign(nodes.rbegin(), nodes.rend());
    }
    if (!std::exchange(has_thread_, true)) {
        try {
            crew_.add([this] { run(); });
        } catch (const std::system_error&) {
            has_thread_ = false;
        }
    }
    if (has_thread_)
        signal_.wake.notify_one();
    else
        read(nodes.front());
}

bool NodeLoader::waits() const
{
    const std::lock_guard lock(signal_.mutex);
    return reading_ ||
           std::any_of(wanted_.begin(), wanted_.end(), [&](NodeId node) { return nodes_.find(node) == nullptr; });
}

std::string NodeLoader::error() const
{
    const std::lock_guard lock(signal_.mutex);
    return failed_ ? error_ : std::string();
}

double NodeLoader::seconds_left() const { return retry_after_ - seconds_since(*failed_); }

double NodeLoader::seconds_to_retry() const
{
    constexpr double least = 0.01;
    const std::lock_guard lock(signal_.mutex);
    return failed_ ? std::max(least, seconds_left()) : 0;
}

void NodeLoader::set_wake(std::function<void()> wake)
{
    const std::lock_guard lock(signal_.mutex);
    wake_ = std::move(wake);
}

}  // namespace pcm

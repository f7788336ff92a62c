// Reads nodes of a tree in the background, for a view that must not wait for a disk or a server.
#pragma once

#include "pcm/threads/crew.h"
#include "pcm/tree/node_table.h"

#include <chrono>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace pcm {

// One thread calls, but for set_wake(), which any may call.
class NodeLoader {
public:
    // After a page could not be read, requests are ignored for `retry_after` seconds.
    NodeLoader(NodeTable nodes, double retry_after);
    ~NodeLoader();  // waits for the page that is being read
    NodeLoader(const NodeLoader&) = delete;
    NodeLoader& operator=(const NodeLoader&) = delete;

    // The pages of these nodes are read in this order, instead of those of former requests that are not being read yet.
    // Where the system gives no thread, the first one is read here.
    void request(std::vector<NodeId> nodes);
    // Whether a page that was requested is still to come.
    bool waits() const;
    // Why a page could not be read; empty once the next one is tried.
    std::string error() const;
    // Seconds until a request is followed again; 0: nothing failed.
    double seconds_to_retry() const;

    // `wake` is called on the loader's thread after each page, read or failed; it must return quickly and not call back
    // into this object. When set_wake returns, the former function is not running and will not be called again.
    void set_wake(std::function<void()> wake);

private:
    using Clock = std::chrono::steady_clock;

    void run();
    void read(NodeId node);
    double seconds_left() const;
    NodeId next();

    const NodeTable nodes_;
    const double retry_after_;
    mutable Signal signal_;
    std::vector<NodeId> wanted_;  // from the last to the first
    std::set<NodeId> refused_;    // could not be read when they were last tried: tried again after the others
    bool reading_ = false;
    std::string error_;
    std::optional<Clock::time_point> failed_;
    std::function<void()> wake_;
    bool has_thread_ = false;
    Crew crew_{signal_};
};

}  // namespace pcm

// The searches that bench_all_knn compares with ours, each behind one function. Peers get single-precision coordinates,
// as they are used; each builds its index and then asks for every point's neighbours in turn.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace pcm::bench {

struct PeerRun {
    double build = 0, query = 0;  // CPU seconds of the thread
    double sum = 0;               // sum of the squared distances to the k-th neighbours
    std::vector<double> sampled;  // distances to the k-th neighbours of the sampled points
};

struct Peer {
    std::string name;
    // `xyz`: three coordinates per point. The result has the distances of the points sampled[0], sampled[1], ...
    std::function<PeerRun(const std::vector<float>& xyz, std::size_t k, const std::vector<std::uint32_t>& sampled)> run;
};

// Those that were built.
std::vector<Peer> peers();

double thread_seconds();

}  // namespace pcm::bench

#include "pcm/knn/flann/flann_module.h"

#include <cstring>
#include <exception>
#include <memory>

#include <flann/flann.hpp>

namespace pcm {
namespace {

using Index = flann::KDTreeSingleIndex<flann::L2_Simple<float>>;

void report(const std::exception& failure, char* message)
{
    std::strncpy(message, failure.what(), flann_message_bytes - 1);
    message[flann_message_bytes - 1] = 0;
}

flann::Matrix<float> rows(const float* xyz, std::size_t count) { return {const_cast<float*>(xyz), count, 3}; }

void* make(const float* xyz, std::size_t points, char* message)
try {
    const flann::KDTreeSingleIndexParams parameters(15);
    auto index = std::make_unique<Index>(rows(xyz, points), parameters);
    index->buildIndex();
    return index.release();
} catch (const std::exception& failure) {
    report(failure, message);
    return nullptr;
}

bool search(const void* index, const float* xyz, std::size_t queries, std::size_t k, std::size_t* neighbours,
            float* squared, char* message)
try {
    flann::Matrix<std::size_t> found(neighbours, queries, k);
    flann::Matrix<float> distances(squared, queries, k);
    flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED, 0, true);
    parameters.cores = 1;
    static_cast<const Index*>(index)->knnSearch(rows(xyz, queries), found, distances, k, parameters);
    return true;
} catch (const std::exception& failure) {
    report(failure, message);
    return false;
}

void free_index(void* index) { delete static_cast<Index*>(index); }

}  // namespace
}  // namespace pcm

extern "C" __attribute__((visibility("default"))) const void* pcm_flann_functions()
{
    static constexpr pcm::FlannFunctions functions{pcm::flann_module_version, pcm::make, pcm::search, pcm::free_index};
    return &functions;
}

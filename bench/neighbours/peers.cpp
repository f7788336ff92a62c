#include "bench/neighbours/peers.h"

#include <cmath>
#include <ctime>

#ifdef PCM_BENCH_FLANN
#include <flann/flann.hpp>
#endif
#ifdef PCM_BENCH_NANOFLANN
#include <nanoflann.hpp>
#endif
#ifdef PCM_BENCH_PCL
#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#endif

namespace pcm::bench {
namespace {

// The squared distances to the k-th neighbours, in the order of the points.
class Consumer {
public:
    Consumer(PeerRun& run, const std::vector<std::uint32_t>& sampled, std::size_t points) : run_(run), wanted_(points)
    {
        run.sampled.resize(sampled.size());
        for (std::size_t i = 0; i < sampled.size(); ++i) wanted_[sampled[i]] = static_cast<std::uint32_t>(i + 1);
    }
    void take(std::size_t point, float square)
    {
        run_.sum += square;
        if (wanted_[point]) run_.sampled[wanted_[point] - 1] = std::sqrt(static_cast<double>(square));
    }

private:
    PeerRun& run_;
    std::vector<std::uint32_t> wanted_;
};

#ifdef PCM_BENCH_FLANN
PeerRun run_flann(const std::vector<float>& xyz, std::size_t k, const std::vector<std::uint32_t>& sampled)
{
    const std::size_t n = xyz.size() / 3, batch = 4096;
    PeerRun run;
    Consumer consumer(run, sampled, n);
    const double begin = thread_seconds();
    const flann::Matrix<float> points(const_cast<float*>(xyz.data()), n, 3);
    flann::Index<flann::L2_Simple<float>> index(points, flann::KDTreeSingleIndexParams(15));
    index.buildIndex();
    const double built = thread_seconds();
    std::vector<int> ids(batch * (k + 1));
    std::vector<float> squares(batch * (k + 1));
    flann::SearchParams parameters(flann::FLANN_CHECKS_UNLIMITED);
    parameters.cores = 1;
    for (std::size_t first = 0; first < n; first += batch) {
        const std::size_t size = std::min(batch, n - first);
        const flann::Matrix<float> queries(const_cast<float*>(xyz.data()) + 3 * first, size, 3);
        flann::Matrix<int> found(ids.data(), size, k + 1);
        flann::Matrix<float> distances(squares.data(), size, k + 1);
        index.knnSearch(queries, found, distances, k + 1, parameters);
        for (std::size_t i = 0; i < size; ++i) consumer.take(first + i, squares[i * (k + 1) + k]);
    }
    run.build = built - begin;
    run.query = thread_seconds() - built;
    return run;
}
#endif

#ifdef PCM_BENCH_NANOFLANN
struct Points {
    const std::vector<float>& xyz;
    std::size_t kdtree_get_point_count() const { return xyz.size() / 3; }
    float kdtree_get_pt(std::size_t i, std::size_t axis) const { return xyz[3 * i + axis]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const
    {
        return false;
    }
};

PeerRun run_nanoflann(const std::vector<float>& xyz, std::size_t k, const std::vector<std::uint32_t>& sampled)
{
    using Tree =
        nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points>, Points, 3, std::uint32_t>;
    const std::size_t n = xyz.size() / 3;
    PeerRun run;
    Consumer consumer(run, sampled, n);
    const double begin = thread_seconds();
    const Points points{xyz};
    Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(10));
    const double built = thread_seconds();
    std::vector<std::uint32_t> ids(k + 1);
    std::vector<float> squares(k + 1);
    for (std::size_t i = 0; i < n; ++i) {
        tree.knnSearch(&xyz[3 * i], k + 1, ids.data(), squares.data());
        consumer.take(i, squares[k]);
    }
    run.build = built - begin;
    run.query = thread_seconds() - built;
    return run;
}
#endif

#ifdef PCM_BENCH_PCL
PeerRun run_pcl(const std::vector<float>& xyz, std::size_t k, const std::vector<std::uint32_t>& sampled)
{
    const std::size_t n = xyz.size() / 3;
    const pcl::PointCloud<pcl::PointXYZ>::Ptr cloud(new pcl::PointCloud<pcl::PointXYZ>);
    cloud->resize(n);
    for (std::size_t i = 0; i < n; ++i) (*cloud)[i] = {xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2]};
    PeerRun run;
    Consumer consumer(run, sampled, n);
    const double begin = thread_seconds();
    pcl::KdTreeFLANN<pcl::PointXYZ> tree;
    tree.setInputCloud(cloud);
    const double built = thread_seconds();
    pcl::Indices ids(k + 1);
    std::vector<float> squares(k + 1);
    for (std::size_t i = 0; i < n; ++i) {
        tree.nearestKSearch((*cloud)[i], static_cast<unsigned>(k + 1), ids, squares);
        consumer.take(i, squares[k]);
    }
    run.build = built - begin;
    run.query = thread_seconds() - built;
    return run;
}
#endif

}  // namespace

std::vector<Peer> peers()
{
    std::vector<Peer> all;
#ifdef PCM_BENCH_FLANN
    all.push_back({"flann", run_flann});
#endif
#ifdef PCM_BENCH_NANOFLANN
    all.push_back({"nanoflann", run_nanoflann});
#endif
#ifdef PCM_BENCH_PCL
    all.push_back({"pcl", run_pcl});
#endif
    return all;
}

double thread_seconds()
{
    timespec t{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace pcm::bench

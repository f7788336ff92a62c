// CGAL's normals and outliers for bench/neighbours/run.py: see filter_files.h. One thread: more need TBB.
#define CGAL_DISABLE_GMP 1
#define CGAL_DISABLE_MPFR 1
#include "bench/neighbours/filter_files.h"

#include <CGAL/Simple_cartesian.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <CGAL/remove_outliers.h>

#include <array>
#include <cmath>
#include <utility>

namespace {

using namespace pcm::bench;

using Kernel = CGAL::Simple_cartesian<double>;
struct Item {
    Kernel::Point_3 point;
    Kernel::Vector_3 normal;
    std::size_t index;
};
struct PointOf {
    using key_type = Item;
    using value_type = Kernel::Point_3;
    using reference = const value_type&;
    using category = boost::lvalue_property_map_tag;
    friend reference get(PointOf, const Item& item) { return item.point; }
};
struct NormalOf {
    using key_type = Item;
    using value_type = Kernel::Vector_3;
    using reference = const value_type&;
    using category = boost::read_write_property_map_tag;
    friend reference get(NormalOf, const Item& item) { return item.normal; }
    friend void put(NormalOf, Item& item, const value_type& normal) { item.normal = normal; }
};

FilterResult run(const FilterRequest& request, const std::vector<double>& xyz)
{
    std::vector<Item> items;
    for (std::size_t i = 0; i < xyz.size(); i += 3)
        items.push_back({Kernel::Point_3(xyz[i], xyz[i + 1], xyz[i + 2]), Kernel::Vector_3(0, 0, 0), i / 3});
    const auto k = static_cast<unsigned>(request.neighbours);
    const auto maps = CGAL::parameters::point_map(PointOf()).normal_map(NormalOf());
    FilterResult result;
    if (request.filter == "normals") {
        CGAL::pca_estimate_normals<CGAL::Sequential_tag>(items, k, maps);
        result.normals.resize(xyz.size());
        for (const Item& item : items)
            for (int a = 0; a < 3; ++a)
                result.normals[item.index * 3 + static_cast<std::size_t>(a)] = static_cast<float>(item.normal[a]);
        return result;
    }
    // A share of the points, those with the largest mean square distance: there is no test by standard deviations.
    const auto end = CGAL::remove_outliers<CGAL::Sequential_tag>(
        items, k, maps.threshold_percent(100 * request.share).threshold_distance(0.0));
    result.outliers.assign(xyz.size() / 3, 0);
    for (auto at = end; at != items.end(); ++at) result.outliers[at->index] = 1;
    return result;
}

}  // namespace

int main(int argc, char** argv) { return pcm::bench::run_filter(argc, argv, run); }

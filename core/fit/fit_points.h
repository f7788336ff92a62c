// Points to be fitted: doubles relative to a place near them, so that map coordinates cost no digits.
#pragma once

#include "pcm/cloud/vector.h"

#include <cstddef>
#include <vector>

namespace pcm {

struct FitPoints {
    Vec3d origin{};               // source coordinates
    std::vector<double> x, y, z;  // relative to it, source units
    // Unit normals of any sign, and 0 0 0 for a point that has none; all three empty: no normals.
    std::vector<double> nx, ny, nz;

    std::size_t size() const { return x.size(); }
    bool has_normals() const { return !nx.empty(); }
    Vec3d at(std::size_t i) const { return {x[i], y[i], z[i]}; }
    Vec3d normal(std::size_t i) const { return {nx[i], ny[i], nz[i]}; }
    Vec3d source(std::size_t i) const { return origin + at(i); }
    // All points in source coordinates.
    std::vector<Vec3d> sources() const
    {
        std::vector<Vec3d> all(size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = source(i);
        return all;
    }
    // A point, in source coordinates.
    void add(const Vec3d& p)
    {
        x.push_back(p[0] - origin[0]);
        y.push_back(p[1] - origin[1]);
        z.push_back(p[2] - origin[2]);
    }
    void add(const Vec3d& p, const Vec3d& normal)
    {
        add(p);
        nx.push_back(normal[0]);
        ny.push_back(normal[1]);
        nz.push_back(normal[2]);
    }
    // Source coordinates; the origin is the first point.
    static FitPoints of(const std::vector<Vec3d>& points)
    {
        FitPoints result;
        if (!points.empty()) result.origin = points.front();
        for (const Vec3d& p : points) result.add(p);
        return result;
    }
};

}  // namespace pcm
